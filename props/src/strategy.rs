//! Random sensors, motions and rubbish.

use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use sixaxis_core::{InertiaPerMass, Parameters};
use sixaxis_reference::paper;

/// Seed unless `SIXAXIS_SEED` says otherwise.
const SEED: u64 = 20131;

/// `cases` runs from a fixed seed, so that a failure stays a failure; `SIXAXIS_SEED` sets another.
#[must_use]
pub fn config(cases: u32) -> Config {
    let seed = std::env::var("SIXAXIS_SEED")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(SEED);
    eprintln!("SIXAXIS_SEED={seed}");
    Config {
        cases,
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        ..Config::default()
    }
}

/// A sensor scattered about the design as the paper's identified one is.
pub fn parameters() -> impl Strategy<Value = Parameters> {
    let design = paper::design_parameters();
    (
        prop::array::uniform9(-20e-3..20e-3_f64),
        prop::array::uniform9(0.6..1.4_f64),
        prop::array::uniform3(0.8..1.2_f64),
        prop::array::uniform3(-2e-6..2e-6_f64),
        1.5e8..5.0e8_f64,
    )
        .prop_map(move |(drift, scale, diagonal, off_diagonal, stiffness)| {
            let i = design.inertia_per_mass.to_paper_order();
            Parameters {
                zero_drift_v: drift,
                scale_per_mass_per_kg: scale.map(|s| s * design.scale_per_mass_per_kg[0]),
                inertia_per_mass: InertiaPerMass::from_paper_order([
                    i[0] * diagonal[0],
                    i[1] * diagonal[1],
                    i[2] * diagonal[2],
                    off_diagonal[0],
                    off_diagonal[1],
                    off_diagonal[2],
                ]),
                stiffness_per_mass_per_s2: stiffness,
            }
        })
}

/// A vector with components up to `size`.
pub fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
}

/// Any f64 at all, the odd ones often.
pub fn rubbish() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(0.0),
        Just(f64::MIN_POSITIVE / 2.0),
        Just(f64::MAX),
        -10.0..10.0_f64,
    ]
}
