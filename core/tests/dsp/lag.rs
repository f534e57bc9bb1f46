//! First-order instruments, done and undone.

use core::f64::consts::TAU;

use sixaxis_core::Result;
use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_core::dsp::lag::{FirstOrder, undo_high_pass, undo_low_pass};

use crate::golden;
use crate::tolerance;
use crate::{Noise, check_above, check_below, distance, record, sine, thinned};

type Make = fn(f64, f64) -> Result<FirstOrder>;

fn shown(mut instrument: FirstOrder, input: &[f64]) -> Vec<f64> {
    input.iter().map(|&u| instrument.step(u)).collect()
}

#[test]
fn ref_scipy_first_order() -> Result<()> {
    let mut input = record(300, 1000.0);
    input[0] = 0.0;
    let cases: [(&str, Make, f64, &[f64]); 2] = [
        ("low-pass", FirstOrder::low_pass, 10.0, golden::LAG_LOW_PASS),
        (
            "high-pass",
            FirstOrder::high_pass,
            2.0,
            golden::LAG_HIGH_PASS,
        ),
    ];
    for (what, make, corner_hz, expected) in cases {
        let ours = shown(make(corner_hz, 1000.0)?, &input);
        check_below(
            what,
            distance(&thinned(&ours, 7), expected),
            tolerance::FIRST_ORDER,
        );
    }
    Ok(())
}

/// Corners at 1e-6 and 0.4 of the sample rate, where a formula for the weights loses digits or leaves its branch.
#[test]
fn ref_exact_slow_and_fast_low_pass() -> Result<()> {
    for (corner_hz, expected) in [(0.001, golden::LAG_SLOW), (400.0, golden::LAG_FAST)] {
        let ours = shown(
            FirstOrder::low_pass(corner_hz, 1000.0)?,
            &record(300, 1000.0),
        );
        check_below(
            &format!("corner {corner_hz} Hz"),
            distance(&thinned(&ours, 7), expected),
            tolerance::FIRST_ORDER,
        );
    }
    Ok(())
}

#[test]
fn inv_undone_high_pass() -> Result<()> {
    let input = record(5000, 1000.0);
    for corner_hz in [0.02, 0.5, 2.0, 10.0, 100.0] {
        let recorded = shown(FirstOrder::high_pass(corner_hz, 1000.0)?, &input);
        let away = |assumed_hz| -> Result<f64> {
            let undone = undo_high_pass(&recorded, assumed_hz, 1000.0)?;
            Ok(distance(&undone, &input))
        };
        let what = format!("undone, corner {corner_hz} Hz");
        check_below(&what, away(corner_hz)?, tolerance::UNDONE);
        // Control: a corner taken 1 % wrong.
        check_above(&what, away(1.01 * corner_hz)?, tolerance::UNDONE_CORNER_OFF);
    }
    Ok(())
}

#[test]
fn inv_low_pass_and_high_pass_add_to_the_input() -> Result<()> {
    let input = record(500, 1000.0);
    let sum: Vec<f64> = shown(FirstOrder::low_pass(3.0, 1000.0)?, &input)
        .iter()
        .zip(shown(FirstOrder::high_pass(3.0, 1000.0)?, &input))
        .map(|(low, high)| low + high)
        .collect();
    check_below("sum", distance(&sum, &input), tolerance::COMPLEMENT);
    Ok(())
}

#[test]
fn inv_constant_through_a_low_pass() -> Result<()> {
    let (corner_hz, rate_hz) = (0.01, 1000.0);
    let ratio = TAU * corner_hz / rate_hz;
    let mut instrument = FirstOrder::low_pass(corner_hz, rate_hz)?;
    // 40 time constants: exp(-40) is far below rounding.
    let mut last = 0.0;
    for _ in 0..(40.0 / ratio) as usize {
        last = instrument.step(3.3);
    }
    check_below(
        "constant",
        (last / 3.3 - 1.0).abs(),
        tolerance::LOW_PASS_STALL / ratio,
    );
    Ok(())
}

