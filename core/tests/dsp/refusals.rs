//! What the stages must refuse, and how they say so.

use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_core::dsp::lag::{FirstOrder, undo_high_pass, undo_low_pass};
use sixaxis_core::dsp::zero_phase::zero_phase;
use sixaxis_core::dsp::{butterworth, continued, detrend, each_channel, outlier};
use sixaxis_core::{Error, Result};

use crate::{Stage, record};

fn stages() -> [(&'static str, Stage); 7] {
    [
        ("constant", |x| detrend::constant(x).map(|_| ())),
        ("between rests", |x| {
            detrend::rest_to_rest_trend(x, 4).map(|_| ())
        }),
        ("Hampel", |x| outlier::hampel(x, 3, 3.0).map(|_| ())),
        ("zero phase", |x| {
            zero_phase(&butterworth::low_pass(2, 50.0, 1000.0)?, x)
        }),
        ("continued", |x| {
            continued::zero_phase(&butterworth::low_pass(2, 50.0, 1000.0)?, x)
        }),
        ("derivative", |x| {
            Differentiator::new(3, 2, 1000.0)?.derivative(x).map(|_| ())
        }),
        ("undone low-pass", |x| {
            undo_low_pass(x, 10.0, &Differentiator::new(3, 2, 1000.0)?).map(|_| ())
        }),
    ]
}

#[test]
fn inv_non_finite_sample_is_named_and_nothing_changes() {
    for (name, stage) in stages() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut series = record(50, 1000.0);
            assert!(stage(&mut series).is_ok(), "{name}");
            series[31] = bad;
            let before = series.clone();
            assert!(
                matches!(stage(&mut series), Err(Error::NotFinite { sample: 31, .. })),
                "{name}"
            );
            let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
            assert!(series.iter().zip(&before).all(same), "{name} changed it");
        }
    }
}

#[test]
fn inv_short_series_is_refused() {
    for (name, stage) in stages() {
        assert!(
            matches!(stage(&mut []), Err(Error::TooFewSamples { got: 0, .. })),
            "{name}"
        );
    }
}

#[test]
fn inv_high_pass_record_with_a_gap_is_refused() {
    let mut series = record(50, 1000.0);
    series[31] = f64::NAN;
    assert!(matches!(
        undo_high_pass(&series, 2.0, 1000.0),
        Err(Error::NotFinite { sample: 31, .. })
    ));
}

#[test]
fn inv_settings_without_a_meaning_are_refused() {
    let refused = |result: Result<()>| matches!(result, Err(Error::OutOfRange { .. }));
    for (order, corner_hz, rate_hz) in [
        (0, 50.0, 1000.0),
        (11, 50.0, 1000.0),
        (4, 0.0, 1000.0),
        (4, 0.999e-3, 1000.0),
        (4, 500.0, 1000.0),
        (4, -1.0, 1000.0),
        (4, f64::NAN, 1000.0),
        (4, 50.0, 0.0),
        (4, 50.0, f64::NAN),
        (4, 50.0, f64::INFINITY),
    ] {
        assert!(refused(
            butterworth::low_pass(order, corner_hz, rate_hz).map(|_| ())
        ));
    }
    for (half_width, order, rate_hz) in [
        (0, 1, 1000.0),
        (5, 0, 1000.0),
        (5, 7, 1000.0),
        (1, 3, 1000.0),
        (5, 2, 0.0),
        (5, 2, f64::NAN),
    ] {
        assert!(refused(
            Differentiator::new(half_width, order, rate_hz).map(|_| ())
        ));
    }
    for (corner_hz, rate_hz) in [
        (0.0, 1000.0),
        (-1.0, 1000.0),
        (f64::NAN, 1000.0),
        (10.0, 0.0),
        (10.0, f64::INFINITY),
    ] {
        assert!(refused(
            FirstOrder::low_pass(corner_hz, rate_hz).map(|_| ())
        ));
        assert!(refused(
            FirstOrder::high_pass(corner_hz, rate_hz).map(|_| ())
        ));
        assert!(refused(
            undo_high_pass(&[0.0; 5], corner_hz, rate_hz).map(|_| ())
        ));
    }
    for (half_width, sigmas) in [(0, 3.0), (3, 0.0), (3, -1.0), (3, f64::NAN)] {
        assert!(refused(
            outlier::hampel(&mut [0.0; 20], half_width, sigmas).map(|_| ())
        ));
    }
}

#[test]
fn inv_each_channel_is_the_stage_on_each_and_names_the_channel() -> Result<()> {
    let columns = [record(80, 1000.0), record(80, 500.0), record(80, 2000.0)];
    let rows = |columns: &[Vec<f64>; 3]| -> Vec<[f64; 3]> {
        (0..80)
            .map(|k| core::array::from_fn(|c| columns[c][k]))
            .collect()
    };
    let mut together = rows(&columns);
    each_channel(&mut together, |x| detrend::constant(x).map(|_| ()))?;
    let mut alone = columns.clone();
    for column in &mut alone {
        detrend::constant(column)?;
    }
    assert_eq!(together, rows(&alone));

    let mut broken = rows(&columns);
    broken[17][1] = f64::NAN;
    let refusal = each_channel(&mut broken, |x| detrend::constant(x).map(|_| ()));
    assert!(matches!(
        refusal,
        Err(Error::NotFinite {
            channel: 2,
            sample: 17,
            ..
        })
    ));
    // The first channel is done, the last untouched.
    assert_eq!(broken[5][0], together[5][0]);
    assert_eq!(broken[5][2], columns[2][5]);
    Ok(())
}
