//! A record as the lowest harmonics of its own length, in coordinates in which white noise stays white.
//!
//! What begins and ends at rest at the same value is one period of a smooth periodic signal. Of N samples u_n, spaced h,
//!
//! ```text
//! z_0 = sum u_n / sqrt N,    z_k = sqrt(2/N) sum u_n exp(-i w_k n h),    w_k = 2 pi k/(N h),
//! ```
//!
//! are the coordinates in an orthonormal basis: independent noise of standard deviation sigma in the samples is independent
//! noise of sigma in z_0 and in the real and imaginary parts of every z_k. A derivative is a multiplication by i w_k, a
//! first-order instrument one by its frequency response; nothing is filtered and nothing is lost but what lies above the last
//! harmonic, where only noise is. How much noise that is, Parseval says without a second look at the samples.
//!
//! What ends at another value is that and a share of a *ramp*, the samples n/N, whose coordinates are known in closed form.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::RangeInclusive;

use nalgebra::{Complex, DVector};
use pulp::Arch;

use crate::float::{sin_cos, sqrt};

/// Frequencies of one record's harmonics.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// N.
    pub samples: usize,
    /// h, s.
    pub step_s: f64,
    /// K, the last harmonic.
    pub harmonics: usize,
}

impl Grid {
    /// w_k, rad/s.
    #[must_use]
    pub fn rate_rad_s(&self, k: usize) -> f64 {
        core::f64::consts::TAU * k as f64 / (self.samples as f64 * self.step_s)
    }

    /// Number of real coordinates: the mean, then real and imaginary part of each harmonic.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        2 * self.harmonics + 1
    }

    /// Real coordinates from z_0 and z_1 to z_K.
    pub(super) fn vector(&self, mean: f64, z: &[Complex<f64>]) -> DVector<f64> {
        let mut v = DVector::zeros(self.coordinates());
        v[0] = mean;
        for (k, z) in z.iter().enumerate() {
            v[2 * k + 1] = z.re;
            v[2 * k + 2] = z.im;
        }
        v
    }
}

impl Grid {
    /// Coordinates of the ramp n/N.
    pub(super) fn ramp(&self) -> DVector<f64> {
        let n = self.samples as f64;
        let one = Complex::new(1.0, 0.0);
        let z: Vec<Complex<f64>> = (1..=self.harmonics)
            .map(|k| {
                let (sin, cos) = sin_cos(core::f64::consts::TAU * k as f64 / n);
                one / (Complex::new(cos, -sin) - one) * sqrt(2.0 / n)
            })
            .collect();
        self.vector(0.5 * (n - 1.0) / sqrt(n), &z)
    }

    /// The samples that coordinates stand for.
    #[must_use]
    pub fn samples_of(&self, coordinates: &DVector<f64>) -> Vec<f64> {
        let n = self.samples;
        let table = turn(n);
        let (mean, scale) = (coordinates[0] / sqrt(n as f64), sqrt(2.0 / n as f64));
        let mut samples = vec![mean; n];
        for k in 1..=self.harmonics {
            let z = harmonic(coordinates, k) * scale;
            let mut phase = 0;
            for u in &mut samples {
                let (sin, cos) = table[phase];
                *u += z.re * cos - z.im * sin;
                phase += k;
                if phase >= n {
                    phase -= n;
                }
            }
        }
        samples
    }
}

impl Grid {
    /// The same of a series that ends so much higher than it began, which is a step between its last sample and its first.
    pub(super) fn samples_of_stepped(&self, mut coordinates: DVector<f64>, step: f64) -> Vec<f64> {
        coordinates.axpy(-step, &self.ramp(), 1.0);
        let mut samples = self.samples_of(&coordinates);
        let per_sample = step / self.samples as f64;
        for (n, u) in samples.iter_mut().enumerate() {
            *u += per_sample * n as f64;
        }
        samples
    }
}

