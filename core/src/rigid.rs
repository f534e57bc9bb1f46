//! The decoupler with rigid limbs: the mass moves with the shell.
//!
//! What is left of (3), (4) and (8) when the motion of the mass in the shell is neglected: a = R sum (f/m) e + g and
//! Euler's equation of the shell. A third of the work of [`crate::Decoupler`], and good below the threshold frequencies;
//! at the rig's 5 Hz it is off by 3e-4 of full scale, growing with the square of the frequency.

use crate::decouple::stream::{SixAxis, Start, to_ground};
use crate::error::{Error, Result};
use crate::geometry::LIMBS;
use crate::kernel::attitude::{
    HALF_ANGLE_SQUARED_LIMIT, Quaternion, exp, exp_exactly, half_rotation,
};
use crate::kernel::channel_mask::ChannelMask;
use crate::kernel::constants::{Constants, to_kernel_order};
use crate::kernel::number::Scalar;
use crate::kernel::placement::{self, OVERSTRAIN, RigidLoad};
use crate::kernel::rate::{RateIntegrator, Torques};
use crate::kernel::shell::ShellMotion;
use crate::kernel::vec3::Vec3;
use crate::limb_set::LimbSet;
use crate::model::Parameters;
use crate::model::{Sensor, Settings};
use crate::scheme::Scheme;

/// Streaming decoupler that neglects the motion of the mass in the shell.
///
/// Nothing is differentiated, but a scheme that steps over pairs wants a torque in advance, so here, too, a sample is
/// decoupled when its successor arrives; only the last sample of a stream yields nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidDecoupler<T: Scalar = f64> {
    /// With no strain of limbs that are done without.
    constants: Constants<T>,
    mask: ChannelMask<T>,
    /// Of all limbs.
    all: Constants<T>,
    /// The last row: to be worked on anew when limbs are done without.
    last: [T; LIMBS],
    /// All limbs are heard and the first answer is out: no more to ask of most samples.
    settled: bool,
    scheme: Scheme,
    start: Start<T>,
    received: u64,
    now: RigidLoad<T>,
    spin: RateIntegrator<T>,
    shell: ShellMotion<T>,
    attitude: Quaternion<T>,
}

impl RigidDecoupler {
    /// Prepares a decoupler; k/m matters for the check of strains only.
    ///
    /// # Errors
    /// Those of [`crate::Decoupler::new`].
    pub fn new(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        Self::build(sensor, parameters, settings)
    }
}

impl RigidDecoupler<f32> {
    /// The same in single precision.
    ///
    /// # Errors
    /// As [`RigidDecoupler::new`].
    pub fn new_f32(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        Self::build(sensor, parameters, settings)
    }
}

impl<T: Scalar> RigidDecoupler<T> {
    fn build(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        let exact = Constants::new(sensor, parameters, settings)?;
        let constants: Constants<T> = exact.rounded();
        let start = Start::new(settings);
        let zeros = Vec3::default();
        Ok(Self {
            spin: RateIntegrator::start(constants.gyroscopic, zeros, zeros),
            constants,
            mask: ChannelMask::excluding(LimbSet::EMPTY, &exact)?,
            all: constants,
            last: [T::default(); LIMBS],
            settled: false,
            scheme: settings.scheme,
            start,
            received: 0,
            now: RigidLoad::default(),
            shell: ShellMotion::default(),
            attitude: start.attitude,
        })
    }

    /// Takes the next nine voltages and returns the sample before them, once there are two.
    ///
    /// # Errors
    /// [`Error::NotFinite`] and [`Error::Overstrained`] name channel and sample; [`Error::Overflow`] for a rate whose
    /// answer is not a finite number. The decoupler is unchanged by a refused sample.
    // Always: left to itself the compiler calls it, and the answer goes by memory.
    #[inline(always)]
    pub fn push(&mut self, voltage_v: &[T; LIMBS]) -> Result<Option<SixAxis<T>>> {
        if self.settled {
            let after = placement::rigid(&self.constants, to_kernel_order(*voltage_v));
            if in_range(&after) {
                return self.take::<true>(after, voltage_v);
            }
            self.push_checked(voltage_v)
        } else {
            self.push_excluding(voltage_v)
        }
    }

