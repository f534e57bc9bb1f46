//! Manufactured motion in, six accelerations out: any drawing, any parameters, any sample rate.

use glam::DVec3;
use proptest::prelude::*;
use sixaxis_core::{Scheme, SixAxis};
use sixaxis_props::compare::largest;
use sixaxis_props::evidence::Row;
use sixaxis_props::manufactured::formulations::{Mass, ShellMotion, solve};
use sixaxis_props::manufactured::motion::Manufactured;
use sixaxis_props::problem::{Problem, UNEQUAL_GAINS};
use sixaxis_props::strategy::{config, manufactured};
use sixaxis_props::tolerance;

/// Runge-Kutta steps of the truth from sample to sample.
const STEPS: usize = 4;
/// Periods of the fastest sine.
const PERIODS: f64 = 3.0;

/// Largest error over the largest truth, for one vector of the output, with the two components that differ most.
fn compare(
    ours: &[SixAxis],
    truth: &[ShellMotion],
    get: fn(&ShellMotion) -> DVec3,
    got: fn(&SixAxis) -> DVec3,
) -> (f64, [f64; 2]) {
    let peak = largest(truth.iter().map(|t| get(t).length()));
    let mut worst = (0.0, [0.0; 2]);
    for sample in ours {
        let (a, b) = (get(&truth[sample.sample as usize]), got(sample));
        for axis in 0..3 {
            let error = (a[axis] - b[axis]).abs() / peak;
            if error.is_nan() || error > worst.0 {
                worst = (error, [a[axis], b[axis]]);
            }
        }
    }
    worst
}

fn judge(sensor: &Manufactured, scheme: Scheme, samples_per_period: f64) {
    let tolerance = tolerance::manufactured(scheme);
    let fastest_hz = sensor.highest_frequency_hz();
    let rate_hz = fastest_hz * samples_per_period;
    let samples = (PERIODS * samples_per_period) as usize;
    let truth = solve::<Mass>(sensor, rate_hz, samples, STEPS);
    let halved = solve::<Mass>(sensor, rate_hz, samples, 2 * STEPS);
    let ours = Problem::manufactured(sensor, UNEQUAL_GAINS, rate_hz, samples, scheme)
        .starting(truth[1].attitude.normalize(), truth[1].rate_shell_rad_s)
        .decouple();
    assert_eq!(ours.len(), samples - 2, "samples decoupled");
    let case = format!(
        "{}, {samples_per_period:.0} samples a period",
        scheme.name()
    );
    let unlike = |get: fn(&ShellMotion) -> DVec3| {
        let peak = largest(truth.iter().map(|t| get(t).length()));
        largest(
            truth
                .iter()
                .zip(&halved)
                .map(|(a, b)| (get(a) - get(b)).length()),
        ) / peak
    };
    for (what, unit, get, got) in [
        (
            "linear acceleration, manufactured motion",
            "m/s^2",
            (|t| t.linear_ground_m_s2) as fn(&ShellMotion) -> DVec3,
            (|s| s.linear_ground_m_s2) as fn(&SixAxis) -> DVec3,
        ),
        (
            "angular acceleration, manufactured motion",
            "rad/s^2",
            |t| t.angular_ground_rad_s2,
            |s| s.angular_ground_rad_s2,
        ),
        (
            "rate, manufactured motion",
            "rad/s",
            |t| t.rate_shell_rad_s,
            |s| s.rate_shell_rad_s,
        ),
    ] {
        let (error, [a, b]) = compare(&ours, &truth, get, got);
        // In units of what the scheme's order and the central differences leave at this rate.
        let allowed = allowance(sensor, &truth, scheme, rate_hz);
        Row::new(what, error / allowed, tolerance)
            .case(&case)
            .sides(a, b, unit)
            .beyond(unlike(get) / allowed)
            .judge();
    }
}

/// (w h)^p of the scheme plus (w h)^2 (w/w0)^2 of the central differences, w0^2 = k/m. The fastest thing is either what
/// the mass does in the shell or the turning of the shell itself.
fn allowance(sensor: &Manufactured, truth: &[ShellMotion], scheme: Scheme, rate_hz: f64) -> f64 {
    let vibration = core::f64::consts::TAU * sensor.highest_frequency_hz();
    let turning = largest(truth.iter().map(|t| t.rate_shell_rad_s.length()));
    let step = (vibration + turning) / rate_hz;
    let softness = vibration * vibration / sensor.parameters.stiffness_per_mass_per_s2;
    let of_scheme = match scheme {
        Scheme::Euler => step,
        Scheme::Heun | Scheme::AdamsBashforth2 => step.powi(2),
        // A 64th of Heun's, and the parabola's cubic error.
        Scheme::HeunSubstepped => step.powi(2) / 64.0 + step.powi(3),
        Scheme::AdamsMoulton4 | Scheme::RungeKutta4 => step.powi(4),
    };
    // Errors add up over the angle travelled, which three periods of the vibration do not bound.
    of_scheme * (1.0 + turning / vibration) + step.powi(2) * softness
}

proptest! {
    #![proptest_config(config(48))]

    #[test]
    fn prop_manufactured_motion_comes_back(
        sensor in manufactured(),
        samples_per_period in 60.0..400.0_f64,
    ) {
        for scheme in Scheme::ALL {
            judge(&sensor, scheme, samples_per_period);
        }
    }
}
