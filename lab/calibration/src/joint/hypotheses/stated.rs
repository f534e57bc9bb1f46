//! All day alike, a standard the other way round, wedges' directions in other axes than the sensor's (two of them exchanged, or turned, or a
//! left-handed set), a sensor turned on its flange by any angle, gains in V/N, or down that is up; or directions in other axes in the trials
//! of one step.
//!
//! As in [`super::plugs`], responses say which, and the joint fit whether the trials agree to the noise with that put right.

mod turned;

use glam::{DMat3, DQuat, DVec3};
use rayon::prelude::*;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{Gains, LIMBS, Parameters};

use super::{Unaccounted, agreeing, agreement};
use crate::diagnosis::gravity::NOTICED_M_S2;
use crate::diagnosis::table::Table;
use crate::diagnosis::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::joint::JointReport;
use crate::joint::account::{STRAIGHT_ON_ITS_FLANGE, turned_alike};
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Share of the squared departures that other axes may leave to be worth a fit.
const WORTH_A_FIT: f64 = 0.5;

/// The best of them that are fitted.
const TRIED: usize = 3;

/// Of which trials directions are these, in words and by their roles: a sensor is put back otherwise between two steps.
type Trials = (&'static str, &'static [Role]);

const ALL: Trials = (
    "",
    &[
        Role::Linear,
        Role::Angular,
        Role::HighFrequencyLinear,
        Role::Validation,
    ],
);
const OF_A_STEP: [Trials; 4] = [
    (" of the linear trials", &[Role::Linear]),
    (" of the angular trials", &[Role::Angular]),
    (" of the fast linear trials", &[Role::HighFrequencyLinear]),
    (
        " of all but the linear trials",
        &[Role::Angular, Role::HighFrequencyLinear, Role::Validation],
    ),
];

/// What was stated otherwise than it was.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stated {
    Accelerometer,
    Gyroscope,
    /// Both standards the other way round, or all directions, and down is right.
    Standards,
    /// Gains are one over the stated ones.
    Gains,
    /// Up is what is called down.
    Down,
    /// Directions of some trials are these, of the stated ones.
    Directions(DMat3, Trials),
    /// The sensor is turned on its flange: all directions are these, of the stated ones.
    Turned(DQuat),
}

impl Stated {
    /// Both standards, the gains, and the directions of all trials in other axes.
    fn all_day() -> Vec<Self> {
        let mut all = vec![Self::Accelerometer, Self::Gyroscope, Self::Gains];
        all.extend(Self::directions(ALL));
        all
    }

    /// In all axes that can be named by exchanging and reversing three, but those that are right.
    fn directions(of: Trials) -> Vec<Self> {
        let mut all = Vec::new();
        let unit = [DVec3::X, DVec3::Y, DVec3::Z];
        for (a, b, c) in [
            (0, 1, 2),
            (1, 0, 2),
            (0, 2, 1),
            (2, 1, 0),
            (1, 2, 0),
            (2, 0, 1),
        ] {
            for signs in 0..8_u32 {
                let sign = |bit: u32| if signs >> bit & 1 == 0 { 1.0 } else { -1.0 };
                // Its rows are the axes as stated.
                let rows = [sign(0) * unit[a], sign(1) * unit[b], sign(2) * unit[c]];
                let axes = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
                if axes != DMat3::IDENTITY {
                    all.push(Self::Directions(axes, of));
                }
            }
        }
        all
    }

    /// With a standard turned round its series are the other way, and nothing else.
    fn put_right(self, trial: &mut Trial) {
        let turn = |series: &mut Vec<f64>| series.iter_mut().for_each(|x| *x = -*x);
        match self {
            Self::Accelerometer => turn(&mut trial.accelerometer_m_s2),
            Self::Gyroscope => turn(&mut trial.gyroscope_rad_s),
            Self::Standards => {
                turn(&mut trial.accelerometer_m_s2);
                turn(&mut trial.gyroscope_rad_s);
            }
            Self::Gains => {
                trial.gains.gain_n_per_v = trial.gains.gain_n_per_v.map(f64::recip);
            }
            Self::Down => trial.gravity_ground_m_s2 = -trial.gravity_ground_m_s2,
            Self::Directions(axes, (_, roles)) if roles.contains(&trial.role) => {
                trial.direction_ground = axes * trial.direction_ground;
                trial.gravity_ground_m_s2 = axes * trial.gravity_ground_m_s2;
            }
            Self::Directions(..) => {}
            Self::Turned(turned) => {
                trial.direction_ground = turned * trial.direction_ground;
                trial.gravity_ground_m_s2 = turned * trial.gravity_ground_m_s2;
            }
        }
    }

