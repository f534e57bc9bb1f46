//! Rubbish about the sensor itself: drawing, gains, inertia, gravity, pose. Refused by name or a finite answer; and what
//! documents its precondition instead stays finite for sane numbers.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::paper::attitude;
use sixaxis_core::paper::dynamics::{Instant, MassInertia};
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::preload::{static_equilibrium, static_preload_m_s2};
use sixaxis_core::paper::relative_motion::RelativeMotion;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::paper::wrench::{LimbWrench, limb_directions};
use sixaxis_core::{Error, Gains, Geometry, InertiaPerMass, LIMBS, LimbLaw, Parameters};
use sixaxis_props::compare::all_finite;
use sixaxis_props::strategy::{parameters, vector};
use sixaxis_props::truth;

use crate::input::{adversarial_f64, extreme, remembering, spoiled};

proptest! {
    #![proptest_config(remembering(1024, "sensor"))]

    #[test]
    fn prop_any_gravity_finds_an_equilibrium_or_an_error(
        (numbers, _) in spoiled([25.5e-3, 21e-3, 2e8, 0.0, 0.0, -9.81]),
        all in prop::option::weighted(0.3, prop::array::uniform6(adversarial_f64())),
    ) {
        let [limb_length_m, half_edge_m, k, x, y, z] = all.unwrap_or(numbers);
        let geometry = Geometry { limb_length_m, half_edge_m };
        let gravity = DVec3::new(x, y, z);
        let forces = static_preload_m_s2(&geometry, k, gravity);
        let both = static_equilibrium(&geometry, k, gravity);
        prop_assert_eq!(forces.is_ok(), both.is_ok());
        if let Ok(answer) = &both {
            prop_assert!(all_finite(answer) && all_finite(&gravity), "{answer:?}");
            let pull = gravity.abs().max_element();
            let push = forces.expect("both agree").into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            prop_assert!(pull == 0.0 || push > 0.0 || pull.powi(2) < f64::MIN_POSITIVE, "gravity went unseen");
        }
    }

    #[test]
    fn prop_any_elongations_make_a_pose_or_an_error(
        (lengths, _) in spoiled([25.5e-3, 21e-3]),
        (elongation, _) in spoiled([1e-7; LIMBS]),
        all in prop::option::weighted(0.3, prop::array::uniform9(adversarial_f64())),
        stretch in prop::option::weighted(0.3, extreme()),
    ) {
        let geometry = Geometry { limb_length_m: lengths[0], half_edge_m: lengths[1] };
        let elongation = stretch.map_or(all.unwrap_or(elongation), |dl| [dl; LIMBS]);
        if let Ok(pose) = Pose::from_elongations(&geometry, &elongation) {
            prop_assert!(all_finite(&pose), "{pose:?}");
            prop_assert!(elongation.iter().all(|dl| dl.is_finite()));
        }
    }

    #[test]
    fn prop_any_inertia_is_refused_or_invertible(
        (entries, _) in spoiled([3e-4, 3e-4, 3e-4, 0.0, 0.0, 0.0]),
        all in prop::option::weighted(0.5, prop::array::uniform6(adversarial_f64())),
        size in extreme(),
        scaled in prop::bool::ANY,
    ) {
        let entries = all.unwrap_or(entries).map(|i| if scaled { i * size } else { i });
        let inertia = InertiaPerMass::from_paper_order(entries);
        if let Ok(moments) = inertia.principal_m2() {
            prop_assert!(all_finite(&moments), "{moments:?}");
        }
        if inertia.validate().is_ok() {
            let both = MassInertia::new(&inertia);
            prop_assert!(all_finite(&both), "{both:?}");
        }
    }

    #[test]
    fn prop_plain_mathematics_keeps_sane_numbers_finite(
        parameters in parameters(),
        force in prop::array::uniform9(-1e4..1e4_f64),
        places in [vector(1e-3), vector(1e-3), vector(1e-3)],
        turns in [vector(10.0), vector(10.0), vector(10.0)],
        step_s in 1e-6..1.0_f64,
    ) {
        let geometry = Geometry::PAPER;
        let poses: [Pose; 3] = core::array::from_fn(|i| Pose {
            position_shell_m: places[i],
            rotation_rad: turns[i],
        });
        let pose = &poses[1];
        let motion = RelativeMotion::from_poses(&poses[0], pose, &poses[2], step_s);
        let inertia = MassInertia::new(&parameters.inertia_per_mass);
        let wrench = LimbWrench::at_pose(&geometry, pose, &force);
        let instant = Instant::new(motion, wrench, &inertia);
        let angular = instant.angular_acceleration_shell_rad_s2(turns[0]);
        prop_assert!(all_finite(&(motion, wrench, instant, angular)));
        prop_assert!(all_finite(&instant.specific_force_shell_m_s2(turns[0], angular)));
        prop_assert!(all_finite(&LimbWrench::at_rest(&geometry, &force)));
        prop_assert!(all_finite(&limb_directions(&geometry, pose)));
        prop_assert!(all_finite(&(pose.rotation_matrix(), pose.elongations_m(&geometry))));
        let law = LimbLaw::AsPrinted.elongations_m(&force, parameters.stiffness_per_mass_per_s2);
        prop_assert!(all_finite(&(law, geometry.mass_hinges_m(), geometry.shell_hinges_m())));
        let attitude = attitude::advance(
            attitude::exp(turns[0]), [turns[1], turns[2]], [turns[0], turns[1]], step_s,
        );
        prop_assert!(all_finite(&attitude) && attitude.is_normalized());
    }

    #[test]
    fn prop_sane_signals_stay_finite(
        parameters in parameters(),
        voltage in prop::array::uniform9(-10.0..10.0_f64),
    ) {
        let gains = Gains::uniform(20.0);
        let chain = SignalChain::new(&gains, &parameters);
        let force = chain.force_per_mass_m_s2(&voltage);
        let back = (chain.voltage_v(&force), chain.voltage_change_v(&force));
        prop_assert!(all_finite(&(chain, force, back)));
        prop_assert!(all_finite(&gains.measured_force_n(&voltage, &parameters.zero_drift_v)));
    }

    #[test]
    fn prop_gains_and_drawings_are_refused_by_name(
        (gains, spoiled_gains) in spoiled([1.0; LIMBS]),
        lengths in prop::array::uniform2(adversarial_f64()),
    ) {
        match (Gains { gain_n_per_v: gains }).validate() {
            Ok(()) => prop_assert!(gains.iter().all(|c| c.is_finite() && *c != 0.0)),
            Err(Error::OutOfRange { name, .. }) => {
                prop_assert_eq!(name, "gain_n_per_v");
                prop_assert!(!spoiled_gains.is_empty());
            }
            Err(other) => prop_assert!(false, "unexpected {other}"),
        }
        let geometry = Geometry { limb_length_m: lengths[0], half_edge_m: lengths[1] };
        if geometry.validate().is_ok() {
            prop_assert!(lengths.iter().all(|l| l.is_finite() && *l > 0.0));
            prop_assert!(all_finite(&geometry.shell_hinges_m()));
        }
    }
}

