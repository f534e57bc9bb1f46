//! What is played: everything the reference can be told, with the paper's values where nothing is said.

use rand::seq::IndexedRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use sixaxis_core::{InertiaPerMass, LIMBS, Parameters};

use crate::paper;
use crate::rig::{Mounting, ROTATION_AMPLITUDE_RAD, SLIDER_AMPLITUDE_M};

use super::defect::{Defect, Kind};
use super::effect::Signals;

/// A simulated session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SessionPlan {
    /// Seed of every random number.
    pub seed: u64,
    /// The sensor.
    pub sensor: SensorChoice,
    /// What moves it.
    pub engine: Engine,
    /// Trials for each of steps 2 to 4.
    pub trials_per_step: usize,
    /// Samples per second of the trials.
    pub sample_rate_hz: f64,
    /// Length of the static record, s, and its samples per second.
    pub static_duration_s: f64,
    /// See `static_duration_s`.
    pub static_rate_hz: f64,
    /// The rig.
    pub rig: RigPlan,
    /// The measuring chain.
    pub chain: ChainPlan,
    /// The standard instruments.
    pub instruments: InstrumentPlan,
    /// What is wrong.
    pub defect: DefectChoice,
}

impl Default for SessionPlan {
    fn default() -> Self {
        Self {
            seed: 1,
            sensor: SensorChoice::Paper,
            engine: Engine::Mujoco,
            trials_per_step: 10,
            sample_rate_hz: 2000.0,
            static_duration_s: 600.0,
            static_rate_hz: 100.0,
            rig: RigPlan::default(),
            chain: ChainPlan::default(),
            instruments: InstrumentPlan::default(),
            defect: DefectChoice::None,
        }
    }
}

/// Which sensor is calibrated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorChoice {
    /// The paper's, as identified.
    Paper,
    /// The paper's, as designed.
    Design,
    /// One scattered about the design, drawn with the seed.
    Random,
}

/// What moves the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Engine {
    /// MuJoCo, limbs and all.
    Mujoco,
    /// Closed form with limbs that do not give way: fast; k/m has no effect.
    Rigid,
}

/// The rig.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RigPlan {
    /// Slider amplitude, half the stroke, m.
    pub slider_amplitude_m: f64,
    /// Rotation amplitude, rad.
    pub rotation_amplitude_rad: f64,
    /// Rest before and after each run, s.
    pub rest_s: f64,
    /// Run-up and run-down, crank periods.
    pub ramp_periods: f64,
    /// Turns at full speed.
    pub steady_periods: f64,
    /// How the sensor hangs.
    pub mounting: Mounting,
    /// Largest error of a wedge as its workshop made it, degrees.
    pub wedge_error_deg: f64,
    /// Frequencies of steps 2 and 3, from and to, Hz.
    pub low_band_hz: (f64, f64),
    /// Frequencies of step 4, from and to, Hz.
    pub high_band_hz: (f64, f64),
    /// Taps on the shell at the end of the day, played in MuJoCo whatever moves the trials.
    pub taps: usize,
}

impl Default for RigPlan {
    fn default() -> Self {
        Self {
            slider_amplitude_m: SLIDER_AMPLITUDE_M,
            rotation_amplitude_rad: ROTATION_AMPLITUDE_RAD,
            rest_s: 0.05,
            ramp_periods: 1.0,
            steady_periods: 3.0,
            mounting: Mounting::AxisVertical,
            wedge_error_deg: 0.0,
            low_band_hz: (1.0, 2.0),
            high_band_hz: (4.0, 5.0),
            taps: 0,
        }
    }
}

/// The measuring chain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChainPlan {
    /// Ratio of a full-scale sine to the noise of one sample, dB; infinite for none.
    pub signal_to_noise_db: f64,
    /// Converter resolution, bits; 0 for none.
    pub resolution_bits: u32,
    /// Converter limit, V.
    pub full_scale_v: f64,
    /// What becomes of the load at rest.
    pub coupling: CouplingChoice,
    /// Corner of the charge amplifier's first-order high-pass, Hz, which the session file states; 0 for none.
    pub amplifier_high_pass_hz: f64,
    /// Standard deviation of the limbs' stiffnesses about their mean, relative. Only for [`Engine::Rigid`]: the reference's
    /// MuJoCo model has one stiffness for all limbs.
    pub stiffness_spread: f64,
}

/// What becomes of the load at rest on its way to the converter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CouplingChoice {
    /// The change of force since the run began, as a piezo shows it.
    #[default]
    Tared,
    /// The whole force, gravity's share at rest included, as a force cell shows it.
    Ideal,
}

impl Default for ChainPlan {
    fn default() -> Self {
        Self {
            signal_to_noise_db: 60.0,
            resolution_bits: 16,
            full_scale_v: 10.0,
            coupling: CouplingChoice::Tared,
            amplifier_high_pass_hz: 0.0,
            stiffness_spread: 0.0,
        }
    }
}

