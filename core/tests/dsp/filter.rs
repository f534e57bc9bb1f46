//! Butterworth filters, forwards and backwards and live.

use sixaxis_core::Result;
use sixaxis_core::dsp::butterworth::{Section, low_pass};
use sixaxis_core::dsp::causal::SectionsState;
use sixaxis_core::dsp::continued;
use sixaxis_core::dsp::zero_phase::{padding, zero_phase};

use crate::golden;
use crate::tolerance;
use crate::{check_above, check_below, distance, record, thinned};

/// Gain of a cascade at a frequency: one pass; `zero_phase` has its square.
fn gain(sections: &[Section], frequency_hz: f64, sample_rate_hz: f64) -> f64 {
    let (s, c) = (core::f64::consts::PI * (frequency_hz / sample_rate_hz)).sin_cos();
    // |c0 z + c1 + c2/z| with z = (c + i s)^2; cos as 1 - 2 s^2 below a quarter of the sample rate and 2 c^2 - 1 above
    // keeps the digits that the sum of the coefficients loses where it all but vanishes.
    let modulus_squared = |c0: f64, c1: f64, c2: f64| {
        let real = if s.abs() < c.abs() {
            (c0 + c1 + c2) - 2.0 * (c0 + c2) * s * s
        } else {
            (c1 - c0 - c2) + 2.0 * (c0 + c2) * c * c
        };
        let imaginary = 2.0 * (c0 - c2) * s * c;
        real * real + imaginary * imaginary
    };
    sections
        .iter()
        .map(|Section { b, a }| {
            (modulus_squared(b[0], b[1], b[2]) / modulus_squared(1.0, a[0], a[1])).sqrt()
        })
        .product()
}

fn filtered(sections: &[Section], samples: usize, rate_hz: f64) -> Result<Vec<f64>> {
    let mut series = record(samples, rate_hz);
    zero_phase(sections, &mut series)?;
    Ok(series)
}

#[test]
fn ref_scipy_zero_phase() -> Result<()> {
    let check = |what, sections: Vec<Section>, samples, stride, expected: &[f64]| -> Result<()> {
        let ours = filtered(&sections, samples, 1000.0)?;
        let away = distance(&thinned(&ours, stride), expected);
        check_below(what, away, tolerance::ZERO_PHASE);
        Ok(())
    };
    check(
        "low-pass 1",
        low_pass(1, 100.0, 1000.0)?,
        60,
        2,
        golden::LOW_PASS_1,
    )?;
    check(
        "low-pass 4",
        low_pass(4, 50.0, 1000.0)?,
        300,
        7,
        golden::LOW_PASS_4,
    )?;
    check(
        "low-pass 5",
        low_pass(5, 120.0, 1000.0)?,
        200,
        5,
        golden::LOW_PASS_5,
    )?;
    check(
        "low-pass 10",
        low_pass(10, 300.0, 1000.0)?,
        200,
        5,
        golden::LOW_PASS_10,
    )
}

#[test]
fn ref_exact_narrow_zero_phase() -> Result<()> {
    let ours = |corner_hz| -> Result<Vec<f64>> {
        let sections = low_pass(8, corner_hz, 2000.0)?;
        Ok(thinned(&filtered(&sections, 6000, 2000.0)?, 100))
    };
    let narrow = ours(1.0)?;
    check_below(
        "order 8 at 5e-4 against 50 digits",
        distance(&narrow, golden::NARROW_LOW_PASS_8_EXACT),
        tolerance::NARROW_AGAINST_EXACT,
    );
    check_below(
        "order 8 at 5e-4 against SciPy",
        distance(&narrow, golden::NARROW_LOW_PASS_8),
        tolerance::NARROW_AGAINST_SCIPY,
    );
    check_above(
        "the same with its corner 1 % off",
        distance(&ours(1.01)?, golden::NARROW_LOW_PASS_8_EXACT),
        tolerance::NARROW_CORNER_OFF,
    );
    Ok(())
}

