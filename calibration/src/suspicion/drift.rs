//! Rests that are not where they were: a run begins and ends at rest, so that whatever differs between its ends is drift.

use sixaxis_core::LIMBS;
use sixaxis_core::identify::zero_drift::ZeroDrift;

use super::odd_trial;
use super::structure::departure;
use super::table::Table;
use super::{Cause, Finding, Suspect};
use crate::session::Role;
use crate::trial::Trial;

/// Drift, relative to the largest force of any channel in the trial, that is noticed.
const NOTICED: f64 = 4e-3;
/// Drift of a static record, relative to the converter's range, that is noticed.
const NOTICED_AT_REST: f64 = 1e-4;
/// Times its standard error that a drift must exceed.
const SIGNIFICANT: f64 = 8.0;
/// Pieces of a static record whose means are compared.
const PIECES: usize = 16;

/// Looks at the ends of all runs, and at the course of the static record.
pub fn examine(
    at_rest: Option<&Trial>,
    drift: Option<&ZeroDrift>,
    table: Option<&Table>,
    suspects: &mut [Suspect<'_>],
    findings: &mut Vec<Finding>,
) {
    if let (Some(rest), Some(drift)) = (at_rest, drift) {
        for channel in 0..LIMBS {
            if let Some(change) = course(rest, channel) {
                findings.push(Finding {
                    cause: Cause::DriftDuringRun,
                    recordings: vec![rest.name.clone()],
                    channels: vec![channel + 1],
                    evidence: format!(
                        "the zero wanders by {:.2} mV during the static record, with noise of {:.2} mV a sample",
                        1e3 * change,
                        1e3 * drift.noise_v[channel]
                    ),
                    advice: "let sensor and amplifiers warm up, then record at rest again".to_owned(),
                });
            }
        }
    }
    for suspect in suspects.iter_mut() {
        let Some(response) = &suspect.response else {
            continue;
        };
        if suspect.settled {
            continue;
        }
        // In a trial of another scale or another sensor the zero is another, too, and that is not the news.
        let fits_in = table
            .and_then(|table| departure(table, suspect))
            .is_some_and(|departure| departure < odd_trial::NOTICED);
        let largest = response
            .channels
            .iter()
            .map(|c| c.response.abs() * response.peak)
            .fold(0.0, f64::max)
            .max(weight_n(suspect, table));
        for channel in 0..LIMBS {
            if suspect.excused[channel] {
                continue;
            }
            let own = &response.channels[channel];
            let gain = suspect.trial.gains.gain_n_per_v[channel];
            let ends = ends_n(suspect, channel);
            let limit = NOTICED * largest;
            let by_fit = own.drift_n.abs() > limit + SIGNIFICANT * own.drift_error_n;
            // Over a few hundredths of a second noise is not averaged out as over the run: the ends only confirm.
            let by_ends = ends.1.abs() > limit && ends.1 * own.drift_n > 0.0;
            let by_level = drift.is_some() && fits_in && ends.0.abs() > 2.0 * limit;
            if (by_fit && by_ends) || by_level {
                let (what, size) = if by_fit && by_ends {
                    ("during the run", ends.1)
                } else {
                    ("between the static record and the run", ends.0)
                };
                findings.push(Finding {
                    cause: Cause::DriftDuringRun,
                    recordings: vec![suspect.trial.name.clone()],
                    channels: vec![channel + 1],
                    evidence: format!(
                        "the zero moves by {:.1} mV {what}, {:.1} % of the largest signal",
                        1e3 * size / gain,
                        100.0 * size.abs() / largest
                    ),
                    advice: "warm up and repeat the trial, or switch [preprocessing] detrend on with the rest before and after each run".to_owned(),
                });
                suspect.excused[channel] = true;
            }
        }
    }
}

/// The largest share that turning weight has in a channel's force, N: taken off, but only as well as the angle is known.
fn weight_n(suspect: &Suspect<'_>, table: Option<&Table>) -> f64 {
    let trial = suspect.trial;
    let (Some(table), true) = (table, trial.role != Role::Linear && trial.gravity_turns()) else {
        return 0.0;
    };
    let weight = trial.gravity_ground_m_s2.length();
    (0..LIMBS)
        .map(|i| {
            let share = table.shares.linear[table.limb_of[i]].length();
            (table.mass_over_scale_kg[i] * share * weight).abs()
        })
        .fold(0.0, f64::max)
}

/// Level at the beginning of the run and its change until the end, N.
fn ends_n(suspect: &Suspect<'_>, channel: usize) -> (f64, f64) {
    // A hundredth of the run is at rest in any run that begins and ends there.
    let samples = (suspect.force_n.len() / 100).max(1);
    let mean = |rows: &[[f64; LIMBS]]| {
        rows.iter().map(|row| row[channel]).sum::<f64>() / rows.len() as f64
    };
    let first = mean(&suspect.force_n[..samples]);
    let last = mean(&suspect.force_n[suspect.force_n.len() - samples..]);
    (first, last - first)
}

/// Change of a static channel from its first quarter to its last, V, if it is no noise.
fn course(rest: &Trial, channel: usize) -> Option<f64> {
    let per_piece = rest.voltage_v.len() / PIECES;
    if per_piece < 2 {
        return None;
    }
    let means: Vec<f64> = rest
        .voltage_v
        .chunks_exact(per_piece)
        .take(PIECES)
        .map(|piece| piece.iter().map(|row| row[channel]).sum::<f64>() / per_piece as f64)
        .collect();
    // Line through the pieces' means, judged by what they scatter about it.
    let n = PIECES as f64;
    let middle = (n - 1.0) / 2.0;
    let mean = means.iter().sum::<f64>() / n;
    let squares = n * (n * n - 1.0) / 12.0;
    let slope = means
        .iter()
        .enumerate()
        .map(|(i, m)| (i as f64 - middle) * (m - mean))
        .sum::<f64>()
        / squares;
    let scatter = means
        .iter()
        .enumerate()
        .map(|(i, m)| (m - mean - slope * (i as f64 - middle)).powi(2))
        .sum::<f64>()
        / (n - 2.0);
    let change = slope * (n - 1.0);
    let error = (scatter / squares).sqrt() * (n - 1.0);
    (change.abs() > SIGNIFICANT * error && change.abs() > NOTICED_AT_REST * rest.full_scale_v)
        .then_some(change)
}
