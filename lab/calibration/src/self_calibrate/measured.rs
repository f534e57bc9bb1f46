//! A recording passed through once: moments of its blocks and, where it is asked for, the means of two rests.

use std::path::Path;

use crate::apply::conditioning_stream::ConditioningStream;
use crate::apply::explain;
use crate::apply::recording::{Batch, Recording};
use crate::apply::setup::Setup;
use crate::apply::voltages::Voltages;
use anyhow::{Result, anyhow, bail, ensure};
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::self_calibration::{Accumulator, Moments};
use sixaxis_core::{LIMBS, LimbSet, Scheme, Settings};

use super::cause::Scatter;

/// A time of rest, s from the recording's beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// From.
    pub from_s: f64,
    /// To.
    pub to_s: f64,
}

impl Rest {
    /// From `FROM-TO`.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (from, to) = text
            .split_once('-')
            .ok_or_else(|| format!("{text:?} is not FROM-TO"))?;
        let number = |text: &str| {
            text.trim()
                .parse::<f64>()
                .map_err(|_| format!("{text:?} is not a number of seconds"))
        };
        let (from_s, to_s) = (number(from)?, number(to)?);
        if from_s >= 0.0 && to_s > from_s && to_s.is_finite() {
            Ok(Self { from_s, to_s })
        } else {
            Err(format!("{text:?} does not last"))
        }
    }
}

/// Mean voltages of the second rest less those of the first.
pub struct Change {
    /// V.
    pub voltage_v: [f64; LIMBS],
    /// Standard deviations, V, from means of blocks.
    pub deviation_v: [f64; LIMBS],
}

/// What a recording holds.
pub struct Measured {
    /// Its moments.
    pub moments: Moments,
    /// Scatter of its blocks, forces by the calibration's scale factors.
    pub scatter: Scatter,
    /// Samples.
    pub samples: u64,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Samples averaged to a block.
    pub block: u32,
    /// Between two rests.
    pub change: Option<Change>,
    /// What a person should know.
    pub warnings: Vec<String>,
}

/// Block means of one rest.
#[derive(Default)]
struct Means {
    block: [f64; LIMBS],
    filled: u32,
    blocks: f64,
    mean: [f64; LIMBS],
    squares: [f64; LIMBS],
    last: [f64; LIMBS],
    /// Squares of the differences between neighbours.
    steps: [f64; LIMBS],
}

impl Means {
    fn push(&mut self, row: &[f64; LIMBS], block: u32) {
        for (sum, u) in self.block.iter_mut().zip(row) {
            *sum += u;
        }
        self.filled += 1;
        if self.filled == block {
            self.blocks += 1.0;
            for i in 0..LIMBS {
                let x = self.block[i] / f64::from(block);
                if self.blocks > 1.0 {
                    self.steps[i] += (x - self.last[i]) * (x - self.last[i]);
                }
                self.last[i] = x;
                let from_old = x - self.mean[i];
                self.mean[i] += from_old / self.blocks;
                self.squares[i] += from_old * (x - self.mean[i]);
            }
            self.block = [0.0; LIMBS];
            self.filled = 0;
        }
    }

    /// A channel that moves slowly in it, and by how much, V (root mean square). Noise varies as much from block to block as over all of them; a
    /// drift is no motion as long as it is small beside the largest change between the rests, V. Motion faster than eight blocks or so is not
    /// seen, and its mean is none.
    fn moves(&self, largest_v: f64) -> Option<(usize, f64)> {
        let deviation = |limb: usize| (self.squares[limb] / (self.blocks - 1.0)).sqrt();
        let moving = |limb: &usize| {
            let as_noise = self.squares[*limb] <= MOVES * 0.5 * self.steps[*limb];
            !as_noise && deviation(*limb) > OF_CHANGE * largest_v
        };
        let limb = (0..LIMBS)
            .filter(moving)
            .max_by(|a, b| deviation(*a).total_cmp(&deviation(*b)))?;
        Some((limb, deviation(limb)))
    }

    /// Variance of the mean.
    fn variance(&self, limb: usize) -> f64 {
        self.squares[limb] / (self.blocks - 1.0) / self.blocks
    }
}

/// Samples beyond the converter's range that may be wild ones.
const WILD: u64 = 10;
/// Blocks that a rest must have.
const FEWEST_BLOCKS: f64 = 8.0;
/// Variance of a rest's blocks, over half the mean square of their steps: 1 of noise. Eight blocks of white noise exceed it once in 16,000 times.
const MOVES: f64 = 8.0;
/// Deviation of a rest's blocks over the largest change between the rests, from which it bends that change.
const OF_CHANGE: f64 = 0.01;

