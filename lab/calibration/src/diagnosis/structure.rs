//! What all trials together show of a channel, and of the campaign's directions.

use glam::{DMat3, DVec3};
use sixaxis_core::LIMBS;
use sixaxis_core::dsp::spectrum::noise_floor;

use super::table::{Table, norm};
use super::trial_case::{Facts, TrialCase, names};
use crate::finding::{Cause, Finding};
use crate::series::{deviation, median};
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_recordings::session::Role;

/// A direction that gets less than this share of the best one's excitation is not excited: the errors of what rests on it
/// are three times as large and more.
const EXCITED: f64 = 0.1;
/// A trial with less than this share of the largest peak excites nothing.
const WEAK: f64 = 0.02;
/// Sine of the angle below which two directions are one wedge's.
const SAME_WEDGE: f64 = 0.01;
/// A channel whose response is below this share of what its neighbours make one expect is silent.
const SILENT: f64 = 0.03;
/// A channel that varies by less than so many times its noise from sample to sample shows nothing but noise. A channel that
/// is merely scaled down shows its signal still.
const ONLY_NOISE: f64 = 1.5;
/// Directions that the trials of steps 2 and 3 leave out.
pub fn excitation(cases: &[TrialCase<'_>], findings: &mut Vec<Finding>) {
    for (role, what, step) in [
        (Role::Linear, "linear", "scale factors"),
        (Role::Angular, "angular", "inertias"),
    ] {
        let trials: Vec<(DVec3, f64)> = cases
            .iter()
            .filter(|s| s.trial.role == role)
            .filter_map(|s| {
                let response = s.response.as_ref()?;
                Some((s.trial.direction_ground, response.peak))
            })
            .collect();
        let largest = trials.iter().map(|t| t.1).fold(0.0, f64::max);
        let mut gram = DMat3::ZERO;
        // Repeats on one wedge excite no more directions, and a trial needs no more than to stand out from the noise.
        let mut counted: Vec<DVec3> = Vec::new();
        for (d, peak) in &trials {
            if *peak < WEAK * largest || counted.iter().any(|c| c.cross(*d).length() < SAME_WEDGE) {
                continue;
            }
            counted.push(*d);
            let v = *d;
            gram += DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        }
        let m = nalgebra::Matrix3::from_column_slice(&gram.to_cols_array());
        let Some(eigen) = nalgebra::SymmetricEigen::try_new(m, 1e-14, 1000) else {
            continue;
        };
        let (worst, best) = (eigen.eigenvalues.imin(), eigen.eigenvalues.max());
        let share = (eigen.eigenvalues[worst].max(0.0) / best).sqrt();
        // Written so that no trials at all, NaN, count as none excited.
        let excited = share >= EXCITED;
        let unread = trials.is_empty() && findings.iter().any(|f| f.cause == Cause::Unreadable);
        if !(excited || unread) {
            let lost = eigen.eigenvectors.column(worst);
            let evidence = if trials.is_empty() {
                format!("no {what} trial could be used")
            } else {
                format!(
                    "the {what} trials together move {:.1} % as much along ({:.2}, {:.2}, {:.2}) as along their best direction; the {step} rest on all three",
                    100.0 * share,
                    lost[0],
                    lost[1],
                    lost[2]
                )
            };
            let advice = format!(
                "record {what} trials on a wedge whose direction is near ({:.1}, {:.1}, {:.1})",
                lost[0], lost[1], lost[2]
            );
            findings.push(Finding::new(Cause::UnderExcitedAxis, evidence, advice));
        }
    }
}

/// Size of a channel's response over what the design makes one expect; none where that is too little to be a measure.
pub fn over_design(
    shares: &StaticLoadSharing,
    facts: &Facts<'_>,
    case: &TrialCase<'_>,
    channel: usize,
) -> Option<f64> {
    let response = case.response.as_ref()?;
    let d = case.trial.direction_ground;
    // The inertia's share is left out.
    let expected = if response.travels {
        shares.of_acceleration(channel).dot(d).abs()
    } else {
        let inertia = facts.design.inertia_per_mass.matrix_mass_m2();
        shares.of_torque_per_m(channel).dot(inertia * d).abs()
    };
    let design = facts.design.scale_per_mass_per_kg[channel];
    let seen = (response.channels[channel].response * design).abs();
    // Shares of the size of a tenth of the largest are the first that a twisted wedge or a neighbour's error leaves alone.
    let largest = if response.travels { 0.58 } else { 6.6e-3 };
    // In a compound run the two shares may cancel.
    (case.trial.role != Role::Validation && expected > 0.15 * largest).then_some(seen / expected)
}

/// Size of all channels' responses together over what the design makes one expect, which no cancelling of two motions' shares in one
/// of them spoils.
pub fn all_over_design(
    shares: &StaticLoadSharing,
    facts: &Facts<'_>,
    case: &TrialCase<'_>,
) -> Option<f64> {
    let design = Table {
        shares: *shares,
        mass_over_scale_kg: facts.design.scale_per_mass_per_kg.map(f64::recip),
        inertia_m2: Some(facts.design.inertia_per_mass.matrix_mass_m2()),
        angle_error: 0.0,
        silent: [false; LIMBS],
    };
    let (seen, expected) = design.compare(case, case.response.as_ref()?);
    Some(norm(&seen) / norm(&expected))
}

/// Channels that show no signal in any trial, or none in some.
pub fn silent(
    shares: &StaticLoadSharing,
    facts: &Facts<'_>,
    cases: &mut [TrialCase<'_>],
    findings: &mut Vec<Finding>,
) -> [bool; LIMBS] {
    let ratio = |case: &TrialCase<'_>, channel| over_design(shares, facts, case, channel);
    let mut silent = [false; LIMBS];
    for (channel, silent) in silent.iter_mut().enumerate() {
        let mut quiet: Vec<usize> = Vec::new();
        let mut judged = 0;
        for (index, case) in cases.iter().enumerate() {
            let Some(own) = ratio(case, channel) else {
                continue;
            };
            let others = (0..LIMBS).filter(|other| *other != channel);
            let Some(usual) = median(others.filter_map(|other| ratio(case, other))) else {
                continue;
            };
            judged += 1;
            if own < SILENT * usual && only_noise(case, channel) {
                quiet.push(index);
            }
        }
        if quiet.is_empty() {
            continue;
        }
        *silent = quiet.len() == judged;
        for index in &quiet {
            cases[*index].ignored[channel] = true;
        }
        let evidence = format!(
            "no response to the motion in {} of {judged} trials that should move it",
            quiet.len()
        );
        let advice = format!(
            "check piezo, cable and amplifier of limb {}, then repeat all trials",
            channel + 1
        );
        let finding = Finding::new(Cause::DeadLimb, evidence, advice).on_channels([channel]);
        findings.push(if *silent {
            finding
        } else {
            finding.in_recordings(names(quiet.iter().map(|i| &cases[*i])))
        });
    }
    silent
}

fn only_noise(case: &TrialCase<'_>, channel: usize) -> bool {
    let series: Vec<f64> = case
        .trial
        .voltage_v
        .iter()
        .map(|row| row[channel])
        .collect();
    series.iter().all(|u| *u == series[0]) || varies_as_noise(&series)
}

/// Whether a series varies by no more than its noise from sample to sample; one that never changes has none.
pub(crate) fn varies_as_noise(series: &[f64]) -> bool {
    noise_floor(series).is_ok_and(|noise| noise > 0.0 && deviation(series) <= ONLY_NOISE * noise)
}

/// Channels whose scale factor has the other sign than the design's.
pub fn inverted(
    table: &Table,
    facts: &Facts<'_>,
    silent: &[bool; LIMBS],
    findings: &mut Vec<Finding>,
) {
    let reversed = |channel: usize| {
        table.mass_over_scale_kg[channel] * facts.design.scale_per_mass_per_kg[channel] < 0.0
    };
    let judged = silent.iter().filter(|silent| !**silent).count();
    if (0..LIMBS).filter(|i| !silent[*i] && reversed(*i)).count() == judged {
        // With the accelerometer reversed torques have the wrong sign by these scale factors, and inertias come out negative.
        let trace = table
            .inertia_m2
            .map(|i| i.x_axis.x + i.y_axis.y + i.z_axis.z);
        let (cause, which, advice) = match trace {
            Some(trace) if trace > 0.0 => (
                Cause::InvertedChannel,
                ", and the inertias have not: all channels are inverted, or all directions stated the other way round",
                "change the sign of each gain_n_per_v, which is negative of a charge amplifier that inverts, or turn all directions round",
            ),
            Some(trace) if trace < 0.0 => (
                Cause::WrongScaling,
                ", and so have the inertias: the standard accelerometer is reversed",
                "turn the accelerometer's polarity round, or the wedges' directions",
            ),
            _ => (
                Cause::WrongScaling,
                ": the standard accelerometer is reversed, or all channels are inverted",
                "turn the accelerometer's polarity round, or change the sign of each gain_n_per_v",
            ),
        };
        let evidence = format!("all scale factors have the other sign than the design's{which}");
        findings.push(Finding::new(cause, evidence, advice));
        return;
    }
    for (channel, silent) in silent.iter().enumerate() {
        if !silent && reversed(channel) {
            let evidence = format!(
                "scale factor {:.3} 1/kg, of the other sign than the design's {:.3} 1/kg",
                1.0 / table.mass_over_scale_kg[channel],
                facts.design.scale_per_mass_per_kg[channel]
            );
            let advice = "turn the channel's polarity round, or give its gain_n_per_v a minus sign";
            let finding = Finding::new(Cause::InvertedChannel, evidence, advice);
            findings.push(finding.on_channels([channel]));
        }
    }
}

/// How far a trial departs from the table, relative to its own size.
pub fn departure(table: &Table, case: &TrialCase<'_>) -> Option<f64> {
    let response = case.response.as_ref()?;
    if !response.travels && table.inertia_m2.is_none() {
        return None;
    }
    let (seen, expected) = table.compare(case, response);
    let difference = core::array::from_fn(|i| {
        if case.ignored[i] {
            0.0
        } else {
            seen[i] - expected[i]
        }
    });
    Some(norm(&difference) / table.size(case, response, &expected))
}
