//! Rubbish in: a typed error that names its cause or a finite answer, never a panic, never a silent NaN. The stream; the
//! sensor, recordings, identification and preprocessing have files of their own.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::model::STIFFNESS_PER_MASS_RANGE_PER_S2;
use sixaxis_core::paper::limb_stream::LimbStream;
use sixaxis_core::{
    Decoupler, Error, Gains, Geometry, InertiaPerMass, LIMBS, Model, Parameters, Result, Scheme,
    Sensor, Settings, SixAxis, StaticResponse,
};
use sixaxis_props::compare::all_finite;
use sixaxis_props::strategy::parameters;
use sixaxis_props::truth;

use crate::input::{INERTIA, adversarial_setup, record, remembering};

fn sensor() -> Sensor {
    Sensor {
        geometry: Geometry::PAPER,
        gains: Gains::uniform(1.0),
    }
}

/// A sound voltage row that differs from sample to sample.
fn sound_row(sample: usize) -> [f64; LIMBS] {
    core::array::from_fn(|channel| 0.01 * (0.3 * sample as f64 + channel as f64).sin())
}

/// Pushes a row; asserts that what comes back is finite, and that a refusal names its cause and leaves no trace.
fn push(decoupler: &mut Decoupler, row: &[f64; LIMBS], accepted: usize) -> Result<Option<SixAxis>> {
    let before = decoupler.clone();
    let answer = decoupler.push(row);
    match &answer {
        Ok(samples) => {
            assert!(
                row.iter().all(|u| u.is_finite()),
                "what is not finite was accepted"
            );
            assert!(all_finite(samples), "{samples:?}");
            assert!(all_finite(decoupler), "{decoupler:?}");
        }
        Err(error) => {
            assert_eq!(*decoupler, before, "{error} left a trace");
            check_cause(error, row, accepted);
        }
    }
    answer
}

fn check_cause(error: &Error, row: &[f64; LIMBS], accepted: usize) {
    match *error {
        Error::NotFinite {
            channel, sample, ..
        } => {
            assert!(!row[channel - 1].is_finite(), "the wrong channel is named");
            assert_eq!(sample, accepted, "the wrong sample is named");
        }
        Error::LimbsDoNotMeet { node } => {
            assert!((1..=3).contains(&node));
        }
        Error::Overflow { sample, .. } | Error::Overstrained { sample, .. } => {
            assert_eq!(sample, accepted, "the wrong sample is named");
        }
        ref other => panic!("unexpected {other}"),
    }
}

/// Pushes rows to the end of the stream and through it.
fn run(mut decoupler: Decoupler, rows: &[[f64; LIMBS]]) {
    let mut accepted = 0;
    for row in rows {
        accepted += usize::from(push(&mut decoupler, row, accepted).is_ok());
    }
}

