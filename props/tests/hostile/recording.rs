//! Rubbish recordings, gaps and runs from rest to rest: refused by name or worked through, never a silent NaN.

use proptest::prelude::*;
use sixaxis_core::decouple::rest_to_rest;
use sixaxis_core::identify::zero_drift;
use sixaxis_core::recording::check_channels;
use sixaxis_core::{Error, LIMBS, Parameters, Scheme, Settings};
use sixaxis_props::compare::all_finite;
use sixaxis_props::strategy::parameters;
use sixaxis_props::truth;

use crate::input::{adversarial_f64, adversarial_setup, extreme, record, remembering};

/// A smooth motion, mostly of a size that a sensor shows.
fn motion() -> impl Strategy<Value = Vec<[f64; LIMBS]>> {
    let size = prop_oneof![4 => Just(1e-3), 1 => extreme()];
    (4_i32..24, size).prop_map(|(samples, size)| {
        let voltage =
            |sample, channel: usize| size * (0.3 * f64::from(sample) + channel as f64).sin();
        (0..samples)
            .map(|sample| core::array::from_fn(|channel| voltage(sample, channel)))
            .collect()
    })
}

proptest! {
    #![proptest_config(remembering(1024, "recording"))]

    #[test]
    fn prop_a_recording_that_passes_is_sound(
        rows in record::<LIMBS>(8),
        limit_v in prop_oneof![Just(10.0), Just(f64::INFINITY), adversarial_f64()],
    ) {
        match check_channels(&rows, limit_v) {
            Ok(()) => prop_assert!(rows.as_flattened().iter().all(|u| u.is_finite() && u.abs() < limit_v)),
            Err(Error::NotFinite { channel, sample, .. }) => {
                prop_assert!(!rows[sample][channel - 1].is_finite());
            }
            Err(Error::Clipped { channel, sample, .. }) => {
                prop_assert!(rows[sample][channel - 1].abs() >= limit_v);
            }
            Err(Error::DeadChannel { channel, .. }) => {
                prop_assert!(rows.iter().all(|row| row[channel - 1] == rows[0][channel - 1]));
            }
            Err(Error::OutOfRange { name, .. }) => {
                prop_assert_eq!(name, "limit_v");
                prop_assert!(limit_v.is_nan() || limit_v <= 0.0);
            }
            Err(Error::TooFewSamples { got, .. }) => prop_assert_eq!(got, rows.len()),
            Err(other) => prop_assert!(false, "unexpected {other}"),
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

proptest! {
    #![proptest_config(remembering(128, "recording"))]

    #[test]
    fn prop_any_run_is_closed_or_refused(
        (setup, _) in adversarial_setup(),
        sound in prop::bool::ANY,
        rows in prop_oneof![record::<LIMBS>(24), motion()],
        scheme in prop::sample::select(&Scheme::ALL[..]),
    ) {
        let (sensor, mut parameters, mut settings) = setup;
        if sound {
            parameters = truth::identified_parameters();
            settings = Settings::new(1e3);
        }
        settings.scheme = scheme;
        match rest_to_rest::detrend(&sensor, &parameters, &settings, &rows) {
            Ok((closed, trend)) => {
                prop_assert!(all_finite(&closed) && all_finite(&trend), "{trend:?}");
                prop_assert_eq!(closed.len(), rows.len());
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}

#[test]
fn law_empty_and_one_sample_records_are_refused() {
    for samples in [0, 1] {
        assert!(matches!(
            zero_drift::identify(&vec![[0.0; LIMBS]; samples]),
            Err(Error::TooFewSamples { .. })
        ));
    }
}

#[test]
fn law_a_broken_recording_is_refused_by_name() {
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
}

/// Nothing reaches NaN: it would let everything pass.
#[test]
fn regress_a_limit_that_judges_nothing_is_refused() {
    let rows = [[0.0; LIMBS], [1.0; LIMBS]];
    assert!(matches!(
        check_channels(&rows, f64::NAN),
        Err(Error::OutOfRange {
            name: "limit_v",
            ..
        })
    ));
}
