//! What the suites of campaigns have in common: a session that is played in milliseconds, and rows that nobody played.

#![allow(dead_code, reason = "each suite uses its own share")]

use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::significance::NORMAL_95;
use std::path::Path;

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_campaign::part::Provenance;
use sixaxis_campaign::plan::CampaignPlan;
use sixaxis_campaign::row::{Group, Row, Scalar, Status, Text};
use sixaxis_campaign::run::{VERSION, Watch};
use sixaxis_reference::laboratory::plan::{Engine, SensorChoice, SessionPlan};

/// A session that is played in milliseconds.
pub fn small() -> SessionPlan {
    SessionPlan {
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        trials_per_step: 3,
        sample_rate_hz: 200.0,
        static_duration_s: 30.0,
        static_rate_hz: 10.0,
        ..SessionPlan::default()
    }
}

/// Nobody looks.
pub struct Unwatched;

impl Watch for Unwatched {
    fn begins(&self, _: u64, _: u64) {}
    fn case(&self) {}
    fn set_aside(&self, _: &Path, _: &Path, _: &str) {}
}

/// Where made-up rows say that they are from.
pub fn provenance(asked: core::ops::Range<u64>) -> Provenance {
    let plan = CampaignPlan::new(&small(), asked.start, asked.end - asked.start)
        .expect("the plan can be played");
    Provenance {
        version: VERSION.to_owned(),
        plan: plan.text(),
        asked,
    }
}

/// A row whose errors are normal, `honesty` times what it states, and whose joint fit is as good as its bound. Every tenth
/// case failed.
pub fn made_up(seed: u64, honesty: f64) -> Row {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    if seed.is_multiple_of(10) {
        let mut row = Row::new(seed, Status::NotIdentified);
        row.set_text(Text::Failure, "step 2: no \u{2192} \"reason\"");
        return row;
    }
    let mut row = Row::new(seed, Status::Calibrated);
    row.set_text(
        Text::Step4,
        if seed.is_multiple_of(3) {
            "flat"
        } else {
            "determined"
        },
    );
    row.set_scalar(Scalar::AccelerometerGainError, 1e-3 * normal());
    let truth: [f64; PARAMETERS] = core::array::from_fn(|_| normal());
    // Sensors differ in how well they are known.
    let stated: [f64; PARAMETERS] = core::array::from_fn(|_| 0.1 + normal().abs());
    let estimate = core::array::from_fn(|i| Some(truth[i] + honesty * stated[i] * normal()));
    row.set_group(Group::Truth, truth.map(Some));
    row.set_group(Group::FourSteps, estimate);
    row.set_group(Group::FourStepsStandardError, stated.map(Some));
    row.set_group(Group::StatedHalfWidth, stated.map(|s| Some(3.0 * s)));
    let joint: [f64; PARAMETERS] = core::array::from_fn(|i| truth[i] + 0.5 * stated[i] * normal());
    row.set_group(Group::Joint, joint.map(Some));
    row.set_group(Group::JointGainKnown, joint.map(Some));
    let ends =
        |sign: f64| core::array::from_fn(|i| Some(joint[i] + sign * NORMAL_95 * 0.5 * stated[i]));
    row.set_group(Group::JointLow, ends(-1.0));
    row.set_group(Group::JointHigh, ends(1.0));
    row.set_group(Group::JointStandardError, stated.map(|s| Some(0.5 * s)));
    row.set_group(Group::CramerRao, stated.map(|s| Some(0.5 * s)));
    row
}
