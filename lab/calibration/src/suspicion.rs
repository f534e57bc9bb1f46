//! What is wrong with a campaign, named: which cause, in which trial, on which channel, by how much, and what to do.
//!
//! Everything is held against [`crate::rigid`], which says what each channel should show of each trial's motion, and what is
//! left over is tried against one cause after the other. The order matters: a fault that explains others is looked for first,
//! and what it explains is not reported again.
//!
//! 1. [`raw`]: what one recording shows by itself: clipped, constant.
//! 2. [`structure`]: what all trials together show of a channel: silent, exchanged, inverted, under-excited axes.
//! 3. [`gravity`]: weight that turns in the sensor although the session says it does not.
//! 4. [`timing`]: lags and clocks.
//! 5. [`level`]: factors that all trials share: units, sensitivities, gains.
//! 6. [`drift`]: rests that are not where they were.
//! 7. [`odd_trial`]: trials that do not fit in with the others.

pub mod drift;
pub mod gravity;
pub mod level;
pub mod odd_trial;
pub mod raw;
pub mod structure;
pub mod table;
pub mod timing;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sixaxis_core::identify::zero_drift::{self, ZeroDrift};
use sixaxis_core::{Geometry, LIMBS, Parameters};

use crate::conditioning::Conditioned;
use crate::response::{self, Response};
use crate::rigid::{StaticLoadSharing, turned_gravity_m_s2};
use crate::trial::Trial;
use sixaxis_recordings::session::{Rig, Role};
use table::Table;

/// Relative error of an angle that undoing a gyroscope's lag and the low-pass leave.
const LAG_ANGLE_ERROR: f64 = 3e-3;

/// What can be wrong.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// A recording cannot be read or lacks what the session promises.
    Unreadable,
    /// A channel stands at the converter's limit.
    ClippedConverter,
    /// A limb says nothing.
    DeadLimb,
    /// Two channels are exchanged.
    SwappedChannels,
    /// A channel has the wrong sign.
    InvertedChannel,
    /// The trials leave a direction out.
    UnderExcitedAxis,
    /// Gravity turns in the sensor and the session does not say so, or the other way round.
    GravityNotHandled,
    /// Volts and millivolts mixed up.
    MillivoltMixUp,
    /// A gain, a sensitivity or a unit is not what the session says.
    WrongScaling,
    /// Sensor and standards, or the recording and the session, do not agree on time.
    ClockMismatch,
    /// The gyroscope lags and nothing undoes it.
    GyroscopeLag,
    /// A channel's zero moved during a run or since the static record.
    DriftDuringRun,
    /// The motion was not along the direction that the wedge sets.
    LooseWedge,
    /// A trial is another sensor's.
    ForeignTrial,
    /// A trial does not agree with the others, and no cause explains it.
    Unexplained,
    /// The joint fit was asked for and cannot be done.
    JointFitRefused,
}

impl Cause {
    /// In words, for a heading.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Unreadable => "recording cannot be used",
            Self::ClippedConverter => "converter clips",
            Self::DeadLimb => "dead limb",
            Self::SwappedChannels => "channels exchanged",
            Self::InvertedChannel => "channel inverted",
            Self::UnderExcitedAxis => "axis not excited",
            Self::GravityNotHandled => "gravity not handled",
            Self::MillivoltMixUp => "volts and millivolts mixed up",
            Self::WrongScaling => "wrong unit or scaling",
            Self::ClockMismatch => "clocks disagree",
            Self::GyroscopeLag => "gyroscope's lag not undone",
            Self::DriftDuringRun => "zero drifts",
            Self::LooseWedge => "wedge loose or wrong",
            Self::ForeignTrial => "trial of another sensor",
            Self::Unexplained => "does not fit, cause unknown",
            Self::JointFitRefused => "joint fit refused",
        }
    }
}

/// Something that is wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Finding {
    /// What.
    pub cause: Cause,
    /// Recordings concerned; all if empty.
    pub recordings: Vec<String>,
    /// Channels concerned, from 1; all or none in particular if empty.
    pub channels: Vec<usize>,
    /// What was seen, with its numbers.
    pub evidence: String,
    /// What to do.
    pub advice: String,
}

/// What the examination is told.
#[derive(Debug, Clone, Copy)]
pub struct Facts<'a> {
    /// The sensor's lengths.
    pub geometry: Geometry,
    /// Design values.
    pub design: &'a Parameters,
    /// What is known of the rig.
    pub rig: Option<&'a Rig>,
    /// Largest relative error that the gyroscope's certificate allows.
    pub gyroscope_class: f64,
    /// Whether a gyroscope's lag is being undone.
    pub gyroscope_lag_undone: bool,
}

/// One trial under examination.
#[derive(Debug, Clone)]
pub struct Suspect<'a> {
    /// As recorded.
    pub trial: &'a Trial,
    /// As conditioned.
    pub conditioned: &'a Conditioned,
    /// Measured forces less the zero drift and the expected share of gravity, N.
    pub force_n: Vec<[f64; LIMBS]>,
    /// What each channel shows of it; none where nothing could be fitted.
    pub response: Option<Response>,
    /// Channels that something has already been found about.
    pub excused: [bool; LIMBS],
    /// Nothing more is to be said of this trial.
    pub settled: bool,
}

