//! A trial does not stand where the others on its wedge do: dirt under the sensor, a screw that was not tightened.
//!
//! The fit is made again with a direction of its own for each trial. If that accounts for all of them, those that stand off the middle of their
//! wedge's are named; of two trials on a wedge, both, by half the angle between them.

use glam::DVec3;
use sixaxis_core::identify::joint::unknowns::Wedges;

use super::Unaccounted;
use crate::finding::{Cause, Finding, in_a_sentence};
use crate::joint::{JointReport, at_rest};
use crate::series::median;
use crate::trial::{Trial, same_wedge};

/// Angle off the middle of its wedge's trials from which a trial stands otherwise, degrees, and up to which it stands on that wedge at all.
const OFF_DEG: (f64, f64) = (0.03, 2.0);
/// Share of the largest such angle from which another trial is off as well.
const AS_WELL: f64 = 0.3;
/// Trials that may be off: more are no trials' mounts.
const MOST: usize = 3;

/// The trials that stand otherwise, if that accounts for the day.
pub fn tried(day: &Unaccounted<'_>) -> Option<Finding> {
    let trials: Vec<&Trial> = day.campaign.trials.iter().map(|(trial, _)| trial).collect();
    let mut freed = *day.knowledge;
    freed.certificates.wedges = Wedges::Apart;
    let joint = day.accounting(&trials, &at_rest(day.drift), &day.start, &freed)?;
    let off_deg = off_their_wedges_deg(&joint);
    let most_deg = off_deg.iter().copied().fold(0.0, f64::max);
    if !(OFF_DEG.0..OFF_DEG.1).contains(&most_deg) {
        return None;
    }
    let named: Vec<&str> = joint
        .recordings
        .iter()
        .zip(&off_deg)
        .filter(|(_, off)| **off > AS_WELL * most_deg)
        .map(|(name, _)| name.as_str())
        .collect();
    let names = in_a_sentence(&named).filter(|_| named.len() <= MOST)?;
    let stands = if named.len() == 1 {
        "stands"
    } else {
        "stand up to"
    };
    let evidence = format!(
        "{}: {names} {stands} {most_deg:.2}° from the middle of the trials on the same wedge",
        super::agreeing("a direction of its own for each trial", &joint)
    );
    let advice = "clean the wedge and the sensor's foot, tighten both, and repeat the trial";
    Some(Finding::new(Cause::LooseWedge, evidence, advice).in_recordings(named))
}

/// How far each trial is off the middle of those in its direction, degrees.
fn off_their_wedges_deg(joint: &JointReport) -> Vec<f64> {
    let unknowns = &joint.estimate.unknowns;
    let direction = |wedge: usize| unknowns.direction(wedge).0;
    let wedges = joint.estimate.trials.iter().map(|trial| trial.wedge);
    wedges
        .map(|own| {
            let alike: Vec<DVec3> = (0..unknowns.wedges.len())
                .filter(|other| {
                    let nominal = |wedge: usize| unknowns.wedges[wedge].nominal;
                    same_wedge(nominal(*other), nominal(own))
                })
                .map(direction)
                .collect();
            let middle = match alike[..] {
                // Of two neither is the measure.
                [one, other] => 0.5 * (one + other),
                _ => DVec3::from_array(core::array::from_fn(|axis| {
                    median(alike.iter().map(|n| n[axis])).unwrap_or(f64::NAN)
                })),
            };
            direction(own).angle_between(middle).to_degrees()
        })
        .collect()
}