/// The standard instruments.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct InstrumentPlan {
    /// Class, %: the gain error is drawn from half of it.
    pub class_percent: f64,
    /// Bandwidth of the gyroscope, Hz; 0: it follows at once.
    pub gyroscope_bandwidth_hz: f64,
    /// Ratio of a sine of the run's own peak to the noise of one sample, dB; infinite for none.
    pub signal_to_noise_db: f64,
}

impl Default for InstrumentPlan {
    fn default() -> Self {
        Self {
            class_percent: 1.0,
            gyroscope_bandwidth_hz: crate::instruments::GYROSCOPE_BANDWIDTH_HZ,
            signal_to_noise_db: 60.0,
        }
    }
}

/// What is wrong with the session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
#[serde(rename_all = "snake_case")]
pub enum DefectChoice {
    /// Nothing.
    #[default]
    None,
    /// One of any kind or, as likely, none: drawn with the seed, for a session that is to be judged blind.
    Random,
    /// One of a kind, its particulars drawn with the seed.
    Kind(Kind),
    /// This one.
    Exactly(Defect),
}

/// Spread of a random sensor's scale factors: standard deviation of their logarithm. The paper's have 0.33.
const SCALE_SPREAD: f64 = 0.25;
/// Largest zero drift of a random sensor, V: the paper's largest is 17 mV.
const LARGEST_DRIFT_V: f64 = 20e-3;
/// Moments of inertia of a random sensor over the design's, from and to.
const MOMENTS: (f64, f64) = (0.85, 1.2);
/// Products of inertia of a random sensor, m^2, at most.
const PRODUCT_M2: f64 = 2e-6;

/// A sensor scattered about the design.
pub fn random_sensor(rng: &mut impl Rng) -> Parameters {
    let design = paper::design_parameters();
    let moments = design.inertia_per_mass.to_paper_order();
    Parameters {
        zero_drift_v: core::array::from_fn(|_| rng.random_range(-LARGEST_DRIFT_V..LARGEST_DRIFT_V)),
        scale_per_mass_per_kg: design.scale_per_mass_per_kg.map(|s| {
            let unit: f64 = StandardNormal.sample(rng);
            s * (SCALE_SPREAD * unit).exp()
        }),
        inertia_per_mass: InertiaPerMass::from_paper_order(core::array::from_fn(|i| {
            if i < 3 {
                moments[i] * rng.random_range(MOMENTS.0..MOMENTS.1)
            } else {
                rng.random_range(-PRODUCT_M2..PRODUCT_M2)
            }
        })),
        stiffness_per_mass_per_s2: rng.random_range(1.5e8..5.0e8),
    }
}

/// Random stream of the sensor; the campaign's own streams are in [`super::play`].
const SENSOR_STREAM: u128 = 3;
/// Random stream of the limbs' stiffnesses.
const STIFFNESS_STREAM: u128 = 4;
/// Random stream of [`DefectChoice::Random`]; 5 to 7 and from 64 on are the campaign's.
const KIND_STREAM: u128 = 8;

impl SessionPlan {
    /// The true parameters.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        match self.sensor {
            SensorChoice::Paper => paper::identified_parameters(),
            SensorChoice::Design => paper::design_parameters(),
            SensorChoice::Random => {
                random_sensor(&mut Pcg64::new(u128::from(self.seed), SENSOR_STREAM))
            }
        }
    }

    /// Stiffnesses of the nine limbs over their mean.
    #[must_use]
    pub fn stiffness_ratio(&self) -> [f64; LIMBS] {
        let mut rng = Pcg64::new(u128::from(self.seed), STIFFNESS_STREAM);
        core::array::from_fn(|_| {
            let unit: f64 = StandardNormal.sample(&mut rng);
            1.0 + self.chain.stiffness_spread * unit
        })
    }

    /// The defect, drawn if only its kind is given or not even that. Drawn ones are drawn again until they do harm, as
    /// [`Signals::harmed_by`] has it; what is given exactly is played as it is.
    #[must_use]
    pub fn drawn_defect(&self) -> Option<Defect> {
        match &self.defect {
            DefectChoice::None => None,
            DefectChoice::Random => {
                let mut rng = Pcg64::new(u128::from(self.seed), KIND_STREAM);
                let kind = Kind::ALL.choose(&mut rng).copied();
                kind.filter(|_| rng.random_bool(0.5))
                    .map(|kind| self.harmful(kind))
            }
            DefectChoice::Kind(kind) => Some(self.harmful(*kind)),
            DefectChoice::Exactly(defect) => Some(defect.clone()),
        }
    }

    fn harmful(&self, kind: Kind) -> Defect {
        let mut rng = Pcg64::seed_from_u64(self.seed ^ 0x0d_efec7);
        let signals = Signals::of(self);
        let mut defect = Defect::draw(kind, self.trials_per_step, &mut rng);
        // On a rig where nothing does harm, the last one stands.
        for _ in 0..MOST_DRAWS {
            if signals.harmed_by(&defect) {
                break;
            }
            defect = Defect::draw(kind, self.trials_per_step, &mut rng);
        }
        defect
    }
}

/// Draws of a defect's particulars before a harmless one is let pass.
const MOST_DRAWS: usize = 1000;
