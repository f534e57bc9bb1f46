//! Rubbish in: a typed error or a finite answer, never a panic, never a silent NaN.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::decoupler::Decoupler;
use sixaxis_core::identify::zero_drift;
use sixaxis_core::recording::{check_channels, check_time_stamps};
use sixaxis_core::{
    Error, Gains, Geometry, InertiaPerMass, LIMBS, Parameters, Scheme, Sensor, Settings,
};
use sixaxis_props::strategy::{config, parameters, rubbish};
use sixaxis_reference::paper;

fn sensor() -> Sensor {
    Sensor {
        geometry: Geometry::PAPER,
        gains: Gains::uniform(1.0),
    }
}

proptest! {
    #![proptest_config(config(512))]

    #[test]
    fn prop_any_parameters_are_refused_or_decouple(
        drift in prop::array::uniform9(rubbish()),
        scale in prop::array::uniform9(rubbish()),
        inertia in prop::array::uniform6(rubbish()),
        stiffness in rubbish(),
        gravity in prop::array::uniform3(rubbish()),
        rate_hz in rubbish(),
    ) {
        let parameters = Parameters {
            zero_drift_v: drift,
            scale_per_mass_per_kg: scale,
            inertia_per_mass: InertiaPerMass::from_paper_order(inertia),
            stiffness_per_mass_per_s2: stiffness,
        };
        let settings = Settings {
            gravity_ground_m_s2: DVec3::from_array(gravity),
            ..Settings::new(rate_hz)
        };
        // Reaching the end is the assertion: no panic, no hang.
        let _ = Decoupler::new(&sensor(), &parameters, &settings);
    }

    #[test]
    fn prop_any_voltage_is_refused_by_name_or_decoupled(
        parameters in parameters(),
        rows in prop::collection::vec(prop::array::uniform9(rubbish()), 3..12),
        scheme in prop::sample::select(&Scheme::ALL[..]),
    ) {
        let settings = Settings { scheme, ..Settings::new(1e4) };
        let mut decoupler = Decoupler::new(&sensor(), &parameters, &settings)
            .expect("the strategy makes sound parameters");
        let mut accepted = 0;
        for row in &rows {
            match decoupler.push(row) {
                Ok(_) => {
                    accepted += 1;
                    prop_assert!(row.iter().all(|u| u.is_finite()), "a rubbish sample was accepted");
                }
                Err(Error::NotFinite { channel, sample, .. }) => {
                    prop_assert!(!row[channel - 1].is_finite(), "the wrong channel is named");
                    prop_assert_eq!(sample, accepted, "the wrong sample is named");
                }
                Err(Error::LimbsDoNotMeet { node }) => prop_assert!((1..=3).contains(&node)),
                Err(other) => prop_assert!(false, "unexpected {other}"),
            }
        }
    }

    #[test]
    fn prop_parameters_survive_json_bit_for_bit(parameters in parameters()) {
        let text = serde_json::to_string(&parameters).expect("finite numbers serialise");
        let back: Parameters = serde_json::from_str(&text).expect("what was written reads back");
        prop_assert_eq!(parameters, back);
        let with_stranger = text.replacen('{', "{\"stranger\":1,", 1);
        prop_assert!(serde_json::from_str::<Parameters>(&with_stranger).is_err());
    }
}

#[test]
fn prop_impossible_bodies_are_refused() {
    let sound = paper::identified_parameters();
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

#[test]
fn prop_empty_and_one_sample_records_are_refused() {
    for samples in [0, 1] {
        assert!(matches!(
            zero_drift::identify(&vec![[0.0; LIMBS]; samples]),
            Err(Error::TooFewSamples { .. })
        ));
    }
}

#[test]
fn prop_a_broken_recording_is_refused_by_name() {
    const LIMIT_V: f64 = 10.0;
    let sound: Vec<[f64; LIMBS]> = (0..50)
        .map(|i| core::array::from_fn(|channel| (f64::from(i) * 0.1 + channel as f64).sin()))
        .collect();
    assert_eq!(check_channels(&sound, LIMIT_V), Ok(()));
    let broken = |change: &dyn Fn(&mut [f64; LIMBS], usize)| {
        let mut rows = sound.clone();
        for (sample, row) in rows.iter_mut().enumerate() {
            change(row, sample);
        }
        check_channels(&rows, LIMIT_V)
    };
    assert!(matches!(
        broken(&|row, _| row[6] = 0.25),
        Err(Error::DeadChannel { channel: 7, .. })
    ));
    assert!(matches!(
        broken(&|row, sample| row[2] = if sample == 9 { LIMIT_V } else { row[2] }),
        Err(Error::Clipped {
            channel: 3,
            sample: 9,
            ..
        })
    ));
    assert!(matches!(
        broken(&|row, sample| row[0] = if sample == 4 { f64::NAN } else { row[0] }),
        Err(Error::NotFinite {
            channel: 1,
            sample: 4,
            ..
        })
    ));
    assert!(matches!(
        check_channels(&sound[..1], LIMIT_V),
        Err(Error::TooFewSamples { .. })
    ));

    let even: Vec<f64> = (0..50).map(|i| f64::from(i) * 1e-4).collect();
    assert_eq!(check_time_stamps(&even, 1e4), Ok(()));
    for (change, sample) in [(f64::NAN, 20), (even[19], 20), (even[20] + 5e-6, 20)] {
        let mut uneven = even.clone();
        uneven[sample] = change;
        assert!(matches!(
            check_time_stamps(&uneven, 1e4),
            Err(Error::IrregularTime { sample: found, .. }) if found == sample
        ));
    }
    assert!(check_time_stamps(&even, f64::NAN).is_err());
}
