//! Allan deviation of a channel at rest, and what it tells: noise density, bias instability, random walk.
//!
//! The variance at an averaging time of m samples is half the mean square of the difference of two neighbouring means over m samples,
//! taken at every quarter of m, or at every sample where that is less than one: from m = 4 on four times as many differences as means that do not overlap, in a memory that does not grow with
//! the record, without its length being known beforehand, and without a sum of all samples, whose rounding a large mean turns into
//! noise. The coefficients are fitted to differences of means that do not overlap, which for white noise are independent from one
//! averaging time to the next: only then do their errors add up. (The crate `allan` 0.4 keeps twice the longest averaging time and such a sum.) Averaging times are 1, 2, 4 ... samples.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// Means of one averaging time that must fit into the record for it to be told: eight differences or more.
const LEAST_MEANS: u64 = 9;
/// Differences of means that do not overlap, of an averaging time that is fitted.
const LEAST_APART: u64 = 4;
/// Quarters of an averaging time of which two neighbouring means consist.
const QUARTERS: usize = 8;
/// A coefficient is told from so many of its standard errors on.
const SIGNIFICANT: f64 = 3.0;
/// Allan deviation of flicker noise over its bias instability: root of 2 ln 2 / pi.
const FLICKER: f64 = 0.664;
/// Reduced chi-square of the model from which the record holds something else: motion, hum, jumps.
const MISFIT: f64 = 5.0;
/// Chi-square that one more term must take off.
const PRICE: f64 = 6.0;
/// Errors of flicker and walk over those of independent differences: a difference of a walk's means is correlated by 0.53 with that of
/// the next averaging time over the same samples.
const CORRELATED: f64 = 1.5;
/// Rounds of fitting with the weights of the round before.
const ROUNDS: usize = 4;

/// Deviation at one averaging time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Deviation {
    /// Averaging time, s.
    pub averaging_s: f64,
    /// Allan deviation, the channel's unit.
    pub deviation: f64,
    /// One standard deviation of it, from the number of differences, at most.
    pub standard_error: f64,
}

/// A coefficient with one standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coefficient {
    /// Its value.
    pub value: f64,
    /// One standard deviation of it.
    pub standard_error: f64,
}

/// What a channel at rest shows over averaging times.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stability {
    /// Allan deviations, averaging times ascending.
    pub deviations: Vec<Deviation>,
    /// One-sided density of the white noise, unit/root(Hz): root of twice the coefficient that IEEE 952 calls N, squared.
    pub noise_density: Option<Coefficient>,
    /// The lowest deviation over 0.664, the channel's unit, and its averaging time; where flicker or a random walk stand out of the
    /// white noise and the deviation rises again.
    pub bias_instability: Option<(Coefficient, f64)>,
    /// Random walk of the mean (IEEE 952: K), unit/root(s).
    pub random_walk: Option<Coefficient>,
    /// Why a coefficient is null.
    pub absent: BTreeMap<&'static str, String>,
}

/// Takes samples one by one.
#[derive(Debug, Clone, Default)]
pub struct Allan {
    levels: Vec<Level>,
}

/// Means over 2^k samples each.
#[derive(Debug, Clone, Default)]
struct Level {
    /// The last eight, in turn.
    means: [f64; QUARTERS],
    /// Means since the last gap.
    count: u64,
    /// The first of two that become one of the next level.
    half: Option<f64>,
    /// Of each of the averaging times of 1, 2 and 4 of its means; coarser levels than the first use the last alone.
    sums: [Sum; 3],
    /// Of means that do not overlap, of one of them.
    apart: Sum,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    squares: f64,
    differences: u64,
}

impl Sum {
    fn add(&mut self, difference: f64) {
        self.squares += difference * difference;
        self.differences += 1;
    }
}

impl Allan {
    /// Takes the next samples. A value that is not finite is a gap: no difference reaches over it.
    pub fn extend(&mut self, samples: &[f64]) {
        for &x in samples {
            if x.is_finite() {
                self.push(x);
            } else {
                for level in &mut self.levels {
                    (level.count, level.half) = (0, None);
                }
            }
        }
    }

    fn push(&mut self, sample: f64) {
        let mut next = Some(sample);
        let mut k = 0;
        while let Some(mean) = next {
            if k == self.levels.len() {
                self.levels.push(Level::default());
            }
            next = self.levels[k].push(mean, k == 0);
            k += 1;
        }
    }

