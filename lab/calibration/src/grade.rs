//! From evidence to a grade: what fails, what is missing, what is good.

use crate::diagnosis::rig;
use crate::drive;
use crate::finding::{Cause, Finding, in_a_sentence};
use crate::joint::misfit::CONTRADICTING;
use crate::report::{Grade, ParameterReport, TrialReport};
use crate::steps::{Campaign, FourSteps};
use sixaxis_core::identify::inertia::GAIN_RANGE;
use sixaxis_page::number::decimals_apart;
use sixaxis_recordings::session::{Role, Session};

/// Largest coordination residual that a good calibration has: limbs whose stiffnesses differ by so much are not nine of a kind.
pub const COORDINATION_LIMIT: f64 = 0.1;
/// A limit that is missed by this factor fails the calibration.
const BEYOND_DOUBT: f64 = 2.0;
/// Standard errors by which the gyroscope's gain must leave its class to be called wrong.
const GAIN_SIGNIFICANT: f64 = 5.0;
/// Trials of a step from which leaving one out proves something.
const TRIALS_WANTED: usize = 6;
/// Distance from an end of the gains that are searched at which one was found there.
const AT_AN_END: f64 = 1e-6;

/// The largest of some errors; what is not a number is infinitely large.
pub(crate) fn worst(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |worst: f64, error| {
        if error.is_nan() {
            f64::INFINITY
        } else {
            worst.max(*error)
        }
    })
}

/// Whether an error misses its limit so far that no reservation will do.
pub(crate) fn fails(error: f64, limit_percent: f64) -> bool {
    error > BEYOND_DOUBT * limit_percent / 100.0
}

/// A share as percent, with as many decimals as tell it from the limit that it misses.
fn beside(share: f64, limit_percent: f64) -> String {
    let percent = 100.0 * share;
    format!("{percent:.*}", decimals_apart(percent, limit_percent, 1))
}

