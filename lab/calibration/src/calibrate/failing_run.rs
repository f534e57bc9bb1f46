//! Why a run that was not fitted fails: what is odd about it by the other trials, that it is not whole, that rows of it are missing, that
//! its channels are noisy or its converter coarse.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use sixaxis_core::LIMBS;
use sixaxis_page::number::significant;
use sixaxis_recordings::session::Role;

use super::validation::{Decoding, arm_m, compare, errors};
use crate::conditioning::Conditioned;
use crate::diagnosis::raw::converter_step_v;
use crate::finding::{Cause, Finding};
use crate::grade::worst;
use crate::prepare::{PreparedSession, for_role};
use crate::report::{TrialReport, ValidationRun};
use crate::trial::Trial;

/// Share of the drive's period at either end of a run over which a rest shows, and the share of the gyroscope's peak that its swing has
/// in none.
const END_PERIODS: f64 = 0.05;
const TURNS: f64 = 0.1;

/// Share of a failing run's departure that noise and rounding make at least where they are its cause.
const MOST: f64 = 0.5;

/// Times the usual bend of a channel's course that a jump has, and the share of bends that are usual.
const JUMP: f64 = 4.0;
const USUAL: f64 = 0.99;

/// Completes the finding that a run fails with why, as far as that is known.
pub(super) fn explain(
    failure: &mut Finding,
    suspected: &[Finding],
    prepared: &PreparedSession,
    decoding: Option<&Decoding<'_>>,
    reports: &[TrialReport],
) {
    let [name] = &failure.recordings[..] else {
        return;
    };
    let runs = prepared.campaign.trials.iter().zip(reports);
    let mut runs = runs.filter(|((trial, _), _)| trial.role == Role::Validation);
    let run = runs.find(|((trial, _), _)| trial.name == *name);
    // Rows that are missing make a run look like anything.
    if let Some((sample, channels)) = run.and_then(|((trial, _), _)| rows_missing(trial)) {
        failure.cause = Cause::Unreadable;
        failure.evidence = format!(
            "{}; {channels} of its channels jump at once after sample {sample} and go on evenly from there: rows are missing",
            failure.evidence
        );
        failure.advice = "record the run again, without a gap".to_owned();
        return;
    }
    if let Some(odd) = suspected.iter().find(|f| f.recordings.contains(name)) {
        failure.cause = odd.cause;
        failure.channels.clone_from(&odd.channels);
        failure.evidence = format!("{}; {}", failure.evidence, odd.evidence);
        failure.advice.clone_from(&odd.advice);
    }
    let Some(((trial, conditioned), report)) = run else {
        return;
    };
    // What is compared is decoupled as one from rest to rest.
    let mut broken_off = prepared.broken_off.iter();
    let broken_off = broken_off.find(|(_, names)| names.contains(&trial.name));
    let how = broken_off.map(|(how, _)| how.clone());
    if let Some(how) = how.or_else(|| turns_at_an_end(trial)) {
        failure.cause = Cause::Unreadable;
        failure.evidence = format!("{}; {how}", failure.evidence);
        failure.advice = "record the run whole, from rest to rest".to_owned();
    }
    let off = report.validation.map(|errors| worst(&errors));
    if let (Cause::Unexplained, Some(decoding), Some(off)) = (failure.cause, decoding, off) {
        noisy(failure, prepared, decoding, (trial, conditioned), off);
    }
}

/// The sample after which rows are missing, and how many channels jump there.
fn rows_missing(trial: &Trial) -> Option<(usize, usize)> {
    let rows = &trial.voltage_v;
    let changes = rows.len().checked_sub(1)?;
    let mut jumps = vec![0_usize; changes];
    for channel in 0..LIMBS {
        let series: Vec<f64> = rows.iter().map(|row| row[channel]).collect();
        let change = |i: usize| series[i + 1] - series[i];
        // Of a change, what is not as before and after it.
        let bends: Vec<f64> = (1..changes.saturating_sub(1))
            .map(|i| (change(i) - 0.5 * (change(i - 1) + change(i + 1))).abs())
            .collect();
        let mut sorted = bends.clone();
        let place = (USUAL * sorted.len() as f64) as usize;
        if place >= sorted.len() {
            return None;
        }
        let (_, usual, _) = sorted.select_nth_unstable_by(place, f64::total_cmp);
        // A jump bends its neighbours half as much; of a single wild sample both changes bend alike.
        for (i, three) in bends.windows(3).enumerate() {
            let alone = three[1] > 1.5 * three[0].max(three[2]);
            jumps[i + 2] += usize::from(alone && three[1] > JUMP * *usual);
        }
    }
    let (sample, channels) = jumps.iter().enumerate().max_by_key(|(_, count)| **count)?;
    (*channels > LIMBS / 2).then_some((sample, *channels))
}