    /// What the samples show at so many of them a second; none of less than two averaging times.
    pub fn finish(&self, samples: u64, rate_hz: f64) -> Option<Stability> {
        let first = self.levels.first()?.sums.iter().take(2).enumerate();
        let longer = self
            .levels
            .iter()
            .enumerate()
            .map(|(k, level)| (k + 2, &level.sums[2]));
        let times = first
            .chain(longer)
            .map(|(k, sum)| (1_u64 << k.min(62), sum));
        let told = times.filter(|(m, sum)| samples / m >= LEAST_MEANS && sum.differences > 0);
        // Differences of neighbours are correlated: of white noise two thirds are free; of overlapping means no more are counted
        // than of those that do not overlap.
        let points: Vec<Point> = told
            .map(|(m, sum)| {
                let means = samples as f64 / m as f64;
                let freedom = if m == 1 {
                    means * (2.0 / 3.0)
                } else {
                    means - 1.0
                };
                Point::new(m, sum, freedom.min(sum.differences as f64), rate_hz)
            })
            .collect();
        let apart = self.levels.iter().enumerate();
        let apart: Vec<Point> = apart
            .map(|(k, level)| (1_u64 << k.min(62), &level.apart))
            .filter(|(_, sum)| sum.differences >= LEAST_APART)
            .map(|(m, sum)| Point::new(m, sum, sum.differences as f64, rate_hz))
            .collect();
        (points.len() >= 2).then(|| Stability::of(&points, &apart, rate_hz))
    }
}

impl Level {
    /// Takes a mean; returns one of the next level where it is complete.
    fn push(&mut self, mean: f64, finest: bool) -> Option<f64> {
        self.means[(self.count % QUARTERS as u64) as usize] = mean;
        self.count += 1;
        for (power, sum) in self.sums.iter_mut().enumerate() {
            let m = 1_usize << power;
            if (finest || power == 2) && self.count >= 2 * m as u64 {
                let of = |back: usize| {
                    let at =
                        |j| self.means[((self.count - 1 - j as u64) % QUARTERS as u64) as usize];
                    (back..back + m).map(at).sum::<f64>()
                };
                let difference = (of(0) - of(m)) / m as f64;
                sum.add(difference);
            }
        }
        match self.half.take() {
            None => {
                self.half = Some(mean);
                None
            }
            Some(first) => {
                self.apart.add(mean - first);
                Some(0.5 * (first + mean))
            }
        }
    }
}

/// A variance with its degrees of freedom.
#[derive(Clone, Copy)]
struct Point {
    averaging_s: f64,
    variance: f64,
    freedom: f64,
}

impl Point {
    fn new(m: u64, sum: &Sum, freedom: f64, rate_hz: f64) -> Self {
        Self {
            averaging_s: m as f64 / rate_hz,
            variance: 0.5 * sum.squares / sum.differences as f64,
            freedom,
        }
    }

    /// Standard error over value, of the deviation.
    fn relative(&self) -> f64 {
        1.0 / (2.0 * self.freedom).sqrt()
    }

    /// What N^2 of white noise, the square of a constant deviation and K^2 of a random walk add to the variance. The walk's second
    /// term is that of a walk by steps from sample to sample.
    fn row(&self, step_s: f64) -> Vector3<f64> {
        let tau = self.averaging_s;
        Vector3::new(1.0 / tau, 1.0, tau / 3.0 + step_s * step_s / (6.0 * tau))
    }
}

impl Stability {
    /// `points` are told, `apart` are fitted.
    fn of(points: &[Point], apart: &[Point], rate_hz: f64) -> Self {
        let deviations: Vec<Deviation> = points
            .iter()
            .map(|point| Deviation {
                averaging_s: point.averaging_s,
                deviation: point.variance.sqrt(),
                standard_error: point.variance.sqrt() * point.relative(),
            })
            .collect();
        let longest_s = points.last().map_or(0.0, |point| point.averaging_s);
        let mut absent = BTreeMap::new();
        let fit = Fit::of(apart, 1.0 / rate_hz);
        let mut coefficient = |name, k: usize, scale: f64, why: String| {
            let cause = match &fit {
                None => "the channel stands still".to_owned(),
                Some(fit) if fit.chi_square > MISFIT => format!(
                    "the deviations are no sum of white noise, flicker and a random walk (chi-square {:.1} a degree of freedom): motion, hum or jumps",
                    fit.chi_square
                ),
                Some(fit) => {
                    let (square, error) = (fit.squares[k], fit.errors[k]);
                    if square > SIGNIFICANT * error {
                        let value = square.sqrt();
                        return Some(Coefficient {
                            value: scale * value,
                            standard_error: scale * 0.5 * error / value,
                        });
                    }
                    why
                }
            };
            absent.insert(name, cause);
            None
        };
        let noise_density = coefficient(
            "noise_density",
            0,
            core::f64::consts::SQRT_2,
            "no white noise stands out".to_owned(),
        );
        let random_walk = coefficient(
            "random_walk",
            2,
            1.0,
            format!("record too short: no rise out of the noise up to {longest_s} s"),
        );
        let lowest = deviations
            .iter()
            .min_by(|a, b| a.deviation.total_cmp(&b.deviation));
        let rises = |lowest: &&Deviation| {
            let stands_out = |fit: &Fit, k: usize| fit.squares[k] > SIGNIFICANT * fit.errors[k];
            // Where the shortest one is the lowest there was no white noise to stand out of.
            lowest.averaging_s < longest_s
                && lowest.averaging_s > deviations[0].averaging_s
                && fit
                    .as_ref()
                    .is_some_and(|fit| stands_out(fit, 1) || stands_out(fit, 2))
        };
        let bias_instability = lowest.filter(rises).map(|lowest| {
            let value = Coefficient {
                value: lowest.deviation / FLICKER,
                standard_error: lowest.standard_error / FLICKER,
            };
            (value, lowest.averaging_s)
        });
        if bias_instability.is_none() {
            let at_once = |lowest: &Deviation| lowest.averaging_s == deviations[0].averaging_s;
            let why = if lowest.is_some_and(at_once) {
                "the deviation rises from the shortest time on: no white noise to stand out of"
                    .to_owned()
            } else {
                format!("record too short: no rise after the lowest deviation up to {longest_s} s")
            };
            absent.insert("bias_instability", why);
        }
        Self {
            deviations,
            noise_density,
            bias_instability,
            random_walk,
            absent,
        }
    }
}

