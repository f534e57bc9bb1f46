//! A standard that follows later than the session says: by a first-order lag, or by a delay that is the same at every frequency.

use core::f64::consts::TAU;

use sixaxis_core::identify::joint::Certificates;
use sixaxis_core::identify::joint::unknowns::GYROSCOPE_LAG;

use super::{BEYOND_DOUBT, Fitted, about, known, told};
use crate::diagnosis::timing;
use crate::finding::{Cause, Finding};
use crate::joint::hypotheses::Unaccounted;
use crate::series::median;
use sixaxis_recordings::session::Role;

/// Lag of a gyroscope, s: where it is looked for first, and how far about.
const LAG_S: (f64, f64) = (2e-3, 0.05);
/// Lag of an accelerometer, s, that is looked for at least, and the share of it that the gyroscope shows at most: where both are late, a file is.
const SHORTEST_LAG_S: f64 = 2e-5;
const OTHER_STANDARD: f64 = 0.2;
/// Share of a stated lag by which the found one may be another: a first-order corner at twice the drive's frequency that is off by as
/// much changes what is read by 0.4 %, less than a certificate allows.
const AS_STATED: f64 = 0.02;
/// Trials whose standard is the accelerometer, and the gyroscope.
const LINEAR: [Role; 2] = [Role::Linear, Role::HighFrequencyLinear];
const ANGULAR: [Role; 1] = [Role::Angular];

pub(super) fn lag(_: &Unaccounted<'_>, free: &mut Certificates) -> Option<()> {
    free.gyroscope_lag_s = Some(about(LAG_S));
    Some(())
}

pub(super) fn gyroscope(fit: &Fitted<'_>) -> Option<Finding> {
    let joint = fit.joint;
    let found = known(joint, GYROSCOPE_LAG);
    let Some(stated) = fit.stated.certificates.gyroscope_lag_s else {
        let lag_s = told(joint, GYROSCOPE_LAG)?;
        return Some(Finding::new(
            Cause::GyroscopeLag,
            format!(
                "with a gyroscope that is {}, all trials agree to the noise, and without that they do not",
                behind(lag_s)
            ),
            "state the gyroscope's bandwidth_hz as its certificate has it; its lag is then undone",
        ));
    };
    let apart_s = (found.value - stated.value).abs();
    let other = apart_s > (BEYOND_DOUBT * found.deviation).max(AS_STATED * stated.value);
    let stated_hz = 1.0 / (TAU * stated.value);
    let is = match told(joint, GYROSCOPE_LAG) {
        Some(lag_s) => behind(lag_s),
        None => "not behind at all".to_owned(),
    };
    if !other {
        return None;
    }
    Some(Finding::new(
        Cause::GyroscopeLag,
        format!(
            "with a gyroscope that is {is}, all trials agree to the noise, and with the stated bandwidth of {stated_hz:.1} Hz they do not"
        ),
        "correct the gyroscope's bandwidth_hz by its certificate, or take it out",
    ))
}

fn behind(lag_s: f64) -> String {
    format!(
        "{:.2} ms behind, as a first-order bandwidth of {:.1} Hz has it",
        1e3 * lag_s,
        1.0 / (TAU * lag_s)
    )
}

pub(super) fn no_accelerometer_lag(_: &Unaccounted<'_>, free: &mut Certificates) -> Option<()> {
    (core::mem::take(&mut free.accelerometer_lag_s) > 0.0).then_some(())
}

pub(super) fn accelerometer(fit: &Fitted<'_>) -> Option<Finding> {
    Some(Finding::new(
        Cause::ClockMismatch,
        format!(
            "with an accelerometer that follows at once all trials agree to the noise, and with the stated bandwidth of {:.1} Hz they do not",
            1.0 / (TAU * fit.stated.certificates.accelerometer_lag_s)
        ),
        "take the accelerometer's bandwidth_hz out of the session, or correct it by its certificate",
    ))
}

/// The accelerometer behind, by what the linear trials show, where the gyroscope is not.
pub(super) fn accelerometer_lag(day: &Unaccounted<'_>, free: &mut Certificates) -> Option<()> {
    let stated = free.accelerometer_lag_s;
    // The time constant of a first-order lag, which a sine shows as a smaller delay.
    free.accelerometer_lag_s = late_alone(day, [&LINEAR, &ANGULAR], stated, |omega, lag_s| {
        (omega * lag_s).tan() / omega
    })?;
    (stated == 0.0 && free.accelerometer_lag_s > 0.0).then_some(())
}

pub(super) fn late_accelerometer(fit: &Fitted<'_>) -> Option<Finding> {
    Some(Finding::new(
        Cause::ClockMismatch,
        format!(
            "with an accelerometer that is {}, all trials agree to the noise, and without that they do not",
            behind(fit.taken.certificates.accelerometer_lag_s)
        ),
        "state the accelerometer's bandwidth_hz as its certificate has it, or see what filters its channel alone",
    ))
}

/// Late at every frequency alike, beside what the session says.
pub(super) fn accelerometer_delay(day: &Unaccounted<'_>, free: &mut Certificates) -> Option<()> {
    free.standard_delay_s[0] = late_alone(day, [&LINEAR, &ANGULAR], 0.0, |_, lag_s| lag_s)?;
    Some(())
}