impl Measured {
    /// Reads a recording from end to end, conditioned as `sixaxis decouple` does it.
    ///
    /// # Errors
    /// A recording that cannot be read, or is shorter than a block; rests that are too short.
    pub fn of(
        path: &Path,
        setup: &Setup,
        rests: Option<[Rest; 2]>,
        advance: &dyn Fn(u64, u64),
    ) -> Result<Self> {
        let mut recording = Recording::open(
            path,
            &setup.channels,
            LimbSet::EMPTY,
            setup.rate_hz,
            setup.full_scale_v,
        )?;
        let sample_rate_hz = recording.sample_rate_hz;
        // How limbs share a load at rest is part of what is asked: of any ratios the calibration says nothing here.
        let settings = Settings {
            stiffness_ratio: [1.0; LIMBS],
            ..setup.settings(sample_rate_hz, Scheme::Heun)
        };
        let mut conditioning = ConditioningStream::new(&setup.conditioning, sample_rate_hz)?;
        let mut taken = Accumulator::of_usual_blocks(&setup.sensor, &setup.parameters, &settings)?;
        let chain = SignalChain::new(&setup.sensor.gains, &setup.parameters);
        let mut scatter = Scatter::new(*chain.sensitivity_m_s2_per_v(), taken.block());
        let (place, names) = (path.display().to_string(), recording.names.clone());
        let mut means = [Means::default(), Means::default()];
        let mut take = |ready: &Voltages| -> Result<()> {
            for row in ready.rows() {
                let time_s = taken.samples() as f64 / sample_rate_hz;
                taken
                    .push(&row)
                    .map_err(|error| explain(&error, &place, &names))?;
                scatter.push(&row);
                for (rest, means) in rests.iter().flatten().zip(&mut means) {
                    if (rest.from_s..rest.to_s).contains(&time_s) {
                        means.push(&row, taken.block());
                    }
                }
            }
            Ok(())
        };
        let total = recording.samples.unwrap_or(0);
        let (mut batch, mut ready) = (Batch::default(), Voltages::default());
        while recording.read(&mut batch)? {
            conditioning.push(&mut batch.voltage_v, &mut ready);
            take(&ready)?;
            ready.clear();
            advance(total, batch.times_s.len() as u64);
        }
        conditioning.finish(&mut ready)?;
        take(&ready)?;
        let change = match rests {
            None => None,
            Some(rests) => {
                for (rest, means) in rests.iter().zip(&means) {
                    ensure!(
                        means.blocks >= FEWEST_BLOCKS,
                        "--rests: {}-{} s of {place} holds {} blocks of {} samples; {FEWEST_BLOCKS} are needed",
                        rest.from_s,
                        rest.to_s,
                        means.blocks,
                        taken.block()
                    );
                }
                let [a, b] = &means;
                let voltage_v: [f64; LIMBS] = core::array::from_fn(|i| b.mean[i] - a.mean[i]);
                let largest_v = voltage_v.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
                for (rest, means) in rests.iter().zip(&means) {
                    if let Some((limb, by_v)) = means.moves(largest_v) {
                        bail!(
                            "--rests: in {}-{} s of {place} the sensor does not rest: channel {} moves slowly by {by_v:.2e} V (root mean square)",
                            rest.from_s,
                            rest.to_s,
                            names[limb]
                        );
                    }
                }
                Some(Change {
                    voltage_v,
                    deviation_v: core::array::from_fn(|i| (a.variance(i) + b.variance(i)).sqrt()),
                })
            }
        };
        let moments = taken.moments();
        ensure!(
            moments.blocks() > 0,
            "{place}: {} samples are less than a block of {}",
            recording.seen.samples,
            taken.block()
        );
        let beyond = recording.is_beyond_converter();
        ensure!(
            !beyond || recording.seen.clipped.iter().sum::<u64>() <= WILD,
            "{}: nothing is said of limbs",
            recording.warnings().join("; ")
        );
        Ok(Self {
            moments,
            scatter,
            samples: recording.seen.samples,
            sample_rate_hz,
            block: taken.block(),
            change,
            warnings: recording.warnings(),
        })
    }

    /// What the ratios of these blocks cannot be found for, in samples and seconds.
    pub fn explained(&self, place: &Path, error: sixaxis_core::Error) -> anyhow::Error {
        if let sixaxis_core::Error::TooFewSamples { needed, got, .. } = error {
            let block = self.block as f64;
            return anyhow!(
                "{}: {} samples are {got} blocks of {block}, and {needed} are needed: record {:.1} s in motion or more",
                place.display(),
                self.samples,
                needed as f64 * block / self.sample_rate_hz
            );
        }
        anyhow::Error::new(error).context(place.display().to_string())
    }
}