proptest! {
    #![proptest_config(remembering(1024, "decoder"))]

    #[test]
    fn prop_any_setup_is_refused_by_name_or_decouples(
        (setup, spoiled_names) in adversarial_setup(),
        scheme in prop::sample::select(&Scheme::ALL[..]),
        full in prop::bool::ANY,
    ) {
        let (sensor, parameters, mut settings) = setup;
        settings.scheme = scheme;
        if full {
            settings.static_response = StaticResponse::Full;
        }
        match Decoupler::new(&sensor, &parameters, &settings) {
            Ok(decoupler) => {
                prop_assert!(all_finite(&decoupler), "{decoupler:?}");
                let rows: Vec<_> = (0..12).map(sound_row).collect();
                run(decoupler, &rows);
            }
            Err(Error::OutOfRange { name: "inertia_per_mass", .. } | Error::ImpossibleInertia { .. }) => {
                prop_assert!(spoiled_names.iter().any(|spoiled| INERTIA.contains(spoiled)));
            }
            Err(Error::OutOfRange { name, .. }) => prop_assert!(
                spoiled_names.iter().any(|spoiled| name.contains(spoiled)),
                "{name} is named, not one of {spoiled_names:?}"
            ),
            Err(Error::NotConverged { what, .. }) => {
                prop_assert!(what.starts_with("static equilibrium"), "{what}");
            }
            Err(other) => prop_assert!(false, "unexpected {other}"),
        }
    }

    #[test]
    fn prop_any_voltage_is_refused_by_name_or_decoupled(
        parameters in parameters(),
        rows in record::<LIMBS>(24),
        scheme in prop::sample::select(&Scheme::ALL[..]),
    ) {
        let settings = Settings { scheme, ..Settings::new(1e4) };
        let decoupler = Decoupler::new(&sensor(), &parameters, &settings)
            .expect("the strategy makes sound parameters");
        run(decoupler, &rows);
    }

    #[test]
    fn prop_a_refused_sample_leaves_the_stream_as_it_was(
        rows in record::<LIMBS>(8),
        scheme in prop::sample::select(&Scheme::ALL[..]),
        period in 1_usize..4,
    ) {
        let settings = Settings { scheme, ..Settings::new(1e4) };
        let fresh = Decoupler::new(&sensor(), &truth::identified_parameters(), &settings)
            .expect("the paper's sensor is sound");
        let (mut disturbed, mut undisturbed) = (fresh.clone(), fresh);
        let mut accepted = 0;
        for (i, row) in rows.iter().enumerate() {
            if push(&mut disturbed, row, accepted).is_ok() {
                accepted += 1;
                undisturbed.push(row).expect("the other took it");
            }
            for sample in 0..period {
                let sound = sound_row(i * period + sample);
                let answer = push(&mut disturbed, &sound, accepted);
                prop_assert_eq!(&answer, &undisturbed.push(&sound));
                accepted += usize::from(answer.is_ok());
            }
        }
        prop_assert_eq!(disturbed, undisturbed);
    }

    /// A constant torque, from none to one beyond any f64: the rate runs away until the numbers end.
    #[test]
    fn prop_a_runaway_is_finite_or_ends_in_an_error(
        exponent in -3.0..30.0_f64,
        direction in prop::array::uniform9(-1.0..1.0_f64),
        scheme in prop::sample::select(&Scheme::ALL[..]),
        rate_exponent in -3.0..9.0_f64,
    ) {
        let settings = Settings { scheme, ..Settings::new(10.0_f64.powf(rate_exponent)) };
        let mut decoupler = Decoupler::new(&sensor(), &truth::identified_parameters(), &settings)
            .expect("the paper's sensor is sound");
        let row = direction.map(|d| d * 10.0_f64.powf(exponent));
        for sample in 0..40 {
            if push(&mut decoupler, &row, sample).is_err() {
                break;
            }
        }
    }

    #[test]
    fn prop_any_voltage_makes_limbs_or_an_error(
        (setup, _) in adversarial_setup(),
        rows in record::<LIMBS>(8),
    ) {
        let (sensor, parameters, settings) = setup;
        let model = Model::new(&sensor, &parameters, &settings);
        let Ok(mut stream) = model.and_then(|model| LimbStream::new(&model)) else {
            return Ok(());
        };
        prop_assert!(all_finite(stream.geometry()) && all_finite(stream.preload_m_s2()));
        for row in &rows {
            let before = stream.clone();
            match stream.push(row) {
                Ok(sample) => prop_assert!(all_finite(&sample), "{sample:?}"),
                Err(error) => prop_assert_eq!(&stream, &before, "{} left a trace", error),
            }
        }
    }
}

