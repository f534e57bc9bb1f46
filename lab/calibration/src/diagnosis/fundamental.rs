//! The fundamental of a standard's reading while the drive is up to speed.
//!
//! A crank's fundamental is its radius over the sine of its angle, whatever the length of its rod, so that amplitude and frequency
//! of the fundamental tell the rig's stroke where the largest reading does not: harmonics of the rod and noise are in that.

use core::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use crate::series::extent;

/// Cycles in the middle of the run that are fitted: of the recording, or, where that does not move as far as the run does in each half, of the
/// part that moves.
const CYCLES: f64 = 2.0;
/// Share of the largest span of one cycle that each half of what is fitted has, and from which the drive turns.
const TURNING: f64 = 0.5;
/// Share by which the cycle in the middle of what is fitted may span more than one on either side: the drive is up to speed in both.
const STEADY: f64 = 0.02;
/// Harmonics of the fit: a rod of three cranks leaves a thousandth beyond.
const HARMONICS: usize = 4;
/// Corrections of the frequency; it settles in three.
const CORRECTIONS: usize = 8;
/// Relative change of the frequency at which it stands.
const SETTLED: f64 = 1e-9;
/// Departure from the frequency where it was looked for at which it is another one.
const ELSEWHERE: f64 = 0.25;

/// Amplitude and frequency of a sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fundamental {
    /// In the unit of the series.
    pub amplitude: f64,
    /// rad/s.
    pub rate_rad_s: f64,
}

/// Fits a series near a frequency; none where the middle of it holds no such sine.
pub fn measure(series: &[f64], sample_rate_hz: f64, frequency_hz: f64) -> Option<Fundamental> {
    let wanted = (CYCLES * sample_rate_hz / frequency_hz).round();
    if !(wanted >= (4 * HARMONICS) as f64 && wanted <= series.len() as f64) {
        return None;
    }
    let count = wanted as usize;
    let first = middle_of_the_run(series, count);
    let fitted = &series[first..first + count];
    let (early, late) = fitted.split_at(count / 2);
    let middle = span(&fitted[count / 4..count / 4 + count / 2]);
    if middle > (1.0 + STEADY) * span(early).min(span(late)) {
        return None;
    }
    let values = DVector::from_column_slice(fitted);
    // About the middle, so that a change of the frequency does not turn the phase.
    let time_s = |n: usize| (n as f64 - 0.5 * (count - 1) as f64) / sample_rate_hz;
    let start_rad_s = TAU * frequency_hz;
    let mut rate_rad_s = start_rad_s;
    for _ in 0..CORRECTIONS {
        let mut design = DMatrix::from_element(count, 2 * HARMONICS + 1, 1.0);
        for k in 1..=HARMONICS {
            for n in 0..count {
                let (sin, cos) = (k as f64 * rate_rad_s * time_s(n)).sin_cos();
                design[(n, 2 * k - 1)] = cos;
                design[(n, 2 * k)] = sin;
            }
        }
        let normal = (design.transpose() * &design).cholesky()?;
        let shape = normal.solve(&(design.transpose() * &values));
        let residual = &values - &design * &shape;
        // What is left along the derivative by the rate, less what the other columns explain of it.
        let slope = DVector::from_fn(count, |n, _| {
            (1..=HARMONICS)
                .map(|k| {
                    let (cos, sin) = (design[(n, 2 * k - 1)], design[(n, 2 * k)]);
                    let by_phase = shape[2 * k] * cos - shape[2 * k - 1] * sin;
                    k as f64 * time_s(n) * by_phase
                })
                .sum::<f64>()
        });
        let explained = &design * normal.solve(&(design.transpose() * &slope));
        let own = &slope - explained;
        let change = own.dot(&residual) / own.norm_squared();
        rate_rad_s += change;
        let elsewhere = (rate_rad_s / start_rad_s - 1.0).abs();
        if elsewhere.is_nan() || elsewhere > ELSEWHERE {
            return None;
        }
        if change.abs() < SETTLED * rate_rad_s {
            return Some(Fundamental {
                amplitude: shape[1].hypot(shape[2]),
                rate_rad_s,
            });
        }
    }
    None
}

