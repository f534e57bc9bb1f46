//! What a channel shows of a motion: forces that are made of the fit's own terms, whose sizes come out again.

use core::f64::consts::TAU;

use glam::DVec3;
use sixaxis_calibration::conditioning::Conditioned;
use sixaxis_calibration::response::{Response, measure};
use sixaxis_calibration::trial::Trial;
use sixaxis_core::{Gains, LIMBS};
use sixaxis_recordings::session::Role;

const RATE_HZ: f64 = 1000.0;
const FREQUENCY_HZ: f64 = 5.0;
const SAMPLES: usize = 4001;
const LINEAR_M_S2: f64 = 20.0;
const ANGULAR_RAD_S2: f64 = 300.0;

/// The derivative is that of a cubic through nine samples: right to the fourth power of a sample's phase, 0.03 rad.
const DERIVATIVE: f64 = 1e-4;
/// Terms of a whole number of cycles are square to one another, of rows less a hundredth at either end to a few per cent.
const NEARLY_SQUARE: f64 = 0.05;

fn phase(t: usize) -> f64 {
    TAU * FREQUENCY_HZ * t as f64 / RATE_HZ
}

/// From -1 to 1 over the run.
fn place(t: usize) -> f64 {
    (t as f64 - 2000.0) / 2000.0
}

fn played(role: Role, direction: DVec3, linear: f64, angular: f64) -> (Trial, Conditioned) {
    let each = |f: &dyn Fn(usize) -> f64| -> Vec<DVec3> {
        (0..SAMPLES).map(|t| direction * f(t)).collect()
    };
    let omega = TAU * FREQUENCY_HZ;
    let trial = Trial {
        name: "made up".to_owned(),
        role,
        sample_rate_hz: RATE_HZ,
        gains: Gains::uniform(1.0),
        full_scale_v: 5.0,
        voltage_v: vec![[0.0; LIMBS]; SAMPLES],
        accelerometer_m_s2: Vec::new(),
        gyroscope_rad_s: Vec::new(),
        limbs_band_hz: f64::INFINITY,
        standards_band_hz: f64::INFINITY,
        direction_ground: direction,
        gravity_ground_m_s2: DVec3::ZERO,
        frequency_hz: FREQUENCY_HZ,
    };
    let conditioned = Conditioned {
        voltage_v: Vec::new(),
        linear_ground_m_s2: each(&|t| linear * phase(t).sin()),
        rate_shell_rad_s: each(&|t| -angular / omega * phase(t).cos()),
        angular_shell_rad_s2: each(&|t| angular * phase(t).sin()),
        outliers: 0,
        zero_wander_v: [0.0; LIMBS],
    };
    (trial, conditioned)
}

/// Limb i's force, N: `of` its number, the place in the run, the waveform over its peak, and its derivative by phase.
fn forces(of: impl Fn(f64, f64, f64, f64) -> f64) -> Vec<[f64; LIMBS]> {
    (0..SAMPLES)
        .map(|t| {
            let (sine, cosine) = phase(t).sin_cos();
            core::array::from_fn(|i| of((i + 1) as f64, place(t), sine, cosine))
        })
        .collect()
}

fn close(what: &str, ours: f64, expected: f64, tolerance: f64) {
    let off = (ours - expected).abs();
    assert!(off <= tolerance, "{what}: {ours}, not {expected}");
}

#[test]
fn inv_terms_of_the_fit_come_out_again() {
    let d = DVec3::new(0.6, 0.0, -0.8);
    for (role, linear, angular) in [
        (Role::Linear, LINEAR_M_S2, 0.0),
        (Role::Angular, 0.0, ANGULAR_RAD_S2),
        (Role::Validation, LINEAR_M_S2, ANGULAR_RAD_S2),
    ] {
        let (trial, conditioned) = played(role, d, linear, angular);
        let turns = angular > 0.0;
        let force = forces(|i, s, sine, cosine| {
            let centrifugal = if turns { cosine * cosine } else { 0.0 };
            10.0 * i + 3.0 * i * s + 2.0 * i * sine - 0.5 * i * cosine
                + 0.25 * i * s * cosine
                + 0.125 * i * centrifugal
        });
        let found = measure(&trial, &conditioned, &force).expect("long enough");
        let peak = if linear > 0.0 { linear } else { angular };
        let omega = TAU * FREQUENCY_HZ;
        close("peak", found.peak, peak, DERIVATIVE * peak);
        close(
            "linear",
            found.peak_linear_m_s2,
            linear,
            DERIVATIVE * linear,
        );
        let rate = angular / omega;
        close("rate", found.peak_rate_rad_s, rate, DERIVATIVE * rate);
        let ratio = if turns { angular / peak } else { 0.0 };
        close(
            "ratio",
            found.angular_over_waveform,
            ratio,
            DERIVATIVE * ratio,
        );
        assert_eq!(found.travels, linear > 0.0);
        let of_travel = if linear > 0.0 { 1.0 } else { 0.0 };
        close("travel", found.linear_over_waveform, of_travel, 0.0);
        close("duration", found.duration_s, 4.001, DERIVATIVE);
        let frequency_hz = found.frequency_hz.expect("twenty cycles");
        close("frequency", frequency_hz, FREQUENCY_HZ, DERIVATIVE);
        for (channel, i) in found.channels.iter().zip(1..) {
            let i = f64::from(i);
            close("drift", channel.drift_n, 2.0 * 3.0 * i, DERIVATIVE * i);
            close("response", channel.response * peak, 2.0 * i, DERIVATIVE * i);
            let lagging = channel.lagging * peak * omega;
            close("lagging", lagging, -0.5 * i, DERIVATIVE * i);
            let growth = channel.lagging_growth * peak * omega;
            close("its growth", growth, 0.25 * i, DERIVATIVE * i);
            close("residual", channel.residual_n, 0.0, DERIVATIVE * i);
        }
    }
}

