//! Why a run that was not fitted fails: what is odd about it by the other trials, that it is not whole, that rows of it are missing, that
//! its channels are noisy or its converter coarse, that its zeros are others than those of the static record.

#[cfg(test)]
mod tests;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use sixaxis_core::identify::inertia::euler_torque;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::{LIMBS, Parameters};
use sixaxis_page::number::significant;
use sixaxis_recordings::session::{Limits, Role};

use super::validation::{Decoding, arm_m, compare, errors, in_sensor_axes};
use crate::conditioning::{Conditioned, Stage};
use crate::diagnosis::drift::{WANDERS, rests};
use crate::diagnosis::raw::converter_step_v;
use crate::finding::{Cause, Finding};
use crate::grade::{fails, worst};
use crate::prepare::{PreparedSession, for_role};
use crate::report::{TrialReport, ValidationRun};
use crate::series::mean_of;
use crate::steps::Campaign;
use crate::trial::Trial;

/// Share of the drive's period at either end of a run over which a rest shows, and the share of the gyroscope's peak that its swing has
/// in none.
const END_PERIODS: f64 = 0.05;
const TURNS: f64 = 0.1;

/// Share of a failing run's departure, and of the peak of one that is lost, that noise and rounding make at least where they are its cause.
const MOST: f64 = 0.5;

