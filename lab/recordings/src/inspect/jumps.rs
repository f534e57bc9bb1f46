//! Where a channel leaves its own course from one sample to the next: a spike, a step, samples that are missing.
//!
//! Third differences take off what a motion is in four samples, and leave white noise with twenty times its variance. What stands far out of
//! both noise and converter steps for a few samples, and does so seldom, is no motion of a mass on springs: a blow rings.

use serde::Serialize;

/// Times its deviation by noise, and converter steps, beyond which a third difference is none of noise and rounding.
const TIMES: f64 = 25.0;
const STEPS: f64 = 20.0;
/// Variance of third differences of white noise.
const VARIANCE: f64 = 20.0;
/// Samples within which such differences are one jump, and which one lasts at most.
const APART: usize = 3;
const LONGEST: usize = 8;
/// Jumps in a piece beyond which they are how the channel moves.
const SELDOM: usize = 3;
/// Jumps kept.
const KEPT: usize = 64;

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Jump {
    /// Sample before which it is, from 0.
    pub sample: u64,
    /// Largest difference of neighbours there, signed, in the channel's unit.
    pub by: f64,
    /// Whether it goes on from there, or recurs, as what a blow or a motion makes.
    pub rings: bool,
}

/// Those of one channel.
#[derive(Debug, Clone, Default)]
pub struct Jumps {
    /// The first ones.
    pub first: Vec<Jump>,
}

impl Jumps {
    /// Looks at a piece without a gap, from this sample on, with such noise.
    pub fn look(&mut self, piece: &[f64], from: u64, noise: f64) {
        let changes = piece.windows(2).map(|w| (w[1] - w[0]).abs());
        let step = changes
            .filter(|change| *change > 0.0)
            .fold(f64::INFINITY, f64::min);
        if !step.is_finite() || self.first.len() >= KEPT {
            return;
        }
        let most = TIMES * VARIANCE.sqrt() * noise + STEPS * step;
        let mut found: Vec<(usize, usize)> = Vec::new();
        for (k, w) in piece.windows(4).enumerate() {
            if ((w[3] - w[0]) - 3.0 * (w[2] - w[1])).abs() > most {
                match found.last_mut() {
                    Some((_, last)) if k - *last <= APART => *last = k,
                    _ => found.push((k, k)),
                }
            }
        }
        let rings =
            found.len() > SELDOM || found.iter().any(|(first, last)| last - first >= LONGEST);
        if rings {
            found.truncate(1);
        }
        for (first, last) in found {
            // A difference k is of the samples k to k + 3.
            let place = (first + 1..=last + 3)
                .max_by(|a, b| change(piece, *a).abs().total_cmp(&change(piece, *b).abs()));
            self.first.extend(place.map(|place| Jump {
                sample: from + place as u64,
                by: change(piece, place),
                rings,
            }));
        }
    }
}

fn change(piece: &[f64], at: usize) -> f64 {
    piece[at] - piece[at - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: f64 = 4e-3;

    /// Volts of a 3 Hz motion at 1 kHz with noise, and what is done to them.
    fn found(spoil: impl Fn(&mut Vec<f64>)) -> Vec<Jump> {
        let mut state = 11_u64;
        let mut noise = || {
            let mut unit = || {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            };
            NOISE * ((0..12).map(|_| unit()).sum::<f64>() - 6.0)
        };
        let course = |k: usize| 5.0 * (core::f64::consts::TAU * 3e-3 * k as f64).sin();
        let mut piece: Vec<f64> = (0..4096).map(|k| course(k) + noise()).collect();
        spoil(&mut piece);
        let mut jumps = Jumps::default();
        jumps.look(&piece, 1000, NOISE);
        jumps.first.retain(|jump| !jump.rings);
        jumps.first
    }

    #[test]
    fn spikes_steps_and_missing_samples_are_found_where_they_are() {
        assert_eq!(found(|_| ()), []);
        let [spike] = found(|u| u[2000] += 3.0)[..] else {
            panic!("one spike")
        };
        assert!((3000..=3001).contains(&spike.sample) && (spike.by.abs() - 3.0).abs() < 0.2);
        let [step] = found(|u| u[700..].iter_mut().for_each(|u| *u -= 1.0))[..] else {
            panic!("one step")
        };
        assert!(
            step.sample == 1700 && (step.by + 1.0).abs() < 0.2,
            "{step:?}"
        );
        let [gap] = found(|u| {
            u.drain(1332..1340);
        })[..] else {
            panic!("one gap")
        };
        assert_eq!(gap.sample, 2332);
    }

    #[test]
    fn a_blow_that_rings_and_pulses_that_recur_are_motion() {
        let ring = |u: &mut Vec<f64>| {
            for k in 0..400 {
                let t = k as f64;
                u[1500 + k] += 5.0 * (-t / 100.0).exp() * (1.2 * t).sin();
            }
        };
        assert_eq!(found(ring), []);
        assert_eq!(
            found(|u| u.iter_mut().step_by(500).for_each(|u| *u += 3.0)),
            []
        );
    }
}
