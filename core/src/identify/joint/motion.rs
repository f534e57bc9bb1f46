//! The latent motion of one trial and the series that the limbs feel of it.
//!
//! The motion itself is unknown: the standard shows it with a gain error, a lag and noise, the nine channels show it too, and
//! what is estimated is the harmonics q of the acceleration along the travel or of the rate about the pinion's axis. Every
//! limb force is a combination of a few *series* phi_m(q), the same for all limbs:
//!
//! | motion | series | what they multiply |
//! |---|---|---|
//! | linear | a, -a'' | share of the limb; compliance 1/(k/m) |
//! | angular | w', w^2 | inertia; its centrifugal part |
//! | angular, gravity turning | sin theta, 1 - cos theta | gravity square to the axis, in it |
//!
//! A trial that does not end at the angle at which it began has a mean rate, too, behind the harmonics. Its angle is then no periodic
//! signal, nor are sine and cosine of it: they are one and a ramp to where they end.
//!
//! Each comes with its derivative by q, a diagonal of complex factors or, for products of the motion with itself, a matrix.

use alloc::vec::Vec;

use nalgebra::{Complex, DMatrix, DVector};

use super::harmonics::{Grid, harmonic, turn};
use crate::float::{sin_cos, sqrt};

/// Linear operator from the latent harmonics, and the mean behind them if there is one, to the coordinates of a series.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Operator {
    /// Each harmonic by its own factor.
    Diagonal(Vec<Complex<f64>>),
    /// Anything else: (2K + 1) x 2K, or as many columns as rows with a mean.
    Dense(DMatrix<f64>),
}

impl Operator {
    /// With the derivative by the mean behind those by the harmonics.
    fn with_mean(self, by_mean: DVector<f64>) -> Self {
        let dense = match self {
            Self::Dense(matrix) => matrix,
            Self::Diagonal(factors) => {
                let mut matrix = DMatrix::zeros(by_mean.len(), 2 * factors.len());
                for (k, f) in factors.iter().enumerate() {
                    let (re, im) = (2 * k, 2 * k + 1);
                    matrix[(re + 1, re)] = f.re;
                    matrix[(re + 1, im)] = -f.im;
                    matrix[(im + 1, re)] = f.im;
                    matrix[(im + 1, im)] = f.re;
                }
                matrix
            }
        };
        let last = dense.ncols();
        let mut matrix = dense.insert_column(last, 0.0);
        matrix.set_column(last, &by_mean);
        Self::Dense(matrix)
    }

    /// Followed by a filter with the given factor at the mean and at each harmonic.
    pub fn filtered(self, mean: f64, factors: &[Complex<f64>]) -> Self {
        match self {
            Self::Diagonal(own) => {
                Self::Diagonal(own.iter().zip(factors).map(|(a, b)| a * b).collect())
            }
            Self::Dense(mut matrix) => {
                for mut column in matrix.column_iter_mut() {
                    column[0] *= mean;
                    for (k, f) in factors.iter().enumerate() {
                        let z = Complex::new(column[2 * k + 1], column[2 * k + 2]) * f;
                        column[2 * k + 1] = z.re;
                        column[2 * k + 2] = z.im;
                    }
                }
                Self::Dense(matrix)
            }
        }
    }

    /// Its transpose times a series.
    pub fn transposed_times(&self, v: &DVector<f64>) -> DVector<f64> {
        match self {
            Self::Diagonal(factors) => {
                let mut out = DVector::zeros(2 * factors.len());
                for (k, f) in factors.iter().enumerate() {
                    let z = f.conj() * harmonic(v, k + 1);
                    out[2 * k] = z.re;
                    out[2 * k + 1] = z.im;
                }
                out
            }
            Self::Dense(matrix) => matrix.tr_mul(v),
        }
    }

    /// Adds `weight` times A^T B + B^T A, or A^T A where both are the same, to a matrix.
    pub fn add_gram(a: &Self, b: &Self, same: bool, weight: f64, out: &mut DMatrix<f64>) {
        let symmetric = if same { 1.0 } else { 2.0 };
        match (a, b) {
            (Self::Diagonal(a), Self::Diagonal(b)) => {
                for (k, (a, b)) in a.iter().zip(b).enumerate() {
                    // The skew part of conj(a) b drops out of the symmetric sum.
                    let real = symmetric * weight * (a.conj() * b).re;
                    out[(2 * k, 2 * k)] += real;
                    out[(2 * k + 1, 2 * k + 1)] += real;
                }
            }
            (Self::Dense(a), Self::Dense(b)) => {
                let product = a.transpose() * b;
                for row in 0..out.nrows() {
                    for column in 0..out.ncols() {
                        let mirrored = if same { 0.0 } else { product[(column, row)] };
                        out[(row, column)] += weight * (product[(row, column)] + mirrored);
                    }
                }
            }
            (Self::Diagonal(a), Self::Dense(b)) | (Self::Dense(b), Self::Diagonal(a)) => {
                for column in 0..b.ncols() {
                    for (k, f) in a.iter().enumerate() {
                        let z = f.conj()
                            * Complex::new(b[(2 * k + 1, column)], b[(2 * k + 2, column)])
                            * weight;
                        out[(2 * k, column)] += z.re;
                        out[(2 * k + 1, column)] += z.im;
                        out[(column, 2 * k)] += z.re;
                        out[(column, 2 * k + 1)] += z.im;
                    }
                }
            }
        }
    }
}

