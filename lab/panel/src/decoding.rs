//! Conditioned voltages to accelerations, live: the decoupler or, with the fault monitor, the decoupler that excludes limbs.

use glam::DVec3;
use sixaxis_calibration::apply::fault_watch::FaultWatch;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::parity::{COORDINATION, ROWS};
use sixaxis_core::{Decoupler, Gains, Geometry, LIMBS, LimbLaw, Sensor, Settings, SixAxis};

/// False alarms of the monitor, per hour.
const FALSE_ALARMS_PER_HOUR: f64 = 1.0;

/// What is decoded with.
#[derive(Debug, Clone)]
pub struct Config<'a> {
    /// Lengths and the gains in use.
    pub sensor: Sensor,
    /// The 25 parameters.
    pub parameters: sixaxis_core::Parameters,
    /// Where they come from, if that is a calibration: without one there is no monitor.
    pub calibration: Option<&'a Calibration>,
    /// Gravity in the sensor's axes at rest, m/s^2; zero if nobody says where down is.
    pub gravity_ground_m_s2: DVec3,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Whether the monitor runs.
    pub watch: bool,
}

enum Decoder {
    Plain(Box<Decoupler>),
    Watched(Box<FaultWatch>),
    /// It has refused a sample; nothing is decoded before the next start.
    Stopped,
}

/// The decoder from rest on.
pub struct LiveDecoder {
    decoder: Decoder,
    chain: SignalChain,
    geometry: Geometry,
    stiffness_per_mass_per_s2: f64,
    /// What the monitor has said, or why decoding has stopped, since the last look.
    pub messages: Vec<String>,
    /// Excluded and suspected limbs as digits.
    pub flags: [f64; 2],
}

impl LiveDecoder {
    /// From rest, with shell axes along the ground's.
    ///
    /// # Errors
    /// Parameters or settings that the decoupler refuses; a monitor without a calibration that states noise and covariance.
    pub fn new(config: &Config<'_>) -> anyhow::Result<Self> {
        let settings = Settings {
            gravity_ground_m_s2: config.gravity_ground_m_s2,
            ..Settings::new(config.sample_rate_hz)
        };
        let decoder = match config.calibration.filter(|_| config.watch) {
            Some(calibration) => {
                let gravity = config.gravity_ground_m_s2;
                let overrides = Overrides {
                    gain_n_per_v: config.sensor.gains.gain_n_per_v.to_vec(),
                    rate_hz: Some(config.sample_rate_hz),
                    down: (gravity != DVec3::ZERO).then(|| gravity.to_array()),
                    ..Overrides::default()
                };
                let setup = Setup::new(calibration, None, None, &overrides)?;
                let watch = FaultWatch::new(&setup, calibration, &settings, FALSE_ALARMS_PER_HOUR)?;
                Decoder::Watched(Box::new(watch))
            }
            None => {
                let decoupler = Decoupler::new(&config.sensor, &config.parameters, &settings)?;
                Decoder::Plain(Box::new(decoupler))
            }
        };
        Ok(Self {
            decoder,
            chain: SignalChain::new(&config.sensor.gains, &config.parameters),
            geometry: config.sensor.geometry,
            stiffness_per_mass_per_s2: config.parameters.stiffness_per_mass_per_s2,
            messages: Vec::new(),
            flags: [0.0; 2],
        })
    }

    /// Takes a row; the answer to the row before.
    pub fn push(&mut self, row: &[f64; LIMBS]) -> Option<SixAxis> {
        let answer = match &mut self.decoder {
            Decoder::Plain(decoupler) => decoupler.push(row),
            Decoder::Watched(watch) => {
                let answered = watch.push(row);
                self.messages.append(&mut watch.messages);
                answered.map(|answered| {
                    answered.map(|(answer, flags)| {
                        self.flags = flags;
                        answer
                    })
                })
            }
            Decoder::Stopped => return None,
        };
        answer.unwrap_or_else(|error| {
            self.messages.push(format!("decoding has stopped: {error}"));
            self.decoder = Decoder::Stopped;
            None
        })
    }

    /// The three sums of limb forces per mass, m/s^2.
    #[must_use]
    pub fn parity_m_s2(&self, row: &[f64; LIMBS]) -> [f64; ROWS] {
        let force = self.chain.force_per_mass_m_s2(row);
        COORDINATION.map(|limbs| limbs.iter().map(|limb| force[*limb]).sum())
    }

    /// Where the mass is in its shell: position, m, and rotation vector, rad, shell axes. Zero for forces that no assembled sensor
    /// carries.
    #[must_use]
    pub fn pose(&self, row: &[f64; LIMBS]) -> Pose {
        let force = self.chain.force_per_mass_m_s2(row);
        let law = LimbLaw::CompressionShortens;
        let elongation_m = law.elongations_m(&force, self.stiffness_per_mass_per_s2);
        Pose::from_elongations(&self.geometry, &elongation_m).unwrap_or_default()
    }
}

/// A sensor with these gains.
#[must_use]
pub fn sensor(geometry: Geometry, gain_n_per_v: [f64; LIMBS]) -> Sensor {
    Sensor {
        geometry,
        gains: Gains { gain_n_per_v },
    }
}