/// Sine and cosine at every n-th of a turn.
pub(super) fn turn(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| sin_cos(core::f64::consts::TAU * i as f64 / n as f64))
        .collect()
}

/// Harmonic k (from 1) of real coordinates.
pub(super) fn harmonic(v: &DVector<f64>, k: usize) -> Complex<f64> {
    Complex::new(v[2 * k - 1], v[2 * k])
}

/// Harmonics that are made in one pass over the samples, whose numbers take longer to fetch than to multiply.
const TOGETHER: usize = 3;

/// Several series of one record, projected.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection<const C: usize> {
    /// Coordinates of each series.
    pub coordinates: [DVector<f64>; C],
    /// Mean square of what is left of each series above the last harmonic, per coordinate: the noise's variance.
    pub variance: [f64; C],
}

/// The same of series that end so much higher than they began: what of the step lies above the last harmonic is no noise.
#[must_use]
pub(super) fn project_stepped<const C: usize>(
    grid: &Grid,
    step: &[f64; C],
    row: impl Fn(usize) -> [f64; C],
) -> Projection<C> {
    let mut flat = project(grid, level(grid, step, row));
    let ramp = grid.ramp();
    for (coordinates, step) in flat.coordinates.iter_mut().zip(step) {
        coordinates.axpy(*step, &ramp, 1.0);
    }
    flat
}

/// Series that end so much higher than they began, less the ramp to there.
pub(super) fn level<const C: usize>(
    grid: &Grid,
    step: &[f64; C],
    row: impl Fn(usize) -> [f64; C],
) -> impl Fn(usize) -> [f64; C] {
    move |n| {
        let share = n as f64 / grid.samples as f64;
        let row = row(n);
        core::array::from_fn(|c| row[c] - step[c] * share)
    }
}

/// Samples n and N - n, which have the same cosine and opposite sines, added and subtracted: half the work for each harmonic.
struct Folded<const C: usize> {
    samples: usize,
    even: Vec<[f64; C]>,
    odd: Vec<[f64; C]>,
    /// The first sample, which the others are counted from, so that a large offset does not swallow the digits of the rest.
    origin: [f64; C],
    squares: [f64; C],
    sums: [f64; C],
    table: Vec<(f64, f64)>,
}

impl<const C: usize> Folded<C> {
    fn new(n: usize, row: impl Fn(usize) -> [f64; C]) -> Self {
        let half = n / 2;
        let mut even: Vec<[f64; C]> = Vec::with_capacity(half + 1);
        let mut odd: Vec<[f64; C]> = Vec::with_capacity(half + 1);
        let origin = row(0);
        let mut squares = [0.0; C];
        let mut sums = [0.0; C];
        for i in 0..=half {
            let a = change(row(i), &origin);
            let mirror = (n - i) % n;
            let (plus, minus) = if mirror == i {
                (a, [0.0; C])
            } else {
                let b = change(row(mirror), &origin);
                for c in 0..C {
                    squares[c] += b[c] * b[c];
                    sums[c] += b[c];
                }
                (
                    core::array::from_fn(|c| a[c] + b[c]),
                    core::array::from_fn(|c| a[c] - b[c]),
                )
            };
            for c in 0..C {
                squares[c] += a[c] * a[c];
                sums[c] += a[c];
            }
            even.push(plus);
            odd.push(minus);
        }
        Self {
            samples: n,
            even,
            odd,
            origin,
            squares,
            sums,
            table: turn(n),
        }
    }

    /// z_k of each series, of k from 1 on in a range.
    fn harmonics(&self, range: RangeInclusive<usize>) -> Vec<[Complex<f64>; C]> {
        let scale = sqrt(2.0 / self.samples as f64);
        turned((&self.even, &self.odd), &self.table, range)
            .map(|(re, im)| core::array::from_fn(|c| Complex::new(scale * re[c], scale * im[c])))
            .collect()
    }
}