/// What the examination found.
#[derive(Debug, Clone)]
pub struct Examination<'a> {
    /// What is wrong, worst first.
    pub findings: Vec<Finding>,
    /// The trials with their responses.
    pub suspects: Vec<Suspect<'a>>,
    /// What all trials agree on, if enough of them could be fitted.
    pub table: Option<Table>,
    /// For each trial, how far it departs from that, relative to its own size.
    pub departures: Vec<Option<f64>>,
}

/// Examines a campaign.
#[must_use]
pub fn examine<'a>(
    facts: &Facts<'_>,
    at_rest: Option<&Trial>,
    trials: &'a [(Trial, Conditioned)],
) -> Examination<'a> {
    let mut findings = Vec::new();
    let mut suspects: Vec<Suspect<'a>> = trials
        .par_iter()
        .map(|(trial, conditioned)| Suspect {
            trial,
            conditioned,
            force_n: Vec::new(),
            response: None,
            excused: [false; LIMBS],
            settled: false,
        })
        .collect();
    raw::examine(at_rest, &mut suspects, &mut findings);
    let drift = at_rest.and_then(|rest| zero_drift::identify(&rest.voltage_v).ok());
    measure(&mut suspects, drift.as_ref(), None);
    let Some(shares) = StaticLoadSharing::new(&facts.geometry) else {
        return unfinished(findings, suspects);
    };
    structure::excitation(&suspects, &mut findings);
    let silent = structure::silent(&shares, facts, &mut suspects, &mut findings);
    // Scale factors come from the linear trials alone, and gravity's turn needs them before the angular ones can be read.
    let mut table = Table::linear(&shares, &suspects, &silent);
    if let Some(table) = &mut table {
        table.angle_error = facts.gyroscope_class + LAG_ANGLE_ERROR;
        gravity::examine(table, &mut suspects, &mut findings);
    }
    measure(&mut suspects, drift.as_ref(), table.as_ref());
    if let Some(linear) = table {
        table = Some(structure::exchanged(
            linear,
            facts,
            &silent,
            &mut suspects,
            &mut findings,
        ));
    }
    timing::examine(facts, &mut suspects, &mut findings);
    if let Some(table) = &table {
        structure::inverted(table, facts, &silent, &mut findings);
        level::examine(table, facts, &silent, &mut suspects, &mut findings);
    }
    drift::examine(
        at_rest,
        drift.as_ref(),
        table.as_ref(),
        &mut suspects,
        &mut findings,
    );
    let departures = match &table {
        Some(table) => odd_trial::examine(table, &mut suspects, &mut findings),
        None => vec![None; suspects.len()],
    };
    // As large as the recordings themselves, and of no further use.
    for suspect in &mut suspects {
        suspect.force_n = Vec::new();
    }
    findings.sort_by_key(|finding| finding.cause);
    Examination {
        findings,
        suspects,
        table,
        departures,
    }
}

fn unfinished<'a>(findings: Vec<Finding>, suspects: Vec<Suspect<'a>>) -> Examination<'a> {
    Examination {
        departures: vec![None; suspects.len()],
        findings,
        suspects,
        table: None,
    }
}

/// Measures the responses, with gravity's share taken off where scale factors to do it with are known.
fn measure(suspects: &mut [Suspect<'_>], drift: Option<&ZeroDrift>, scale: Option<&Table>) {
    suspects.par_iter_mut().for_each(|suspect| {
        let trial = suspect.trial;
        let zero = drift.map_or([0.0; LIMBS], |d| d.drift_v);
        suspect.force_n = suspect
            .conditioned
            .voltage_v
            .iter()
            .map(|row| trial.gains.measured_force_n(row, &zero))
            .collect();
        if let Some(table) = scale
            && trial.role != Role::Linear
            && trial.role != Role::HighFrequencyLinear
        {
            let gravity = trial.gravity_ground_m_s2;
            for (force, angle) in suspect
                .force_n
                .iter_mut()
                .zip(angles(suspect.conditioned, trial))
            {
                let weight = turned_gravity_m_s2(gravity, trial.direction_ground, angle);
                for (limb, force) in force.iter_mut().enumerate() {
                    *force -= table.mass_over_scale_kg[limb]
                        * table.shares.linear[table.limb_of[limb]].dot(weight);
                }
            }
        }
        suspect.response = response::measure(trial, suspect.conditioned, &suspect.force_n);
    });
}

/// Angle turned since the first sample, rad, by the trapezoidal rule.
fn angles(conditioned: &Conditioned, trial: &Trial) -> impl Iterator<Item = f64> {
    let step_s = 1.0 / trial.sample_rate_hz;
    let direction = trial.direction_ground;
    let (mut angle, mut before) = (0.0, 0.0);
    conditioned.rate_shell_rad_s.iter().map(move |rate| {
        let now = rate.dot(direction);
        angle += 0.5 * (before + now) * step_s;
        before = now;
        angle
    })
}

/// The names of some trials.
fn names<'s, 'a: 's>(suspects: impl IntoIterator<Item = &'s Suspect<'a>>) -> Vec<String> {
    suspects
        .into_iter()
        .map(|suspect| suspect.trial.name.clone())
        .collect()
}
