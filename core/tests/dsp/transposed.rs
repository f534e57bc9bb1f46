//! Transposes: L a . b = a . L^T b for every linear stage, ends included.

use sixaxis_core::Result;
use sixaxis_core::dsp::butterworth::low_pass;
use sixaxis_core::dsp::continued;
use sixaxis_core::dsp::detrend::rest_to_rest_trend;
use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_core::dsp::lag::{undo_high_pass, undo_low_pass};
use sixaxis_core::dsp::transposed;
use sixaxis_core::dsp::zero_phase::zero_phase;

use crate::{Noise, check_above, check_below, tolerance};

const RATE_HZ: f64 = 500.0;
const SAMPLES: usize = 240;

fn noise(seed: u64) -> Vec<f64> {
    let mut noise = Noise(seed);
    (0..SAMPLES).map(|_| noise.next()).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn length(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// |L a . b - a . L^T b| over |L a| |b|.
fn asymmetry(
    forward: impl Fn(&[f64]) -> Result<Vec<f64>>,
    backward: impl Fn(&[f64]) -> Result<Vec<f64>>,
) -> f64 {
    let (a, b) = (noise(1), noise(2));
    let image = forward(&a).expect("the record is sound");
    let influence = backward(&b).expect("the weights are sound");
    (dot(&image, &b) - dot(&a, &influence)).abs() / (length(&image) * length(&b))
}

fn in_place(stage: impl Fn(&mut [f64]) -> Result<()>) -> impl Fn(&[f64]) -> Result<Vec<f64>> {
    move |series| {
        let mut answer = series.to_vec();
        stage(&mut answer)?;
        Ok(answer)
    }
}

#[test]
fn inv_zero_phase_transposed() {
    for order in [1, 4, 5] {
        let sections = low_pass(order, 12.0, RATE_HZ).expect("the corner is sound");
        check_below(
            "zero-phase filter",
            asymmetry(
                in_place(|x| zero_phase(&sections, x)),
                in_place(|x| transposed::zero_phase(&sections, x)),
            ),
            tolerance::TRANSPOSED,
        );
        // The filter itself is its own transpose but for the ends, and noise is as large there as anywhere.
        check_above(
            "filter taken for its transpose",
            asymmetry(
                in_place(|x| zero_phase(&sections, x)),
                in_place(|x| zero_phase(&sections, x)),
            ),
            tolerance::ENDS_LEFT_OUT,
        );
    }
}

#[test]
fn inv_continued_zero_phase_transposed() {
    // Corners of which the record is long enough to be continued in full, and too short.
    for (order, corner_hz) in [(1, 12.0), (4, 12.0), (5, 70.0), (4, 2.0)] {
        let sections = low_pass(order, corner_hz, RATE_HZ).expect("the corner is sound");
        check_below(
            "continued zero-phase filter",
            asymmetry(
                in_place(|x| continued::zero_phase(&sections, x)),
                in_place(|x| transposed::continued_zero_phase(&sections, x)),
            ),
            tolerance::TRANSPOSED,
        );
    }
    let sections = low_pass(4, 12.0, RATE_HZ).expect("the corner is sound");
    check_above(
        "transpose of the filter that is not continued",
        asymmetry(
            in_place(|x| continued::zero_phase(&sections, x)),
            in_place(|x| transposed::zero_phase(&sections, x)),
        ),
        tolerance::ENDS_LEFT_OUT,
    );
}

#[test]
fn inv_derivative_transposed() {
    let d = Differentiator::new(3, 4, RATE_HZ).expect("the settings are sound");
    check_below(
        "differentiator",
        asymmetry(|x| d.derivative(x), |x| transposed::derivative(&d, x)),
        tolerance::TRANSPOSED,
    );
    let minus = |x: &[f64]| Ok(d.derivative(x)?.into_iter().map(|y| -y).collect());
    check_above(
        "minus the differentiator",
        asymmetry(|x| d.derivative(x), minus),
        tolerance::ENDS_LEFT_OUT,
    );
}

#[test]
fn inv_undone_lags_transposed() {
    let d = Differentiator::new(3, 4, RATE_HZ).expect("the settings are sound");
    check_below(
        "undone low-pass",
        asymmetry(
            |x| undo_low_pass(x, 10.0, &d),
            |x| transposed::undo_low_pass(x, 10.0, &d),
        ),
        tolerance::TRANSPOSED,
    );
    let forward = |x: &[f64]| undo_high_pass(x, 0.3, RATE_HZ);
    check_below(
        "undone high-pass",
        asymmetry(forward, |x| transposed::undo_high_pass(x, 0.3, RATE_HZ)),
        tolerance::TRANSPOSED,
    );
    check_above(
        "undone high-pass, not turned round",
        asymmetry(forward, forward),
        tolerance::ENDS_LEFT_OUT,
    );
}

#[test]
fn inv_line_between_rests_transposed() {
    for rest in [1, 25, SAMPLES / 2] {
        check_below(
            "line between rests",
            asymmetry(
                in_place(|x| rest_to_rest_trend(x, rest).map(|_| ())),
                in_place(|x| transposed::rest_to_rest_trend(x, rest)),
            ),
            tolerance::TRANSPOSED,
        );
        check_above(
            "line taken for its transpose",
            asymmetry(
                in_place(|x| rest_to_rest_trend(x, rest).map(|_| ())),
                in_place(|x| rest_to_rest_trend(x, rest).map(|_| ())),
            ),
            tolerance::ENDS_LEFT_OUT,
        );
    }
}
