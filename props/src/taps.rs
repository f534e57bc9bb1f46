//! Taps to judge the fit of k/m by: random sensors, blows and errors of what is known beforehand, and what became of them.

mod bound;

use crate::truth;
pub use bound::{States, bound_ln};
use nalgebra::Matrix6;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use sixaxis_core::identify::tap::{Setup, Tap, identify};
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::significance::NORMAL_95;
use sixaxis_core::{Geometry, InertiaPerMass, LIMBS, Parameters, Sensor};
use sixaxis_reference::mujoco::model::DAMPING_RATIO;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::mujoco::simulate;
use sixaxis_reference::mujoco::simulation::SimulationError;
use sixaxis_reference::paper;
use sixaxis_reference::rig;
use sixaxis_reference::rig::run::Mounting;
use sixaxis_reference::rig::tap::{DURATION_S, SAMPLE_RATE_HZ, STEPS_PER_SAMPLE};

/// Standard deviation of the noise over the largest channel's peak that the bars are set at.
pub const NOISE_SHARE: f64 = 0.01;
/// Standard deviation of what step 2 leaves of each channel's gain, and step 3 of I/m over its mean moment.
pub const KNOWN_TO: f64 = 0.005;
/// Limit of the converter, V.
pub const FULL_SCALE_V: f64 = 10.0;

/// Random stream of taps.
const STREAM: u128 = 32;

/// One tap: truth, blow and what the laboratory believes.
#[derive(Debug, Clone)]
pub struct Case {
    /// Seed that it was drawn with.
    pub seed: u64,
    /// The sensor.
    pub truth: Parameters,
    /// Damping of one limb, of critical under the whole mass.
    pub damping_ratio: f64,
    /// The blow.
    pub tap: rig::tap::Tap,
    /// Scale factors and I/m with their errors, k/m of the design.
    pub known: Parameters,
    rng: Pcg64,
}

/// A recorded tap with the forces behind it.
#[derive(Debug, Clone)]
pub struct Recorded {
    /// Geometry and ranges.
    pub sensor: Sensor,
    /// What is on disk.
    pub voltage_v: Vec<[f64; LIMBS]>,
    /// Changes of the true limb forces per mass since the first sample, m/s^2.
    pub force_per_mass_m_s2: Vec<[f64; LIMBS]>,
    /// Standard deviation of the noise in it.
    pub noise_v: f64,
}

impl Case {
    /// Draws a sensor, a tap and errors of what is known beforehand.
    pub fn random(seed: u64) -> Self {
        let mut rng = Pcg64::new(u128::from(seed), STREAM);
        let truth = truth::random_parameters(&mut rng);
        let tap = rig::tap::Tap::random(&mut rng);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let inertia = truth.inertia_per_mass.to_paper_order();
        let deviation = inertia_deviation_m2(&truth);
        let known = Parameters {
            scale_per_mass_per_kg: truth
                .scale_per_mass_per_kg
                .map(|s| s * (KNOWN_TO * normal()).exp()),
            inertia_per_mass: InertiaPerMass::from_paper_order(
                inertia.map(|i| i + deviation * normal()),
            ),
            stiffness_per_mass_per_s2: paper::DESIGN_STIFFNESS_PER_MASS_PER_S2,
            ..truth
        };
        Self {
            seed,
            truth,
            damping_ratio: DAMPING_RATIO,
            tap,
            known,
            rng,
        }
    }

    /// The sensor as MuJoCo has it.
    pub fn model(&self) -> SensorModel {
        let gravity_ground_m_s2 = Mounting::AxisVertical.gravity_ground_m_s2(glam::DVec3::Z);
        SensorModel {
            damping_ratio: self.damping_ratio,
            ..truth::model(&self.truth, gravity_ground_m_s2)
        }
    }

    /// Plays it in MuJoCo and records it with noise of the given share of the largest channel's peak.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn record(&self, noise_share: f64) -> Result<Recorded, SimulationError> {
        self.record_stepped(noise_share, STEPS_PER_SAMPLE)
    }

    /// As [`Self::record`] with another step of the simulation.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn record_stepped(
        &self,
        noise_share: f64,
        steps: usize,
    ) -> Result<Recorded, SimulationError> {
        let motion = simulate(&self.model(), &self.tap, DURATION_S, SAMPLE_RATE_HZ, steps)?;
        Ok(self.measured(motion.limb_force_per_mass_m_s2, noise_share))
    }

    /// The measuring chain: ranges that fit, noise of one size in all channels.
    pub fn measured(&self, force: Vec<[f64; LIMBS]>, noise_share: f64) -> Recorded {
        let gains = truth::amplifier_ranges(&force, &self.truth);
        let rest = force[0];
        let force_per_mass_m_s2: Vec<[f64; LIMBS]> = force
            .iter()
            .map(|row| core::array::from_fn(|i| row[i] - rest[i]))
            .collect();
        let chain = SignalChain::new(&gains, &self.truth);
        let peak_v = force_per_mass_m_s2
            .iter()
            .flat_map(|row| chain.voltage_change_v(row))
            .fold(0.0_f64, |a, u| a.max(u.abs()));
        let noise_v = noise_share * peak_v;
        let mut rng = self.rng.clone();
        let sensor = truth::sensor(&self.truth);
        let voltage_v = force_per_mass_m_s2
            .iter()
            .map(|row| {
                let voltage_v = sensor.voltage_v(row, &gains.gain_n_per_v);
                voltage_v.map(|u| {
                    let unit: f64 = StandardNormal.sample(&mut rng);
                    u + noise_v * unit
                })
            })
            .collect();
        Recorded {
            sensor: Sensor {
                geometry: Geometry::PAPER,
                gains,
            },
            voltage_v,
            force_per_mass_m_s2,
            noise_v,
        }
    }

    /// What the fit is told.
    pub fn setup<'a>(&'a self, sensor: &'a Sensor) -> Setup<'a> {
        let deviation = inertia_deviation_m2(&self.truth);
        Setup {
            sensor,
            parameters: &self.known,
            inertia_covariance_m4: Matrix6::identity() * (deviation * deviation),
            gain_deviation: [KNOWN_TO; LIMBS],
            sample_rate_hz: SAMPLE_RATE_HZ,
            full_scale_v: FULL_SCALE_V,
        }
    }

    /// Identifies k/m from a recording.
    ///
    /// # Errors
    /// Those of [`identify`].
    pub fn identify(&self, recorded: &Recorded) -> sixaxis_core::Result<Tap> {
        identify(&self.setup(&recorded.sensor), &recorded.voltage_v)
    }

    /// Error of ln k/m.
    pub fn error_ln(&self, tap: &Tap) -> f64 {
        (tap.stiffness_per_mass_per_s2 / self.truth.stiffness_per_mass_per_s2).ln()
    }
}

