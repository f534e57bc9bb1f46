//! Rubbish into the search for k/m: a typed error that names its cause or a finite judgement, never a silent NaN.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::identify::stiffness;
use sixaxis_core::paper::dynamics::{Instant, MassInertia};
use sixaxis_core::paper::relative_motion::RelativeMotion;
use sixaxis_core::paper::wrench::LimbWrench;
use sixaxis_core::{
    Error, Gains, Geometry, InertiaPerMass, LIMBS, Parameters, Scheme, Sensor, Settings,
};
use sixaxis_props::compare::all_finite;
use sixaxis_props::truth;

use crate::input::{adversarial_f64, adversarial_setup, extreme, record, remembering};

proptest! {
    #![proptest_config(remembering(1024, "stiffness"))]

    #[test]
    fn prop_any_curve_is_judged_or_refused(
        sound in prop::collection::vec(0.0..1.0_f64, 0..8),
        size in prop_oneof![Just(1.0), extreme()],
        grid_size in prop_oneof![Just(1e8), extreme()],
        wild in prop::option::of(prop::collection::vec((adversarial_f64(), adversarial_f64()), 0..6)),
        strewn in prop::option::of((0_usize..8, adversarial_f64(), prop::bool::ANY)),
    ) {
        let mut curve = wild.unwrap_or_else(|| {
            sound.iter().enumerate().map(|(i, w)| ((i + 1) as f64 * grid_size, w * size)).collect()
        });
        if let Some((place, value, of_grid)) = strewn
            && let Some((k, w)) = curve.get_mut(place)
        {
            *(if of_grid { k } else { w }) = value;
        }
        match stiffness::judge(&curve) {
            Ok(found) => {
                prop_assert!(all_finite(&found), "{found:?} of {curve:?}");
                prop_assert!(curve.iter().all(|(k, w)| *k > 0.0 && *w >= 0.0));
            }
            Err(Error::NotFinite { sample, .. }) => prop_assert!(!curve[sample].1.is_finite()),
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }

    #[test]
    fn prop_any_trial_has_a_rate_or_an_error(
        (setup, _) in adversarial_setup(),
        rows in record::<LIMBS>(8),
    ) {
        let (sensor, parameters, settings) = setup;
        if let Ok(found) = stiffness::rate_norm_sum(&sensor, &parameters, &settings, &rows) {
            prop_assert!(all_finite(&found), "{found:?}");
        }
    }
}

/// Each was judged: to a k/m of NaN, and to `Determined` by a floor of -1 over nothing.
#[test]
fn regress_a_curve_without_a_meaning_is_refused() {
    for curve in [
        [(1e8, 1.0), (f64::NAN, 0.0), (3e8, 1.0)],
        [(1e8, 0.0), (2e8, -1.0), (3e8, 0.0)],
        [(3e8, 1.0), (2e8, 0.0), (1e8, 1.0)],
    ] {
        assert!(matches!(
            stiffness::judge(&curve),
            Err(Error::OutOfRange { .. })
        ));
    }
}

/// The squares of the values are infinite: the parabola through them has no vertex.
#[test]
fn law_a_curve_whose_squares_overflow_keeps_its_grid_minimum() {
    let curve = [(1e8, 1e200), (2e8, 1e-200), (3e8, 1e200)];
    let found = stiffness::judge(&curve).expect("finite, positive, ascending");
    assert!(all_finite(&found));
    assert!(found.verdict.is_determined());
}

/// In one step of Euler's a body spins itself up to a rate that is finite and whose length is not: the sum was infinite.
#[test]
fn regress_a_rate_beyond_squares_has_no_mean() {
    let entries = [3.00e-4, 3.01e-4, 3.02e-4, 0.0, 0.0, 0.0];
    let parameters = Parameters {
        inertia_per_mass: InertiaPerMass::from_paper_order(entries),
        ..truth::identified_parameters()
    };
    let sensor = Sensor {
        geometry: Geometry::PAPER,
        gains: Gains::uniform(1.0),
    };
    let inertia = MassInertia::new(&parameters.inertia_per_mass);
    let free = Instant::new(RelativeMotion::default(), LimbWrench::default(), &inertia);
    // Without forces (8) is quadratic in the rate.
    let response = free.angular_acceleration_shell_rad_s2(DVec3::ONE).length();
    let (start, end) = (1e120, 1.345e154);
    let settings = Settings {
        scheme: Scheme::Euler,
        initial_rate_shell_rad_s: DVec3::splat(start),
        ..Settings::new(response * start / end * start)
    };
    let rows = [parameters.zero_drift_v; 4];
    let answer = stiffness::rate_norm_sum(&sensor, &parameters, &settings, &rows);
    assert!(
        matches!(
            answer,
            Err(Error::Overflow {
                what: "mean rate (step 4)",
                ..
            })
        ),
        "{answer:?}"
    );
}
