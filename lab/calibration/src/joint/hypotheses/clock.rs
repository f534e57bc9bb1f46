//! Standards on a clock of their own, which began at another time and runs at another speed than the session says, all day alike.
//!
//! The speed comes from the fundamentals of a trial's strongest channel and of its standard; what is left of both, by which standards
//! lag and by which that grows along the runs, from the channels' responses ([`timing`]). The joint fit then says whether the trials
//! agree to the noise with the standards read on that clock.

use core::f64::consts::TAU;

use rayon::prelude::*;
use sixaxis_core::LIMBS;
use sixaxis_core::dsp::resample::CubicSpline;

use super::Unaccounted;
use super::freedoms::WORTH_A_WORD;
use crate::diagnosis::fundamental;
use crate::diagnosis::table::weighted_median;
use crate::diagnosis::timing;
use crate::finding::{Cause, Finding};
use crate::joint::{at_rest, record};
use crate::response;
use crate::trial::Trial;

/// Corrections by what is left of lag and speed; a lag is read to second order, so that two do.
const CORRECTIONS: usize = 3;
/// Standard deviations from none at which a clock is worth a fit.
const WORTH_A_FIT: f64 = 30.0;

/// The standards' clock by that of the channels: at `behind_s + (1 + faster) t` it shows what happens at `t`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Clock {
    pub behind_s: f64,
    pub faster: f64,
}

/// The clock with which the joint fit accounts for all trials.
pub fn tried(day: &Unaccounted<'_>) -> Option<Finding> {
    let mut clock = Clock {
        behind_s: 0.0,
        faster: by_fundamentals(day)?,
    };
    let mut significance = 0.0_f64;
    for _ in 0..CORRECTIONS {
        let [behind, faster] = left_over(day, clock)?;
        clock.behind_s += behind.0;
        clock.faster += faster.0;
        significance = (clock.behind_s / behind.1)
            .abs()
            .max((clock.faster / faster.1).abs());
    }
    let worth_a_fit = significance > WORTH_A_FIT && worth_a_word(day, clock);
    if !worth_a_fit {
        return None;
    }
    let trials: Vec<Trial> = (day.campaign.trials.iter())
        .map(|(trial, _)| read_on(trial, clock))
        .collect::<Option<_>>()?;
    let borrowed: Vec<&Trial> = trials.iter().collect();
    day.accounting(&borrowed, &at_rest(day.drift), &day.start, day.knowledge)?;
    let evidence = format!(
        "with standards that are {:.3} ms behind the channels at the start of each recording and sampled at {:.6} times their stated rate all trials agree to the noise, and without they do not",
        1e3 * clock.behind_s,
        1.0 + clock.faster
    );
    let advice = "record sensor and standards on one clock, or state reference_start_s and both sample rates";
    Some(Finding::new(Cause::ClockMismatch, evidence, advice))
}

/// Whether it puts so much of a signal into quadrature at the fastest drive, at one of a run's ends, that it is worth a word.
fn worth_a_word(day: &Unaccounted<'_>, clock: Clock) -> bool {
    let trials = || day.campaign.trials.iter().map(|(trial, _)| trial);
    let fastest_rad_s = TAU * trials().map(|t| t.frequency_hz).fold(0.0, f64::max);
    let length_s = |t: &Trial| t.voltage_v.len() as f64 / t.sample_rate_hz;
    let longest_s = trials().map(length_s).fold(0.0, f64::max);
    let at_the_end_s = clock.behind_s + clock.faster * longest_s;
    let late_s = clock.behind_s.abs().max(at_the_end_s.abs());
    late_s * fastest_rad_s > WORTH_A_WORD
}

/// How much faster the standards' clock runs, by the drive's frequency on both.
fn by_fundamentals(day: &Unaccounted<'_>) -> Option<f64> {
    let of = |case: &crate::diagnosis::trial_case::TrialCase<'_>| -> Option<(f64, f64)> {
        let (trial, response) = (case.trial, case.response.as_ref()?);
        let standard = record(trial)?.standard;
        let near_hz = response.frequency_hz.unwrap_or(trial.frequency_hz);
        let strongest = (0..LIMBS).filter(|i| !case.ignored[*i]).max_by(|a, b| {
            let size = |i: usize| response.channels[i].response.abs();
            size(*a).total_cmp(&size(*b))
        })?;
        let channel: Vec<f64> = trial.voltage_v.iter().map(|row| row[strongest]).collect();
        let rate = |series: &[f64]| {
            let found = fundamental::measure(series, trial.sample_rate_hz, near_hz)?;
            Some(found.rate_rad_s)
        };
        Some((rate(&channel)? / rate(standard)? - 1.0, 1.0))
    };
    let mut all: Vec<(f64, f64)> = day.cases.iter().filter_map(of).collect();
    weighted_median(&mut all)
}

/// What standards read on a clock still lag by at the start of a run, s, and by how much faster their clock still is, each with its
/// standard error.
fn left_over(day: &Unaccounted<'_>, clock: Clock) -> Option<[(f64, f64); 2]> {
    let of = |trial: &Trial| -> Option<[(f64, f64); 2]> {
        record(trial)?;
        let trial = read_on(trial, clock)?;
        let conditioned = day.conditioning.condition(&trial).ok()?;
        let force_n: Vec<[f64; LIMBS]> = (conditioned.voltage_v.iter())
            .map(|row| trial.gains.measured_force_n(row, &day.drift.drift_v))
            .collect();
        let response = response::measure(&trial, &conditioned, &force_n)?;
        let [(lag, lag_error), (growth, growth_error)] =
            timing::lag(&trial, &response, &[false; LIMBS]);
        Some([
            (lag - 0.5 * growth, lag_error.hypot(0.5 * growth_error)),
            (
                growth / response.duration_s,
                growth_error / response.duration_s,
            ),
        ])
    };
    let all: Vec<[(f64, f64); 2]> = (day.campaign.trials.par_iter())
        .filter_map(|(trial, _)| of(trial))
        .collect();
    let mean = |what: usize| {
        let (mut weights, mut sum) = (0.0, 0.0);
        for (value, error) in all.iter().map(|trial| trial[what]) {
            weights += 1.0 / (error * error);
            sum += value / (error * error);
        }
        (weights > 0.0 && weights.is_finite()).then(|| (sum / weights, 1.0 / weights.sqrt()))
    };
    Some([mean(0)?, mean(1)?])
}

/// A trial with its standards read on a clock; beyond their ends they stand.
pub(crate) fn read_on(trial: &Trial, clock: Clock) -> Option<Trial> {
    let rate = trial.sample_rate_hz;
    let read = |series: &[f64]| -> Option<Vec<f64>> {
        if series.is_empty() {
            return Some(Vec::new());
        }
        let spline = CubicSpline::even(series, rate).ok()?;
        let last_s = (series.len() - 1) as f64 / rate;
        (0..series.len())
            .map(|n| {
                let shown_s = clock.behind_s + (1.0 + clock.faster) * n as f64 / rate;
                spline.at(shown_s.clamp(0.0, last_s)).ok()
            })
            .collect()
    };
    Some(Trial {
        accelerometer_m_s2: read(&trial.accelerometer_m_s2)?,
        gyroscope_rad_s: read(&trial.gyroscope_rad_s)?,
        ..trial.clone()
    })
}
