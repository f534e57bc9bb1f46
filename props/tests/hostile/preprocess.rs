//! Rubbish into the preprocessing: a typed error that names its cause or a finite series, never a panic, a hang or a
//! silent NaN.

use proptest::prelude::*;
use sixaxis_core::dsp::butterworth::{self, Section};
use sixaxis_core::dsp::causal::SectionsState;
use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_core::dsp::lag::{FirstOrder, undo_high_pass, undo_low_pass};
use sixaxis_core::dsp::zero_phase::{padding, zero_phase};
use sixaxis_core::dsp::{detrend, each_channel, outlier};
use sixaxis_core::{Error, Result};
use sixaxis_props::compare::all_finite;

use crate::input::{adversarial_f64, extreme, record, remembering, spoiled};

/// One channel of up to `longest` samples.
fn series(longest: usize) -> impl Strategy<Value = Vec<f64>> {
    record::<1>(longest).prop_map(|rows| rows.into_flattened())
}

/// A whole number, mostly small, sometimes beyond all memory.
fn size() -> impl Strategy<Value = usize> {
    prop_oneof![
        6 => 0_usize..12,
        1 => prop::sample::select(vec![usize::MAX, usize::MAX / 2, usize::MAX / 2 + 1, 1 << 40]),
        1 => any::<usize>(),
    ]
}

/// A positive frequency that most filters accept, or an adversarial one.
fn frequency() -> impl Strategy<Value = f64> {
    prop_oneof![2 => 1.0..400.0_f64, 1 => adversarial_f64(), 1 => extreme().prop_map(f64::abs)]
}

fn rate() -> impl Strategy<Value = f64> {
    prop_oneof![2 => Just(1e3), 1 => frequency()]
}

/// Runs a stage that works in place: what it accepts ends finite, and what it refuses, it names and leaves alone.
fn in_place<T: std::fmt::Debug>(series: &[f64], stage: impl FnOnce(&mut [f64]) -> Result<T>) {
    let mut worked = series.to_vec();
    match stage(&mut worked) {
        Ok(answer) => {
            assert!(all_finite(&worked), "{worked:?} from {series:?}");
            assert!(all_finite(&answer), "{answer:?} from {series:?}");
        }
        Err(error) => {
            let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
            assert!(worked.iter().zip(series).all(same), "{error} left a trace");
            check_cause(&error, series);
        }
    }
}

/// The same for a stage that makes a new series.
fn anew(series: &[f64], answer: Result<Vec<f64>>) {
    match answer {
        Ok(worked) => {
            assert!(all_finite(&worked), "{worked:?} from {series:?}");
            assert_eq!(worked.len(), series.len());
        }
        Err(error) => check_cause(&error, series),
    }
}

fn check_cause(error: &Error, series: &[f64]) {
    match *error {
        Error::NotFinite { sample, .. } => assert!(!series[sample].is_finite()),
        Error::Overflow { sample, .. } => assert!(sample < series.len()),
        Error::TooFewSamples { got, needed, .. } => {
            assert_eq!(got, series.len());
            assert!(needed > got);
        }
        Error::OutOfRange { .. } => (),
        ref other => panic!("unexpected {other}"),
    }
}