#[test]
fn ref_scipy_causal() -> Result<()> {
    let mut state = SectionsState::at_rest(&low_pass(6, 30.0, 1000.0)?);
    let ours: Vec<f64> = record(200, 1000.0)
        .into_iter()
        .map(|x| state.step(x))
        .collect();
    check_below(
        "causal low-pass 6",
        distance(&thinned(&ours, 5), golden::CAUSAL_LOW_PASS_6),
        tolerance::CAUSAL,
    );
    Ok(())
}

#[test]
fn inv_settled_state_has_no_transient() -> Result<()> {
    let sections = low_pass(8, 1.0, 2000.0)?;
    let level = 3.7;
    let mut settled = SectionsState::settled(&sections, level);
    let mut from_rest = SectionsState::at_rest(&sections);
    let mut kept: f64 = 0.0;
    let mut first = f64::NAN;
    for i in 0..5000 {
        kept = kept.max((settled.step(level) / level - 1.0).abs());
        let out = from_rest.step(level);
        if i == 0 {
            first = out;
        }
    }
    check_below(
        "constant through a settled filter",
        kept,
        tolerance::CONSTANT_KEPT,
    );
    // Control: from rest the first sample is all transient.
    check_above(
        "transient from rest",
        1.0 - first / level,
        tolerance::TRANSIENT,
    );
    Ok(())
}

#[test]
fn inv_gain_is_butterworths() -> Result<()> {
    let rate_hz = 2000.0;
    let (mut worst, mut worst_unit) = (0.0_f64, 0.0_f64);
    for order in 1..=10 {
        for relative_corner in [5e-4, 1e-2, 0.1, 0.3, 0.49] {
            let corner_hz = relative_corner * rate_hz;
            let low = low_pass(order, corner_hz, rate_hz)?;
            worst_unit = worst_unit
                .max((gain(&low, 0.0, rate_hz) - 1.0).abs())
                .max(gain(&low, 0.5 * rate_hz, rate_hz));
            for relative in [0.2, 0.7, 1.0, 1.4, 2.0] {
                let frequency_hz = relative * corner_hz;
                if frequency_hz >= 0.5 * rate_hz {
                    continue;
                }
                // The bilinear transform maps f to tan(pi f/rate).
                let warped = |f: f64| (core::f64::consts::PI * f / rate_hz).tan();
                let power = (warped(frequency_hz) / warped(corner_hz)).powi(2 * order as i32);
                let formula = 1.0 / (1.0 + power).sqrt();
                worst = worst.max((gain(&low, frequency_hz, rate_hz) - formula).abs());
            }
        }
    }
    check_below("gain against the formula", worst, tolerance::GAIN);
    check_below("gain where it is 1 or 0", worst_unit, tolerance::UNIT_GAIN);
    Ok(())
}

#[test]
fn inv_rounding_moves_the_corner_by_its_square() -> Result<()> {
    // At its corner any order has gain 2^(-1/2) and there falls by order/2 2^(-1/2) per relative change of frequency.
    let half_power = core::f64::consts::FRAC_1_SQRT_2;
    let mut worst = 0.0_f64;
    for order in [2, 5, 8, 10] {
        for k in 0..200 {
            let relative_corner = 1e-6 * 1.05_f64.powi(k).min(5e5);
            if relative_corner > 0.1 {
                continue;
            }
            let sections = low_pass(order, relative_corner, 1.0)?;
            let off = (gain(&sections, relative_corner, 1.0) - half_power).abs();
            let moved = off / (order as f64 / 2.0 * half_power);
            worst = worst.max(moved * relative_corner * relative_corner);
        }
    }
    check_below(
        "corner moved, times its square",
        worst,
        tolerance::CORNER_MOVED,
    );
    Ok(())
}

#[test]
fn inv_zero_phase_has_the_gain_squared() -> Result<()> {
    // In the middle of a long sine the ends are forgotten: the filter of order 2 at 50 Hz forgets in 20 ms.
    let (rate_hz, frequency_hz, samples) = (1000.0, 40.0, 2001);
    let sections = low_pass(2, 50.0, rate_hz)?;
    let expected = gain(&sections, frequency_hz, rate_hz).powi(2);
    let input = crate::sine(samples, frequency_hz, rate_hz);
    let mut output = input.clone();
    zero_phase(&sections, &mut output)?;
    let scaled: Vec<f64> = input.iter().map(|x| x * expected).collect();
    let middle = 800..1200;
    check_below(
        "sine in the middle",
        distance(&output[middle.clone()], &scaled[middle]),
        tolerance::ZERO_PHASE,
    );
    Ok(())
}

