//! What any method could know of k/m: the Cramer-Rao bound over the frequency of the excitation, with the limbs' tilt and in linear
//! theory.

use anyhow::Result;
use core::f64::consts::TAU;
use glam::DVec3;
use sixaxis_core::identify::stiffness_bound::{
    Bound, Excitation, Information, LinearSensor, Response,
};
use sixaxis_core::{Geometry, LIMBS, Parameters};
use sixaxis_reference::rig::run::{Mounting, WEDGES};
use sixaxis_reference::rig::run::{ROTATION_AMPLITUDE_RAD, SLIDER_AMPLITUDE_M};

use crate::study::results::identifiability::{BandBound, BoundStudy};

/// Frequencies a band.
const FREQUENCIES: usize = 20;
/// Samples a trial: ten seconds at 10 kHz.
const SAMPLES: usize = 100_000;
/// Noise of a sample over the largest channel of its trial: the class of the paper's instruments.
const NOISE_OVER_LARGEST: f64 = 0.01;
/// Lower end of a band over its upper end: the paper's 4 to 5 Hz.
const BAND: f64 = 0.8;
/// Upper ends of the bands that the table names, Hz; the paper's first.
const NAMED_HZ: [f64; 4] = [5.0, 50.0, 500.0, 2000.0];
/// Ends of the curve, Hz, and points a decade on it.
const CURVE_HZ: (f64, f64) = (1.0, 2000.0);
const POINTS_PER_DECADE: f64 = 10.0;
/// Phases of a period that the tilted forces are taken at: they hold its second harmonic, and of the square of it the fourth.
const PHASES: usize = 16;
/// Highest frequency of the rig, Hz: from there on its largest acceleration, below it its stroke is the limit.
const RIG_HZ: f64 = 5.0;

/// The study.
///
/// # Errors
/// Those of the bound.
pub fn study(truth: &Parameters) -> Result<BoundStudy> {
    let sensor = LinearSensor::new(
        &Geometry::PAPER,
        &truth.inertia_per_mass,
        truth.stiffness_per_mass_per_s2,
    )?;
    let size_m2 = truth.inertia_per_mass.xx_m2;
    let bound = |to_hz: f64| -> Result<BandBound> {
        let three = band(&sensor, size_m2, to_hz, &WEDGES[..3])?;
        Ok(BandBound {
            to_hz,
            three_directions: three.all_unknown,
            six_directions: band(&sensor, size_m2, to_hz, &WEDGES)?.all_unknown,
            scale_known: three.scale_known,
            all_else_known: three.all_else_known,
            tilted_three_directions: tilted(&sensor, size_m2, trials(to_hz, &WEDGES[..3]))?
                .bound()?
                .all_unknown,
            tilted_six_directions: tilted(&sensor, size_m2, trials(to_hz, &WEDGES))?
                .bound()?
                .all_unknown,
            tilted_linear_motion: tilted(
                &sensor,
                size_m2,
                trials(to_hz, &WEDGES[..3])
                    .filter(|(excitation, _)| excitation.angular_shell_rad_s2 == DVec3::ZERO),
            )?
            .bound_with_inertia_known()?,
        })
    };
    let decades = (CURVE_HZ.1 / CURVE_HZ.0).log10();
    let steps = (decades * POINTS_PER_DECADE).ceil() as u32;
    let curve = (0..=steps).map(|step| {
        let share = f64::from(step) / f64::from(steps);
        // Both ends exactly.
        CURVE_HZ.0.powf(1.0 - share) * CURVE_HZ.1.powf(share)
    });
    Ok(BoundStudy {
        frequencies: FREQUENCIES,
        samples: SAMPLES,
        noise_over_largest: NOISE_OVER_LARGEST,
        bands: NAMED_HZ.into_iter().map(bound).collect::<Result<_>>()?,
        curve: curve.map(bound).collect::<Result<_>>()?,
    })
}

/// The bound from linear and angular trials in one band, in linear theory.
fn band(sensor: &LinearSensor, size_m2: f64, to_hz: f64, directions: &[DVec3]) -> Result<Bound> {
    let mut information = Information::new(size_m2)?;
    for (excitation, _) in trials(to_hz, directions) {
        let response = sensor.response(&excitation)?;
        let noise_m_s2 = NOISE_OVER_LARGEST * largest(&response.force_per_mass_m_s2);
        information.push(&response, noise_m_s2, SAMPLES)?;
    }
    Ok(information.bound()?)
}

/// Information of trials with tilted limbs, centrifugal torque and gravity, and nine zero drifts of each trial unknown.
fn tilted(
    sensor: &LinearSensor,
    size_m2: f64,
    trials: impl Iterator<Item = (Excitation, DVec3)>,
) -> Result<Information> {
    let mut information = Information::new(size_m2)?;
    for (excitation, gravity) in trials {
        // The same noise: the amplifiers are set to the motion.
        let noise_m_s2 =
            NOISE_OVER_LARGEST * largest(&sensor.response(&excitation)?.force_per_mass_m_s2);
        let phase = |i: usize| TAU * i as f64 / PHASES as f64;
        let phases = (0..PHASES)
            .map(|i| sensor.tilted(&excitation, gravity, phase(i)))
            .collect::<sixaxis_core::Result<Vec<Response>>>()?;
        information.push_trial(&phases, noise_m_s2, SAMPLES)?;
    }
    Ok(information)
}

/// Linear and angular trials of a band, each with gravity along its direction, as the rig hangs the sensor.
fn trials(to_hz: f64, directions: &[DVec3]) -> impl Iterator<Item = (Excitation, DVec3)> {
    (0..FREQUENCIES).flat_map(move |step| {
        let share = step as f64 / (FREQUENCIES - 1) as f64;
        let frequency_hz = to_hz * (BAND + (1.0 - BAND) * share);
        let omega2 = (TAU * frequency_hz.min(RIG_HZ)).powi(2);
        directions.iter().flat_map(move |direction| {
            let along = direction.normalize() * omega2;
            let gravity = Mounting::AxisVertical.gravity_ground_m_s2(*direction);
            let still = DVec3::ZERO;
            [
                (along * SLIDER_AMPLITUDE_M, still),
                (still, along * ROTATION_AMPLITUDE_RAD),
            ]
            .map(|(linear, angular)| {
                let excitation = Excitation {
                    frequency_hz,
                    linear_shell_m_s2: linear,
                    angular_shell_rad_s2: angular,
                };
                (excitation, gravity)
            })
        })
    })
}

fn largest(forces: &[f64; LIMBS]) -> f64 {
    forces.iter().fold(0.0, |a, f| a.max(f.abs()))
}
