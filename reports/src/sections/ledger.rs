//! The claims ledger: each printed claim of the paper, what was measured, and what became of it.
//!
//! A verdict is computed where a measured number can decide it; where only an argument can, it is marked as judged
//! ([`verdict`]).

mod verdict;

use anyhow::Result;
use core::f64::consts::TAU;
use serde::Serialize;
use sixaxis_core::Scheme;
use sixaxis_page::{Block, Claim, Section, Text};
use sixaxis_props::results::{Budget, Published, headline};
use sixaxis_reference::paper::{COMPOUND_TABLES, GRAVITY_M_S2, THRESHOLD_FREQUENCY_HZ};
use sixaxis_reference::rig::run::{Mode, ROTATION_AMPLITUDE_RAD, SLIDER_AMPLITUDE_M};

use super::DEG_PER_RAD;
use super::budget::nothing;
use super::identifiability::lost_at;
use crate::study::arithmetic::Arithmetic;
use crate::study::identifiability::RECORDS;
use crate::study::results::identifiability::{Erring, Records};
use crate::study::results::{
    Correction, Defects, FOUR_STEPS, ParameterSet, Results, Standard, substepped, worst,
};

/// Step 4 holds while the median of |ln(k/m found over true)| is within this.
const KEPT: f64 = 0.1;

/// The section.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    Ok(Section::new(
        "ledger",
        "Claims ledger",
        "What the paper prints, what this project measured, and what became of it. Measured numbers are of this run, but for the \
         imperfections that alone make 7.479 %, which are published. A verdict marked as judged stands in the text, whatever is measured.",
    )
    .block(Block::Ledger(claims(r)?)))
}

/// All claims.
///
/// # Errors
/// If the text does not fit the results.
pub fn claims(r: &Results) -> Result<Vec<Claim>> {
    let found = Found::of(r, &Budget::embedded()?);
    Text::new(include_str!("ledger.md"))
        .values(&found)
        .claims(|id| found.verdict(id))
}

/// Largest motions of the rig at 5 Hz.
#[derive(Serialize)]
struct Rig {
    acceleration_g: f64,
    rate_deg_s: f64,
    angular_deg_s2: f64,
}

/// Where relative accelerations cross the paper's thresholds, Hz.
#[derive(Serialize)]
struct Crossings {
    linear: f64,
    angular: f64,
    identified_angular: f64,
}

/// What of an imperfection makes the paper's largest error by itself: between which sizes.
#[derive(Serialize)]
struct Alone {
    name: String,
    unit: String,
    sizes: Option<[f64; 2]>,
}

/// All of them, as published.
fn alone(budget: &Budget) -> Vec<Alone> {
    let ladders = budget.ladders();
    let alone = ladders.iter().map(|ladder| Alone {
        name: ladder.name.to_owned(),
        unit: ladder.unit.to_owned(),
        sizes: ladder.alone(headline),
    });
    alone.collect()
}

/// What the claims are held against.
#[derive(Serialize)]
struct Found {
    /// Imperfections with the sizes between which each alone makes the paper's largest error.
    alone: Vec<Alone>,
    /// What a perfect laboratory is left with: the low-pass.
    conditioning: f64,
    printed_hz: (f64, f64),
    crossing_hz: Crossings,
    /// Relative accelerations of the identified sensor at 2 and 4 Hz.
    linear_m_s2: [f64; 2],
    angular_rad_s2: [f64; 2],
    angular_at_2_hz_deg_s2: f64,
    /// Whether step 4 has a minimum with the sign as printed, and on the true grid point with the other one.
    printed_sign_has_minimum: bool,
    other_sign_finds_truth: bool,
    largest_scale_error: f64,
    /// Smallest error of the scale factors with which most searches of step 4 have no minimum any more: whole runs, even turns.
    lost_at: [Option<f64>; 2],
    /// The torque that the limbs' compliance causes in step 4 over that of a limb.
    torque_of_compliance: f64,
    stiffness_is_determined: bool,
    stiffness_per_s2: f64,
    /// Largest errors of the compound runs, over the peaks.
    four_steps: f64,
    /// In the laboratory, against the instruments.
    before: Treated,
    after: Treated,
    heun: f64,
    substepped: f64,
    /// Sample rate at which Heun would be good to 10⁻⁶: of second order, the rate grows with the root of the error.
    heun_rate_khz: f64,
    worst_target: f64,
    rig: Rig,
    defects: Defects,
    arithmetic: Arithmetic,
    /// Slopes of the relative acceleration over the frequency on log axes, design sensor: linear, angular.
    slopes: [f64; 2],
    /// Condition number of step 2's regressor, column-scaled.
    scale_condition: f64,
    /// Largest error of the scale factors with which the median of k/m is still within [`KEPT`]: whole runs, even turns.
    scale_kept: [Option<f64>; 2],
    kept: f64,
}