/// Departure of a run, relative, from which the open loop has lost it, and its size says nothing.
const LOST: f64 = 1.0;
/// Times the converter's largest step from which a channel's noise is none of its rounding.
const NO_ROUNDING: f64 = 3.0;
/// Share of the zero that has moved most from which others have moved along with it.
const ALONG: f64 = 0.3;

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
    limits: &Limits,
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
    // One that cannot be decoupled at all is as far off as can be.
    let off = report
        .validation
        .map_or(f64::INFINITY, |errors| worst(&errors));
    if let (Cause::Unexplained, Some(decoding)) = (failure.cause, decoding) {
        let run = (trial, conditioned);
        let found = noisy(prepared, decoding, run, off)
            .or_else(|| moved_zeros(&prepared.campaign, decoding, run, limits));
        if let Some(found) = found {
            failure.cause = found.cause;
            failure.channels = found.channels;
            failure.evidence = format!("{}; {}", failure.evidence, found.evidence);
            failure.advice = found.advice;
        }
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

/// Where noise and rounding of the run's channels alone make as much as it is off. They are put on channels that follow the standards: a run
/// that departs for another reason magnifies whatever is put on it, and so would seem noisy.
fn noisy(
    prepared: &PreparedSession,
    decoding: &Decoding<'_>,
    (trial, conditioned): (&Trial, &Conditioned),
    off: f64,
) -> Option<Finding> {
    let rest = prepared.at_rest.as_ref()?;
    let campaign = &prepared.campaign;
    let steps_v: [f64; LIMBS] = core::array::from_fn(|i| converter_step_v(trial, i));
    let deviations_v = deviations_v(&steps_v, rest);
    let quiet = following(campaign, decoding, trial, conditioned)?;
    // About a level of as many samples as the recorded trial's: conditioning is linear then.
    let mut conditioning = for_role(&prepared.conditioning, trial.role);
    conditioning.level_samples = Some(conditioning.level_samples(trial));
    let conditioned_of = |voltage_v: Vec<[f64; LIMBS]>| {
        let trial = Trial {
            voltage_v,
            ..trial.clone()
        };
        conditioning.condition(&trial).ok()
    };
    let less = conditioned_of(quiet.voltage_v.clone())?;
    let more = conditioned_of(noisier(&quiet.voltage_v, &deviations_v, &steps_v))?;
    let noise = more.voltage_v.iter().zip(&less.voltage_v);
    let noisy = quiet.voltage_v.iter().zip(noise);
    let noisy = noisy.map(|(u, (more, less))| core::array::from_fn(|i| u[i] + more[i] - less[i]));
    let noisy = Conditioned {
        voltage_v: noisy.collect(),
        ..quiet.clone()
    };
    let plain = Decoding {
        limbs: None,
        ..*decoding
    };
    let run = compare(campaign, trial, &quiet, &plain).ok()?;
    // One that cannot be decoupled any more is lost.
    let by_noise = compare(campaign, trial, &noisy, &plain).map_or(f64::INFINITY, |more| {
        let moved = run.decoupled.iter().zip(&more.decoupled).zip(&run.standard);
        let decoupled = moved
            .map(|((a, b), standard)| core::array::from_fn(|i| standard[i] + b[i] - a[i]))
            .collect();
        let run = ValidationRun {
            decoupled,
            ..run.clone()
        };
        worst(&errors(&run, arm_m(&campaign.design)))
    });
    if by_noise <= MOST * off.min(LOST) {
        return None;
    }
    let finite = steps_v.iter().copied().filter(|v| v.is_finite());
    let step_v = finite.fold(0.0, f64::max);
    let noisiest = (0..LIMBS).max_by(|a, b| deviations_v[*a].total_cmp(&deviations_v[*b]))?;
    let noise_v = deviations_v[noisiest];
    let is_rounding = noise_v < NO_ROUNDING * step_v;
    let most = if is_rounding {
        String::new()
    } else {
        format!(
            " (channel {} has most, {} V)",
            noisiest + 1,
            significant(noise_v, 2)
        )
    };
    let effect = if by_noise > LOST {
        "take a run that follows the standards somewhere else altogether".to_owned()
    } else {
        format!(
            "move a run that follows the standards by {:.1} %",
            100.0 * by_noise
        )
    };
    let evidence = format!(
        "noise and rounding as its channels have them{most}, in steps of {} V, {effect}",
        significant(step_v, 2),
    );
    let source = if is_rounding {
        ""
    } else {
        "find where the noise comes from, of which sixaxis inspect tells hum; "
    };
    let undone = if conditioning.has(Stage::HighPass) {
        ": behind a high-pass that is undone noise grows with the length of the run, and less with a rest of 2 s before it"
    } else {
        ""
    };
    let advice = format!(
        "{source}record the run in ranges that it fills, with a converter of more bits or less noise{undone}, or state the validation_percent in [limits] that this one can meet"
    );
    Some(Finding::new(Cause::Noisy, evidence, advice))
}

/// A run whose channels show what these standards ask of nine limbs that are alike, without noise.
fn following(
    campaign: &Campaign,
    decoding: &Decoding<'_>,
    trial: &Trial,
    conditioned: &Conditioned,
) -> Option<Conditioned> {
    let parameters: &Parameters = decoding.parameters;
    let shares = StaticLoadSharing::new(&campaign.geometry).ok()?;
    let chain = SignalChain::new(&trial.gains, parameters);
    let rates = conditioned.rate_shell_rad_s.iter();
    let moves =
        in_sensor_axes(trial, conditioned).zip(rates.zip(&conditioned.angular_shell_rad_s2));
    let voltage_v = moves.map(|(felt, (rate, derivative))| {
        let torque = euler_torque(&parameters.inertia_per_mass, *rate, *derivative);
        chain.voltage_v(&shares.of_wrench(felt, torque))
    });
    Some(Conditioned {
        voltage_v: voltage_v.collect(),
        ..conditioned.clone()
    })
}

/// Where the zeros that the run itself shows at rest, before and after its motion, make it come out as the session asks for.
fn moved_zeros(
    campaign: &Campaign,
    decoding: &Decoding<'_>,
    (trial, conditioned): (&Trial, &Conditioned),
    limits: &Limits,
) -> Option<Finding> {
    let rows = &conditioned.voltage_v;
    let (before, after) = rests(conditioned)?;
    let [first, last] = [&rows[..before], &rows[rows.len() - after..]];
    let moved_v: [f64; LIMBS] = core::array::from_fn(|i| {
        0.5 * (mean_of(first, i) + mean_of(last, i)) - decoding.parameters.zero_drift_v[i]
    });
    // Noise moves them where a high-pass is undone.
    let by_noise_v = conditioned.zero_wander_v.map(|sd_v| WANDERS * sd_v);
    if (0..LIMBS).all(|i| moved_v[i].abs() <= by_noise_v[i]) {
        return None;
    }
    let put_right = Conditioned {
        voltage_v: rows
            .iter()
            .map(|row| core::array::from_fn(|i| row[i] - moved_v[i]))
            .collect(),
        ..conditioned.clone()
    };
    let run = compare(campaign, trial, &put_right, decoding).ok()?;
    let left = worst(&errors(&run, arm_m(&campaign.design)));
    if fails(left, limits.validation_percent) {
        return None;
    }
    let most = (0..LIMBS).max_by(|a, b| moved_v[*a].abs().total_cmp(&moved_v[*b].abs()))?;
    let along = (0..LIMBS).filter(|i| moved_v[*i].abs() > ALONG * moved_v[most].abs());
    let channels: Vec<usize> = along.collect();
    let evidence = format!(
        "{} by {:+.1} mV since the static record, and with the zeros that the run shows at rest it departs by {:.1} %",
        match channels.len() {
            1 => "the zero has moved".to_owned(),
            _ => format!("zeros have moved, that of channel {} most,", most + 1),
        },
        1e3 * moved_v[most],
        100.0 * left
    );
    let advice = "warm up and repeat the run, and record at rest right before it";
    Some(Finding::new(Cause::DriftDuringRun, evidence, advice).on_channels(channels))
}

/// Deviation of each channel's noise, V, as the static record's samples differ from their neighbours, and no less than that of rounding.
fn deviations_v(steps_v: &[f64; LIMBS], rest: &Trial) -> [f64; LIMBS] {
    core::array::from_fn(|i| {
        let pairs = rest.voltage_v.windows(2);
        let squares: f64 = pairs.map(|pair| (pair[1][i] - pair[0][i]).powi(2)).sum();
        let at_rest = (0.5 * squares / rest.voltage_v.len().max(1) as f64).sqrt();
        let step = Some(steps_v[i]).filter(|step| step.is_finite());
        at_rest.max(step.unwrap_or(0.0) / 12f64.sqrt())
    })
}

/// Voltages with evenly distributed white noise of such deviations; where a step is coarser than that, rounded to it instead, with a zero
/// anywhere within a step: the same for the same voltages.
fn noisier(
    voltage_v: &[[f64; LIMBS]],
    deviations_v: &[f64; LIMBS],
    steps_v: &[f64; LIMBS],
) -> Vec<[f64; LIMBS]> {
    let mut numbers = Pcg64::seed_from_u64(1);
    let mut even = || numbers.random::<f64>() - 0.5;
    let zeros: [f64; LIMBS] = core::array::from_fn(|_| even());
    let mut noisy = voltage_v.to_vec();
    for row in &mut noisy {
        for (i, u) in row.iter_mut().enumerate() {
            let (noise, step_v) = (even(), steps_v[i]);
            if step_v.is_finite() && deviations_v[i] < step_v {
                *u = (*u / step_v + zeros[i]).round() * step_v;
            } else {
                *u += deviations_v[i] * 12f64.sqrt() * noise;
            }
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