proptest! {
    #![proptest_config(remembering(1024, "decoder"))]

    /// Three limbs of one length always meet, however long: the one way to a pose, and a motion, of any size.
    #[test]
    fn prop_equally_stretched_limbs_move_or_are_refused(
        volts in prop::collection::vec(0.0..90.0_f64, 3..8),
        rate_exponent in 0.0..150.0_f64,
        scheme in prop::sample::select(&Scheme::ALL[..]),
    ) {
        let settings = Settings { scheme, ..Settings::new(10.0_f64.powf(rate_exponent)) };
        let parameters = truth::design_parameters();
        let mut stream = Model::new(&sensor(), &parameters, &settings)
            .and_then(|model| LimbStream::new(&model))
            .expect("sound");
        let decoupler = Decoupler::new(&sensor(), &parameters, &settings).expect("sound");
        let rows: Vec<_> = volts.iter().map(|v| [-(10.0_f64.powf(*v)); LIMBS]).collect();
        for row in &rows {
            let before = stream.clone();
            match stream.push(row) {
                Ok(sample) => prop_assert!(all_finite(&sample), "{sample:?}"),
                Err(error) => prop_assert_eq!(&stream, &before, "{} left a trace", error),
            }
        }
        run(decoupler, &rows);
    }
}

/// An ordinary start, then a rate that squares itself from step to step: the first answer beyond f64 came out as NaN.
#[test]
fn regress_a_runaway_rate_is_an_overflow() {
    for scheme in Scheme::ALL {
        let settings = Settings {
            scheme,
            initial_rate_shell_rad_s: DVec3::new(1e30, 2e30, 3e30),
            ..Settings::new(1e-2)
        };
        let mut decoupler = Decoupler::new(&sensor(), &truth::identified_parameters(), &settings)
            .expect("finite settings");
        let refused = (0..40).find_map(|i| push(&mut decoupler, &sound_row(i), i).err());
        assert!(
            matches!(refused, Some(Error::Overflow { .. })),
            "{scheme:?}: {refused:?}"
        );
    }
}

fn refused_by_name(changed: impl Fn(&mut Sensor, &mut Parameters, &mut Settings), name: &str) {
    let (mut sensor, mut parameters) = (sensor(), truth::identified_parameters());
    let mut settings = Settings::new(1e4);
    changed(&mut sensor, &mut parameters, &mut settings);
    match Decoupler::new(&sensor, &parameters, &settings) {
        Err(Error::OutOfRange { name: found, .. }) => assert_eq!(found, name),
        other => panic!("{name} was not refused: {other:?}"),
    }
}

/// Each of these was accepted, and made NaN, zeros, or limbs that do not meet of the samples.
#[test]
fn regress_finite_settings_beyond_arithmetic_are_refused() {
    for extreme in [1e-300, 1e300] {
        refused_by_name(
            |s, _, _| s.geometry.limb_length_m = extreme,
            "limb_length_m",
        );
        refused_by_name(|s, _, _| s.geometry.half_edge_m = extreme, "half_edge_m");
        refused_by_name(|_, _, s| s.sample_rate_hz = extreme, "sample_rate_hz");
        refused_by_name(
            |s, p, _| {
                s.gains = Gains::uniform(extreme);
                p.scale_per_mass_per_kg = [extreme; LIMBS];
            },
            "scale_per_mass_per_kg x gain_n_per_v",
        );
        refused_by_name(
            |_, p, _| {
                p.inertia_per_mass =
                    InertiaPerMass::from_paper_order([extreme, extreme, extreme, 0.0, 0.0, 0.0]);
            },
            "inertia_per_mass",
        );
    }
    refused_by_name(
        |_, _, s| s.gravity_ground_m_s2.z = 1e300,
        "gravity_ground_m_s2",
    );
}

#[test]
fn law_ends_of_the_stiffness_range_decouple() {
    let (low, high) = STIFFNESS_PER_MASS_RANGE_PER_S2;
    for stiffness_per_mass_per_s2 in [low, high] {
        let parameters = Parameters {
            stiffness_per_mass_per_s2,
            ..truth::identified_parameters()
        };
        let decoupler = Decoupler::new(&sensor(), &parameters, &Settings::new(1e4))
            .expect("the ends belong to the range");
        let rows: Vec<_> = (0..12).map(sound_row).collect();
        run(decoupler, &rows);
    }
}