/// First of `count` samples in the middle of the run: a recording may go on at rest, at one end more than at the other.
fn middle_of_the_run(series: &[f64], count: usize) -> usize {
    let cycle = count / 2;
    let spans: Vec<f64> = series.chunks(cycle).map(span).collect();
    let turning = TURNING * spans.iter().copied().fold(0.0, f64::max);
    let middle = (series.len() - count) / 2;
    let (early, late) = series[middle..middle + count].split_at(cycle);
    if span(early).min(span(late)) >= turning {
        return middle;
    }
    let turns = |span: &f64| *span >= turning;
    let from = spans.iter().position(turns).unwrap_or(0);
    let to = spans.iter().rposition(turns).unwrap_or(0);
    let centre = (from + to + 1) * cycle / 2;
    centre.saturating_sub(cycle).min(series.len() - count)
}

fn span(part: &[f64]) -> f64 {
    let (low, high) = extent(part.iter().copied());
    high - low
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Harmonics beyond the fit's and rounding leave this of the amplitude of a crank with a rod of five cranks.
    const LEFT: f64 = 1e-5;

    /// A crank of 1 with a rod of `rod`, its angle off the start by 0.3.
    fn crank(rod: f64, frequency_hz: f64) -> Vec<f64> {
        (0..3000)
            .map(|n| {
                let (sin, cos) = (TAU * frequency_hz * n as f64 * 1e-3 + 0.3).sin_cos();
                cos + (rod * rod - sin * sin).sqrt() + 7.0
            })
            .collect()
    }

    #[test]
    fn inv_a_crank_tells_its_radius_whatever_its_rod() {
        for (rod, stated_hz) in [(1e6, 1.9), (5.0, 1.9), (5.0, 1.95), (3.0, 1.85)] {
            let found = measure(&crank(rod, 1.9), 1000.0, stated_hz).expect("two cycles");
            assert!((found.amplitude - 1.0).abs() < LEFT, "{found:?}");
            assert!(
                (found.rate_rad_s / (TAU * 1.9) - 1.0).abs() < LEFT,
                "{found:?}"
            );
        }
    }

    /// A single turn at full speed between a run-up and a run-down is no two cycles.
    #[test]
    fn inv_a_drive_that_is_hardly_up_to_speed_tells_nothing() {
        let speed = |n: usize| f64::min(1.0, (n as f64 / 526.0).min((1578.0 - n as f64) / 526.0));
        let run = |steady: usize| -> Vec<f64> {
            let mut angle = 0.0;
            (0..1578 + steady)
                .map(|n| {
                    let now = if n < 789 {
                        speed(n)
                    } else {
                        speed(n.saturating_sub(steady).max(789))
                    };
                    angle += TAU * 1.9e-3 * now;
                    now * angle.sin()
                })
                .collect()
        };
        assert_eq!(measure(&run(0), 1000.0, 1.9), None);
        let found = measure(&run(1052), 1000.0, 1.9).expect("two cycles and more");
        assert!((found.amplitude - 1.0).abs() < LEFT, "{found:?}");
    }

    #[test]
    fn inv_a_rest_at_one_end_changes_nothing() {
        let run = crank(5.0, 1.9);
        for (before, after) in [(0, 6000), (6000, 0), (5000, 9000)] {
            let rest = |samples: usize, at: f64| vec![at; samples];
            let ends = [run[0], run[run.len() - 1]];
            let recording = [rest(before, ends[0]), run.clone(), rest(after, ends[1])].concat();
            let found = measure(&recording, 1000.0, 1.9).expect("two cycles");
            assert!((found.amplitude - 1.0).abs() < LEFT, "{found:?}");
        }
    }

    #[test]
    fn neg_no_sine_there() {
        assert_eq!(measure(&[0.0; 3000], 1000.0, 1.9), None);
        assert_eq!(measure(&crank(5.0, 1.9), 1000.0, 0.5), None);
        assert_eq!(measure(&crank(5.0, 1.9), 1000.0, f64::NAN), None);
        assert_eq!(measure(&[], 1000.0, 1.9), None);
    }
}