/// One series and its derivative by the latent harmonics.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    pub value: DVector<f64>,
    pub by_latent: Operator,
}

/// a and -a'' of a linear trial.
pub(super) fn linear(grid: &Grid, latent: &DVector<f64>) -> [Series; 2] {
    let one = (1..=grid.harmonics)
        .map(|_| Complex::new(1.0, 0.0))
        .collect();
    let squared = (1..=grid.harmonics)
        .map(|k| {
            let w = grid.rate_rad_s(k);
            Complex::new(w * w, 0.0)
        })
        .collect();
    [one, squared].map(|factors| diagonal(grid, latent, factors))
}

/// w' and w^2 of an angular trial and, where gravity turns, sin theta and 1 - cos theta.
pub(super) fn angular(grid: &Grid, latent: &DVector<f64>, gravity_turns: bool) -> Vec<Series> {
    let slope = (1..=grid.harmonics)
        .map(|k| Complex::new(0.0, grid.rate_rad_s(k)))
        .collect();
    let root_n = sqrt(grid.samples as f64);
    let mean_rate_rad_s = latent.get(2 * grid.harmonics).map(|mean| mean / root_n);
    let by_mean = |operator: Operator, column: &dyn Fn() -> DVector<f64>| match mean_rate_rad_s {
        None => operator,
        Some(_) => operator.with_mean(column()),
    };
    let Series { value, by_latent } = diagonal(grid, latent, slope);
    let mut series = alloc::vec![Series {
        value,
        by_latent: by_mean(by_latent, &|| DVector::zeros(grid.coordinates())),
    }];
    let fine = Fine::new(grid, if gravity_turns { 8 } else { 4 });
    let amplitude = sqrt(2.0 / grid.samples as f64);
    let rate: Vec<Complex<f64>> = (0..grid.harmonics)
        .map(|k| Complex::new(latent[2 * k], latent[2 * k + 1]) * amplitude)
        .collect();
    let mut w = fine.times(&rate);
    if let Some(mean) = mean_rate_rad_s {
        w.iter_mut().for_each(|w| *w += mean);
    }
    let squares: Vec<f64> = w.iter().map(|w| w * w).collect();
    let twice: Vec<f64> = w.iter().map(|w| 2.0 * w).collect();
    series.push(Series {
        value: fine.coordinates(&squares),
        by_latent: by_mean(fine.product(&twice, None), &|| {
            fine.coordinates(&twice) / root_n
        }),
    });
    if gravity_turns {
        let whole: Vec<Complex<f64>> = (1..=grid.harmonics)
            .map(|k| Complex::new(0.0, -1.0 / grid.rate_rad_s(k)))
            .collect();
        let angle: Vec<Complex<f64>> = rate.iter().zip(&whole).map(|(a, b)| a * b).collect();
        let mut theta = fine.times(&angle);
        // The angle counts from where the run begins.
        let start = theta[0];
        theta.iter_mut().for_each(|t| *t -= start);
        let times_s: Vec<f64> = (0..fine.points).map(|i| fine.time_s(i)).collect();
        let end = mean_rate_rad_s.map(|mean| {
            for (theta, t) in theta.iter_mut().zip(&times_s) {
                *theta += mean * t;
            }
            sin_cos(mean * fine.time_s(fine.points))
        });
        let (sine, cosine): (Vec<f64>, Vec<f64>) = theta.iter().map(|t| sin_cos(*t)).unzip();
        let versine: Vec<f64> = cosine.iter().map(|c| 1.0 - c).collect();
        let [sine_end, cosine_end] = end.map_or([0.0, 1.0], |(sin, cos)| [sin, cos]);
        for (value, value_end, slope, slope_end) in [
            (&sine, sine_end, &cosine, cosine_end),
            (&versine, 1.0 - cosine_end, &sine, sine_end),
        ] {
            let by_angle = fine.product(slope, Some(&whole));
            let grown = || {
                let by_time: Vec<f64> = slope.iter().zip(&times_s).map(|(s, t)| s * t).collect();
                let step = slope_end * fine.time_s(fine.points);
                fine.stepped(&by_time, step) / root_n
            };
            series.push(Series {
                value: match end {
                    None => fine.coordinates(value),
                    Some(_) => fine.stepped(value, value_end),
                },
                by_latent: by_mean(by_angle, &grown),
            });
        }
    }
    series
}

fn diagonal(grid: &Grid, latent: &DVector<f64>, factors: Vec<Complex<f64>>) -> Series {
    let z: Vec<Complex<f64>> = factors
        .iter()
        .enumerate()
        .map(|(k, f)| f * Complex::new(latent[2 * k], latent[2 * k + 1]))
        .collect();
    Series {
        value: grid.vector(0.0, &z),
        by_latent: Operator::Diagonal(factors),
    }
}

