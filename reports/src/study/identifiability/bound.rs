//! What any method could know of k/m: the Cramer-Rao bound over the frequency of the excitation.

use anyhow::Result;
use core::f64::consts::TAU;
use glam::DVec3;
use sixaxis_core::identify::stiffness_bound::{Bound, Excitation, Information, LinearSensor};
use sixaxis_core::{Geometry, Parameters};
use sixaxis_reference::rig::run::WEDGES;
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

/// The bound from linear and angular trials in one band.
fn band(sensor: &LinearSensor, size_m2: f64, to_hz: f64, directions: &[DVec3]) -> Result<Bound> {
    let mut information = Information::new(size_m2)?;
    for step in 0..FREQUENCIES {
        let share = step as f64 / (FREQUENCIES - 1) as f64;
        let frequency_hz = to_hz * (BAND + (1.0 - BAND) * share);
        let omega2 = (TAU * frequency_hz.min(RIG_HZ)).powi(2);
        for direction in directions {
            let along = direction.normalize() * omega2;
            let still = DVec3::ZERO;
            for (linear, angular) in [
                (along * SLIDER_AMPLITUDE_M, still),
                (still, along * ROTATION_AMPLITUDE_RAD),
            ] {
                let response = sensor.response(&Excitation {
                    frequency_hz,
                    linear_shell_m_s2: linear,
                    angular_shell_rad_s2: angular,
                })?;
                let forces = response.force_per_mass_m_s2;
                let largest = forces.iter().fold(0.0_f64, |a, f| a.max(f.abs()));
                information.push(&response, NOISE_OVER_LARGEST * largest, SAMPLES)?;
            }
        }
    }
    Ok(information.bound()?)
}