/// Squares of the three coefficients, none negative, by weighted least squares.
struct Fit {
    squares: Vector3<f64>,
    errors: Vector3<f64>,
    /// Per degree of freedom.
    chi_square: f64,
    /// Chi-square and the price of its terms: flicker and a random walk look alike, and a term that hardly helps spoils the other.
    score: f64,
}

impl Fit {
    fn of(points: &[Point], step_s: f64) -> Option<Self> {
        let rows: Vec<_> = points.iter().map(|point| point.row(step_s)).collect();
        let mut expected: Vec<f64> = points.iter().map(|point| point.variance).collect();
        let mut best = None;
        for _ in 0..ROUNDS {
            if expected.iter().any(|variance| !variance.is_normal()) {
                return None;
            }
            best = (1..8_u8)
                .filter_map(|subset| Self::with(points, &rows, &expected, subset))
                .min_by(|a, b| a.score.total_cmp(&b.score));
            let squares = best.as_ref()?.squares;
            expected = rows.iter().map(|row| row.dot(&squares)).collect();
        }
        best
    }

    /// With the coefficients of a set, by bits.
    fn with(points: &[Point], rows: &[Vector3<f64>], expected: &[f64], subset: u8) -> Option<Self> {
        // In units of the expected variances, so that three terms of very different size stand on an equal footing.
        let size = Vector3::from_fn(|k, _| {
            let largest = rows
                .iter()
                .zip(expected)
                .map(|(row, variance)| row[k] / variance);
            largest.fold(0.0, f64::max)
        });
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for ((point, row), variance) in points.iter().zip(rows).zip(expected) {
            let weight = 0.5 * point.freedom;
            let row = Vector3::from_fn(|k, _| match subset >> k & 1 {
                1 => row[k] / variance / size[k],
                _ => 0.0,
            });
            normal += weight * row * row.transpose();
            right += weight * (point.variance / variance) * row;
        }
        for k in 0..3 {
            if subset >> k & 1 == 0 {
                normal[(k, k)] = 1.0;
            }
        }
        let inverse = normal.cholesky()?.inverse();
        let scaled: Vector3<f64> = inverse * right;
        let squares = scaled.component_div(&size);
        let variances = inverse.diagonal().map(f64::sqrt).component_div(&size);
        let correlated = Vector3::new(1.0, CORRELATED, CORRELATED);
        let errors =
            Vector3::from_fn(|k, _| f64::from(subset >> k & 1) * variances[k] * correlated[k]);
        let misfit = points
            .iter()
            .zip(rows)
            .zip(expected)
            .map(|((point, row), variance)| {
                let apart = (point.variance - row.dot(&squares)) / variance;
                0.5 * point.freedom * apart * apart
            });
        let misfit: f64 = misfit.sum();
        let terms = subset.count_ones() as usize;
        let chi_square = misfit / points.len().saturating_sub(terms).max(1) as f64;
        let score = misfit + PRICE * terms as f64;
        let possible = squares
            .iter()
            .all(|square| *square >= 0.0 && square.is_finite());
        possible.then_some(Self {
            squares,
            errors,
            chi_square,
            score,
        })
    }
}

#[cfg(test)]
#[path = "allan/tests.rs"]
mod tests;
