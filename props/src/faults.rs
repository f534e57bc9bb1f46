//! Limbs that fail, to judge detection and isolation by: random sensors in six-axis motion, failures of stated size, and what the
//! monitor said of them.
//!
//! The motion is closed form: whatever smooth course the mass's pose takes in the shell is that of some motion of the shell, and
//! the nine elongations of a pose are exact. So the rows are held to second order, and truth needs no simulator.

pub mod dying;
pub mod laboratories;
pub mod null;
pub mod tally;
pub mod watched;

use core::f64::consts::TAU;

use crate::truth;
use glam::DVec3;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::fault::{Event, Kind, Monitor, Verdict, Watch};
use sixaxis_core::redundancy::tolerant::ROWS_KEPT;
use sixaxis_core::{FaultTolerant, Geometry, LIMBS, Parameters, Sensor, Settings};
use sixaxis_reference::laboratory::chain::Chain;

/// Samples per second.
pub const SAMPLE_RATE_HZ: f64 = 10_000.0;
/// Alarms of a healthy sensor that are accepted.
pub const FALSE_ALARMS_PER_HOUR: f64 = 1.0;
/// Samples before the failure: at least, and up to as many more.
const HEALTHY: u64 = 4096;
/// Samples after the failure at which a trial ends at the latest.
const LONGEST: u64 = 80_000;
/// Course of a drift to its size, and of a burst.
const DRIFT_SAMPLES: u64 = 10_000;
/// See [`DRIFT_SAMPLES`].
const BURST_SAMPLES: u64 = 3_000;
/// Highest frequency of the motion, Hz, and what a sine of it moves the mass by, m.
const HIGHEST_HZ: f64 = 5.0;
const MOVED_M: f64 = 1e-7;
const SINES: usize = 3;
/// Random streams.
const STREAM: u128 = 71;
const NOISE_STREAM: u128 = 72;

/// A sensor and its motion.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Geometry and ranges.
    pub sensor: Sensor,
    /// True parameters, which the monitor knows.
    pub parameters: Parameters,
    /// Noise of one sample, V.
    pub noise_v: [f64; LIMBS],
    chain: SignalChain,
    sines: [[(f64, DVec3, DVec3); SINES]; 2],
    /// Root mean square of each channel's signal, counted from its zero, V.
    pub signal_v: [f64; LIMBS],
}

impl Scene {
    /// Draws one. Channels' noise is that of a chain of 60 dB, times a factor of each channel's own of up to `unequal`.
    pub fn random(seed: u64, unequal: f64) -> Self {
        Self::draw(seed, unequal, None)
    }

    /// The same with scale factors that differ from their mean by up to a share `spread`, and one range of all amplifiers: nearly the same
    /// strain per volt.
    pub fn alike(seed: u64, spread: f64) -> Self {
        Self::draw(seed, 1.0, Some(spread))
    }

    fn draw(seed: u64, unequal: f64, alike: Option<f64>) -> Self {
        let mut rng = Pcg64::new(u128::from(seed), STREAM);
        let mut parameters = truth::random_parameters(&mut rng);
        if let Some(spread) = alike {
            let scale = &mut parameters.scale_per_mass_per_kg;
            let mean = scale.iter().sum::<f64>() / LIMBS as f64;
            *scale = core::array::from_fn(|_| {
                let uniform: f64 = StandardUniform.sample(&mut rng);
                mean * (1.0 + spread * (2.0 * uniform - 1.0))
            });
        }
        let mut uniform = || -> f64 { StandardUniform.sample(&mut rng) };
        let mut axis =
            |size: f64| DVec3::from_array([0; 3].map(|_| size * (2.0 * uniform() - 1.0)));
        let geometry = Geometry::PAPER;
        let sizes = [MOVED_M, MOVED_M / geometry.half_edge_m];
        let sines = sizes.map(|size| {
            core::array::from_fn(|k| {
                let frequency_hz = HIGHEST_HZ * (k + 1) as f64 / SINES as f64;
                (TAU * frequency_hz, axis(size), axis(TAU))
            })
        });
        let noise = Chain::laboratory().noise_v();
        let noise_v = core::array::from_fn(|_| noise * unequal.powf(uniform()));
        let mut scene = Self {
            sensor: Sensor {
                geometry,
                gains: sixaxis_core::Gains::uniform(1.0),
            },
            chain: SignalChain::new(&sixaxis_core::Gains::uniform(1.0), &parameters),
            parameters,
            noise_v,
            sines,
            signal_v: [0.0; LIMBS],
        };
        // Two seconds at 200 Hz: a period and more of every sine.
        let course: Vec<[f64; LIMBS]> = (0..400).map(|k| scene.force_m_s2(50 * k)).collect();
        let mut from_zero = vec![[0.0; LIMBS]];
        from_zero.extend(&course);
        scene.sensor.gains = truth::amplifier_ranges(&from_zero, &parameters);
        if alike.is_some() {
            let widest = scene
                .sensor
                .gains
                .gain_n_per_v
                .into_iter()
                .fold(0.0, f64::max);
            scene.sensor.gains = sixaxis_core::Gains::uniform(widest);
        }
        scene.chain = SignalChain::new(&scene.sensor.gains, &parameters);
        scene.signal_v = core::array::from_fn(|i| {
            let sum: f64 = course
                .iter()
                .map(|force| (scene.chain.voltage_v(force)[i] - parameters.zero_drift_v[i]).powi(2))
                .sum();
            (sum / course.len() as f64).sqrt()
        });
        scene
    }