#[test]
fn ref_scipy_padding() -> Result<()> {
    // 3 (order + 1), and one sample more is the least that SciPy and we accept.
    for order in 1..=10 {
        let sections = low_pass(order, 50.0, 1000.0)?;
        let pad = padding(&sections);
        assert_eq!(pad, 3 * (order + 1));
        assert!(zero_phase(&sections, &mut record(pad, 1000.0)).is_err());
        assert!(zero_phase(&sections, &mut record(pad + 1, 1000.0)).is_ok());
    }
    Ok(())
}

#[test]
fn inv_an_end_has_the_noise_of_its_fit() -> Result<()> {
    // Order 4 at 5e-3 of the sample rate delays by 83 samples, over which the parabola is fitted: 3/sqrt(83) = 0.33.
    let (rate_hz, corner_hz, samples) = (1000.0, 5.0, 4000);
    let sections = low_pass(4, corner_hz, rate_hz)?;
    let filtered = |seed, filter: fn(&[Section], &mut [f64]) -> Result<()>| -> Result<_> {
        let mut noise = crate::Noise(seed);
        let mut series: Vec<f64> = (0..samples).map(|_| noise.next()).collect();
        let raw = rms(&[series[0], series[samples - 1]]);
        filter(&sections, &mut series)?;
        Ok((raw, rms(&[series[0], series[samples - 1]])))
    };
    let ratio = |filter: fn(&[Section], &mut [f64]) -> Result<()>| -> Result<f64> {
        let pairs = (1..=200)
            .map(|seed| filtered(seed, filter))
            .collect::<Result<Vec<_>>>()?;
        let (raw, ours): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        Ok(rms(&ours) / rms(&raw))
    };
    let expected = 3.0 / 83.0_f64.sqrt();
    let ours = ratio(continued::zero_phase)?;
    check_below(
        "noise of an end against the fit's",
        (ours / expected - 1.0).abs(),
        tolerance::END_NOISE,
    );
    check_above(
        "noise of an end that is turned round its sample",
        ratio(zero_phase)? / expected,
        2.0,
    );
    Ok(())
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
fn inv_a_parabola_keeps_its_ends() -> Result<()> {
    // Turned round the fit, a parabola goes on with its slope and without its bend, which is what the filter makes of it.
    let sections = low_pass(4, 5.0, 1000.0)?;
    let line: Vec<f64> = (0..3000).map(|i| 2.0 - 0.01 * f64::from(i)).collect();
    let mut ours = line.clone();
    continued::zero_phase(&sections, &mut ours)?;
    // A record that long is continued for five delays, which leaves 0.7 % of where the filter begins.
    check_below(
        "a line, end to end",
        distance(&ours, &line),
        tolerance::CONTINUED_LINE,
    );
    let bend: Vec<f64> = (0..3000).map(|i| 1e-6 * f64::from(i * i)).collect();
    let mut ours = bend.clone();
    continued::zero_phase(&sections, &mut ours)?;
    check_below(
        "ends of a parabola",
        distance(&ours, &bend),
        tolerance::CONTINUED_LINE,
    );
    Ok(())
}

#[test]
fn inv_a_wide_filter_has_scipys_ends() -> Result<()> {
    // It delays by less than three samples: turned round its end sample like SciPy, for not quite as long.
    let sections = low_pass(4, 200.0, 1000.0)?;
    let mut ours = record(300, 1000.0);
    let mut scipys = ours.clone();
    continued::zero_phase(&sections, &mut ours)?;
    zero_phase(&sections, &mut scipys)?;
    check_below(
        "wide filter",
        distance(&ours, &scipys),
        tolerance::WIDE_FILTER,
    );
    Ok(())
}