    /// What the channels then show of a trial, with its stated gains, over what they show as they are.
    fn factors(self, role: Role, stated: &Gains) -> [f64; LIMBS] {
        let turned = match self {
            Self::Accelerometer => matches!(role, Role::Linear | Role::HighFrequencyLinear),
            Self::Gyroscope => role == Role::Angular,
            Self::Standards => true,
            Self::Gains => return stated.gain_n_per_v.map(|gain| 1.0 / (gain * gain)),
            Self::Down | Self::Directions(..) | Self::Turned(_) => false,
        };
        [if turned { -1.0 } else { 1.0 }; LIMBS]
    }

    fn in_words(self) -> (Cause, String, String) {
        match self {
            Self::Accelerometer => (
                Cause::WrongScaling,
                "the standard accelerometer reversed".to_owned(),
                "turn the accelerometer's polarity round, or the directions of the linear trials".to_owned(),
            ),
            Self::Gyroscope => (
                Cause::WrongScaling,
                "the standard gyroscope reversed".to_owned(),
                "turn the gyroscope round, or the sign of its column in the files; if it is right, turn the directions of the angular \
                 trials round"
                    .to_owned(),
            ),
            Self::Standards => (
                Cause::WrongScaling,
                "both standards, or all directions but `down`, reversed".to_owned(),
                "turn both standards round, or the signs of their columns in the files; if they are right, turn all directions round, and leave `down` as it is"
                    .to_owned(),
            ),
            Self::Gains => (
                Cause::WrongScaling,
                "one over each gain_n_per_v".to_owned(),
                "state all gains in N/V: they are written in V/N".to_owned(),
            ),
            Self::Down => (
                Cause::GravityNotHandled,
                "every `down` the other way round".to_owned(),
                "turn every `down` round: it points where gravity pulls, in the sensor's axes".to_owned(),
            ),
            Self::Turned(turned) => (
                Cause::LooseWedge,
                format!("all directions {},", turned_alike(turned)),
                STRAIGHT_ON_ITS_FLANGE.to_owned(),
            ),
            Self::Directions(axes, (of, _)) => {
                let rows = axes.transpose();
                let entry = |row: DVec3| {
                    let at = row.abs().to_array().into_iter().position(|x| x > 0.5);
                    let sign = if row.element_sum() < 0.0 { "-" } else { "" };
                    format!("{sign}{}", ["x", "y", "z"][at.unwrap_or(0)])
                };
                let list = [rows.x_axis, rows.y_axis, rows.z_axis]
                    .map(entry)
                    .join(", ");
                let or = if axes == -DMat3::IDENTITY {
                    "; or, if they are right, both standards' polarity"
                } else {
                    ""
                };
                (
                    Cause::LooseWedge,
                    format!("each direction (x, y, z){of} read as ({list})"),
                    format!("state the directions{of} in the sensor's axes: ({list}) of what is written{or}"),
                )
            }
        }
    }
}

/// What accounts for all trials, if one of these does.
pub fn tried(day: &Unaccounted<'_>) -> Option<Finding> {
    let shares = StaticLoadSharing::new(&day.campaign.geometry).ok()?;
    let (as_stated, table) = with(&shares, day.cases, None)?;
    // Scale factors do not depend on gravity; inertias that turned the wrong way are none, and the drawing's are taken.
    let scales = Table {
        inertia_m2: None,
        ..table.clone()
    };
    let down = || accounts(day, Stated::Down, &scales);
    if let Some(down) = turns_in_the_sensor(day).then(down).flatten() {
        return Some(down);
    }
    // Of what the channels show it makes no difference which way round a standard is: scale factors and inertias come out negative.
    let enough = if is_a_sensor(&table, &day.campaign.design) {
        WORTH_A_FIT * as_stated
    } else {
        as_stated / WORTH_A_FIT
    };
    let first_that_accounts = |all: Vec<Stated>| {
        let mut worth_a_fit: Vec<(f64, Stated, Table)> = all
            .into_par_iter()
            .filter_map(|stated| {
                let (left, table) = with(&shares, day.cases, Some(stated))?;
                Some((left, stated, table))
            })
            .filter(|(left, _, table)| *left <= enough && is_a_sensor(table, &day.campaign.design))
            .collect();
        worth_a_fit.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = worth_a_fit.into_iter().take(TRIED);
        best.find_map(|(_, stated, table)| accounts(day, stated, &table))
    };
    let of_a_step = || OF_A_STEP.into_iter().flat_map(Stated::directions);
    first_that_accounts(Stated::all_day())
        .or_else(|| first_that_accounts(of_a_step().collect()))
        .or_else(|| reversed_under_gravity(day, &scales))
}

