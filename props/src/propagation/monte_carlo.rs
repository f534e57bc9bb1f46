//! Campaigns drawn, calibrated and summed up; the same to the last bit on any number of threads.

use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;
use sixaxis_calibration::conditioning::Conditioning;
use sixaxis_calibration::propagation::{Propagated, Sources, propagate};
use sixaxis_calibration::steps::{Campaign, GyroscopeGain};
use sixaxis_calibration::trial::Trial;
use sixaxis_core::SixAxis;
use sixaxis_core::decouple::uncertainty::parameters::Covariance;
use sixaxis_core::decouple::uncertainty::{ChannelNoise, SampleUncertainty};
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::{Geometry, LIMBS, LimbSet, Scheme};

use super::{World, calibrate, identified};

/// Six accelerations: linear, m/s^2, then angular, rad/s^2, ground axes.
pub const AXES: usize = 6;

/// Draws that are summed up one after the other, whatever thread does it.
const CHUNK: u64 = 50;

/// Sums over draws of departures from what is found without errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Tally {
    /// Draws.
    pub draws: usize,
    sum: SVector<f64, PARAMETERS>,
    squares: Covariance,
    /// For each compound run, for each decoupled sample.
    samples: Vec<Vec<[[f64; 2]; AXES]>>,
}

/// Accelerations of every compound run.
type Runs = Vec<Vec<[f64; AXES]>>;

fn decoupled(campaign: &Campaign, compound: &[Trial]) -> Runs {
    let (parameters, _) = identified(campaign);
    compound
        .iter()
        .map(|trial| {
            World::decouple(trial, &parameters)
                .iter()
                .map(SixAxis::accelerations)
                .collect()
        })
        .collect()
}

impl Tally {
    fn empty(runs: &Runs) -> Self {
        Self {
            draws: 0,
            sum: SVector::zeros(),
            squares: Covariance::zeros(),
            samples: runs
                .iter()
                .map(|run| vec![[[0.0; 2]; AXES]; run.len()])
                .collect(),
        }
    }

    fn append(&mut self, other: &Self) {
        self.draws += other.draws;
        self.sum += other.sum;
        self.squares += other.squares;
        let ours = self.samples.iter_mut().flatten().flatten();
        for (a, b) in ours.zip(other.samples.iter().flatten().flatten()) {
            a[0] += b[0];
            a[1] += b[1];
        }
    }

    /// Draws campaigns from consecutive seeds; without compound runs about as fast again.
    pub fn draw(world: &World, sources: &Sources, first_seed: u64, draws: u64) -> Self {
        let found = calibrate(&world.clean);
        let runs = decoupled(&world.clean, &world.compound);
        let chunks: Vec<u64> = (0..draws).step_by(CHUNK as usize).collect();
        let tallies: Vec<Self> = chunks
            .into_par_iter()
            .map(|from| {
                let mut tally = Self::empty(&runs);
                for draw in from..(from + CHUNK).min(draws) {
                    let (campaign, compound) = world.draw(sources, first_seed + draw);
                    let error = calibrate(&campaign) - found;
                    tally.draws += 1;
                    tally.sum += error;
                    tally.squares += error * error.transpose();
                    let seen = decoupled(&campaign, &compound);
                    let sums = tally.samples.iter_mut().flatten().flatten();
                    let ours = seen.iter().flatten().flatten();
                    for (sum, (a, b)) in sums.zip(ours.zip(runs.iter().flatten().flatten())) {
                        sum[0] += a - b;
                        sum[1] += (a - b) * (a - b);
                    }
                }
                tally
            })
            .collect();
        let mut all = Self::empty(&runs);
        // In the order of the seeds.
        for tally in &tallies {
            all.append(tally);
        }
        all
    }

    /// Covariance of the 25 that the draws show.
    pub fn covariance(&self) -> Covariance {
        let n = self.draws as f64;
        (self.squares - self.sum * self.sum.transpose() / n) / (n - 1.0)
    }

    /// Standard deviations of the accelerations, for each compound run, for each decoupled sample.
    pub fn accelerations(&self) -> Runs {
        let n = self.draws as f64;
        let deviation = |[sum, squares]: [f64; 2]| ((squares - sum * sum / n) / (n - 1.0)).sqrt();
        self.samples
            .iter()
            .map(|run| run.iter().map(|axes| axes.map(deviation)).collect())
            .collect()
    }
}

/// What the closed form says of one campaign, recorded with errors as any other, and of its compound runs.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedForm {
    /// The 25 parameters.
    pub propagated: Propagated,
    /// Standard deviations for each compound run, for each decoupled sample.
    pub accelerations: Runs,
    /// Of the attitude: root of the sum of squares over the axes, rad.
    pub attitude_rad: Vec<Vec<f64>>,
}

impl ClosedForm {
    /// From the recordings of one draw: the propagation sees no truth.
    ///
    /// # Panics
    /// If a step refuses.
    pub fn of(world: &World, sources: &Sources, seed: u64) -> Self {
        let (campaign, compound) = world.draw(sources, seed);
        let propagated = of_campaign(&campaign, &world.conditioning, sources);
        let (parameters, _) = identified(&campaign);
        let noise = ChannelNoise::white([world.noise_v; LIMBS]);
        let (accelerations, attitude_rad) = compound
            .iter()
            .map(|trial| {
                let mut stream = SampleUncertainty::new(
                    &trial.sensor(Geometry::PAPER),
                    &parameters,
                    &trial.settings(Scheme::Heun),
                    LimbSet::EMPTY,
                    &propagated.total(),
                    &noise,
                )
                .expect("a covariance of the chain is one");
                World::decouple(trial, &parameters)
                    .iter()
                    .map(|s| {
                        let spread = stream
                            .push(&trial.voltage_v[s.sample as usize], s)
                            .expect("a run of the rig has finite errors");
                        (spread.accelerations(), spread.attitude_shell_rad.length())
                    })
                    .unzip()
            })
            .unzip();
        Self {
            propagated,
            accelerations,
            attitude_rad,
        }
    }
}

/// The propagation for one campaign's recordings, the gyroscope trusted.
///
/// # Panics
/// If a step refuses.
pub fn of_campaign(
    campaign: &Campaign,
    conditioning: &Conditioning,
    sources: &Sources,
) -> Propagated {
    let steps = campaign
        .identify(GyroscopeGain::Trusted)
        .expect("the four steps are possible");
    propagate(campaign, conditioning, &steps, sources)
        .expect("what can be conditioned can be propagated")
}

/// Standard deviations of closed form over drawn ones, less one.
pub fn departures(closed: &Covariance, drawn: &Covariance) -> [f64; PARAMETERS] {
    core::array::from_fn(|i| (closed[(i, i)] / drawn[(i, i)]).sqrt() - 1.0)
}

/// Correlations of a covariance.
pub fn correlations(covariance: &Covariance) -> Covariance {
    SMatrix::from_fn(|i, j| covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt())
}

/// Largest and root mean square departure of one axis over a run, closed form over drawn less one.
pub fn run_departure(closed: &[[f64; AXES]], drawn: &[[f64; AXES]], axis: usize) -> [f64; 2] {
    let (mut largest, mut squares) = (0.0_f64, 0.0);
    for (a, b) in closed.iter().zip(drawn) {
        let departure = a[axis] / b[axis] - 1.0;
        // NaN must not be passed over.
        largest = if departure.is_nan() {
            f64::NAN
        } else {
            largest.max(departure.abs())
        };
        squares += departure * departure;
    }
    [largest, (squares / drawn.len() as f64).sqrt()]
}
