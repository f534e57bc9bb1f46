//! Lags and clocks: whether sensor, standards and session agree on time.

use core::f64::consts::TAU;

use sixaxis_core::LIMBS;

use super::trial_case::{Facts, TrialCase, mark_explained, names};
use crate::drive;
use crate::finding::{Cause, Finding};
use crate::response::Response;
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Lag between sensor and standards that is noticed: at 2 Hz, 0.6 % of the signal in quadrature.
const LAG_S: f64 = 0.5e-3;
/// Growth of the lag over a run that is noticed, s.
const GROWTH_S: f64 = 0.5e-3;
/// Times its standard error that a lag must exceed.
const SIGNIFICANT: f64 = 6.0;
/// Share of the largest response that a late channel has in quadrature at least, and that its own has.
const QUADRATURE: f64 = 0.005;
const LOUD: f64 = 0.2;
/// Relative error below which no response is known: noise-free recordings have no error of their own.
const ROUNDING: f64 = 1e-9;
/// Departure of the drive's frequency from the session's that is noticed.
const FREQUENCY: f64 = 0.02;

/// Lag of a trial's standards and how much it grows over the run, s, and the standard errors of both.
pub fn lag(trial: &Trial, response: &Response, ignored: &[bool; LIMBS]) -> [(f64, f64); 2] {
    // All nine channels agree on the lag; each counts by how well it is known.
    let (mut along, mut across, mut growth) = (0.0, 0.0, 0.0);
    for (channel, ignored) in response.channels.iter().zip(ignored) {
        if *ignored || channel.response == 0.0 {
            continue;
        }
        let error = channel.standard_error.hypot(ROUNDING * channel.response);
        let weight = 1.0 / (error * error);
        along += weight * channel.response * channel.response;
        across += weight * channel.response * channel.lagging;
        growth += weight * channel.response * channel.lagging_growth;
    }
    if along == 0.0 {
        return [(0.0, f64::INFINITY); 2];
    }
    let omega = TAU * trial.frequency_hz;
    // A sine's derivative is omega times the sine in size, and s has a root mean square of 3^(-1/2).
    let error = 1.0 / (omega * along.sqrt());
    [
        ((omega * across / along).atan() / omega, error),
        (2.0 * growth / along, 2.0 * 3.0_f64.sqrt() * error),
    ]
}

/// Time by which a trial's standards lag behind the sensor, s.
pub fn lag_of(case: &TrialCase<'_>) -> Option<f64> {
    let response = case.response.as_ref()?;
    let [(lag, error), _] = lag(case.trial, response, &case.ignored);
    error.is_finite().then_some(lag)
}