/// What to do about trials whose drive turned at another frequency than stated, by clocks that are right, and about those whose clocks are
/// not, which the rig tells.
pub(crate) fn misstated_drives(reports: &[TrialReport], of_wrong_clocks: &[String]) -> Vec<String> {
    let misstated = reports
        .iter()
        .filter_map(|report| Some((report, drive::misstated_hz(report)?)));
    let (clocks, drives): (Vec<_>, Vec<_>) =
        misstated.partition(|(report, _)| of_wrong_clocks.contains(&report.name));
    let clock_is_off = "their standards show what the rig makes them show at the stated frequency: correct sample_rate_hz, or the rate or the time stamps in the file";
    [
        misstated_drive(&clocks, clock_is_off),
        misstated_drive(&drives, "correct frequency_hz"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn misstated_drive(misstated: &[(&TrialReport, f64)], advice: &str) -> Option<String> {
    let (first, seen_hz) = misstated.first()?;
    let names: Vec<&str> = misstated.iter().map(|(r, _)| r.name.as_str()).collect();
    let names = in_a_sentence(&names)?;
    let in_the_first = if misstated.len() > 1 {
        "in the first of them "
    } else {
        ""
    };
    Some(format!(
        "{names}: {in_the_first}{}: {advice}",
        drive::both_in_words(first.frequency_hz, *seen_hz)
    ))
}

/// Whose word decides whether trials agree with each other.
#[derive(Debug, Clone, Copy)]
pub(crate) enum JudgedBy<'a> {
    /// A joint fit that accounts for them: they do.
    Joint,
    /// The four steps, which hold one trial out after the other; none if they could not be done.
    FourSteps(Option<&'a FourSteps>),
}

/// Evidence that fails so badly that no reservation will do. By the rig's rotation the gyroscope reads so many times what it should, if the
/// session states one.
pub(crate) fn failures(
    session: &Session,
    reports: &[TrialReport],
    judged_by: JudgedBy<'_>,
    gyroscope_by_rig: Option<f64>,
) -> Vec<Finding> {
    let steps = match judged_by {
        JudgedBy::Joint => None,
        JudgedBy::FourSteps(steps) => steps,
    };
    let by_joint = matches!(judged_by, JudgedBy::Joint);
    let limits = &session.limits;
    let gyroscope_class = session.gyroscope.class_percent / 100.0;
    let mut failures = Vec::new();
    for report in reports {
        let hold_out = report
            .hold_out
            .filter(|_| !by_joint)
            .map(|error| worst(&[error]));
        let validation = report.validation.map(|errors| worst(&errors));
        for (error, limit, what) in [
            (
                hold_out,
                limits.hold_out_percent,
                "the other trials predict it only to within",
            ),
            (
                validation,
                limits.validation_percent,
                "decoupled, it departs from the standards by",
            ),
        ] {
            if let Some(error) = error
                && fails(error, limit)
            {
                let evidence = format!(
                    "{what} {} %, where the session asks for {limit} %",
                    beside(error, limit)
                );
                let advice = "check wedges, mounting and preprocessing; with a level axis, or a wedge off by a tenth of a degree, the open loop is no better";
                let finding = Finding::new(Cause::Unexplained, evidence, advice);
                failures.push(finding.in_recordings([&report.name]));
            }
        }
    }
    if let Some((gain, error)) = steps.and_then(|steps| steps.gyroscope_gain_seen)
        && (gain - 1.0).abs() > gyroscope_class + GAIN_SIGNIFICANT * error
    {
        let or_beyond = match gain {
            gain if gain - GAIN_RANGE.0 < AT_AN_END => " or less",
            gain if GAIN_RANGE.1 - gain < AT_AN_END => " or more",
            _ => "",
        };
        let by_euler = format!(
            "by Euler's equation the true rate is {gain:.3} ± {error:.3} times the gyroscope's reading{or_beyond}, beyond its class of {:.1} %",
            100.0 * gyroscope_class
        );
        let certified = |reads: &f64| (reads - 1.0).abs() <= gyroscope_class + rig::TOLERANCE;
        let (cause, evidence, advice) = match gyroscope_by_rig.filter(certified) {
            None => (
                Cause::WrongScaling,
                by_euler,
                "check unit and sensitivity of the gyroscope against its certificate",
            ),
            Some(reads) => (
                Cause::Unexplained,
                format!(
                    "{by_euler}, and by the rig's rotation it reads {reads:.3} times what it should: linear and angular trials do not go together"
                ),
                "see whether a channel's gain, plug or sensitivity changed between the linear and the angular trials",
            ),
        };
        failures.push(Finding::new(cause, evidence, advice));
    }
    failures
}

/// What would prove a calibration and is missing, or is less than it should be.
pub(crate) fn reservations(
    campaign: &Campaign,
    session: &Session,
    parameters: &[ParameterReport],
    reports: &[TrialReport],
    judged_by: JudgedBy<'_>,
) -> Vec<String> {
    let by_steps = matches!(judged_by, JudgedBy::FourSteps(_));
    let limits = &session.limits;
    let rig_is_known = session
        .rig
        .as_ref()
        .is_some_and(|rig| rig.stroke_mm.is_some() && rig.rotation_amplitude_deg.is_some());
    let mut reservations = Vec::new();
    let count = |role: Role| {
        campaign
            .trials
            .iter()
            .filter(|(t, _)| t.role == role)
            .count()
    };
    for (role, what) in [(Role::Linear, "linear"), (Role::Angular, "angular")] {
        let trials = count(role);
        if trials < TRIALS_WANTED {
            reservations.push(format!(
                "{trials} {what} trials leave little to test with: record at least {TRIALS_WANTED}, on three wedges or more"
            ));
        }
    }
    reservations.extend(session.sensor.odd_lengths());
    if !rig_is_known {
        reservations.push(
            "state the rig's stroke_mm and rotation_amplitude_deg in [rig]: nothing else checks the scaling of the standards"
                .to_owned(),
        );
    }
    if count(Role::Validation) == 0 {
        reservations.push(
            "record a compound motion (role \"validation\"): nothing here was held against a run that was not fitted".to_owned(),
        );
    }
    // A product of inertia may be zero; the moments and the scale factors may not.
    let wide: Vec<(&ParameterReport, f64)> = parameters
        .iter()
        .filter(|p| p.parameter.has_size())
        .filter_map(|p| Some((p, p.half_width_95? / p.estimate.abs())))
        .filter(|(_, share)| *share > limits.interval_percent / 100.0)
        .collect();
    if let Some((worst, share)) = wide.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        let names: Vec<String> = wide.iter().map(|(p, _)| p.parameter.to_string()).collect();
        // More of the same contradict each other as much.
        let advice = if worst.dominated_by == CONTRADICTING {
            ""
        } else {
            "; repeat trials that load them"
        };
        reservations.push(format!(
            "{}: known only to ±{:.*} % at worst ({}), mostly because of {}{advice}",
            names.join(", "),
            decimals_apart(100.0 * share, limits.interval_percent, 0),
            100.0 * share,
            worst.parameter,
            worst.dominated_by
        ));
    }
    let uneven: Vec<(&TrialReport, f64)> = reports
        .iter()
        .filter_map(|r| Some((r, worst(&r.coordination?))))
        .filter(|(_, worst)| by_steps && *worst > COORDINATION_LIMIT)
        .collect();
    if let Some((report, worst)) = uneven.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        reservations.push(format!(
            "in {} recordings the forces break a coordination equation by up to {:.0} % ({}): the limbs are not equally stiff, or a channel is not what it was in the other recordings",
            uneven.len(),
            100.0 * worst,
            report.name
        ));
    }
    let resting: Vec<&str> = reports
        .iter()
        .filter(|r| matches!(r.role, Role::Linear | Role::Angular) && r.hold_out.is_none())
        .map(|r| r.name.as_str())
        .collect();
    let enough = count(Role::Linear).min(count(Role::Angular)) >= TRIALS_WANTED;
    if by_steps && !resting.is_empty() && enough && !parameters.is_empty() {
        reservations.push(format!(
            "{}: without it a direction is not excited, so that nothing tests it: record another on its wedge",
            resting.join(", ")
        ));
    }
    for report in reports {
        if let Some(error) = report.hold_out
            && by_steps
            && error > limits.hold_out_percent / 100.0
        {
            reservations.push(format!(
                "{}: the other trials predict it only to within {} % (the session asks for {} %): repeat it",
                report.name,
                beside(error, limits.hold_out_percent),
                limits.hold_out_percent
            ));
        }
        if let Some(errors) = report.validation {
            let worst = worst(&errors);
            if worst > limits.validation_percent / 100.0 {
                reservations.push(format!(
                    "{}: decoupled, it departs from the standards by {} % (the session asks for {} %); at low frequency a wedge that is off by a tenth of a degree does as much as 15 %",
                    report.name,
                    beside(worst, limits.validation_percent),
                    limits.validation_percent
                ));
            }
        }
    }
    reservations
}

pub(crate) fn grade(
    findings: &[Finding],
    reservations: &[String],
    reports: &[TrialReport],
    identified: bool,
) -> (Grade, String) {
    if let Some(first) = findings.first() {
        let mut causes: Vec<Cause> = findings.iter().map(|f| f.cause).collect();
        causes.dedup();
        let more = match causes.as_slice() {
            [_, second] => format!("; also: {}", second.name()),
            [_, second, rest @ ..] => {
                format!("; also: {} and {} more", second.name(), rest.len())
            }
            _ => String::new(),
        };
        // In the findings' order, as they stand below.
        let mut places: Vec<&str> = Vec::new();
        for finding in findings.iter().filter(|f| f.cause == first.cause) {
            for name in &finding.recordings {
                if !places.contains(&name.as_str()) {
                    places.push(name);
                }
            }
        }
        let place = in_a_sentence(&places).map_or(String::new(), |place| format!(" in {place}"));
        return (
            Grade::Bad,
            format!("Not good: {}{place}{more}.", first.cause.name()),
        );
    }
    if !identified {
        return (
            Grade::Bad,
            "Not good: the four steps could not be done.".to_owned(),
        );
    }
    let worst = reports
        .iter()
        .filter_map(|r| r.validation)
        .map(|errors| worst(&errors))
        .fold(0.0, f64::max);
    if reservations.is_empty() {
        (
            Grade::Good,
            format!(
                "Good: nothing was found wrong, and runs that were not fitted come out within {:.1} % of the standards.",
                100.0 * worst
            ),
        )
    } else {
        (
            Grade::Reserved,
            match reservations.len() {
                1 => "Good with reservations: one point is open.".to_owned(),
                n => format!("Good with reservations: {n} points are open."),
            },
        )
    }
}

#[cfg(test)]
pub(crate) mod tests;
