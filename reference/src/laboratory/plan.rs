//! The plan of a session: all that the simulation can be told, with the paper's values as defaults.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use super::chain::{Chain, Coupling};
use super::channels::Channels;
use super::defect::{Defect, Kind};
use super::instruments::{GYROSCOPE_BANDWIDTH_HZ, Instruments};
use crate::geometry::LIMBS;
use crate::limbs::Limbs;
use crate::rig::run::{Mounting, ROTATION_AMPLITUDE_RAD, SLIDER_AMPLITUDE_M};
use crate::sensor::TrueSensor;

/// A simulated session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SessionPlan {
    /// Seed of every random number.
    pub seed: u64,
    /// The sensor.
    pub sensor: SensorChoice,
    /// From the cube's centre to that of its mass, sensor axes, mm.
    pub mass_centre_mm: [f64; 3],
    /// Half a limb's mass over the seismic mass, where its element is at the shell and shows what accelerates it, too.
    pub rod_mass: f64,
    /// The engine that simulates the trials.
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
    /// What the limbs have beside one axial stiffness.
    pub limbs: LimbPlan,
    /// The measuring chain.
    pub chain: ChainPlan,
    /// The reference instruments.
    pub instruments: InstrumentPlan,
    /// The defect.
    pub defect: DefectChoice,
}

impl Default for SessionPlan {
    fn default() -> Self {
        Self {
            seed: 1,
            sensor: SensorChoice::Paper,
            mass_centre_mm: [0.0; 3],
            rod_mass: 0.0,
            engine: Engine::Mujoco,
            trials_per_step: 10,
            sample_rate_hz: 2000.0,
            static_duration_s: 600.0,
            static_rate_hz: 100.0,
            rig: RigPlan::default(),
            limbs: LimbPlan::default(),
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

/// The engine that simulates the trials.
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
    /// Angle between the axis and what [`Mounting`] says of it: the plumb line, or a level. Travel stays along the axis, gravity
    /// does not; towards another side on each wedge. Degrees.
    pub axis_tilt_deg: f64,
    /// Length of the vector from a point of the pinion's axis to the sensor's centre, in another direction on each wedge, mm: what is along
    /// the axis does nothing.
    pub centre_offset_mm: f64,
    /// Crank over connecting rod of both crank-sliders; 0 for an endless rod.
    pub crank_over_rod: f64,
    /// Frequencies of steps 2 and 3, from and to, Hz.
    pub low_band_hz: (f64, f64),
    /// Frequencies of step 4, from and to, Hz.
    pub high_band_hz: (f64, f64),
    /// Taps on the shell at the end of the day, simulated in MuJoCo whatever moves the trials.
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
            axis_tilt_deg: 0.0,
            centre_offset_mm: 0.0,
            crank_over_rod: 0.0,
            low_band_hz: (1.0, 2.0),
            high_band_hz: (4.0, 5.0),
            taps: 0,
        }
    }
}

impl RigPlan {
    /// The rig with a single turn at full speed in each run, as [`crate::rig::run::Run::new`] has it.
    pub fn one_turn(mounting: Mounting) -> Self {
        Self {
            steady_periods: 1.0,
            mounting,
            ..Self::default()
        }
    }
}

/// What the limbs have beside one axial stiffness: only for [`Engine::Mujoco`]. Pure numbers, each as in [`Limbs`].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimbPlan {
    /// Stiffness of a limb square to its axis, of flexures that bend, over its axial one.
    pub lateral_stiffness: f64,
    /// Damping in the same directions over the critical damping of one limb under the whole mass.
    pub lateral_damping: f64,
    /// Mass of a limb over the seismic mass.
    pub mass: f64,
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
    /// Standard deviation of the limbs' stiffnesses about their mean, relative.
    pub stiffness_spread: f64,
    /// Share of its neighbour's charge that a channel shows at most, either sign, evenly drawn for each.
    pub cross_talk: f64,
    /// Amplitude of 50 Hz hum on every channel of the trials, V; the static record and a tumble have none.
    pub hum_v: f64,
    /// Standard deviation of a channel's zero in each trial about that of the static record, V.
    pub zero_spread_v: f64,
    /// Standard deviation of what a channel's sensitivity changes by from the day's first trial to its last, relative.
    pub sensitivity_drift: f64,
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
            cross_talk: 0.0,
            hum_v: 0.0,
            zero_spread_v: 0.0,
            sensitivity_drift: 0.0,
        }
    }
}

/// The reference instruments.
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
            gyroscope_bandwidth_hz: GYROSCOPE_BANDWIDTH_HZ,
            signal_to_noise_db: 60.0,
        }
    }
}

/// The defect of a session.
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

