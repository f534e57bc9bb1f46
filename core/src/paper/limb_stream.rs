//! Voltages in, motion of the mass in the shell out: the part of the way that knows nothing of the shell's own motion.
//!
//! Rates and accelerations of the mass in the shell are central differences of its pose, so a sample is complete when
//! its successor arrives; the first and the last of a stream have no such neighbour and yield nothing.

use super::pose::Pose;
use super::preload::hidden_preload_m_s2;
use super::relative_motion::RelativeMotion;
use super::signal::SignalChain;
use crate::error::{Error, Result, require_finite_row};
use crate::geometry::{Geometry, LIMBS};
use crate::model::{LimbLaw, Model};

/// One complete sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimbSample {
    /// Index of the voltage sample, from 0.
    pub sample: u64,
    /// What the channels show of the limb forces, over the mass, m/s^2: eq. (11).
    pub sensed_m_s2: [f64; LIMBS],
    /// Whole limb forces over the mass, positive in compression, m/s^2.
    pub force_per_mass_m_s2: [f64; LIMBS],
    /// Motion of the mass in the shell.
    pub relative: RelativeMotion,
}

/// A sample as the window keeps it: the pose and what the channels show of the forces.
pub(crate) type Entry = (Pose, [f64; LIMBS]);

/// Turns a stream of voltages into limb forces and relative motion: eqs. (11) and (2).
#[derive(Debug, Clone, PartialEq)]
pub struct LimbStream {
    geometry: Geometry,
    chain: SignalChain,
    limb_law: LimbLaw,
    stiffness_per_mass_per_s2: f64,
    preload_m_s2: [f64; LIMBS],
    step_s: f64,
    received: u64,
    /// The two samples before the newest, oldest first.
    window: [Entry; 2],
}

impl LimbStream {
    /// Prepares a stream.
    ///
    /// # Errors
    /// [`Error::NotConverged`] when gravity finds no equilibrium.
    pub fn new(model: &Model) -> Result<Self> {
        let (sensor, parameters, settings) = (model.sensor(), model.parameters(), model.settings());
        Ok(Self {
            geometry: sensor.geometry,
            chain: SignalChain::new(&sensor.gains, parameters),
            limb_law: settings.limb_law,
            stiffness_per_mass_per_s2: parameters.stiffness_per_mass_per_s2,
            preload_m_s2: hidden_preload_m_s2(model)?,
            step_s: 1.0 / settings.sample_rate_hz,
            received: 0,
            window: [(Pose::default(), [0.0; LIMBS]); 2],
        })
    }

    /// The drawing that the stream works with.
    #[must_use]
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Static limb forces that a tared signal does not show, m/s^2; zero for a full one.
    #[must_use]
    pub fn preload_m_s2(&self) -> &[f64; LIMBS] {
        &self.preload_m_s2
    }

    /// Takes the next nine voltages and returns the sample before them, once there are three.
    ///
    /// # Errors
    /// [`Error::NotFinite`] names channel and sample; [`Error::LimbsDoNotMeet`] for forces that no assembled sensor
    /// can carry; [`Error::Overflow`] if a finite voltage makes a motion that no f64 holds. The stream is unchanged by a
    /// refused sample.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Option<LimbSample>> {
        let (entry, sample) = self.look(voltage_v)?;
        self.accept(entry);
        Ok(sample)
    }

    /// What [`Self::push`] would return, and the entry that [`Self::accept`] then takes.
    #[inline]
    pub(crate) fn look(&self, voltage_v: &[f64; LIMBS]) -> Result<(Entry, Option<LimbSample>)> {
        require_finite_row(voltage_v, self.awaited())?;
        let sensed = self.chain.force_per_mass_m_s2(voltage_v);
        let pose = self.pose(&sensed)?;
        let [(before, _), (now, now_sensed)] = self.window;
        let entry = (pose, sensed);
        if self.received < 2 {
            return Ok((entry, None));
        }
        let relative = RelativeMotion::from_poses(&before, &now, &pose, self.step_s);
        if !relative.is_finite() {
            return Err(Error::overflow("relative motion", self.awaited()));
        }
        let sample = LimbSample {
            sample: self.received - 1,
            sensed_m_s2: now_sensed,
            force_per_mass_m_s2: self.whole(&now_sensed),
            relative,
        };
        Ok((entry, Some(sample)))
    }

    #[inline]
    pub(crate) fn accept(&mut self, entry: Entry) {
        self.window = [self.window[1], entry];
        self.received += 1;
    }

    /// Index of the sample that is to come.
    #[inline]
    pub(crate) fn awaited(&self) -> usize {
        self.received as usize
    }

    fn whole(&self, sensed_m_s2: &[f64; LIMBS]) -> [f64; LIMBS] {
        core::array::from_fn(|i| sensed_m_s2[i] + self.preload_m_s2[i])
    }

    fn pose(&self, sensed_m_s2: &[f64; LIMBS]) -> Result<Pose> {
        let elongation = self
            .limb_law
            .elongations_m(&self.whole(sensed_m_s2), self.stiffness_per_mass_per_s2);
        Pose::from_elongations(&self.geometry, &elongation)
    }
}