/// Standard deviation of what is known of each of I1 to I6 over m, m^2.
fn inertia_deviation_m2(truth: &Parameters) -> f64 {
    let [xx, yy, zz, ..] = truth.inertia_per_mass.to_paper_order();
    KNOWN_TO * (xx + yy + zz) / 3.0
}

/// What became of one tap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Seed of the case.
    pub seed: u64,
    /// Error of ln k/m.
    pub error_ln: f64,
    /// Standard error that the fit states.
    pub stated_ln: f64,
    /// Cramér-Rao bound of the samples that it used.
    pub bound_ln: f64,
    /// Whether the fit calls k/m determined.
    pub determined: bool,
}

impl Outcome {
    /// Plays, records and identifies one random tap.
    ///
    /// # Errors
    /// The refusal or the failure of the simulation, as text with the seed.
    pub fn of(seed: u64, damping_ratio: f64, noise_share: f64) -> Result<Self, String> {
        let at = |error: &dyn core::fmt::Display| format!("seed {seed}: {error}");
        let case = Case {
            damping_ratio,
            ..Case::random(seed)
        };
        let recorded = case.record(noise_share).map_err(|e| at(&e))?;
        let tap = case.identify(&recorded).map_err(|e| at(&e))?;
        Ok(Self {
            seed,
            error_ln: case.error_ln(&tap),
            stated_ln: tap.standard_error_ln,
            bound_ln: bound_ln(&case, &recorded, &tap.fitted),
            determined: tap.verdict.is_determined(),
        })
    }
}

/// Many taps at one damping.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Damping of one limb, of critical under the whole mass.
    pub damping_ratio: f64,
    /// Taps.
    pub taps: usize,
    /// Taps refused or called undetermined.
    pub refused: usize,
    /// Root mean square of the errors of ln k/m.
    pub rms_error_ln: f64,
    /// Of the bound of one tap: median and largest.
    pub median_bound_ln: f64,
    /// See `median_bound_ln`.
    pub largest_bound_ln: f64,
    /// Share of taps whose bound is 1e-3 or less.
    pub share_within_bar: f64,
    /// Standard deviation of error over bound.
    pub deviation_over_bound: f64,
    /// Mean of error over bound.
    pub bias_over_bound: f64,
    /// Share of 95 % intervals that hold the truth.
    pub coverage_95: f64,
}

/// Standard deviation of ln k/m that is asked for.
const BAR_LN: f64 = 1e-3;

impl Tally {
    /// Counts; none of no outcome at all.
    pub fn of(damping_ratio: f64, taps: usize, outcomes: &[Outcome]) -> Self {
        let used: Vec<&Outcome> = outcomes.iter().filter(|o| o.determined).collect();
        let n = used.len() as f64;
        let mean = |of: &dyn Fn(&Outcome) -> f64| used.iter().map(|o| of(o)).sum::<f64>() / n;
        let bias_over_bound = mean(&|o| o.error_ln / o.bound_ln);
        let mut bounds: Vec<f64> = used.iter().map(|o| o.bound_ln).collect();
        bounds.sort_unstable_by(f64::total_cmp);
        Self {
            damping_ratio,
            taps,
            refused: taps - used.len(),
            rms_error_ln: mean(&|o| o.error_ln * o.error_ln).sqrt(),
            median_bound_ln: bounds.get(bounds.len() / 2).copied().unwrap_or(f64::NAN),
            largest_bound_ln: bounds.last().copied().unwrap_or(f64::NAN),
            share_within_bar: mean(&|o| f64::from(u8::from(o.bound_ln <= BAR_LN))),
            deviation_over_bound: mean(&|o| (o.error_ln / o.bound_ln - bias_over_bound).powi(2))
                .sqrt(),
            bias_over_bound,
            coverage_95: mean(&|o| {
                f64::from(u8::from(o.error_ln.abs() <= NORMAL_95 * o.stated_ln))
            }),
        }
    }
}