proptest! {
    #![proptest_config(remembering(1024, "preprocess"))]

    #[test]
    fn prop_any_filter_is_refused_or_finite(
        order in size(),
        corner_hz in frequency(),
        rate_hz in rate(),
    ) {
        match butterworth::low_pass(order, corner_hz, rate_hz) {
            Ok(sections) => {
                prop_assert!(all_finite(&sections), "{sections:?}");
                prop_assert!(sections.iter().all(|s| s.static_gain().is_finite()));
                prop_assert!(all_finite(&SectionsState::settled(&sections, corner_hz)));
                let mut live = SectionsState::at_rest(&sections);
                prop_assert!((0..8).all(|_| live.step(1.0).is_finite()));
            }
            Err(Error::OutOfRange { name, .. }) => {
                prop_assert!(["order", "corner_hz", "sample_rate_hz"].contains(&name));
            }
            Err(other) => prop_assert!(false, "unexpected {other}"),
        }
    }

    #[test]
    fn prop_any_series_is_filtered_or_refused(
        series in series(60),
        order in 1_usize..=10,
        corner_hz in 1.0..400.0_f64,
    ) {
        let sections = butterworth::low_pass(order, corner_hz, 1e3).expect("a sound filter");
        in_place(&series, |x| zero_phase(&sections, x));
    }

    #[test]
    fn prop_any_sections_filter_or_are_refused(
        series in series(40),
        coefficients in prop::collection::vec(spoiled([0.25, 0.5, 0.25, -0.3, 0.1]), 0..4),
        all in prop::option::weighted(0.2, prop::array::uniform5(extreme())),
    ) {
        let sections: Vec<Section> = coefficients
            .iter()
            .map(|(x, _)| all.unwrap_or(*x))
            .map(|x| Section { b: [x[0], x[1], x[2]], a: [x[3], x[4]] })
            .collect();
        prop_assert!(padding(&sections) > 0);
        in_place(&series, |x| zero_phase(&sections, x));
    }

    #[test]
    fn prop_any_series_is_detrended_or_refused(series in series(20), rest in size()) {
        in_place(&series, detrend::constant);
        in_place(&series, |x| detrend::rest_to_rest_trend(x, rest));
    }

    #[test]
    fn prop_any_series_is_cleared_of_outliers_or_refused(
        series in series(20),
        half_width in size(),
        sigmas in prop_oneof![Just(3.0), adversarial_f64()],
    ) {
        in_place(&series, |x| outlier::hampel(x, half_width, sigmas));
    }

    #[test]
    fn prop_any_differentiator_is_refused_or_finite(
        half_width in size(),
        order in size(),
        rate_hz in rate(),
        series in series(30),
        at in 0.0..0.5_f64,
    ) {
        match Differentiator::new(half_width, order, rate_hz) {
            Ok(differentiator) => {
                prop_assert!(all_finite(&differentiator));
                prop_assert!(differentiator.relative_gain(at * rate_hz).is_finite());
                anew(&series, differentiator.derivative(&series));
            }
            Err(Error::OutOfRange { name, .. }) => {
                prop_assert!(["half_width", "order", "sample_rate_hz"].contains(&name));
            }
            Err(other) => prop_assert!(false, "unexpected {other}"),
        }
    }

    #[test]
    fn prop_any_lag_is_undone_or_refused(
        series in series(20),
        corner_hz in frequency(),
        rate_hz in rate(),
        step in -10.0..10.0_f64,
    ) {
        for make in [FirstOrder::low_pass, FirstOrder::high_pass] {
            if let Ok(mut instrument) = make(corner_hz, rate_hz) {
                prop_assert!((0..8).all(|_| instrument.step(step).is_finite()));
                prop_assert!(all_finite(&instrument), "{instrument:?}");
            }
        }
        anew(&series, undo_high_pass(&series, corner_hz, rate_hz));
        if let Ok(differentiator) = Differentiator::new(3, 2, rate_hz) {
            anew(&series, undo_low_pass(&series, corner_hz, &differentiator));
        }
    }

    #[test]
    fn prop_any_channel_at_fault_is_named(rows in record::<4>(16), rest in size()) {
        let mut worked = rows.clone();
        match each_channel(&mut worked, |x| detrend::rest_to_rest_trend(x, rest).map(|_| ())) {
            Ok(()) => prop_assert!(all_finite(&worked)),
            Err(Error::NotFinite { channel, sample, .. }) => {
                prop_assert!(!rows[sample][channel - 1].is_finite());
            }
            Err(Error::Overflow { channel, .. }) => prop_assert!(channel > 0, "no channel is named"),
            Err(Error::TooFewSamples { .. }) => (),
            Err(other) => prop_assert!(false, "unexpected {other}"),
        }
    }
}

/// Twice the largest half width and one is nothing, or all of the memory.
#[test]
fn regress_windows_beyond_memory_are_refused() {
    let mut series = [0.0; 20];
    for huge in [usize::MAX, usize::MAX / 2 + 1, 1 << 40] {
        assert!(matches!(
            outlier::hampel(&mut series, huge, 3.0),
            Err(Error::TooFewSamples { .. })
        ));
        assert!(matches!(
            detrend::rest_to_rest_trend(&mut series, huge),
            Err(Error::TooFewSamples { .. })
        ));
        assert!(matches!(
            Differentiator::new(huge, 2, 1e3),
            Err(Error::OutOfRange {
                name: "half_width",
                ..
            })
        ));
    }
}

/// The step of the scan for the bandwidth was zero, and the scan without end.
#[test]
fn regress_a_rate_whose_fractions_vanish_is_refused() {
    assert!(matches!(
        Differentiator::new(3, 2, 5e-324),
        Err(Error::OutOfRange {
            name: "sample_rate_hz",
            ..
        })
    ));
}

/// Pi times this corner is infinite, and a corner of zero is a millionth of the smallest rate: NaN and 0/0 came out.
#[test]
fn regress_filters_at_the_ends_of_the_range_are_finite() {
    let sections =
        butterworth::low_pass(2, 0.4 * f64::MAX, f64::MAX).expect("0.4 of the sample rate");
    assert!(all_finite(&sections));
    assert!(butterworth::low_pass(2, 0.0, 1e-323).is_err());
}

#[test]
fn regress_sums_beyond_the_range_are_overflows() {
    let huge = [
        f64::MAX,
        f64::MIN,
        f64::MAX,
        f64::MIN,
        f64::MAX,
        f64::MIN,
        f64::MAX,
    ];
    let overflow = |result: Result<()>| matches!(result, Err(Error::Overflow { .. }));
    assert!(overflow(detrend::constant(&mut huge.clone()).map(|_| ())));
    assert!(overflow(
        detrend::rest_to_rest_trend(&mut huge.clone(), 2).map(|_| ())
    ));
    let slope = Differentiator::new(3, 2, 1e3).expect("a sound differentiator");
    assert!(overflow(slope.derivative(&huge).map(|_| ())));
    assert!(overflow(undo_high_pass(&huge, 1e300, 1e-300).map(|_| ())));
    assert!(overflow(
        undo_low_pass(&[1.0, 2.0, 4.0, 8.0, 7.0, 6.0, 5.0], 1e-310, &slope).map(|_| ())
    ));
    let integrator = [Section {
        b: [1.0, 0.0, 0.0],
        a: [-1.0, 0.0],
    }];
    assert!(overflow(zero_phase(&integrator, &mut [1.0; 20])));
}