    /// Without limbs. By itself: what is done there wants registers that most streams never need.
    #[inline(never)]
    fn push_excluding(&mut self, voltage_v: &[T; LIMBS]) -> Result<Option<SixAxis<T>>> {
        if self.received > 1 {
            let heard = self.mask.voltages(to_kernel_order(*voltage_v));
            let after = self.mask.strains.rigid(&self.constants, heard);
            if in_range(&after) {
                return self.take::<true>(after, voltage_v);
            }
        }
        self.push_checked(voltage_v)
    }

    /// The start of a stream, and samples with something wrong in them. The whole sample: coming back from a call, the fast way
    /// would have to keep in memory what it has in registers.
    #[cold]
    #[inline(never)]
    fn push_checked(&mut self, voltage_v: &[T; LIMBS]) -> Result<Option<SixAxis<T>>> {
        let after = self.load(voltage_v);
        self.require_in_range(&after, voltage_v, self.received)?;
        if self.received < 2 {
            return self.first(after, voltage_v);
        }
        self.take::<false>(after, voltage_v)
    }

    /// Any but the first two samples; `FAST` as long as it does not turn too far.
    #[inline(always)]
    fn take<const FAST: bool>(
        &mut self,
        after: RigidLoad<T>,
        voltage_v: &[T; LIMBS],
    ) -> Result<Option<SixAxis<T>>> {
        let torques = Torques {
            now: self.now.torque,
            next: after.torque,
        };
        let step = self
            .spin
            .step(self.scheme, self.constants.gyroscopic, torques);
        let motion = self.motion(step.rate, step.derivative);
        let half = half_rotation(&self.shell, &motion);
        let unit = self.attitude.to_unit();
        let (mut turn, half_angle_squared) = exp(half, unit);
        let slow = half_angle_squared <= T::from_f64(HALF_ANGLE_SQUARED_LIMIT);
        if !slow {
            if FAST {
                return self.push_checked(voltage_v);
            }
            turn = self.turn_exactly(half, unit, &motion)?;
        }
        self.spin.take(self.scheme, step);
        let attitude = self.attitude.after(turn);
        self.last = *voltage_v;
        Ok(Some(self.advance(after, motion, attitude)))
    }

    /// From now on without these limbs: their channels are not looked at, whatever they say. [`LimbSet::EMPTY`] takes all
    /// back.
    ///
    /// May be called at any time. In mid-stream the last sample, of which nothing has entered the rate yet, is worked on
    /// anew, so that a channel that failed there leaves no trace. Allocates nothing.
    ///
    /// # Errors
    /// As [`crate::Decoupler::set_excluded`]; the decoupler is then unchanged.
    #[cold]
    #[inline(never)]
    pub fn set_excluded(&mut self, excluded: LimbSet) -> Result<()> {
        let mut switched = self.clone();
        let all = self.all.map(T::to_f64);
        switched.mask = ChannelMask::excluding(excluded, &all)?;
        switched.constants = all.excluding(excluded).rounded();
        switched.settled = excluded.is_empty() && self.received >= 2;
        if self.received >= 1 {
            let last = self.received - 1;
            switched.now = switched.load(&self.last);
            switched.require_in_range(&switched.now, &self.last, last)?;
            let torque = switched.now.torque - self.now.torque;
            let g = switched.constants.gyroscopic;
            switched.spin.change_next_torque(self.scheme, g, torque);
        }
        *self = switched;
        Ok(())
    }

