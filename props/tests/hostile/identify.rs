//! Rubbish into the four steps: a typed error that names its cause or a finite estimate, never a silent NaN.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::identify::compliance::CompliantRows;
use sixaxis_core::identify::inertia::{InertiaIdentification, euler_torque, regressor};
use sixaxis_core::identify::least_squares::Accumulator;
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::identify::zero_drift;
use sixaxis_core::paper::limb_stream::LimbSample;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::relative_motion::RelativeMotion;
use sixaxis_core::paper::wrench::LimbWrench;
use sixaxis_core::{Error, Gains, Geometry, LIMBS, Sensor, Settings};
use sixaxis_props::compare::all_finite;
use sixaxis_props::strategy::{parameters, vector};
use sixaxis_props::truth;

use crate::input::{adversarial_f64, adversarial_setup, extreme, record, remembering, spoiled};

fn sensor() -> Sensor {
    Sensor {
        geometry: Geometry::PAPER,
        gains: Gains::uniform(1.0),
    }
}

/// Rows of N numbers, sound but for a common size and a few adversarial ones.
fn rows<const N: usize>() -> impl Strategy<Value = Vec<[f64; N]>> {
    (
        record::<N>(24),
        prop::array::uniform(prop_oneof![4 => Just(1.0), 1 => extreme()]),
    )
        .prop_map(|(mut rows, sizes): (_, [f64; N])| {
            for row in &mut rows {
                for (x, size) in row.iter_mut().zip(sizes) {
                    *x *= size;
                }
            }
            rows
        })
}

fn triple(row: &[f64], from: usize) -> DVec3 {
    DVec3::new(row[from], row[from + 1], row[from + 2])
}

/// Nine limb forces out of the head of a row.
fn nine(row: &[f64]) -> [f64; LIMBS] {
    core::array::from_fn(|i| row[i])
}

/// The least limb forces per mass that make a torque per mass and no net force.
fn torque_forces(torque: DVec3) -> [f64; LIMBS] {
    let columns = nalgebra::SMatrix::<f64, 6, LIMBS>::from_fn(|row, limb| {
        let mut unit = [0.0; LIMBS];
        unit[limb] = 1.0;
        let wrench = LimbWrench::at_rest(&Geometry::PAPER, &unit);
        [wrench.force_shell_m_s2, wrench.torque_shell_m2_s2][row / 3][row % 3]
    });
    let wrench = nalgebra::Vector6::new(0.0, 0.0, 0.0, torque.x, torque.y, torque.z);
    let normal = (columns * columns.transpose()).try_inverse();
    (columns.transpose() * normal.expect("the limbs hold the mass") * wrench).into()
}

/// Equality as text, for which NaN equals itself.
fn same<T: std::fmt::Debug>(a: &T, b: &T) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

/// A limb sample from 33 numbers.
fn limb_sample(x: &[f64; 33]) -> LimbSample {
    LimbSample {
        sample: 1,
        sensed_m_s2: nine(x),
        force_per_mass_m_s2: nine(&x[9..]),
        relative: RelativeMotion {
            pose: Pose {
                position_shell_m: triple(x, 18) * 1e-7,
                rotation_rad: triple(x, 21) * 1e-5,
            },
            velocity_shell_m_s: DVec3::ZERO,
            rate_shell_rad_s: triple(x, 24),
            acceleration_shell_m_s2: triple(x, 27),
            angular_acceleration_shell_rad_s2: triple(x, 30),
        },
    }
}

