//! What the channels' noise makes of the six accelerations of a sensor at rest.

use anyhow::{Context, Result};
use sixaxis_core::{Decoupler, LIMBS, LimbSet, Scheme, Settings};

use super::setup::Setup;

/// Step of a channel about its zero drift by which the decoupler's gradient is taken, V: at rest it is linear, far beyond this.
const STEP_V: f64 = 1e-3;
/// Rate at which it is taken, Hz: what a constant voltage makes of the accelerations at rest depends on none.
const RATE_HZ: f64 = 1e6;

/// One-sided root densities of ax to az, m/s^2/root(Hz), and alpha_x to alpha_z, rad/s^2/root(Hz), at rest, from those of the nine
/// channels, V/root(Hz). Noise of different channels is independent.
///
/// # Errors
/// Parameters that are no sensor's.
pub fn axis_noise_densities(setup: &Setup, channels: &[f64; LIMBS]) -> Result<[f64; 6]> {
    let settings = setup.settings(RATE_HZ, Scheme::default());
    by_steps(channels, |limb, step_v| {
        let mut voltage_v = setup.parameters.zero_drift_v;
        voltage_v[limb] += step_v;
        let mut decoupler = Decoupler::new(&setup.sensor, &setup.parameters, &settings)?;
        let mut answer = None;
        for _ in 0..3 {
            answer = decoupler.push(&voltage_v)?.or(answer);
        }
        let answer = answer.context("three samples have an answer")?;
        Ok(vec![answer.accelerations()])
    })
}

/// Standard deviations of a sample's ax to az, m/s^2, and alpha_x to alpha_z, rad/s^2, at rest, that white noise of the channels, V,
/// gives it by itself: what it adds up to in rate and attitude is not in them. Channels of excluded limbs are not read.
///
/// # Errors
/// Parameters that are no sensor's; limbs that cannot be excluded.
pub fn sample_noise(
    setup: &Setup,
    settings: &Settings,
    excluded: LimbSet,
    noise_v: &[f64; LIMBS],
) -> Result<[f64; 6]> {
    // One sample among others that are at rest shows in its own answer and, by differences, in its neighbours'.
    by_steps(noise_v, |limb, step_v| {
        let mut decoupler =
            Decoupler::new(&setup.sensor, &setup.parameters, settings)?.excluding(excluded)?;
        let mut answers = Vec::new();
        for sample in 0..7 {
            let mut voltage_v = setup.parameters.zero_drift_v;
            voltage_v[limb] += if sample == 3 { step_v } else { 0.0 };
            answers.extend(decoupler.push(&voltage_v)?.map(|a| a.accelerations()));
        }
        Ok(answers)
    })
}

/// What independent noise of the nine channels adds up to in accelerations, whose answers to a step of one channel, V, are given.
fn by_steps(
    noise: &[f64; LIMBS],
    answers: impl Fn(usize, f64) -> Result<Vec<[f64; 6]>>,
) -> Result<[f64; 6]> {
    let mut squares = [0.0; 6];
    for (limb, noise) in noise.iter().enumerate() {
        for (more, less) in answers(limb, STEP_V)?.iter().zip(answers(limb, -STEP_V)?) {
            for (axis, square) in squares.iter_mut().enumerate() {
                let gradient = (more[axis] - less[axis]) / (2.0 * STEP_V);
                *square += (gradient * noise).powi(2);
            }
        }
    }
    Ok(squares.map(f64::sqrt))
}
