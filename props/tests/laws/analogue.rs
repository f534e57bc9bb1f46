//! Analogue filters on the way to the disk, and how they are undone: against the filter's differential equation, integrated in
//! steps far below a sample, of which neither the reference's quadrature nor the core's recursions know anything.

use core::f64::consts::TAU;

use rand_pcg::Pcg64;
use sixaxis_core::LIMBS;
use sixaxis_core::dsp::differentiate::Differentiator;
use sixaxis_core::dsp::lag::{undo_high_pass, undo_low_pass};
use sixaxis_props::compare::largest;
use sixaxis_props::evidence::Row;
use sixaxis_props::tolerance::{self, Tolerance};
use sixaxis_reference::laboratory::chain::{Chain, Coupling};
use sixaxis_reference::laboratory::instruments::Instruments;
use sixaxis_reference::sensor::TrueSensor;

/// The campaign's sample rate of a blind trial.
const RATE_HZ: f64 = 1000.0;
const SAMPLES: usize = 5000;
/// Steps of the oversampled filter in a sample: Runge and Kutta's fourth order leaves 1e-14.
const STEPS: u32 = 64;
/// Fundamentals of the signals: the bands of steps 2 to 4, and one above.
const DRIVES_HZ: [f64; 3] = [1.0, 5.0, 20.0];
/// Corner of a charge amplifier, and of the paper's gyroscope.
const AMPLIFIER_HZ: f64 = 0.1;
const GYROSCOPE_HZ: f64 = 10.0;
/// The rows at each end where the differentiator's window is cut off.
const ENDS: usize = 10;

/// From rest in value and slope, two harmonics.
fn signal(drive_hz: f64, time_s: f64) -> f64 {
    let phase = TAU * drive_hz * time_s;
    phase.sin() - 0.5 * (2.0 * phase).sin()
}

fn sampled(drive_hz: f64) -> Vec<f64> {
    let time_s = |i: usize| i as f64 / RATE_HZ;
    (0..SAMPLES).map(|i| signal(drive_hz, time_s(i))).collect()
}

/// What a first-order low-pass shows of the signal: x' = (u - x)/tau from rest.
fn oversampled(drive_hz: f64, corner_hz: f64) -> Vec<f64> {
    let pull = TAU * corner_hz;
    let slope = |time_s: f64, x: f64| pull * (signal(drive_hz, time_s) - x);
    let step_s = 1.0 / (RATE_HZ * f64::from(STEPS));
    let mut x = 0.0;
    let mut shown = vec![0.0];
    for sample in 1..SAMPLES {
        let from_s = (sample - 1) as f64 / RATE_HZ;
        for step in 0..STEPS {
            let t = from_s + f64::from(step) * step_s;
            let (half, full) = (t + 0.5 * step_s, t + step_s);
            let first = slope(t, x);
            let second = slope(half, x + 0.5 * step_s * first);
            let third = slope(half, x + 0.5 * step_s * second);
            let fourth = slope(full, x + step_s * third);
            x += step_s / 6.0 * (first + 2.0 * (second + third) + fourth);
        }
        shown.push(x);
    }
    shown
}

fn apart(ours: &[f64], truth: &[f64]) -> f64 {
    let pairs = ours.iter().zip(truth);
    largest(pairs.map(|(ours, truth)| ours - truth)) / largest(truth.iter().copied())
}

/// A row of evidence, and one that must fail.
fn judge(what: &str, drive_hz: f64, [error, broken]: [f64; 2], tolerance: Tolerance) {
    let row = |what, error| Row::new(what, error, tolerance).case(format_args!("{drive_hz} Hz"));
    row(what.to_owned(), error).judge();
    row(format!("{what}, corner off by 10 %"), broken)
        .control(10.0)
        .judge();
}

#[test]
fn ref_an_amplifier_s_high_pass_is_simulated_and_undone() {
    let mut sensor = TrueSensor::identified();
    sensor.zero_drift_v = [0.0; LIMBS];
    sensor.scale_per_mass_per_kg = [1.0; LIMBS];
    let simulated = |drive_hz: f64, corner_hz: f64| -> Vec<f64> {
        let chain = Chain {
            coupling: Coupling::AlternatingCurrent { corner_hz },
            full_scale_v: f64::INFINITY,
            ..Chain::noise_free()
        };
        let forces: Vec<_> = sampled(drive_hz).iter().map(|u| [*u; LIMBS]).collect();
        let gains = [1.0; LIMBS];
        let rows = chain.record(&forces, &sensor, &gains, RATE_HZ, &mut Pcg64::new(1, 1));
        rows.iter().map(|row| row[0]).collect()
    };
    for drive_hz in DRIVES_HZ {
        let truth = sampled(drive_hz);
        let lag = oversampled(drive_hz, AMPLIFIER_HZ);
        let shown: Vec<f64> = truth.iter().zip(&lag).map(|(u, x)| u - x).collect();
        let off = |corner_hz| apart(&simulated(drive_hz, corner_hz), &shown);
        let errors = [AMPLIFIER_HZ, 1.1 * AMPLIFIER_HZ].map(off);
        judge(
            "simulated high-pass",
            drive_hz,
            errors,
            tolerance::simulated_high_pass(AMPLIFIER_HZ, drive_hz, RATE_HZ),
        );
        let off = |corner_hz| {
            let undone = undo_high_pass(&shown, corner_hz, RATE_HZ).expect("finite samples");
            apart(&undone, &truth)
        };
        let errors = [AMPLIFIER_HZ, 1.1 * AMPLIFIER_HZ].map(off);
        let limit = tolerance::undone_high_pass(AMPLIFIER_HZ, drive_hz, RATE_HZ);
        judge("undone high-pass", drive_hz, errors, limit);
    }
}

#[test]
fn ref_a_gyroscope_s_lag_is_simulated_and_undone() {
    let differentiator = Differentiator::new(ENDS, 4, RATE_HZ).expect("a window");
    for (place, drive_hz) in DRIVES_HZ.into_iter().enumerate() {
        let truth = sampled(drive_hz);
        let shown = oversampled(drive_hz, GYROSCOPE_HZ);
        let off = |corner_hz| {
            let gyroscope = Instruments {
                gyroscope_bandwidth_hz: Some(corner_hz),
                ..Instruments::perfect()
            };
            let simulated = gyroscope.read_gyroscope(&truth, RATE_HZ, &mut Pcg64::new(1, 1));
            apart(&simulated, &shown)
        };
        let errors = [GYROSCOPE_HZ, 1.1 * GYROSCOPE_HZ].map(off);
        let limit = tolerance::simulated_lag(drive_hz, RATE_HZ);
        judge("simulated lag", drive_hz, errors, limit);
        let off = |corner_hz| {
            let undone = undo_low_pass(&shown, corner_hz, &differentiator).expect("finite samples");
            apart(&undone[ENDS..SAMPLES - ENDS], &truth[ENDS..SAMPLES - ENDS])
        };
        // Beyond the corner the window is too long for the signal.
        if let Some(limit) = tolerance::UNDONE_LAG.get(place) {
            let errors = [GYROSCOPE_HZ, 1.1 * GYROSCOPE_HZ].map(off);
            judge("undone lag", drive_hz, errors, *limit);
        }
    }
}