/// The same instead of the lag that the session says.
pub(super) fn accelerometer_delay_alone(
    day: &Unaccounted<'_>,
    free: &mut Certificates,
) -> Option<()> {
    let stated_s = core::mem::take(&mut free.accelerometer_lag_s);
    free.standard_delay_s[0] = late_alone(day, [&LINEAR, &ANGULAR], stated_s, |_, lag_s| lag_s)?;
    (stated_s > 0.0).then_some(())
}

/// The same of the gyroscope, about what the angular trials show: the fit knows its lag better, and so short a lag is as good as a delay.
pub(super) fn gyroscope_delay(day: &Unaccounted<'_>, free: &mut Certificates) -> Option<()> {
    free.standard_delay_s[1] = late_alone(day, [&ANGULAR, &LINEAR], 0.0, |_, lag_s| lag_s)?;
    free.gyroscope_lag_s
        .get_or_insert(about((SHORTEST_LAG_S, LAG_S.1)));
    Some(())
}

pub(super) fn gyroscope_delay_alone(day: &Unaccounted<'_>, free: &mut Certificates) -> Option<()> {
    let stated_s = free
        .gyroscope_lag_s
        .replace(about((SHORTEST_LAG_S, LAG_S.1)))?
        .value;
    free.standard_delay_s[1] = late_alone(day, [&ANGULAR, &LINEAR], stated_s, |_, lag_s| lag_s)?;
    Some(())
}

/// What a standard is late by in the middle of its own trials, s, if the other one is not in the middle of the others, as `what` measures
/// it from each trial's angular frequency and delay. The first-order lag that has been undone is a part of it.
fn late_alone(
    day: &Unaccounted<'_>,
    [own, others]: [&[Role]; 2],
    undone_s: f64,
    what: impl Fn(f64, f64) -> f64,
) -> Option<f64> {
    let middle = |roles: &[Role], undone_s: f64, what: &dyn Fn(f64, f64) -> f64| {
        let cases = day.cases.iter();
        let cases = cases.filter(|case| roles.contains(&case.trial.role));
        median(cases.filter_map(|case| {
            let omega = TAU * case.trial.frequency_hz;
            let undone_s = (omega * undone_s).atan() / omega;
            Some(what(omega, timing::lag_of(case)? + undone_s))
        }))
    };
    let own_s = middle(own, undone_s, &what)?;
    let others_s = middle(others, 0.0, &|_, lag_s| lag_s)?;
    let alone = others_s.abs() < OTHER_STANDARD * own_s.abs();
    (alone && own_s.abs() > SHORTEST_LAG_S).then_some(own_s)
}

pub(super) fn delayed_accelerometer(fit: &Fitted<'_>) -> Option<Finding> {
    let (stated, taken) = (fit.stated, &fit.taken.certificates);
    let lag_s = Some(stated.certificates.accelerometer_lag_s).filter(|lag| *lag > 0.0);
    let instead = taken.accelerometer_lag_s == 0.0;
    let delays_s = [stated.undone_delay_s[0], taken.standard_delay_s[0]];
    let cause = Cause::ClockMismatch;
    delayed("accelerometer", cause, delays_s, lag_s, instead)
}

pub(super) fn delayed_gyroscope(fit: &Fitted<'_>) -> Option<Finding> {
    let (stated, taken) = (fit.stated, &fit.taken.certificates);
    let stated_lag = stated.certificates.gyroscope_lag_s;
    let lag_s = stated_lag.map(|lag| lag.value);
    let instead = taken.gyroscope_lag_s != stated_lag;
    let mut delays_s = [stated.undone_delay_s[1], taken.standard_delay_s[1]];
    if instead {
        delays_s[1] += known(fit.joint, GYROSCOPE_LAG).value;
    }
    let cause = Cause::GyroscopeLag;
    delayed("gyroscope", cause, delays_s, lag_s, instead)
}

/// Said of a standard with a delay that is stated, and one that was found beyond it, beside a stated first-order lag or instead of it. No
/// standard is ahead, but one may have less of a delay than is stated, or none.
fn delayed(
    standard: &str,
    cause: Cause,
    [stated_s, found_s]: [f64; 2],
    lag_s: Option<f64>,
    instead: bool,
) -> Option<Finding> {
    let delay_ms = 1e3 * (stated_s + found_s);
    let none_left = (stated_s + found_s).abs() < AS_STATED * stated_s;
    let bandwidth = lag_s.map(|lag_s| format!("bandwidth of {:.1} Hz", 1.0 / (TAU * lag_s)));
    let (beside, in_place) = match &bandwidth {
        Some(bandwidth) if instead => (String::new(), format!(", in place of its {bandwidth}")),
        Some(bandwidth) => (format!(", beside the stated {bandwidth},"), String::new()),
        None => (String::new(), String::new()),
    };
    let otherwise = match stated_s > 0.0 {
        true => format!("with the stated delay of {:.2} ms", 1e3 * stated_s),
        false => "without that".to_owned(),
    };
    let is = match none_left {
        true => "not behind at all".to_owned(),
        false => format!("{delay_ms:.2} ms behind at every frequency"),
    };
    let evidence = format!(
        "with the {standard} {is}{beside} all trials agree to the noise, and {otherwise} they do not"
    );
    let advice = format!(
        "state delay_ms of the {standard} by its manual, as a digital filter or one of higher order has it{in_place}"
    );
    let advice = if none_left {
        format!("take delay_ms of the {standard} out of the session")
    } else {
        advice
    };
    (delay_ms > 0.0 || none_left).then(|| Finding::new(cause, evidence, advice))
}
