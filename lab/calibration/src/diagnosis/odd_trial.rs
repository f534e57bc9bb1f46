//! Trials that do not fit in with the others, and why.

mod explanation;
mod interval;

use glam::DVec3;
use sixaxis_core::LIMBS;

pub(crate) use explanation::OTHER_RANGES;
use explanation::{Odd, OtherDirection};

use super::structure::departure;
use super::table::Table;
use super::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::response::Response;
use crate::trial::Trial;

/// Departure, relative to the trial's own size, that is noticed: a wedge half a degree off.
pub const NOTICED: f64 = 0.01;
/// Times its standard error that a departure must exceed.
const SIGNIFICANT: f64 = 6.0;
/// Share of a trial's signal that its fit may leave unexplained.
const RESIDUAL: f64 = 0.02;

/// Largest share of the trials that may be another sensor's.
const AMONG: f64 = 0.25;

/// Looks at every trial by itself. Returns each one's departure from the table.
pub fn examine(
    table: &Table,
    cases: &mut [TrialCase<'_>],
    findings: &mut Vec<Finding>,
) -> Vec<Option<f64>> {
    let departures: Vec<Option<f64>> = cases.iter().map(|s| departure(table, s)).collect();
    // Trials of one cause and one direction make one finding: a wedge is loose in all of them.
    let mut told: Vec<(DVec3, Finding)> = Vec::new();
    let all: Vec<&Trial> = cases.iter().map(|case| case.trial).collect();
    for (case, departure) in cases.iter().zip(&departures) {
        let (Some(departure), Some(response)) = (departure, &case.response) else {
            continue;
        };
        if case.explained {
            continue;
        }
        let found = if *departure > NOTICED + SIGNIFICANT * noise(table, case, response) {
            explain(table, case, response, &all, *departure)
        } else {
            unexplained_in_time(table, case, response)
        };
        let Some(finding) = found else {
            continue;
        };
        // What a part of the run makes of the whole is no factor and no direction.
        let finding = interval::examine(table, case).unwrap_or(finding);
        let direction = case.trial.direction_ground;
        let known = told.iter_mut().find(|(d, known)| {
            known.cause == finding.cause
                && known.channels == finding.channels
                && known.advice == finding.advice
                && (finding.cause != Cause::LooseWedge || *d == direction)
        });
        match known {
            Some((_, known)) => known.recordings.extend(finding.recordings),
            None => told.push((direction, finding)),
        }
    }
    for (_, mut finding) in told {
        // Another sensor's trial is odd among many that agree. Where many do not, the others are no measure.
        let concerned = finding.recordings.len() as f64;
        if finding.cause == Cause::ForeignTrial && concerned > AMONG * cases.len() as f64 {
            finding.cause = Cause::Unexplained;
            "look at the curves of these trials in the report".clone_into(&mut finding.advice);
        }
        findings.push(finding);
    }
    departures
}

fn explain(
    table: &Table,
    case: &TrialCase<'_>,
    response: &Response,
    all: &[&Trial],
    departure: f64,
) -> Option<Finding> {
    let odd = Odd::new(table, case, response, departure);
    // A factor on all channels leaves nothing over of their course.
    let course = unexplained_in_time(table, case, response);
    let explained = odd
        .one_standard()
        .or_else(|| odd.one_factor())
        .map(|factor| course.unwrap_or(factor))
        .or_else(|| odd.one_channel())
        .or_else(|| odd.exchanged())
        .or_else(|| odd.moved_on())
        .or_else(|| odd.gains_of_another(all))
        .or_else(|| odd.gains_inverted());
    if explained.is_some() {
        return explained;
    }
    match odd.other_direction(all) {
        OtherDirection::None => odd
            .gains_of_none(all)
            .or_else(|| odd.gains_of_other_ranges())
            .or_else(|| Some(odd.nothing_else())),
        OtherDirection::WithinPlay => None,
        OtherDirection::Loose(finding) => Some(finding),
    }
}

/// Standard error of a trial's departure.
fn noise(table: &Table, case: &TrialCase<'_>, response: &Response) -> f64 {
    let (_, expected) = table.compare(case, response);
    let squares: f64 = (0..LIMBS)
        .filter(|i| !case.ignored[*i] && !table.silent[*i])
        .map(|i| (response.channels[i].standard_error / table.mass_over_scale_kg[i]).powi(2))
        .sum();
    squares.sqrt() / table.size(case, response, &expected)
}

/// A trial whose amplitudes agree but whose course does not.
fn unexplained_in_time(
    table: &Table,
    case: &TrialCase<'_>,
    response: &Response,
) -> Option<Finding> {
    let over = |get: fn(&crate::response::ChannelResponse) -> f64| -> f64 {
        (0..LIMBS)
            .filter(|i| !case.ignored[*i] && !table.silent[*i])
            .map(|i| (get(&response.channels[i]) / table.mass_over_scale_kg[i]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    // Weight was taken off by an angle that is as good as the gyroscope; what is left of it is expected.
    let known = table.weight_left_m_s2(case, response) / RESIDUAL;
    let share = over(|c| c.residual_n) / (over(|c| c.signal_n) + known);
    (share > RESIDUAL).then(|| {
        let evidence = format!(
            "{:.1} % of the signal follows neither the standards nor any fault that is known",
            100.0 * share
        );
        let advice = "look at the trial's curves in the report, and repeat it";
        Finding::new(Cause::Unexplained, evidence, advice).in_trial(case.trial)
    })
}