/// Sums of series times the cosine of k turns over a record, and of others times minus its sine, for each k of a range.
fn turned<const C: usize>(
    (even, odd): (&[[f64; C]], &[[f64; C]]),
    table: &[(f64, f64)],
    range: RangeInclusive<usize>,
) -> impl Iterator<Item = ([f64; C], [f64; C])> {
    let count = (range.end() + 1).saturating_sub(*range.start());
    // The last pass may be for more of them than are wanted: it takes as long.
    range
        .step_by(TOGETHER)
        .flat_map(move |first| Arch::new().dispatch(|| turned_together(even, odd, table, first)))
        .take(count)
}

#[inline(always)]
fn turned_together<const C: usize>(
    even: &[[f64; C]],
    odd: &[[f64; C]],
    table: &[(f64, f64)],
    first: usize,
) -> [([f64; C], [f64; C]); TOGETHER] {
    let mut sums = [([0.0; C], [0.0; C]); TOGETHER];
    let mut phases = [0; TOGETHER];
    for (plus, minus) in even.iter().zip(odd) {
        for (j, phase) in phases.iter_mut().enumerate() {
            let (sin, cos) = table[*phase];
            let (re, im) = &mut sums[j];
            for c in 0..C {
                re[c] += plus[c] * cos;
            }
            for c in 0..C {
                im[c] -= minus[c] * sin;
            }
            *phase += first + j;
            if *phase >= table.len() {
                *phase -= table.len();
            }
        }
    }
    sums
}

/// Projects the series whose samples `row` gives.
#[must_use]
pub fn project<const C: usize>(grid: &Grid, row: impl Fn(usize) -> [f64; C]) -> Projection<C> {
    let n = grid.samples;
    let folded = Folded::new(n, row);
    let root_n = sqrt(n as f64);
    let z = folded.harmonics(1..=grid.harmonics);
    let (squares, sums) = (&folded.squares, &folded.sums);
    let left = (n - grid.coordinates()) as f64;
    let variance = core::array::from_fn(|c| {
        let inside = sums[c] * sums[c] / n as f64 + z.iter().map(|z| z[c].norm_sqr()).sum::<f64>();
        ((squares[c] - inside) / left).max(0.0)
    });
    let coordinates = core::array::from_fn(|c| {
        let own: Vec<Complex<f64>> = z.iter().map(|z| z[c]).collect();
        grid.vector(sums[c] / root_n + folded.origin[c] * root_n, &own)
    });
    Projection {
        coordinates,
        variance,
    }
}

/// Squares of some harmonics, from 1, of each series: of noise of unit variance 1 in the mean.
pub(super) fn squares<const C: usize>(
    grid: &Grid,
    row: impl Fn(usize) -> [f64; C],
    harmonics: RangeInclusive<usize>,
) -> [Vec<f64>; C] {
    let of = Folded::new(grid.samples, row).harmonics(harmonics);
    core::array::from_fn(|c| of.iter().map(|z| 0.5 * z[c].norm_sqr()).collect())
}

/// Mean square of the coordinates of some harmonics of each series, from 1.
pub(super) fn mean_square<const C: usize>(
    grid: &Grid,
    row: impl Fn(usize) -> [f64; C],
    harmonics: RangeInclusive<usize>,
) -> [f64; C] {
    let n = grid.samples;
    let (table, rows) = (turn(n), (0..n).map(row).collect::<Vec<_>>());
    let (mut squares, mut coordinates) = ([0.0; C], 0.0);
    for (re, im) in turned((&rows, &rows), &table, harmonics) {
        for c in 0..C {
            squares[c] += (re[c] * re[c] + im[c] * im[c]) * 2.0 / n as f64;
        }
        coordinates += 2.0;
    }
    squares.map(|squares| squares / coordinates)
}

fn change<const C: usize>(row: [f64; C], origin: &[f64; C]) -> [f64; C] {
    core::array::from_fn(|c| row[c] - origin[c])
}