/// Random streams of a defect's kind, and of all else that is drawn of it.
const KIND_STREAM: u128 = 8;
const DEFECT_STREAM: u128 = 11;
/// Random stream of what holds all day.
const ROOM_STREAM: u128 = 10;
/// Random stream of the sensor; the campaign's own streams are in [`super::session`].
const SENSOR_STREAM: u128 = 3;
/// Random stream of the limbs' stiffnesses.
const STIFFNESS_STREAM: u128 = 4;
/// Random stream of the instruments.
const INSTRUMENT_STREAM: u128 = 6;

impl SessionPlan {
    /// The defect, drawn if only its kind is given or not even that.
    pub fn true_defect(&self) -> Option<Defect> {
        let stream = |stream| Pcg64::new(u128::from(self.seed), stream);
        let kind = match self.defect {
            DefectChoice::None => return None,
            DefectChoice::Exactly(defect) => return Some(defect),
            DefectChoice::Kind(kind) => kind,
            DefectChoice::Random => {
                let mut rng = stream(KIND_STREAM);
                let kind = *Kind::ALL.choose(&mut rng)?;
                if rng.random_bool(0.5) {
                    return None;
                }
                kind
            }
        };
        Some(Defect::draw(kind, self, &mut stream(DEFECT_STREAM)))
    }

    /// The sensor as it truly is.
    pub fn true_sensor(&self) -> TrueSensor {
        let centred = match self.sensor {
            SensorChoice::Paper => TrueSensor::identified(),
            SensorChoice::Design => TrueSensor::design(),
            SensorChoice::Random => {
                TrueSensor::random(&mut Pcg64::new(u128::from(self.seed), SENSOR_STREAM))
            }
        };
        TrueSensor {
            mass_centre_m: self.mass_centre_mm.map(|mm| 1e-3 * mm),
            ..centred
        }
    }

    /// Stiffnesses of the nine limbs over their mean.
    pub fn stiffness_ratio(&self) -> [f64; LIMBS] {
        let mut rng = Pcg64::new(u128::from(self.seed), STIFFNESS_STREAM);
        core::array::from_fn(|_| {
            let unit: f64 = StandardNormal.sample(&mut rng);
            1.0 + self.chain.stiffness_spread * unit
        })
    }

    /// The limbs beside their mean axial stiffness.
    pub fn true_limbs(&self) -> Limbs {
        let LimbPlan {
            lateral_stiffness,
            lateral_damping,
            mass,
        } = self.limbs;
        Limbs {
            stiffness_ratio: self.stiffness_ratio(),
            lateral_stiffness,
            lateral_damping,
            mass,
        }
    }

    /// The channels without a defect, at an hour from 0, the first trial's, to 1, the last one's and of what follows.
    pub fn true_channels(&self, hour: f64) -> Channels {
        let mut day = Pcg64::new(u128::from(self.seed), ROOM_STREAM);
        let chain = &self.chain;
        Channels {
            sensitivity: core::array::from_fn(|_| {
                let unit: f64 = StandardNormal.sample(&mut day);
                1.0 + hour * chain.sensitivity_drift * unit
            }),
            of_next: core::array::from_fn(|_| chain.cross_talk * (2.0 * day.random::<f64>() - 1.0)),
        }
    }

    /// The measuring chain.
    pub(super) fn measuring_chain(&self) -> Chain {
        let ChainPlan {
            signal_to_noise_db,
            resolution_bits,
            full_scale_v,
            coupling,
            amplifier_high_pass_hz: corner_hz,
            ..
        } = self.chain;
        Chain {
            coupling: match coupling {
                CouplingChoice::Ideal => Coupling::Ideal,
                CouplingChoice::Tared if corner_hz > 0.0 => {
                    Coupling::AlternatingCurrent { corner_hz }
                }
                CouplingChoice::Tared => Coupling::Tared,
            },
            signal_to_noise_db: signal_to_noise_db.is_finite().then_some(signal_to_noise_db),
            resolution_bits: (resolution_bits > 0).then_some(resolution_bits),
            full_scale_v,
        }
    }

    /// The reference instruments as they are, drawn from their class with the seed.
    pub(super) fn true_instruments(&self) -> Instruments {
        let InstrumentPlan {
            class_percent,
            signal_to_noise_db,
            gyroscope_bandwidth_hz: bandwidth_hz,
        } = self.instruments;
        let mut rng = Pcg64::new(u128::from(self.seed), INSTRUMENT_STREAM);
        Instruments {
            gyroscope_bandwidth_hz: (bandwidth_hz > 0.0).then_some(bandwidth_hz),
            signal_to_noise_db: signal_to_noise_db.is_finite().then_some(signal_to_noise_db),
            ..Instruments::drawn(class_percent / 100.0, &mut rng)
        }
    }
}