    fn force_m_s2(&self, sample: u64) -> [f64; LIMBS] {
        let time_s = sample as f64 / SAMPLE_RATE_HZ;
        let [position, rotation] = self.sines.map(|sines| {
            sines
                .iter()
                .map(|(omega, size, phase)| {
                    let angle = *phase + DVec3::splat(omega * time_s);
                    *size * DVec3::from_array(angle.to_array().map(f64::sin))
                })
                .sum::<DVec3>()
        });
        let pose = Pose {
            position_shell_m: position,
            rotation_rad: rotation,
        };
        let stiffness = self.parameters.stiffness_per_mass_per_s2;
        pose.elongations_m(&self.sensor.geometry)
            .map(|e| -stiffness * e)
    }

    /// Voltages without noise.
    pub fn voltage_v(&self, sample: u64) -> [f64; LIMBS] {
        self.chain.voltage_v(&self.force_m_s2(sample))
    }

    /// A monitor that knows the sensor and its noise.
    ///
    /// # Panics
    /// If it refuses a sound sensor.
    pub fn monitor(&self, false_alarms_per_hour: f64) -> Monitor {
        let (watch, settings) = self.watch(false_alarms_per_hour);
        Monitor::new(&self.sensor, &self.parameters, &settings, &watch).expect("a sound sensor")
    }

    /// A decoupler with that monitor.
    ///
    /// # Panics
    /// As [`Self::monitor`].
    pub fn stream(&self, false_alarms_per_hour: f64) -> FaultTolerant<Vec<[f64; LIMBS]>> {
        let (watch, settings) = self.watch(false_alarms_per_hour);
        let rows = vec![[0.0; LIMBS]; ROWS_KEPT];
        FaultTolerant::new(&self.sensor, &self.parameters, &settings, &watch, rows)
            .expect("a sound sensor")
    }

    fn watch(&self, false_alarms_per_hour: f64) -> (Watch, Settings) {
        let watch = Watch::exact(false_alarms_per_hour, self.noise_v);
        (watch, Settings::new(SAMPLE_RATE_HZ))
    }
}

/// A failure to inject.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// How.
    pub kind: Name,
    /// Limb, from 0; of a swapped pair the first.
    pub limb: usize,
    /// The second of a swapped pair.
    pub other: usize,
    /// Size in standard deviations of the channel's noise: of the new zero; of where a drift arrives; of the deviation of the
    /// signal, rms, that another sensitivity makes; of a burst. Dead, stuck and swapped have the size that the motion gives.
    pub sigmas: f64,
}

/// Kinds that are injected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Name {
    /// Noise about the zero.
    Dead,
    /// The last value.
    Stuck,
    /// Another sensitivity.
    ScaleJump,
    /// Another zero.
    Offset,
    /// A ramp.
    Drift,
    /// More noise.
    NoiseBurst,
    /// Two channels for one another.
    Swapped,
}

