//! What trials tell of an unknown, where that has a closed form.

use glam::DVec3;
use sixaxis_core::decouple::uncertainty::influence::{GyroscopeShare, InertiaInfluence};
use sixaxis_core::identify::inertia::{InertiaEstimate, InertiaIdentification, euler_torque};
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::identify::stiffness_bound::{Information, Response};
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS};

const NOISE_M_S2: f64 = 0.01;
const SAMPLES: usize = 5000;
const ROUNDING: f64 = 1e-12;

/// Trials of which each shows one unknown by itself: none costs another anything. In one channel k/m and the scale factor go
/// together as well: with a correlation rho the bound is wider by one over the root of 1 - rho^2.
#[test]
fn inv_bounds_of_unknowns_that_go_apart_or_together() {
    let nothing = Response {
        force_per_mass_m_s2: [0.0; LIMBS],
        by_log_stiffness_m_s2: [0.0; LIMBS],
        by_inertia: [[0.0; LIMBS]; 6],
    };
    for (together, inertia) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
        let mut information = Information::new(1e-4).expect("a size");
        let mut add = |response: &Response| {
            information
                .push(response, NOISE_M_S2, SAMPLES)
                .expect("noise");
        };
        let mut stiffness = nothing;
        stiffness.by_log_stiffness_m_s2[0] = 1.0;
        stiffness.force_per_mass_m_s2[0] = together;
        stiffness.by_inertia[0][0] = inertia * 1e4;
        add(&stiffness);
        let mut scale = nothing;
        scale.force_per_mass_m_s2 = [1.0; LIMBS];
        add(&scale);
        for entry in 0..6 {
            let mut own = nothing;
            own.by_inertia[entry][entry] = 1e4;
            add(&own);
        }
        // One trial shows k/m alone; the other unknown that it shows, a second one does, too: rho^2 is a half.
        let alone = NOISE_M_S2 / (0.5 * SAMPLES as f64).sqrt();
        let root = 2.0_f64.sqrt();
        let bound = information.bound().expect("determined");
        let known = information.bound_with_inertia_known().expect("determined");
        let by = |x: f64| if x > 0.0 { root } else { 1.0 };
        for (what, ours, expected) in [
            ("all unknown", bound.all_unknown, by(together + inertia)),
            ("scale known", bound.scale_known, by(inertia)),
            ("all else known", bound.all_else_known, 1.0),
            ("inertia known", known, by(together)),
        ] {
            assert!(
                (ours / alone / expected - 1.0).abs() < ROUNDING,
                "{what}: {}",
                ours / alone
            );
        }
    }
}

/// Rates and their derivatives of a made-up run, and what step 3 finds from it.
fn found() -> (Vec<(DVec3, DVec3)>, InertiaEstimate) {
    let geometry = Geometry::PAPER;
    let shares = StaticLoadSharing::new(&geometry).expect("a sensor");
    let truth = InertiaPerMass::from_paper_order([2e-4, 2.5e-4, 3e-4, 1e-5, -2e-5, 3e-5]);
    let mut rows = InertiaIdentification::new(geometry);
    let run = (0..60).map(|n| {
        let of = |k: f64| (k * f64::from(n)).sin();
        (
            DVec3::new(of(0.7), of(1.3), of(2.9)),
            DVec3::new(of(1.1), of(0.3), of(1.9)),
        )
    });
    let run: Vec<(DVec3, DVec3)> = run.collect();
    for &(w, dw) in &run {
        let torque = euler_torque(&truth, w, dw);
        let force = core::array::from_fn(|i| shares.of_torque_per_m(i).dot(torque));
        rows.push(&force, w, dw).expect("finite");
    }
    (run, rows.solve().expect("determined"))
}

/// A gyroscope's gain multiplies w x I w: trials in which nothing turns say nothing of it, whatever share their word has.
#[test]
fn inv_trials_that_do_not_turn_say_nothing_of_the_gyroscope() {
    let (run, found) = found();
    let identified = GyroscopeShare {
        rate_over_reading: 1.0,
        of_trials: 1.0,
    };
    let answer = |share: GyroscopeShare, turns: f64| {
        let samples = run.iter().map(|(w, dw)| (*w * turns, *dw));
        InertiaInfluence::new(&found, share, samples).of_sample(run[7].0, run[7].1)
    };
    let trusted = answer(GyroscopeShare::TRUSTED, 1.0);
    assert_eq!(answer(identified, 0.0), trusted);
    assert_ne!(answer(identified, 1.0), trusted);
}