impl Found {
    fn of(r: &Results, budget: &Budget) -> Self {
        let sweep = |sensor: &str, mode: Mode| {
            let mut all = r.thresholds.iter();
            all.find(|s| s.sensor == sensor && s.mode == mode)
        };
        let crossing = |sensor, mode| {
            let sweep = sweep(sensor, mode);
            sweep.and_then(|s| s.crossing_hz).unwrap_or(f64::NAN)
        };
        let identified =
            |mode| sweep("identified", mode).map_or([f64::NAN; 2], |s| s.at_2_and_4_hz);
        let truth = &r.noise_free.truth;
        let exact_search = |as_printed: bool| {
            let mut all = r.searches.iter();
            all.find(|s| s.sign_as_printed == as_printed && s.scale_error == Some(0.0))
        };
        let scale_errors = (0..9).map(|i| {
            let found = r.noise_free.found.scale_per_mass_per_kg[i];
            (found / truth.scale_per_mass_per_kg[i] - 1.0).abs()
        });
        let torques = r.identifiability.biases.iter();
        let torques = torques.map(|bias| bias.torque_of_compliance / bias.torque_of_a_limb);
        let with_truth = |scheme| {
            worst(
                &r.compound_noise_free,
                (
                    ParameterSet::True,
                    scheme,
                    Correction::OpenLoop,
                    Standard::Truth,
                ),
            )
        };
        let heun = with_truth(Scheme::Heun);
        let omega = TAU * 5.0;
        Self {
            alone: alone(budget),
            conditioning: nothing(budget).map_or(f64::NAN, |errors| headline(&errors)),
            printed_hz: THRESHOLD_FREQUENCY_HZ,
            crossing_hz: Crossings {
                linear: crossing("design", Mode::Linear),
                angular: crossing("design", Mode::Angular),
                identified_angular: crossing("identified", Mode::Angular),
            },
            linear_m_s2: identified(Mode::Linear),
            angular_rad_s2: identified(Mode::Angular),
            angular_at_2_hz_deg_s2: identified(Mode::Angular)[0] * DEG_PER_RAD,
            printed_sign_has_minimum: exact_search(true).is_some_and(|s| s.verdict.is_determined()),
            other_sign_finds_truth: exact_search(false).is_some_and(|s| {
                let found = s.grid_minimum_per_s2 / truth.stiffness_per_mass_per_s2;
                s.verdict.is_determined() && (found - 1.0).abs() < 1e-9
            }),
            largest_scale_error: scale_errors.fold(0.0, f64::max),
            lost_at: RECORDS.map(|records| lost_at(&r.identifiability, records, Erring::Scale)),
            torque_of_compliance: torques.fold(0.0, f64::max),
            stiffness_is_determined: r.laboratory.stiffness_verdict.is_determined(),
            stiffness_per_s2: r.laboratory.found.stiffness_per_mass_per_s2,
            four_steps: worst(&r.compound_noise_free, FOUR_STEPS),
            before: treated(r, ParameterSet::Design),
            after: treated(r, ParameterSet::Identified),
            heun,
            substepped: with_truth(Scheme::HeunSubstepped),
            heun_rate_khz: 10.0 * (heun / 1e-6).sqrt(),
            worst_target: worst_target(r),
            rig: Rig {
                acceleration_g: SLIDER_AMPLITUDE_M * omega * omega / GRAVITY_M_S2,
                rate_deg_s: ROTATION_AMPLITUDE_RAD * omega * DEG_PER_RAD,
                angular_deg_s2: ROTATION_AMPLITUDE_RAD * omega * omega * DEG_PER_RAD,
            },
            defects: r.defects,
            arithmetic: r.arithmetic.clone(),
            slopes: [Mode::Linear, Mode::Angular]
                .map(|mode| sweep("design", mode).map_or(f64::NAN, |s| s.slope)),
            scale_condition: r.noise_free.scale_condition,
            scale_kept: RECORDS.map(|records| scale_kept(r, records)),
            kept: KEPT,
        }
    }

    /// Whether each of these imperfections makes the paper's largest error at a size that is not beyond this one.
    fn enough(&self, imperfections: &[(&str, f64)]) -> bool {
        imperfections.iter().all(|(name, most)| {
            let mut all = self.alone.iter();
            all.any(|alone| {
                alone.name == *name && alone.sizes.is_some_and(|[_, size]| size <= *most)
            })
        })
    }
}

/// Largest error of the scale factors up to which the median of |ln(k/m found over true)| stays within [`KEPT`].
fn scale_kept(r: &Results, records: Records) -> Option<f64> {
    let mut all = r.identifiability.tolerances.iter();
    let tolerance = all.find(|t| t.records == records && t.erring == Erring::Scale)?;
    let kept = tolerance.points.iter().take_while(|p| p.median <= KEPT);
    kept.last().map(|point| point.size)
}

/// Largest errors of the laboratory's runs against the instruments, over the peaks.
#[derive(Serialize)]
struct Treated {
    open_loop: f64,
    corrected: f64,
}

fn treated(r: &Results, set: ParameterSet) -> Treated {
    let worst = |correction| {
        let way = substepped(set, correction, Standard::Instruments);
        worst(&r.compound_laboratory, way)
    };
    Treated {
        open_loop: worst(Correction::OpenLoop),
        corrected: worst(Correction::RestToRest),
    }
}

/// Largest departure of the compound runs' accelerations from the 18 printed targets, relative.
fn worst_target(r: &Results) -> f64 {
    let mut worst = 0.0_f64;
    for run in &r.compound_noise_free {
        let Some(table) = COMPOUND_TABLES.iter().find(|t| t.number == run.table) else {
            continue;
        };
        for axis in 0..6 {
            let unit = if axis < 3 {
                GRAVITY_M_S2
            } else {
                1.0 / DEG_PER_RAD
            };
            worst = worst.max((run.amplitude[axis] / unit / table.target[axis] - 1.0).abs());
        }
    }
    worst
}