impl Name {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Dead,
        Self::Stuck,
        Self::ScaleJump,
        Self::Offset,
        Self::Drift,
        Self::NoiseBurst,
        Self::Swapped,
    ];

    /// As the monitor names it.
    pub const fn kind(self) -> Kind {
        match self {
            Self::Dead => Kind::Dead,
            Self::Stuck => Kind::Stuck,
            Self::ScaleJump => Kind::ScaleJump,
            Self::Offset => Kind::Offset,
            Self::Drift => Kind::Drift,
            Self::NoiseBurst => Kind::NoiseBurst,
            Self::Swapped => Kind::Swapped,
        }
    }
}

/// What the monitor said of one failure.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outcome {
    /// An alarm before the failure.
    pub alarmed_before: bool,
    /// Samples from the failure to the alarm.
    pub alarm_after: Option<u64>,
    /// Samples from the failure to the class.
    pub isolated_after: Option<u64>,
    /// The class, or the pair.
    pub isolated: Option<Verdict>,
    /// The last word, and samples from the failure to it.
    pub identified: Option<(Verdict, u64)>,
}

/// Plays a motion with a failure to a monitor until it has had its say.
pub fn trial(seed: u64, fault: &Fault) -> Outcome {
    let scene = Scene::random(seed, 1.0);
    let mut monitor = scene.monitor(FALSE_ALARMS_PER_HOUR);
    let mut rng = Pcg64::new(u128::from(seed), NOISE_STREAM);
    let uniform: f64 = StandardUniform.sample(&mut rng);
    let onset = HEALTHY + (uniform * HEALTHY as f64) as u64;
    let mut outcome = Outcome::default();
    let mut last = [0.0; LIMBS];
    for sample in 0..onset + LONGEST {
        let clean = scene.voltage_v(sample);
        let mut u = noisy(&scene, clean, &mut rng);
        if sample >= onset {
            u = failed(&scene, fault, u, &last, sample - onset, &mut rng);
        } else {
            last = u;
        }
        let after = sample.saturating_sub(onset);
        match monitor.push(&u) {
            Some(Event::Alarm(_)) if sample < onset => outcome.alarmed_before = true,
            Some(Event::Alarm(_)) => {
                outcome.alarm_after.get_or_insert(after);
            }
            Some(Event::Isolated(verdict)) if sample >= onset => {
                outcome.isolated_after.get_or_insert(after);
                outcome.isolated.get_or_insert(verdict);
            }
            Some(Event::Identified(verdict)) if sample >= onset => {
                outcome.isolated_after.get_or_insert(after);
                outcome.isolated.get_or_insert(verdict);
                outcome.identified = Some((verdict, after));
                break;
            }
            _ => {}
        }
    }
    outcome
}

/// Adds the channels' noise.
pub fn noisy(scene: &Scene, clean: [f64; LIMBS], rng: &mut Pcg64) -> [f64; LIMBS] {
    core::array::from_fn(|i| {
        let unit: f64 = StandardNormal.sample(rng);
        clean[i] + scene.noise_v[i] * unit
    })
}

/// What a failed channel makes of recorded voltages, `after` samples into the failure; `last` is the last sound row.
pub fn failed(
    scene: &Scene,
    fault: &Fault,
    mut u: [f64; LIMBS],
    last: &[f64; LIMBS],
    after: u64,
    rng: &mut Pcg64,
) -> [f64; LIMBS] {
    let i = fault.limb;
    let (sd, zero) = (scene.noise_v[i], scene.parameters.zero_drift_v[i]);
    let size_v = fault.sigmas * sd;
    let mut unit = || -> f64 { StandardNormal.sample(rng) };
    match fault.kind {
        Name::Dead => u[i] = zero + sd * unit(),
        Name::Stuck => u[i] = last[i],
        Name::ScaleJump => u[i] = zero + (u[i] - zero) * (1.0 + size_v / scene.signal_v[i]),
        Name::Offset => u[i] += size_v,
        Name::Drift => u[i] += size_v * after as f64 / DRIFT_SAMPLES as f64,
        Name::NoiseBurst if after < BURST_SAMPLES => u[i] += size_v * unit(),
        Name::NoiseBurst => {}
        Name::Swapped => u.swap(i, fault.other),
    }
    u
}