    /// [`RigidDecoupler::set_excluded`] before the first sample.
    ///
    /// # Errors
    /// As there.
    pub fn excluding(mut self, excluded: LimbSet) -> Result<Self> {
        self.set_excluded(excluded)?;
        Ok(self)
    }

    /// The limbs that are done without.
    #[must_use]
    pub fn excluded(&self) -> LimbSet {
        self.mask.excluded()
    }

    #[inline(always)]
    fn load(&self, voltage_v: &[T; LIMBS]) -> RigidLoad<T> {
        let voltage_v = to_kernel_order(*voltage_v);
        if self.mask.all() {
            placement::rigid(&self.constants, voltage_v)
        } else {
            let heard = self.mask.voltages(voltage_v);
            self.mask.strains.rigid(&self.constants, heard)
        }
    }

    #[inline(always)]
    fn require_in_range(
        &self,
        load: &RigidLoad<T>,
        voltage_v: &[T; LIMBS],
        sample: u64,
    ) -> Result<()> {
        if !in_range(load) {
            self.refuse(voltage_v, sample)?;
        }
        Ok(())
    }

    #[inline(always)]
    fn motion(&self, rate: Vec3<T>, derivative: Vec3<T>) -> ShellMotion<T> {
        ShellMotion {
            rate: self.constants.principal_to_mass(rate),
            rate_derivative: self.constants.principal_to_mass(derivative),
            specific_force: self.now.force.times(self.constants.chi),
        }
    }

    #[cold]
    fn first(&mut self, after: RigidLoad<T>, voltage_v: &[T; LIMBS]) -> Result<Option<SixAxis<T>>> {
        if self.received == 0 {
            self.last = *voltage_v;
            self.received = 1;
            self.now = after;
            return Ok(None);
        }
        let rate = self.constants.mass_to_principal(self.start.rate);
        let spin = RateIntegrator::start(self.constants.gyroscopic, rate, self.now.torque);
        let motion = self.motion(spin.rate, spin.derivative);
        self.refuse_overflow(&motion)?;
        self.spin = spin;
        self.settled = self.mask.all();
        self.last = *voltage_v;
        Ok(Some(self.advance(after, motion, self.start.attitude)))
    }

    #[inline(always)]
    fn advance(
        &mut self,
        after: RigidLoad<T>,
        motion: ShellMotion<T>,
        attitude: Quaternion<T>,
    ) -> SixAxis<T> {
        let sample = self.received - 1;
        self.received += 1;
        self.now = after;
        self.shell = motion;
        self.attitude = attitude;
        let ground = to_ground(&self.constants, &motion, attitude);
        SixAxis::new(sample, ground, attitude)
    }

    #[cold]
    #[inline(never)]
    fn refuse(&self, voltage_v: &[T; LIMBS], sample: u64) -> Result<()> {
        let constants = self.constants.map(T::to_f64);
        let heard = self.mask.exact_voltages(voltage_v);
        placement::refuse(&constants, &heard, sample as usize)
    }

    #[cold]
    #[inline(never)]
    fn turn_exactly(
        &self,
        half: Vec3<T>,
        scale: T,
        motion: &ShellMotion<T>,
    ) -> Result<Quaternion<T>> {
        self.refuse_overflow(motion)?;
        exp_exactly(half, scale).ok_or(self.overflow())
    }

    fn refuse_overflow(&self, motion: &ShellMotion<T>) -> Result<()> {
        let answer = to_ground(&self.constants, motion, self.attitude);
        let finite = answer.iter().all(|v| v.is_finite());
        if finite { Ok(()) } else { Err(self.overflow()) }
    }

    fn overflow(&self) -> Error {
        Error::Overflow {
            what: "decoupling",
            channel: 0,
            sample: self.received as usize,
        }
    }
}

/// Written so that NaN is not.
#[inline(always)]
fn in_range<T: Scalar>(load: &RigidLoad<T>) -> bool {
    load.strain_squares < T::from_f64(OVERSTRAIN * OVERSTRAIN)
}
