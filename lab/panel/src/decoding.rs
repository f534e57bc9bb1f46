//! Conditioned voltages to accelerations, live: the decoupler or, with the fault monitor, the decoupler that excludes limbs.

use glam::DVec3;
use sixaxis_calibration::apply::fault_watch::FaultWatch;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::parity::{COORDINATION, ROWS};
use sixaxis_core::{
    CrossTalk, Decoupler, Gains, Geometry, LIMBS, LimbLaw, Parameters, Scheme, Sensor, Settings,
    SixAxis,
};

use crate::stages::Ready;

/// False alarms of the monitor, per hour.
const FALSE_ALARMS_PER_HOUR: f64 = 1.0;

/// What is decoded with.
#[derive(Debug, Clone)]
pub struct Config<'a> {
    /// Lengths and the gains in use.
    pub sensor: Sensor,
    /// The 25 parameters where there is no calibration.
    pub design: Parameters,
    /// The calibration: without one there is no monitor.
    pub calibration: Option<&'a Calibration>,
    /// Gravity in the sensor's axes at rest, m/s^2; zero if nobody says where down is.
    pub gravity_ground_m_s2: DVec3,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Whether the monitor runs.
    pub watch: bool,
}

impl Config<'_> {
    fn setup(&self, calibration: &Calibration) -> anyhow::Result<Setup> {
        let gravity = self.gravity_ground_m_s2;
        let overrides = Overrides {
            gain_n_per_v: self.sensor.gains.gain_n_per_v.to_vec(),
            rate_hz: Some(self.sample_rate_hz),
            down: (gravity != DVec3::ZERO).then(|| gravity.to_array()),
            ..Overrides::default()
        };
        Setup::new(calibration, None, None, &overrides)
    }
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
    /// What undoes the cross-talk that the calibration has found.
    cross_talk: Option<CrossTalk>,
    geometry: Geometry,
    stiffness_per_mass_per_s2: f64,
    /// What the monitor has said, or why decoding has stopped, since the last look.
    pub messages: Vec<String>,
    /// Excluded and suspected limbs as digits.
    pub flags: [f64; 2],
}

impl LiveDecoder {
    /// From rest, with shell axes along the ground's. What a calibration says is put together as `sixaxis decouple` does it.
    ///
    /// # Errors
    /// Parameters or settings that the decoupler refuses; a monitor without a calibration that states noise and covariance.
    pub fn new(config: &Config<'_>) -> anyhow::Result<Self> {
        let setup = config.calibration.map(|c| config.setup(c)).transpose()?;
        let (sensor, parameters, settings) = match &setup {
            Some(setup) => (
                setup.sensor,
                setup.parameters,
                setup.settings(config.sample_rate_hz, Scheme::Heun),
            ),
            None => (
                config.sensor,
                config.design,
                Settings {
                    gravity_ground_m_s2: config.gravity_ground_m_s2,
                    ..Settings::new(config.sample_rate_hz)
                },
            ),
        };
        let decoder = match (&setup, config.calibration) {
            (Some(setup), Some(calibration)) if config.watch => {
                let watch = FaultWatch::new(setup, calibration, &settings, FALSE_ALARMS_PER_HOUR)?;
                Decoder::Watched(Box::new(watch))
            }
            _ => Decoder::Plain(Box::new(Decoupler::new(&sensor, &parameters, &settings)?)),
        };
        Ok(Self {
            decoder,
            chain: SignalChain::new(&sensor.gains, &parameters),
            cross_talk: setup.and_then(|setup| setup.conditioning.cross_talk),
            geometry: sensor.geometry,
            stiffness_per_mass_per_s2: parameters.stiffness_per_mass_per_s2,
            messages: Vec::new(),
            flags: [0.0; 2],
        })
    }

    /// Allows for zeros that wander because the stages undo a high-pass, and had answered so many samples before the first.
    pub fn allow_for(&mut self, wander: ZeroWander, before: u64) {
        if let Decoder::Watched(watch) = &mut self.decoder {
            watch.allow_for(wander, before);
        }
    }

    /// Whether it has refused a sample.
    pub const fn has_stopped(&self) -> bool {
        matches!(self.decoder, Decoder::Stopped)
    }

    /// Takes a row; the answer to the row before.
    pub fn push(&mut self, ready: &Ready) -> Option<SixAxis> {
        let row = &ready.row;
        let undone = self.undone(row);
        let answer = match &mut self.decoder {
            Decoder::Plain(decoupler) => decoupler.push(&undone),
            // It undoes cross-talk itself: it knows which channels have failed. What is no number stays in a low-pass for ever, and the
            // channel with it.
            Decoder::Watched(watch) => {
                let seen = core::array::from_fn(|limb| match row[limb].is_finite() {
                    true => ready.before_low_pass[limb],
                    false => row[limb],
                });
                let answered = watch.push_filtered(&seen, row);
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

    fn undone(&self, row: &[f64; LIMBS]) -> [f64; LIMBS] {
        self.cross_talk
            .as_ref()
            .map_or(*row, |cross_talk| cross_talk.undo(row))
    }

    /// The three sums of limb forces per mass, m/s^2.
    pub fn parity_m_s2(&self, row: &[f64; LIMBS]) -> [f64; ROWS] {
        let force = self.chain.force_per_mass_m_s2(&self.undone(row));
        COORDINATION.map(|limbs| limbs.iter().map(|limb| force[*limb]).sum())
    }

    /// Where the mass is in its shell: position, m, and rotation vector, rad, shell axes. Zero for forces that no assembled sensor
    /// carries.
    pub fn pose(&self, row: &[f64; LIMBS]) -> Pose {
        let force = self.chain.force_per_mass_m_s2(&self.undone(row));
        let law = LimbLaw::CompressionShortens;
        let elongation_m = law.elongations_m(&force, self.stiffness_per_mass_per_s2);
        Pose::from_elongations(&self.geometry, &elongation_m).unwrap_or_default()
    }
}

/// A sensor with these gains.
pub fn sensor(geometry: Geometry, gain_n_per_v: [f64; LIMBS]) -> Sensor {
    Sensor {
        geometry,
        gains: Gains { gain_n_per_v },
    }
}