/// That standards are reversed where gravity turns in the sensor: a part of what the channels show, its weight, is not reversed with them, so
/// that responses do not say it.
fn reversed_under_gravity(day: &Unaccounted<'_>, scales: &Table) -> Option<Finding> {
    if !turns_in_the_sensor(day) {
        return None;
    }
    let design = &day.campaign.design.scale_per_mass_per_kg;
    let as_designed = |limb: usize| scales.mass_over_scale_kg[limb].copysign(design[limb]);
    let scales = Table {
        mass_over_scale_kg: core::array::from_fn(as_designed),
        ..scales.clone()
    };
    [Stated::Gyroscope, Stated::Accelerometer, Stated::Standards]
        .into_iter()
        .find_map(|stated| accounts(day, stated, &scales))
}

/// That the sensor is turned on its flange, if that accounts for all trials.
pub fn turned_on_the_flange(day: &Unaccounted<'_>) -> Option<Finding> {
    let shares = StaticLoadSharing::new(&day.campaign.geometry).ok()?;
    let (as_stated, _) = with(&shares, day.cases, None)?;
    let turned = Stated::Turned(turned::shown(&shares, &day.campaign.design, day.cases)?);
    let (left, table) = with(&shares, day.cases, Some(turned))?;
    let is_worth_a_fit =
        left <= WORTH_A_FIT * as_stated && is_a_sensor(&table, &day.campaign.design);
    is_worth_a_fit
        .then(|| accounts(day, turned, &table))
        .flatten()
}

/// Whether an angular trial's axis is off the stated plumb line, so that it matters which way gravity pulls.
fn turns_in_the_sensor(day: &Unaccounted<'_>) -> bool {
    let mut angular = day.campaign.of(Role::Angular).map(|(trial, _)| trial);
    let square = |trial: &Trial| {
        trial
            .gravity_ground_m_s2
            .cross(trial.direction_ground)
            .length()
    };
    angular.any(|trial| square(trial) > NOTICED_M_S2)
}

/// Whether the trials agree to the noise with that put right.
fn accounts(day: &Unaccounted<'_>, stated: Stated, table: &Table) -> Option<Finding> {
    let joint = day
        .fit_put_right(table, |trial| stated.put_right(trial))
        .filter(JointReport::accounts)?;
    let (cause, with, advice) = stated.in_words();
    let of_a_step = |trial: &&Trial| match stated {
        Stated::Directions(_, of) => of != ALL && of.1.contains(&trial.role),
        _ => false,
    };
    let trials = day.campaign.trials.iter().map(|(trial, _)| trial);
    let finding = Finding::new(cause, agreeing(&with, &joint), advice);
    Some(finding.in_recordings(trials.filter(of_a_step).map(|trial| &trial.name)))
}

/// Whether the factors have the design's signs, and the inertias are a body's as far as their sum says.
fn is_a_sensor(table: &Table, design: &Parameters) -> bool {
    let scale = (0..LIMBS).all(|limb| {
        table.silent[limb]
            || table.mass_over_scale_kg[limb] * design.scale_per_mass_per_kg[limb] > 0.0
    });
    let inertia = table
        .inertia_m2
        .is_none_or(|i| i.x_axis.x + i.y_axis.y + i.z_axis.z > 0.0);
    scale && inertia
}

/// How far the responses are from agreeing with that put right, and what they then agree on.
fn with(
    shares: &StaticLoadSharing,
    cases: &[TrialCase<'_>],
    stated: Option<Stated>,
) -> Option<(f64, Table)> {
    // Directions are all that is asked of a trial from here on; its series stay where they are.
    let trials: Vec<Trial> = cases
        .iter()
        .map(|case| {
            let mut trial = Trial {
                voltage_v: Vec::new(),
                accelerometer_m_s2: Vec::new(),
                gyroscope_rad_s: Vec::new(),
                name: String::new(),
                ..*case.trial
            };
            if let Some(stated) = stated {
                stated.put_right(&mut trial);
            }
            trial
        })
        .collect();
    let cases: Vec<TrialCase<'_>> = (cases.iter().zip(&trials))
        .map(|(case, trial)| {
            let mut response = case.response.clone();
            if let Some(response) = &mut response
                && let Some(stated) = stated
            {
                let factors = stated.factors(trial.role, &case.trial.gains);
                let each = response.channels.iter_mut().zip(factors);
                each.for_each(|(channel, factor)| *channel = *channel * factor);
            }
            TrialCase {
                trial,
                conditioned: case.conditioned,
                force_n: Vec::new(),
                response,
                // What was found of trials before was found with other axes.
                ignored: [false; LIMBS],
                explained: false,
            }
        })
        .collect();
    agreement(shares, &cases)
}
