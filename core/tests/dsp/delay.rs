//! Delays between channels.

use std::f64::consts::TAU;

use sixaxis_core::dsp::delay::delayed;
use sixaxis_core::dsp::resample::MIN_SAMPLES;
use sixaxis_core::{Error, Result};

use crate::tolerance;
use crate::{check_above, check_below, distance, record, sine};

/// A sine brought forward by a part of a step, against its true values: away from the ends, and in the first step.
fn errors(share: f64, part: f64) -> Result<(f64, f64)> {
    let samples = 400;
    let (ours, _) = delayed(&sine(samples, share, 1.0), -part, 1.0)?;
    let truth: Vec<f64> = (0..samples)
        .map(|k| (TAU * share * (k as f64 + part)).sin())
        .collect();
    let interior = 50..samples - 50;
    let inside = distance(&ours[interior.clone()], &truth[interior]);
    Ok((inside, (ours[0] - truth[0]).abs()))
}

#[test]
fn order_delay() -> Result<()> {
    for share in [0.1, 0.05, 0.025] {
        let phase = TAU * share;
        let (halfway, _) = errors(share, 0.5)?;
        check_below(
            "halfway error over (2 pi f/F)^6 times 225/46080, less 1",
            (halfway / (phase.powi(6) * 225.0 / 46080.0) - 1.0).abs(),
            tolerance::DELAY_LEADING_TERM * phase * phase,
        );
        for part in [0.1, 0.3, 0.7, 0.9] {
            let (inside, first) = errors(share, part)?;
            check_below("inside", inside, halfway);
            check_below("first step", first, tolerance::DELAY_AT_ENDS * halfway);
        }
    }
    Ok(())
}

#[test]
fn inv_whole_delays_shift_and_hold_the_ends() -> Result<()> {
    let series = record(100, 1000.0);
    let n = series.len();
    assert_eq!(delayed(&series, 0.0, 1000.0)?, (series.clone(), 0));
    for shift in [1, 8, n - 1] {
        // A rate that is a power of two: the shift is then whole to the bit.
        let (later, held) = delayed(&series, shift as f64 / 1024.0, 1024.0)?;
        assert_eq!(held, shift);
        assert_eq!(later[shift..], series[..n - shift]);
        assert!(later[..shift].iter().all(|x| *x == series[0]));
        let (earlier, held) = delayed(&series, -(shift as f64) / 1024.0, 1024.0)?;
        assert_eq!(held, shift);
        assert_eq!(earlier[..n - shift], series[shift..]);
        assert!(earlier[n - shift..].iter().all(|x| *x == series[n - 1]));
    }
    // A part of a step holds one sample, on the side that has no neighbour.
    let (later, held) = delayed(&series, 0.2e-3, 1000.0)?;
    assert_eq!((later[0], held), (series[0], 1));
    let (earlier, held) = delayed(&series, -0.2e-3, 1000.0)?;
    assert_eq!((earlier[n - 1], held), (series[n - 1], 1));
    Ok(())
}

/// Nine channels taken 10 microseconds after each other, at 1 kHz, of one sine of 50 Hz.
#[test]
fn inv_multiplexed_channels_meet_at_the_tick() -> Result<()> {
    let (frequency_hz, rate_hz) = (50.0, 1000.0);
    let at_tick = sine(400, frequency_hz, rate_hz);
    for channel in 1..9 {
        let delay_s = 10e-6 * f64::from(channel);
        let taken: Vec<f64> = (0..400)
            .map(|k| (TAU * frequency_hz * (f64::from(k) / rate_hz + delay_s)).sin())
            .collect();
        let (ours, held) = delayed(&taken, delay_s, rate_hz)?;
        assert_eq!(held, 1);
        let interior = 20..380;
        let away = |series: &[f64]| distance(&series[interior.clone()], &at_tick[interior.clone()]);
        check_below(
            "brought to the tick",
            away(&ours),
            tolerance::DELAY_AT_A_TWENTIETH,
        );
        // Controls: left alone, and with the wrong sign.
        let slope = TAU * frequency_hz * delay_s;
        check_above("left alone", away(&taken), tolerance::LEFT_ALONE * slope);
        let (wrong, _) = delayed(&taken, -delay_s, rate_hz)?;
        check_above(
            "wrong sign",
            away(&wrong),
            2.0 * tolerance::LEFT_ALONE * slope,
        );
    }
    Ok(())
}

#[test]
fn inv_what_cannot_be_delayed_is_refused() {
    for n in 0..MIN_SAMPLES {
        let answer = delayed(&record(n, 1000.0), 0.0, 1000.0);
        assert!(matches!(answer, Err(Error::TooFewSamples { got, .. }) if got == n));
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut values = record(50, 1000.0);
        values[31] = bad;
        let answer = delayed(&values, 1e-4, 1000.0);
        assert!(matches!(answer, Err(Error::NotFinite { sample: 31, .. })));
    }
    let values = record(50, 1000.0);
    let refused = |answer| matches!(answer, Err(Error::OutOfRange { .. }));
    for rate_hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(delayed(&values, 0.0, rate_hz)));
    }
    for delay_s in [0.0491, -0.0491, f64::NAN, f64::INFINITY, 1e308] {
        assert!(refused(delayed(&values, delay_s, 1000.0)));
    }
}