/// Where noise and rounding of the run's channels alone make as much as it is off: it is decoupled once more with as much of both again.
fn noisy(
    failure: &mut Finding,
    prepared: &PreparedSession,
    decoding: &Decoding<'_>,
    (trial, conditioned): (&Trial, &Conditioned),
    off: f64,
) {
    let Some(rest) = &prepared.at_rest else {
        return;
    };
    let campaign = &prepared.campaign;
    let steps_v: [f64; LIMBS] = core::array::from_fn(|i| converter_step_v(trial, i));
    let more = Trial {
        voltage_v: noisier(trial, &deviations_v(&steps_v, rest)),
        ..trial.clone()
    };
    let conditioning = for_role(&prepared.conditioning, trial.role);
    let Ok(more) = conditioning.condition(&more) else {
        return;
    };
    let [run, more] = [conditioned, &more].map(|of| compare(campaign, trial, of, decoding));
    let (Ok(run), Ok(more)) = (run, more) else {
        return;
    };
    let moved = run.decoupled.iter().zip(&more.decoupled).zip(&run.standard);
    let decoupled = moved
        .map(|((a, b), standard)| core::array::from_fn(|i| standard[i] + b[i] - a[i]))
        .collect();
    let by_noise = worst(&errors(
        &ValidationRun { decoupled, ..run },
        arm_m(&campaign.design),
    ));
    if by_noise > MOST * off {
        let step_v = steps_v.iter().copied().filter(|v| v.is_finite());
        failure.cause = Cause::Noisy;
        failure.evidence = format!(
            "{}; as much noise and rounding again as its channels have, in steps of {} V, moves it by {:.1} %",
            failure.evidence,
            significant(step_v.fold(0.0, f64::max), 2),
            100.0 * by_noise
        );
        failure.advice = "record the run in ranges that it fills, with a converter of more bits or less noise, or state the validation_percent in [limits] that this one can meet".to_owned();
    }
}

/// Deviation of each channel's noise and rounding, V: as the static record's samples differ from their neighbours, and no less than a
/// step's.
fn deviations_v(steps_v: &[f64; LIMBS], rest: &Trial) -> [f64; LIMBS] {
    core::array::from_fn(|i| {
        let pairs = rest.voltage_v.windows(2);
        let squares: f64 = pairs.map(|pair| (pair[1][i] - pair[0][i]).powi(2)).sum();
        let at_rest = (0.5 * squares / rest.voltage_v.len().max(1) as f64).sqrt();
        let step = Some(steps_v[i]).filter(|step| step.is_finite());
        at_rest.max(step.unwrap_or(0.0) / 12f64.sqrt())
    })
}

/// A trial's voltages with evenly distributed white noise of such deviations: the same for the same trial.
fn noisier(trial: &Trial, deviations_v: &[f64; LIMBS]) -> Vec<[f64; LIMBS]> {
    let mut numbers = Pcg64::seed_from_u64(1);
    let mut noisy = trial.voltage_v.clone();
    for row in &mut noisy {
        for (u, deviation) in row.iter_mut().zip(deviations_v) {
            *u += deviation * 12f64.sqrt() * (numbers.random::<f64>() - 0.5);
        }
    }
    noisy
}

/// That the gyroscope turns at the first or the last samples of a run. Where it passes through zero it changes fastest: of a swing at the
/// drive's frequency, rate and change together tell the size.
fn turns_at_an_end(trial: &Trial) -> Option<String> {
    let rate = &trial.gyroscope_rad_s;
    let mean_of = |part: &[f64]| part.iter().sum::<f64>() / part.len().max(1) as f64;
    let mean = mean_of(rate);
    let peak = rate.iter().fold(0.0_f64, |peak, r| peak.max(r.abs()));
    let drive_rad_s = core::f64::consts::TAU * trial.frequency_hz;
    let half = (0.5 * END_PERIODS * trial.sample_rate_hz / trial.frequency_hz) as usize;
    let half = half.clamp(1, (rate.len() / 2).max(1));
    let ends = [
        ("begins", &rate[..(2 * half).min(rate.len())]),
        ("ends", &rate[rate.len().saturating_sub(2 * half)..]),
    ];
    ends.into_iter().find_map(|(which, end)| {
        let (first, last) = end.split_at(end.len() / 2);
        let change_rad_s2 = (mean_of(last) - mean_of(first)) * trial.sample_rate_hz / half as f64;
        let at_end = mean_of(end);
        let swing = at_end
            .abs()
            .min((at_end - mean).abs())
            .hypot(change_rad_s2 / drive_rad_s);
        (swing > TURNS * peak).then(|| {
            format!(
                "it {which} in motion, where the gyroscope reads {at_end:.2} rad/s and changes by {change_rad_s2:.1} rad/s²: it is not whole"
            )
        })
    })
}