proptest! {
    #![proptest_config(remembering(1024, "identify"))]

    #[test]
    fn prop_any_static_record_gives_a_drift_or_an_error(
        mut rows in record::<LIMBS>(40),
        repeated in prop::bool::ANY,
    ) {
        // Too short to be accepted, unless repeated.
        if repeated {
            rows = rows.iter().cycle().take(rows.len() * 4).copied().collect();
        }
        match zero_drift::identify(&rows) {
            Ok(found) => prop_assert!(all_finite(&found), "{found:?}"),
            Err(Error::NotFinite { channel, sample, .. }) => {
                prop_assert!(!rows[sample][channel - 1].is_finite());
            }
            Err(Error::Overflow { channel, .. }) => prop_assert!((1..=LIMBS).contains(&channel)),
            Err(Error::TooFewSamples { got, .. }) => prop_assert_eq!(got, rows.len()),
            Err(other) => prop_assert!(false, "unexpected {other}"),
        }
    }

    #[test]
    fn prop_any_linear_motion_gives_scales_or_an_error(rows in rows::<12>()) {
        let mut step = ScaleIdentification::default();
        let mut accepted = 0;
        for row in &rows {
            let before = step.clone();
            match step.push(&nine(row), triple(row, 9)) {
                Ok(()) => accepted += 1,
                Err(Error::NotFinite { channel, sample, .. }) => {
                    prop_assert_eq!(sample, accepted);
                    let named = if channel == 0 { &row[9..] } else { &row[channel - 1..channel] };
                    prop_assert!(named.iter().any(|x| !x.is_finite()));
                    prop_assert!(same(&step, &before), "channel {channel} left a trace");
                }
                Err(other) => prop_assert!(false, "unexpected {other}"),
            }
        }
        match step.solve() {
            Ok(found) => prop_assert!(all_finite(&found), "{found:?}"),
            Err(error) => prop_assert!(error.to_string().contains("scale per mass")),
        }
    }

    #[test]
    fn prop_any_angular_motion_gives_an_inertia_or_an_error(
        rows in rows::<15>(),
        (lengths, _) in spoiled([25.5e-3, 21e-3]),
    ) {
        let geometry = Geometry { limb_length_m: lengths[0], half_edge_m: lengths[1] };
        let mut step = InertiaIdentification::new(geometry);
        for row in &rows {
            let before = step.clone();
            let pushed = step.push(&nine(row), triple(row, 9), triple(row, 12));
            if row.iter().all(|x| x.abs() < 1.0) && lengths == [25.5e-3, 21e-3] {
                prop_assert!(pushed.is_ok());
            }
            if row.iter().any(|x| !x.is_finite()) {
                prop_assert!(matches!(pushed, Err(Error::NotFinite { .. })), "{pushed:?}");
            }
            prop_assert!(pushed.is_ok() || same(&step, &before), "{pushed:?} left a trace");
        }
        if let Ok(found) = step.solve() {
            prop_assert!(all_finite(&found), "{found:?}");
        }
        if let Ok(found) = step.solve_with_gain() {
            prop_assert!(all_finite(&found), "{found:?}");
        }
    }

    /// Motions that a rigid body could make, so that the tensor is accepted and the gain is searched for.
    #[test]
    fn prop_the_gain_is_found_or_missed_aloud(
        motions in prop::collection::vec((vector(3.0), vector(100.0)), 0..12),
        rate_size in prop_oneof![Just(0.0), Just(1.0), extreme()],
        noise in prop_oneof![Just(0.0), Just(1e-6), extreme()],
        parameters in parameters(),
    ) {
        let mut step = InertiaIdentification::new(Geometry::PAPER);
        for (i, (rate, derivative)) in motions.iter().enumerate() {
            let rate = *rate * rate_size;
            let torque = euler_torque(&parameters.inertia_per_mass, rate, *derivative);
            let mut force = torque_forces(torque);
            for (limb, f) in force.iter_mut().enumerate() {
                *f += noise * ((i + limb) as f64).sin();
            }
            let _ = step.push(&force, rate, *derivative);
        }
        if let Ok(found) = step.solve_with_gain() {
            prop_assert!(all_finite(&found), "{found:?}");
        }
    }

    #[test]
    fn prop_any_rows_are_solved_or_refused(rows in rows::<7>(), right in prop::option::of(adversarial_f64())) {
        let mut system = Accumulator::<6>::default();
        for row in &rows {
            let coefficients = core::array::from_fn(|i| row[i]);
            system.push(coefficients, right.unwrap_or(row[6]));
        }
        prop_assert_eq!(system.rows(), rows.len());
        let not_finite = rows.iter().any(|row| row[..6].iter().any(|x| !x.is_finite()));
        let solutions = [
            system.solve("rows").map(|found| format!("{found:?}")),
            system.combined(|row| [row[0], row[1] + row[2], row[3]]).solve("rows").map(|found| format!("{found:?}")),
        ];
        for solution in solutions {
            prop_assert!(solution.is_err() || !not_finite, "what is not finite was solved");
            if let Ok(found) = solution {
                prop_assert!(all_finite(&found), "{found}");
            }
        }
        if let Ok(found) = system.solve("rows") {
            prop_assert!(all_finite(&found) && all_finite(&found.standard_error()), "{found:?}");
        }
    }

    #[test]
    fn prop_any_limb_sample_is_a_row_or_an_error(
        (numbers, _) in spoiled([0.5; 33]),
        all in prop::option::weighted(0.3, extreme()),
        acceleration in prop::array::uniform3(adversarial_f64()),
        rates in prop::array::uniform2(prop::array::uniform3(adversarial_f64())),
        sane in prop::bool::ANY,
        sound in prop::collection::vec(
            (prop::array::uniform9(-1.0..1.0_f64), vector(1.0), vector(1.0)), 12,
        ),
    ) {
        let rows = CompliantRows::new(&sensor(), &truth::identified_parameters(), &Settings::new(1e3))
            .expect("the paper's sensor is sound");
        let sample = limb_sample(&all.map_or(numbers, |x| [x; 33]));
        let [acceleration, rate, derivative] = [acceleration, rates[0], rates[1]]
            .map(|v| if sane { DVec3::ONE } else { DVec3::from_array(v) });
        let mut scale = ScaleIdentification::default();
        let mut inertia = InertiaIdentification::new(Geometry::PAPER);
        let pushed = rows.push_scale(&mut scale, &sample, acceleration);
        prop_assert!(pushed.is_err() || all_finite(&(sample.sensed_m_s2, acceleration)));
        let pushed = rows.push_inertia(&mut inertia, &sample, rate, derivative);
        prop_assert!(pushed.is_err() || all_finite(&(sample.force_per_mass_m_s2, rate, derivative)));
        for (force, a, b) in sound {
            scale.push(&force, a).expect("sound rows are taken");
            inertia.push(&force, a, b).expect("sound rows are taken");
        }
        if let Ok(found) = scale.solve() {
            prop_assert!(all_finite(&found), "{found:?}");
        }
        if let Ok(found) = inertia.solve_with_gain() {
            prop_assert!(all_finite(&found), "{found:?}");
        }
    }

    #[test]
    fn prop_a_compliant_stream_is_finite_or_refused(
        (setup, _) in adversarial_setup(),
        rows in record::<LIMBS>(8),
    ) {
        let (sensor, parameters, settings) = setup;
        if let Ok(mut stream) = CompliantRows::new(&sensor, &parameters, &settings) {
            for row in &rows {
                if let Ok(sample) = stream.push(row) {
                    prop_assert!(all_finite(&sample), "{sample:?}");
                }
            }
        }
    }

    #[test]
    fn prop_the_regressor_keeps_sane_numbers_finite(
        parameters in parameters(), rate in vector(1e3), derivative in vector(1e6),
    ) {
        prop_assert!(all_finite(&regressor(rate, derivative)));
        prop_assert!(all_finite(&euler_torque(&parameters.inertia_per_mass, rate, derivative)));
    }
}