/// The mean of a run from rest to rest is a standard's own offset, and no force is lacking for it.
#[test]
fn inv_an_offset_of_the_standard_is_none_of_the_channels() {
    let d = DVec3::new(0.6, 0.0, -0.8);
    let (trial, mut conditioned) = played(Role::Linear, d, LINEAR_M_S2, 0.0);
    let force = forces(|i, _, sine, _| 10.0 * i + 2.0 * i * sine);
    conditioned
        .linear_ground_m_s2
        .iter_mut()
        .for_each(|a| *a += 0.05 * LINEAR_M_S2 * d);
    let found = measure(&trial, &conditioned, &force).expect("long enough");
    for (channel, i) in found.channels.iter().zip(1..) {
        close(
            "offset",
            channel.offset_n,
            10.0 * f64::from(i),
            1e-3 * f64::from(i),
        );
    }
}

/// Noise that changes sign with every second row is square to all terms but for their ends.
#[test]
fn inv_errors_are_those_of_an_orthogonal_fit() {
    const NOISE_N: f64 = 0.01;
    let (trial, conditioned) = played(Role::Linear, DVec3::X, LINEAR_M_S2, 0.0);
    let stride = sixaxis_calibration::steps::stride(&trial);
    let mut force = forces(|_, _, sine, _| 2.0 * sine);
    for (t, row) in force.iter_mut().enumerate() {
        let noise = if (t / stride).is_multiple_of(2) {
            NOISE_N
        } else {
            -NOISE_N
        };
        row.iter_mut().for_each(|f| *f += noise);
    }
    let found = measure(&trial, &conditioned, &force).expect("long enough");
    let rows = 0.98 * SAMPLES as f64 / stride as f64;
    for channel in &found.channels {
        close("residual", channel.residual_n / NOISE_N, 1.0, NEARLY_SQUARE);
        let signal = 2.0 / 2.0_f64.sqrt();
        close("signal", channel.signal_n / signal, 1.0, NEARLY_SQUARE);
        // Means of squares: half a waveform's peak's; a third of the trend's.
        let error = NOISE_N / LINEAR_M_S2 / (rows / 2.0).sqrt();
        close("error", channel.standard_error / error, 1.0, NEARLY_SQUARE);
        let error = 2.0 * NOISE_N / (rows / 3.0).sqrt();
        close(
            "of the drift",
            channel.drift_error_n / error,
            1.0,
            NEARLY_SQUARE,
        );
    }
}

#[test]
fn inv_what_does_not_move_or_is_too_short_is_not_fitted() {
    let force = forces(|_, _, sine, _| sine);
    let measured = |linear: f64, samples: usize| -> Option<Response> {
        let (mut trial, mut conditioned) = played(Role::Linear, DVec3::X, linear, 0.0);
        trial.voltage_v.truncate(samples);
        for series in [
            &mut conditioned.linear_ground_m_s2,
            &mut conditioned.rate_shell_rad_s,
            &mut conditioned.angular_shell_rad_s2,
        ] {
            series.truncate(samples);
        }
        measure(&trial, &conditioned, &force[..samples])
    };
    assert!(measured(LINEAR_M_S2, SAMPLES).is_some());
    assert_eq!(measured(0.0, SAMPLES), None);
    // Four rows for each of six terms.
    let (trial, _) = played(Role::Linear, DVec3::X, LINEAR_M_S2, 0.0);
    let stride = sixaxis_calibration::steps::stride(&trial);
    assert_eq!(measured(LINEAR_M_S2, 23 * stride), None);
    assert!(measured(LINEAR_M_S2, 25 * stride).is_some());
    // Fewer than three cycles have no frequency; four have.
    let found = measured(LINEAR_M_S2, 650).expect("long enough");
    assert_eq!(found.frequency_hz, None);
    let found = measured(LINEAR_M_S2, 1100).expect("long enough");
    close(
        "frequency",
        found.frequency_hz.expect("five cycles"),
        FREQUENCY_HZ,
        1e-3,
    );
}
