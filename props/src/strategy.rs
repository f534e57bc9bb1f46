//! Generators for property tests: sensors, motions, vectors, and numbers from the edges of f64.

use crate::truth;
use glam::DVec3;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use sixaxis_core::{Geometry, InertiaPerMass, Parameters};

use crate::manufactured::motion::{Harmonic, Manufactured};
use crate::seed::seed;

/// `cases` runs from [`seed`]; `SIXAXIS_CASES` is an upper bound on their number, for tools that run the suites a thousand
/// times over.
pub fn config(cases: u32) -> Config {
    let bound = std::env::var("SIXAXIS_CASES")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(u32::MAX);
    Config {
        cases: cases.min(bound),
        rng_seed: RngSeed::Fixed(seed()),
        failure_persistence: None,
        ..Config::default()
    }
}

/// A sensor scattered about the design as the paper's identified one is.
pub fn parameters() -> impl Strategy<Value = Parameters> {
    let design = truth::design_parameters();
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

/// A drawing unlike the paper's: limbs of 5 to 80 mm at a mass of 8 to 120 mm.
pub fn geometry() -> impl Strategy<Value = Geometry> {
    (5e-3..80e-3_f64, 4e-3..60e-3_f64).prop_map(|(limb_length_m, half_edge_m)| Geometry {
        limb_length_m,
        half_edge_m,
    })
}

/// An inertia per mass that fits a body of half edge `half_edge_m`: principal moments within a third of each other,
/// axes turned by up to a few degrees.
fn inertia(half_edge_m: f64) -> impl Strategy<Value = InertiaPerMass> {
    let n2 = half_edge_m * half_edge_m;
    (
        prop::array::uniform3(0.45..0.65_f64),
        prop::array::uniform3(-0.03..0.03_f64),
    )
        .prop_map(move |(d, o)| {
            InertiaPerMass::from_paper_order([d[0], d[1], d[2], o[0], o[1], o[2]].map(|i| i * n2))
        })
}

/// A sensor of any drawing whose mass moves in its shell so that the shell sees some 100 m/s^2 and 30 rad/s at 2 to
/// 100 Hz; limbs from very soft (modes at 0.5 kHz) to stiffer than the paper's.
pub fn manufactured() -> impl Strategy<Value = Manufactured> {
    let wrench = || (vector(60.0), vector(8.0));
    let harmonic = move || (0.4..1.0_f64, [wrench(), wrench()]);
    let sensor = geometry().prop_flat_map(|g| (Just(g), inertia(g.half_edge_m), parameters()));
    (
        sensor,
        vector(7.0),
        7.0..9.0_f64,
        0.3..2.0_f64,
        [harmonic(), harmonic()],
    )
        .prop_map(
            |(
                (geometry, inertia_per_mass, mut parameters),
                gravity_ground_m_s2,
                log_k,
                log_f,
                wanted,
            )| {
                parameters.stiffness_per_mass_per_s2 = 10.0_f64.powf(log_k);
                parameters.inertia_per_mass = inertia_per_mass;
                let harmonics = wanted.map(|(share, [cosine, sine])| {
                    let frequency_hz = share * 10.0_f64.powf(log_f);
                    let [a, b] = [cosine, sine].map(|(acceleration, rate)| {
                        let angular = rate * (core::f64::consts::TAU * frequency_hz);
                        displacement(&geometry, &parameters, acceleration, angular)
                    });
                    Harmonic {
                        frequency_hz,
                        position_m: [a.0, b.0],
                        angle_rad: [a.1, b.1],
                    }
                });
                Manufactured {
                    geometry,
                    parameters,
                    gravity_ground_m_s2,
                    harmonics,
                    rise_s: 0.0,
                }
            },
        )
}

/// Displacement and rotation of the mass under which the limbs accelerate it as wanted, to first order: without it the
/// nodes' places off the centre would turn a pure shift into a violent spin.
fn displacement(
    geometry: &Geometry,
    parameters: &Parameters,
    acceleration: DVec3,
    angular: DVec3,
) -> (DVec3, DVec3) {
    let jacobian = geometry.limb_jacobian();
    let torque = parameters.inertia_per_mass.matrix_mass_m2() * angular;
    let (a, m) = (acceleration, torque);
    let wrench = nalgebra::Vector6::new(a.x, a.y, a.z, m.x, m.y, m.z);
    let moved = (jacobian.transpose() * jacobian)
        .lu()
        .solve(&wrench)
        .expect("three nodes hold a body")
        / -parameters.stiffness_per_mass_per_s2;
    (
        DVec3::new(moved[0], moved[1], moved[2]),
        DVec3::new(moved[3], moved[4], moved[5]),
    )
}

/// A vector with components up to `size`.
pub fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
}

/// Any f64 at all; NaN, the infinities, zero, the smallest and the largest often.
pub fn any_f64_edge() -> impl Strategy<Value = f64> {
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