/// A channel that keeps another time than the other eight of its trial by more than their scatter allows, and by how much it is late, s.
fn late_channel(case: &TrialCase<'_>) -> Option<(usize, f64)> {
    // In a compound run channels follow two motions, each with the lag of its standard.
    let response = case
        .response
        .as_ref()
        .filter(|_| case.trial.role != Role::Validation)?;
    let omega = TAU * case.trial.frequency_hz;
    let sizes = response.channels.map(|channel| channel.response.abs());
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let lag_alone = |channel: usize| {
        let others: [bool; LIMBS] = core::array::from_fn(|i| i != channel || case.ignored[i]);
        lag(case.trial, response, &others)[0]
    };
    let found = (0..LIMBS).filter_map(|channel| {
        let mut without = case.ignored;
        without[channel] = true;
        let (others, others_error) = lag(case.trial, response, &without)[0];
        let (own, own_error) = lag_alone(channel);
        let late = others - own;
        let certain = late.abs() > LAG_S + SIGNIFICANT * own_error.hypot(others_error);
        // Of a channel that hardly moves any quadrature is a neighbour's.
        let matters = omega * late.abs() * sizes[channel] > QUADRATURE * largest;
        (certain && matters && sizes[channel] > LOUD * largest).then_some((channel, late))
    });
    found.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// Channels that are late in one trial alone.
fn late_channels(cases: &mut [TrialCase<'_>], findings: &mut Vec<Finding>) {
    let late = cases.iter().enumerate().filter(|(_, case)| !case.explained);
    let late: Vec<(usize, (usize, f64))> = late
        .filter_map(|(index, case)| Some((index, late_channel(case)?)))
        .collect();
    for (index, (channel, late_s)) in &late {
        // What a channel does all day is the room's, and the joint fit knows of it.
        let alone = late
            .iter()
            .filter(|(_, (other, _))| other == channel)
            .count()
            == 1;
        if !alone {
            continue;
        }
        cases[*index].ignored[*channel] = true;
        let evidence = format!(
            "{:.1} ms {} the other channels, in this trial alone",
            1e3 * late_s.abs(),
            if *late_s > 0.0 { "behind" } else { "ahead of" }
        );
        let advice = "see whether the channel was read by another card, its column shifted, or filtered (a low-pass is behind, an AC coupling ahead); record the trial again";
        let finding = Finding::new(Cause::ClockMismatch, evidence, advice);
        let trial = cases[*index].trial;
        findings.push(finding.in_trial(trial).on_channels([*channel]));
    }
}

/// Looks at lags and clocks.
pub fn examine(facts: &Facts<'_>, cases: &mut [TrialCase<'_>], findings: &mut Vec<Finding>) {
    late_channels(cases, findings);
    let mut wrong_rate = Vec::new();
    let mut late: Vec<(usize, f64, f64)> = Vec::new();
    let mut angular = 0;
    for (index, case) in cases.iter().enumerate() {
        if case.explained {
            continue;
        }
        let Some(response) = &case.response else {
            continue;
        };
        angular += usize::from(case.trial.role == Role::Angular);
        if let Some(frequency_hz) = response.frequency_hz {
            let factor = frequency_hz / case.trial.frequency_hz;
            if (factor - 1.0).abs() > FREQUENCY {
                wrong_rate.push((index, frequency_hz));
                continue;
            }
        }
        let [(lag, lag_error), (growth, growth_error)] = lag(case.trial, response, &case.ignored);
        if lag.abs() > LAG_S + SIGNIFICANT * lag_error
            || growth.abs() > GROWTH_S + SIGNIFICANT * growth_error
        {
            late.push((index, lag, growth));
        }
    }
    if let Some((first, seen_hz)) = wrong_rate.first().copied() {
        let each = wrong_rate.iter().map(|(index, seen_hz)| {
            let trial = cases[*index].trial;
            (trial.name.as_str(), trial.frequency_hz, *seen_hz)
        });
        let (evidence, advice) = match drive::exchanged(&each.collect::<Vec<_>>()) {
            Some(evidence) => (evidence, drive::EXCHANGED),
            None => (
                format!(
                    "the drive turns at {seen_hz:.3} Hz by the standard and the recording's clock, at {:.3} Hz by the session",
                    cases[first].trial.frequency_hz
                ),
                "check frequency_hz against the drive, reference_file where the session has one, and the rate or time stamps of file and session \
                 against the recorder",
            ),
        };
        let recordings = mark_explained(cases, wrong_rate.into_iter().map(|(index, _)| index));
        let finding = Finding::new(Cause::ClockMismatch, evidence, advice);
        findings.push(finding.in_recordings(recordings));
    }
    if late.is_empty() {
        return;
    }
    let all = late.clone();
    // A compound run lags in part: what turns in it does.
    let only_turning = late
        .iter()
        .all(|(i, ..)| matches!(cases[*i].trial.role, Role::Angular | Role::Validation));
    late.retain(|(i, ..)| !only_turning || cases[*i].trial.role == Role::Angular);
    if late.is_empty() {
        late.extend(all);
    }
    let mut lags: Vec<f64> = late.iter().map(|(_, lag, _)| *lag).collect();
    lags.sort_unstable_by(f64::total_cmp);
    let (least, most) = (lags[0], lags[lags.len() - 1]);
    let alike = most - least < 0.25 * most.abs() && least > 0.0;
    if only_turning && late.len() == angular && angular > 1 && alike {
        // The time constant of a first-order lag, which a sine shows as a smaller delay.
        let constants: Vec<f64> = late
            .iter()
            .map(|(i, lag, _)| {
                let omega = TAU * cases[*i].trial.frequency_hz;
                (omega * lag).tan() / omega
            })
            .collect();
        let middle = constants.iter().sum::<f64>() / constants.len() as f64;
        let evidence = format!(
            "in all {angular} angular trials the gyroscope is {:.1} ms behind the sensor, as a first-order bandwidth of {:.1} Hz would have it{}",
            1e3 * middle,
            1.0 / (TAU * middle),
            if facts.gyroscope_lag_undone {
                ", on top of the bandwidth that is being undone"
            } else {
                ""
            }
        );
        let advice =
            "state the gyroscope's bandwidth_hz as its certificate has it; its lag is then undone";
        findings.push(Finding::new(Cause::GyroscopeLag, evidence, advice));
        // What turns cannot be compared before the lag is undone.
        for case in cases.iter_mut() {
            case.explained |= case.trial.role == Role::Validation;
        }
    } else {
        let (worst, lag, growth) = late
            .iter()
            .copied()
            .max_by(|a, b| (a.1.abs() + a.2.abs()).total_cmp(&(b.1.abs() + b.2.abs())))
            .unwrap_or(late[0]);
        let duration = cases[worst].response.as_ref().map_or(1.0, |r| r.duration_s);
        let evidence = format!(
            "the standards are {:.2} ms behind the sensor in the middle of {}, and that changes by {:.2} ms over its {duration:.1} s",
            1e3 * lag,
            cases[worst].trial.name,
            1e3 * growth
        );
        let advice = "record sensor and standards on one clock, or state reference_start_s and both sample rates";
        let finding = Finding::new(Cause::ClockMismatch, evidence, advice);
        findings.push(finding.in_recordings(names(late.iter().map(|(i, ..)| &cases[*i]))));
    }
    mark_explained(cases, late.into_iter().map(|(index, ..)| index));
}