/// Distance of a simulated low-pass of 10 Hz from the analytic steady state under a sine.
fn hold_error(frequency_hz: f64, rate_hz: f64) -> Result<f64> {
    let corner_hz = 10.0;
    let samples = (2.0 * rate_hz) as usize;
    let ours = shown(
        FirstOrder::low_pass(corner_hz, rate_hz)?,
        &sine(samples, frequency_hz, rate_hz),
    );
    let ratio = frequency_hz / corner_hz;
    let expected: Vec<f64> = (0..samples)
        .map(|k| {
            let phase = TAU * frequency_hz * k as f64 / rate_hz;
            (phase - ratio.atan()).sin() / (1.0 + ratio * ratio).sqrt()
        })
        .collect();
    // After one second, 63 time constants, nothing is left of the start.
    Ok(distance(&ours[samples / 2..], &expected[samples / 2..]))
}

#[test]
fn order_hold() -> Result<()> {
    let frequency_hz = 5.0;
    for rate_hz in [500.0, 1000.0, 2000.0] {
        let (coarse, fine) = (
            hold_error(frequency_hz, rate_hz)?,
            hold_error(frequency_hz, 2.0 * rate_hz)?,
        );
        check_below(
            "order against 2",
            ((coarse / fine).log2() - 2.0).abs(),
            tolerance::HOLD_ORDER,
        );
        let predicted = (TAU * frequency_hz / rate_hz).powi(2) / 12.0;
        check_below(
            "error over its leading term, less 1",
            (coarse / predicted - 1.0).abs(),
            tolerance::HOLD_FACTOR,
        );
    }
    Ok(())
}

#[test]
fn inv_undone_gyroscope() -> Result<()> {
    let (corner_hz, rate_hz) = (10.0, 1000.0);
    let differentiator = Differentiator::new(10, 4, rate_hz)?;
    for frequency_hz in [1.0, 2.0, 5.0] {
        // The instrument's analytic record, not our simulation of it.
        let ratio: f64 = frequency_hz / corner_hz;
        let recorded: Vec<f64> = (0..2000)
            .map(|k| {
                let phase = TAU * frequency_hz * f64::from(k) / rate_hz;
                (phase - ratio.atan()).sin() / (1.0 + ratio * ratio).sqrt()
            })
            .collect();
        let truth = sine(2000, frequency_hz, rate_hz);
        let ours = undo_low_pass(&recorded, corner_hz, &differentiator)?;
        check_below(
            &format!("undone, {frequency_hz} Hz"),
            distance(&ours, &truth),
            tolerance::UNDONE_GYROSCOPE,
        );
        let interior = 200..1800;
        check_below(
            "away from the ends",
            distance(&ours[interior.clone()], &truth[interior]),
            tolerance::UNDONE_GYROSCOPE_INTERIOR,
        );
        check_above(
            "left alone",
            distance(&recorded, &truth),
            tolerance::GYROSCOPE_LEFT_ALONE,
        );
    }
    Ok(())
}

#[test]
fn inv_undone_gyroscope_raises_noise_little() -> Result<()> {
    let mut noise = Noise(golden::SEED);
    let record: Vec<f64> = (0..20_000).map(|_| noise.next()).collect();
    let rms = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt();
    let gain = |half_width| -> Result<f64> {
        let differentiator = Differentiator::new(half_width, 4, 1000.0)?;
        Ok(rms(&undo_low_pass(&record, 10.0, &differentiator)?) / rms(&record))
    };
    check_below("noise gain", gain(10)?, tolerance::UNDONE_NOISE);
    // Control: a window as short as the order allows.
    check_above(
        "noise gain, five samples",
        gain(2)?,
        tolerance::UNDONE_NOISE_SHORT,
    );
    Ok(())
}
