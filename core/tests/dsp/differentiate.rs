//! The smoothing differentiator.

use sixaxis_core::Result;
use sixaxis_core::dsp::differentiate::Differentiator;

use crate::golden;
use crate::tolerance;
use crate::{check_above, check_below, distance, peak, record, sine};

#[test]
fn ref_scipy_savitzky_golay() -> Result<()> {
    let differentiator = Differentiator::new(7, 4, 1000.0)?;
    let series = record(120, 1000.0);
    check_below(
        "slope",
        distance(&differentiator.derivative(&series)?, golden::SLOPE_7_4),
        tolerance::SAVITZKY_GOLAY,
    );
    Ok(())
}

#[test]
fn ref_exact_slope_weights() -> Result<()> {
    let cases = [
        (3, 6, golden::SLOPE_WEIGHTS_3_6),
        (50, 6, golden::SLOPE_WEIGHTS_50_6),
        (200, 5, golden::SLOPE_WEIGHTS_200_5),
    ];
    for (half_width, order, expected) in cases {
        // The answer to a unit impulse is the weights, last one first.
        let mut impulse = vec![0.0; 4 * half_width + 1];
        impulse[2 * half_width] = 1.0;
        let answer = Differentiator::new(half_width, order, 1.0)?.derivative(&impulse)?;
        let outwards: Vec<f64> = answer[half_width..=2 * half_width]
            .iter()
            .rev()
            .copied()
            .step_by((half_width / 25).max(1))
            .collect();
        check_below(
            &format!("weights {half_width}, order {order}"),
            distance(&outwards, expected),
            tolerance::SLOPE_WEIGHTS,
        );
    }
    Ok(())
}

#[test]
fn ref_exact_bandwidth() -> Result<()> {
    let cases = [(1, 1), (3, 2), (10, 4), (50, 3), (50, 6), (200, 5)];
    assert_eq!(cases.len(), golden::BANDWIDTH_HZ.len());
    for ((half_width, order), frequency_hz) in cases.into_iter().zip(golden::BANDWIDTH_HZ) {
        let gain = Differentiator::new(half_width, order, 1000.0)?.relative_gain(*frequency_hz);
        check_below(
            "gain at the bandwidth over the root of a half, less 1",
            (gain * core::f64::consts::SQRT_2 - 1.0).abs(),
            tolerance::BANDWIDTH,
        );
    }
    Ok(())
}

#[test]
fn inv_bandwidth_is_where_a_sine_loses_3_db() -> Result<()> {
    let rate_hz = 1000.0;
    let differentiator = Differentiator::new(10, 4, rate_hz)?;
    // The third of the bandwidths.
    let frequency_hz = golden::BANDWIDTH_HZ[2];
    let slope = differentiator.derivative(&sine(400, frequency_hz, rate_hz))?;
    // In the interior the slope is g omega cos(omega t) with no phase.
    let omega = core::f64::consts::TAU * frequency_hz;
    let expected: Vec<f64> = (0..400)
        .map(|k| core::f64::consts::FRAC_1_SQRT_2 * omega * (omega * k as f64 / rate_hz).cos())
        .collect();
    check_below(
        "sine at the bandwidth",
        distance(&slope[10..390], &expected[10..390]),
        tolerance::GAIN_BY_SINE,
    );
    Ok(())
}

#[test]
fn inv_polynomials_up_to_the_order_are_exact() -> Result<()> {
    let (rate_hz, samples) = (1000.0, 90);
    for order in 1..=6 {
        for half_width in [3, 8, 30] {
            let differentiator = Differentiator::new(half_width, order, rate_hz)?;
            let error = |degree: i32| -> Result<f64> {
                // About the middle of the record, |x| <= 1.
                let x = |k: usize| (k as f64 / rate_hz - 0.045) / 0.045;
                let series: Vec<f64> = (0..samples).map(|k| x(k).powi(degree)).collect();
                let slope: Vec<f64> = (0..samples)
                    .map(|k| f64::from(degree) * x(k).powi(degree - 1) / 0.045)
                    .collect();
                Ok(distance(&differentiator.derivative(&series)?, &slope))
            };
            for degree in 1..=order as i32 {
                check_below("polynomial", error(degree)?, tolerance::POLYNOMIAL);
            }
            // Control, in the widest window: it cannot follow one degree more.
            if half_width == 30 {
                let beyond = error(order as i32 + 1)?;
                check_above("one order up", beyond, tolerance::POLYNOMIAL_BEYOND);
            }
        }
    }
    Ok(())
}

#[test]
fn inv_constant_has_no_slope() -> Result<()> {
    let differentiator = Differentiator::new(50, 6, 1000.0)?;
    let slope = differentiator.derivative(&[7.0; 300])?;
    // Against the slope of one unit per window.
    check_below(
        "slope of a constant",
        peak(&slope) / (7.0 * 1000.0 / 101.0),
        tolerance::POLYNOMIAL,
    );
    Ok(())
}
