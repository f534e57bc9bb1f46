//! What the channels' noise makes of the six accelerations of a sensor at rest.

use anyhow::{Context, Result};
use glam::{DMat3, DQuat, DVec3};
use sixaxis_core::decouple::uncertainty::ChannelNoise;
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
    let densities = by_steps(&ChannelNoise::white(*channels), |limb, step_v| {
        let mut voltage_v = setup.parameters.zero_drift_v;
        voltage_v[limb] += step_v;
        let mut decoupler = Decoupler::new(&setup.sensor, &setup.parameters, &settings)?;
        let mut answer = None;
        for _ in 0..3 {
            answer = decoupler.push(&voltage_v)?.or(answer);
        }
        let answer = answer.context("three samples have an answer")?;
        Ok(vec![answer.accelerations()])
    })?;
    Ok(deviations(&densities))
}

/// What white noise of the channels gives a single sample's accelerations by itself: what it adds up to in rate and attitude is not in it.
#[derive(Debug, Clone, Copy)]
pub struct SampleNoise {
    /// Covariances of a, m^2/s^4, and of w', rad^2/s^4, in the shell's axes.
    shell: [DMat3; 2],
}

impl SampleNoise {
    /// For channels with this noise at rest. Channels of excluded limbs are not read.
    ///
    /// # Errors
    /// Parameters that are no sensor's; limbs that cannot be excluded.
    pub fn new(
        setup: &Setup,
        settings: &Settings,
        excluded: LimbSet,
        noise: &ChannelNoise,
    ) -> Result<Self> {
        // One sample among others that are at rest shows in its own answer and, by differences, in its neighbours'.
        let shell = by_steps(noise, |limb, step_v| {
            let mut decoupler =
                Decoupler::new(&setup.sensor, &setup.parameters, settings)?.excluding(excluded)?;
            let mut answers = Vec::new();
            for sample in 0..7 {
                let mut voltage_v = setup.parameters.zero_drift_v;
                voltage_v[limb] += if sample == 3 { step_v } else { 0.0 };
                answers.extend(decoupler.push(&voltage_v)?.map(|a| a.accelerations()));
            }
            Ok(answers)
        })?;
        Ok(Self { shell })
    }

    /// Standard deviations of a, m/s^2, and w', rad/s^2, in ground axes, of a sensor with this attitude.
    pub fn in_ground_axes(&self, attitude: DQuat) -> [f64; 6] {
        let turned = DMat3::from_quat(attitude);
        deviations(&self.shell.map(|shell| turned * shell * turned.transpose()))
    }
}

/// Roots of the diagonals of two covariances.
fn deviations(covariances: &[DMat3; 2]) -> [f64; 6] {
    core::array::from_fn(|axis| {
        let covariance = covariances[axis / 3];
        covariance.col(axis % 3)[axis % 3].max(0.0).sqrt()
    })
}

/// Covariances of a and w' that independent noise of the nine channels adds up to, whose answers to a step of one channel, V, are given,
/// sample by sample.
fn by_steps(
    noise: &ChannelNoise,
    answers: impl Fn(usize, f64) -> Result<Vec<[f64; 6]>>,
) -> Result<[DMat3; 2]> {
    let mut covariances = [DMat3::ZERO; 2];
    for (limb, white_v) in noise.white_v.iter().enumerate() {
        let pairs = answers(limb, STEP_V)?
            .into_iter()
            .zip(answers(limb, -STEP_V)?);
        let shown: Vec<[f64; 6]> = pairs
            .map(|(more, less)| {
                core::array::from_fn(|axis| (more[axis] - less[axis]) / (2.0 * STEP_V) * white_v)
            })
            .collect();
        for (lag, correlation) in noise.correlation.into_iter().enumerate() {
            if correlation == 0.0 {
                continue;
            }
            for (one, other) in shown.iter().zip(&shown[lag.min(shown.len())..]) {
                for (axes, covariance) in covariances.iter_mut().enumerate() {
                    let of = |all: &[f64; 6]| DVec3::from_slice(&all[3 * axes..]);
                    let (v, w) = (of(one), of(other) * correlation);
                    *covariance += DMat3::from_cols(v * w.x, v * w.y, v * w.z);
                    if lag > 0 {
                        *covariance += DMat3::from_cols(w * v.x, w * v.y, w * v.z);
                    }
                }
            }
        }
    }
    Ok(covariances)
}