/// Times at which products of harmonics are taken: enough of them that no product folds back.
struct Fine<'a> {
    grid: &'a Grid,
    points: usize,
    table: Vec<(f64, f64)>,
}

impl<'a> Fine<'a> {
    fn new(grid: &'a Grid, per_harmonic: usize) -> Self {
        let points = per_harmonic * (grid.harmonics + 1);
        Self {
            grid,
            points,
            table: turn(points),
        }
    }

    /// Sine and cosine of 0, 1, 2 ... times the angle of a place in the table.
    fn turns(&self, place: usize) -> impl Iterator<Item = (f64, f64)> {
        let on = move |at: &usize| {
            let next = at + place;
            Some(next.checked_sub(self.points).unwrap_or(next))
        };
        core::iter::successors(Some(0), on).map(|at| self.table[at])
    }

    /// Values of Re sum a_k exp(i w_k t), k from 1.
    fn times(&self, amplitudes: &[Complex<f64>]) -> Vec<f64> {
        (0..self.points)
            .map(|i| {
                amplitudes
                    .iter()
                    .zip(self.turns(i).skip(1))
                    .map(|(a, (sin, cos))| a.re * cos - a.im * sin)
                    .sum()
            })
            .collect()
    }

    /// Mean and complex amplitudes up to harmonic `last`.
    fn amplitudes(&self, values: &[f64], last: usize) -> (f64, Vec<Complex<f64>>) {
        let share = 1.0 / self.points as f64;
        let mean = values.iter().sum::<f64>() * share;
        let z = (1..=last)
            .map(|k| {
                let (mut re, mut im) = (0.0, 0.0);
                for (v, (sin, cos)) in values.iter().zip(self.turns(k)) {
                    re += v * cos;
                    im -= v * sin;
                }
                Complex::new(2.0 * share * re, 2.0 * share * im)
            })
            .collect();
        (mean, z)
    }

    fn coordinates(&self, values: &[f64]) -> DVector<f64> {
        let n = self.grid.samples as f64;
        let (mean, amplitudes) = self.amplitudes(values, self.grid.harmonics);
        let scale = sqrt(0.5 * n);
        let z: Vec<Complex<f64>> = amplitudes.iter().map(|a| a * scale).collect();
        self.grid.vector(mean * sqrt(n), &z)
    }

    fn time_s(&self, point: usize) -> f64 {
        let duration_s = self.grid.samples as f64 * self.grid.step_s;
        duration_s * point as f64 / self.points as f64
    }

    /// The same of a series that begins at 0 and ends at `step`.
    fn stepped(&self, values: &[f64], step: f64) -> DVector<f64> {
        let per_point = step / self.points as f64;
        let ramped = values.iter().enumerate();
        let level: Vec<f64> = ramped.map(|(i, v)| v - per_point * i as f64).collect();
        self.coordinates(&level) + self.grid.ramp() * step
    }

    /// Multiplication by a series g, after a filter if there is one: with G its amplitudes, the product with
    /// Re d_l exp(i w_l t) has the amplitudes (G_{k-l} d_l + G_{k+l} conj d_l)/2, where G_0 counts twice and G_{-m} is conj G_m.
    fn product(&self, g: &[f64], before: Option<&[Complex<f64>]>) -> Operator {
        let harmonics = self.grid.harmonics;
        let (mean, amplitudes) = self.amplitudes(g, 2 * harmonics);
        let at = |m: isize| -> Complex<f64> {
            match m {
                0 => Complex::new(2.0 * mean, 0.0),
                m if m > 0 => amplitudes[m as usize - 1],
                m => amplitudes[(-m) as usize - 1].conj(),
            }
        };
        let mut matrix = DMatrix::zeros(2 * harmonics + 1, 2 * harmonics);
        let from_value = before.is_some();
        // The angle is counted from its first value, so a change of it that starts elsewhere shifts the whole run.
        let shift: DVector<f64> = if from_value {
            self.coordinates(g)
        } else {
            DVector::zeros(2 * harmonics + 1)
        };
        for l in 1..=harmonics {
            let filter = before.map_or(Complex::new(1.0, 0.0), |b| b[l - 1]);
            for (part, unit) in [Complex::new(1.0, 0.0), Complex::new(0.0, 1.0)]
                .into_iter()
                .enumerate()
            {
                let d = unit * filter;
                let mut column = matrix.column_mut(2 * (l - 1) + part);
                column[0] = core::f64::consts::FRAC_1_SQRT_2 * (at(l as isize).conj() * d).re;
                for k in 1..=harmonics {
                    let z =
                        (at(k as isize - l as isize) * d + at((k + l) as isize) * d.conj()) * 0.5;
                    column[2 * k - 1] = z.re;
                    column[2 * k] = z.im;
                }
                if from_value {
                    let start = sqrt(2.0 / self.grid.samples as f64) * d.re;
                    column.axpy(-start, &shift, 1.0);
                }
            }
        }
        Operator::Dense(matrix)
    }
}
