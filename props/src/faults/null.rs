//! Healthy sensors: false alarms counted, and operating curves of a test by itself against theory.

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sixaxis_core::LIMBS;
use sixaxis_core::redundancy::fault::moments::Moments;
use sixaxis_core::redundancy::fault::{Detector, RowNoise};
use sixaxis_core::redundancy::parity::{COORDINATION, ROWS};
use sixaxis_core::significance::{chi_square_limit, chi_square_tail};

/// Samples of one stretch: whole windows of every length.
const STRETCH: u64 = 1 << 20;
const STREAM: u128 = 73;
const CURVE_STREAM: u128 = 74;

/// Alarms counted over a rate asked for.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct FalseAlarms {
    /// Asked for, per sample.
    pub rate_per_sample: f64,
    /// Channels' noise, largest over smallest.
    pub unequal: f64,
    /// Samples.
    pub samples: u64,
    /// Alarms.
    pub alarms: u64,
}

impl FalseAlarms {
    /// Counted over asked for.
    pub fn attained(&self) -> f64 {
        self.alarms as f64 / (self.rate_per_sample * self.samples as f64)
    }
}

/// Sum of white channel noise over each row.
fn rows(sd: &[f64; LIMBS], rng: &mut Pcg64) -> [f64; ROWS] {
    let noise: [f64; LIMBS] = core::array::from_fn(|i| {
        let unit: f64 = StandardNormal.sample(rng);
        sd[i] * unit
    });
    COORDINATION.map(|limbs| limbs.iter().map(|&i| noise[i]).sum())
}

/// Counts alarms of a healthy sensor, whose noise is `actual` times what the detector is told.
///
/// # Panics
/// If the detector refuses.
pub fn false_alarms(
    rate_per_sample: f64,
    unequal: f64,
    actual: f64,
    stretches: u64,
    seed: u64,
) -> FalseAlarms {
    let told: [f64; LIMBS] =
        core::array::from_fn(|i| 1e-8 * unequal.powf(i as f64 / (LIMBS - 1) as f64));
    let noise = RowNoise::from_channels(&told).expect("noise");
    let alarms = (0..stretches)
        .into_par_iter()
        .map(|stretch| {
            let mut detector = Detector::new(noise, rate_per_sample, None).expect("a rate");
            let mut rng = Pcg64::new(u128::from(seed + stretch), STREAM);
            let sd = told.map(|s| s * actual);
            (0..STRETCH)
                .map(|_| {
                    let z = noise.whiten(&rows(&sd, &mut rng));
                    detector.push(&z, &[0.0; LIMBS]).iter().count() as u64
                })
                .sum::<u64>()
        })
        .sum();
    FalseAlarms {
        rate_per_sample,
        unequal,
        samples: stretches * STRETCH,
        alarms,
    }
}

/// Operating curve of the test of a mean.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Curve {
    /// Samples of the window; 1: a sample by itself.
    pub window: u64,
    /// Number of the limb that fails.
    pub limb: usize,
    /// Size of its new zero, standard deviations.
    pub sigmas: f64,
    /// Draws.
    pub draws: u64,
    /// Probabilities of a false alarm.
    pub false_alarm: Vec<f64>,
    /// Share detected.
    pub detected: Vec<f64>,
    /// Probability of detection: noncentral chi-square.
    pub theory: Vec<f64>,
}

/// Draws windows with a limb's zero moved and counts.
///
/// # Panics
/// Never: the noise is sound.
pub fn curve(window: u64, limb: usize, sigmas: f64, draws: u64, seed: u64) -> Curve {
    let false_alarm: Vec<f64> = (0..=20)
        .map(|k| 10.0_f64.powf(-0.25 * f64::from(k)))
        .collect();
    let sd = [1.0; LIMBS];
    let noise = RowNoise::from_channels(&sd).expect("noise");
    let class = sixaxis_core::redundancy::fault::class::CLASS_OF[limb];
    let thresholds: Vec<f64> = false_alarm
        .iter()
        .map(|&p| chi_square_limit(p, 3).unwrap_or(0.0))
        .collect();
    let statistics: Vec<f64> = (0..draws)
        .into_par_iter()
        .map(|draw| {
            let mut rng = Pcg64::new(u128::from(seed) << 64 | u128::from(draw), CURVE_STREAM);
            let mut moments = Moments::default();
            for _ in 0..window {
                let mut rho = rows(&sd, &mut rng);
                for (row, of) in rho.iter_mut().zip(COORDINATION) {
                    if of.contains(&limb) {
                        *row += sigmas;
                    }
                }
                moments.push(&noise.whiten(&rho));
            }
            let [mean, _] = moments.mean_and_slope();
            mean.iter().map(|x| x * x).sum()
        })
        .collect();
    let size = sigmas * noise.length(class);
    let noncentrality = window as f64 * size * size;
    Curve {
        window,
        limb: limb + 1,
        sigmas,
        draws,
        detected: thresholds
            .iter()
            .map(|t| statistics.iter().filter(|s| *s > t).count() as f64 / draws as f64)
            .collect(),
        theory: thresholds
            .iter()
            .map(|&t| noncentral_survival(t, 3, noncentrality))
            .collect(),
        false_alarm,
    }
}

/// Probability that a noncentral chi-square variable exceeds `value`: Poisson's mixture of central ones.
pub fn noncentral_survival(value: f64, freedom: usize, noncentrality: f64) -> f64 {
    let half = 0.5 * noncentrality;
    // Ten deviations beyond the mean of the mixture's index.
    let last = (half + 10.0 * half.sqrt() + 40.0) as usize;
    let mut ln_weight = -half;
    let mut sum = 0.0;
    for k in 0..last {
        if k > 0 {
            ln_weight += (half / k as f64).ln();
        }
        sum += ln_weight.exp() * chi_square_tail(value, freedom + 2 * k).unwrap_or(f64::NAN);
    }
    sum
}