#[test]
fn regress_a_drift_beyond_squares_names_its_channel() {
    let mut rows = vec![[0.0; LIMBS]; 64];
    rows[40][6] = 1e200;
    assert!(matches!(
        zero_drift::identify(&rows),
        Err(Error::Overflow { channel: 7, .. })
    ));
}

/// The square of the entry is infinite, and the rotation wiped out all that was known.
#[test]
fn regress_a_row_whose_square_overflows_is_not_a_row_of_zeros() {
    let mut system = Accumulator::<2>::default();
    for row in [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1e200, 0.0]] {
        system.push(row, row[0] + row[1]);
    }
    assert!(matches!(
        system.solve("rows"),
        Err(Error::OutOfRange { .. })
    ));
}

/// Without a rate the gain has no say in the torque: its standard error was 0/0.
#[test]
fn regress_a_gain_that_nothing_tells_is_an_error() {
    let mut step = InertiaIdentification::new(Geometry::PAPER);
    for i in 0..12 {
        let angular = DVec3::new(
            f64::from(i).sin(),
            f64::from(2 * i).cos(),
            f64::from(3 * i).sin(),
        );
        let inertia = truth::identified_parameters().inertia_per_mass;
        let torque = euler_torque(&inertia, DVec3::ZERO, angular);
        step.push(&torque_forces(torque), DVec3::ZERO, angular)
            .expect("finite rows");
    }
    assert!(step.solve().is_ok());
    assert!(matches!(
        step.solve_with_gain(),
        Err(Error::NotConverged { .. })
    ));
}

/// A reference that does not move makes factors of zero with an error of zero: their quotient was NaN.
#[test]
fn regress_factors_of_zero_are_undetermined_in_numbers() {
    let mut step = ScaleIdentification::default();
    for i in 0..12 {
        let force =
            core::array::from_fn(|limb| f64::from(i * i) * 0.7 * (limb + 1) as f64).map(f64::sin);
        step.push(&force, DVec3::ZERO).expect("finite rows");
    }
    let found = step.solve().expect("nine independent columns");
    assert!(!found.verdict.is_determined());
    assert!(all_finite(&found), "{found:?}");
}