#[test]
fn law_impossible_bodies_are_refused() {
    let sound = truth::identified_parameters();
    for inertia in [
        [1e-4, 1e-4, 3e-4, 0.0, 0.0, 0.0],
        [-1e-4, 1e-4, 1e-4, 0.0, 0.0, 0.0],
        [1e-4, 1e-4, 1e-4, 5e-4, 0.0, 0.0],
    ] {
        let parameters = Parameters {
            inertia_per_mass: InertiaPerMass::from_paper_order(inertia),
            ..sound
        };
        assert!(matches!(
            parameters.validate(),
            Err(Error::ImpossibleInertia { .. })
        ));
    }
    assert!(sound.validate().is_ok());
}

/// Its length is infinite, and so was the imbalance that passed for an equilibrium: no force at all.
#[test]
fn regress_a_gravity_of_infinite_length_is_refused() {
    let gravity = DVec3::new(0.0, 0.0, -1e300);
    assert!(matches!(
        static_preload_m_s2(&Geometry::PAPER, 2e8, gravity),
        Err(Error::OutOfRange {
            name: "gravity_shell_m_s2",
            ..
        })
    ));
}

/// The inverse square of the half edge is infinite: the pose was NaN.
#[test]
fn regress_a_pose_without_a_size_is_refused() {
    let geometry = Geometry {
        half_edge_m: 1e-300,
        ..Geometry::PAPER
    };
    assert!(Pose::from_elongations(&geometry, &[1e-7; LIMBS]).is_err());
}
