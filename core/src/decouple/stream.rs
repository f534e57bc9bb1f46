//! Nine voltages in, six accelerations out: the whole of the paper's section 2.1 as a stream.

mod closed_form;
mod excluded_limbs;
mod limb_mass;
mod state;
mod wider;

use limb_mass::ShownOfRate;
use state::Start;
pub(crate) use state::State;

use super::record::BlockCount;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::kernel::attitude::{
    HALF_ANGLE_SQUARED_LIMIT, Quaternion, exp, half_rotation, to_ground,
};
use crate::kernel::channel_mask::ChannelMask;
use crate::kernel::constants::Constants;
use crate::kernel::number::Scalar;
use crate::kernel::order::to_kernel_order;
use crate::kernel::placement::{self, LimbLoad, STRAIN_LIMIT};
use crate::kernel::rate::{RateIntegrator, Torques};
use crate::kernel::shell::{self, RelativePose, ShellMotion};
use crate::kernel::vec3::Vec3;
use crate::kernel::wider::Wider;
use crate::limb_set::LimbSet;
use crate::model::{Model, Parameters, Sensor, Settings};
use crate::scheme::Scheme;
use crate::six_axis::SixAxis;

/// [`SixAxis`] in the precision of a decoder.
pub type Answer<T> = SixAxis<<T as Scalar>::Vector, <T as Scalar>::Quaternion>;

/// Streaming decoupler: no allocation, no panic, bounded work per sample.
///
/// It is the same for each sample whose strains are below 1e-4 and that turns by less than 0.1 rad; beyond, poses are iterated and rotations
/// have their closed form, which takes several times as much.
///
/// A sample is decoupled when its successor arrives, since the mass's motion in the shell is read from neighbours; the
/// first and the last sample of a stream yield nothing.
///
/// In f32 a recording of the rig at 5 Hz and 10 kHz comes out within about 1e-4 of full scale: an f32 holds a
/// displacement of the mass to 1e-7 of itself, and second differences are taken of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoupler<T: Scalar = f64> {
    /// With no strain of excluded limbs.
    pub(crate) constants: Constants<T>,
    pub(crate) mask: ChannelMask<T>,
    pub(crate) state: State<T>,
    scheme: Scheme,
    start: Start<T>,
    /// Last two voltage rows, indexed by `sample & 1`; replayed when the excluded set changes.
    recent: [[T; LIMBS]; 2],
    /// The first answer is out, and limbs have no mass: series are tried.
    settled: bool,
    /// No limb is excluded besides: most samples take the shortest way.
    fast: bool,
    /// The constants once more where the processor has wider registers than the program was compiled for.
    wider: Option<T::Wider>,
    pub(crate) blocks: BlockCount,
    /// Of all limbs and in f64, for samples beyond the series.
    exact: Constants<f64>,
    /// Of limbs with mass.
    shown_of_rate: Option<ShownOfRate<T>>,
}

impl Decoupler {
    /// Prepares a decoupler.
    ///
    /// # Errors
    /// Those of [`Model::new`]; [`crate::Error::NotConverged`] if gravity finds no equilibrium or an inertia no principal axes;
    /// [`crate::Error::OutOfRange`] for sizes, each sound by itself, whose products overflow or vanish.
    pub fn new(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        Self::build(sensor, parameters, settings)
    }
}

impl Decoupler<f32> {
    /// The same in single precision.
    ///
    /// # Errors
    /// As [`Decoupler::new`].
    pub fn new_f32(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        Self::build(sensor, parameters, settings)
    }
}

impl<T: Scalar> Decoupler<T> {
    /// Samples taken so far.
    #[must_use]
    pub fn received(&self) -> u64 {
        self.state.received
    }

    pub(crate) fn scheme(&self) -> Scheme {
        self.scheme
    }

    fn build(sensor: &Sensor, parameters: &Parameters, settings: &Settings) -> Result<Self> {
        let model = Model::new(sensor, parameters, settings)?;
        let exact = Constants::new(&model)?;
        let constants = exact.rounded();
        let start = Start::new(settings);
        let mask = ChannelMask::excluding(LimbSet::EMPTY, &settings.stiffness_ratio, &exact)?;
        Ok(Self {
            wider: T::Wider::new(&constants, &mask.strains),
            constants,
            mask,
            state: State {
                received: 0,
                before: RelativePose::default(),
                now: LimbLoad::default(),
                spin: RateIntegrator::start(constants.gyroscopic, Vec3::default(), Vec3::default()),
                shell: ShellMotion::default(),
                attitude: start.attitude,
            },
            scheme: settings.scheme,
            start,
            recent: [[T::default(); LIMBS]; 2],
            settled: false,
            fast: false,
            blocks: BlockCount::default(),
            exact,
            shown_of_rate: ShownOfRate::new(&model)?,
        })
    }

    /// Takes the next nine voltages and returns the sample before them, once there are three.
    ///
    /// # Errors
    /// [`crate::Error::NotFinite`] and [`crate::Error::Overstrained`] name channel and sample; [`crate::Error::LimbsDoNotMeet`] and
    /// [`crate::Error::NotConverged`] for forces that no assembled sensor can carry; [`crate::Error::Overflow`] for a rate whose answer
    /// is not a finite number. The decoupler is unchanged by a refused sample: a rate that has run away is refused for good.
    // Always: left to itself the compiler calls it, and the answer goes by memory.
    #[inline(always)]
    pub fn push(&mut self, voltage_v: &[T; LIMBS]) -> Result<Option<Answer<T>>> {
        if self.fast {
            if let Some(wider) = &self.wider {
                return self.push_wider::<false>(wider.proof(), voltage_v);
            }
            if T::Wider::POSSIBLE {
                return self.push_narrow(voltage_v);
            }
            self.push_fast(voltage_v)
        } else {
            self.push_excluding(voltage_v)
        }
    }

    #[inline(always)]
    fn push_fast(&mut self, voltage_v: &[T; LIMBS]) -> Result<Option<Answer<T>>> {
        let after = placement::by_series(&self.constants, to_kernel_order(*voltage_v));
        if in_range(&after) {
            return self.take::<true>(after, voltage_v);
        }
        self.push_checked(voltage_v)
    }

    /// [`Decoupler::push`] for every row of a recording or a piece of one; `sink` takes the answers in order.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`], at the first row that is refused; the rows before it have been taken.
    pub fn push_all(
        &mut self,
        voltage_v: &[[T; LIMBS]],
        mut sink: impl FnMut(&Answer<T>),
    ) -> Result<()> {
        for row in voltage_v {
            if let Some(answer) = self.push(row)? {
                sink(&answer);
            }
        }
        Ok(())
    }

    /// With limbs excluded. A function of its own: what is done there wants registers that most streams never need.
    #[inline(never)]
    fn push_excluding(&mut self, voltage_v: &[T; LIMBS]) -> Result<Option<Answer<T>>> {
        if self.settled {
            if let Some(wider) = &self.wider {
                return self.push_wider::<true>(wider.proof(), voltage_v);
            }
            let used = self.mask.voltages(to_kernel_order(*voltage_v));
            let after = self.mask.strains.by_series(&self.constants, used);
            if in_range(&after) {
                return self.take::<true>(after, voltage_v);
            }
        }
        self.push_checked(voltage_v)
    }

    /// The start of a stream, limbs with mass, and samples beyond series and polynomials. The whole sample: coming back from a call, the fast way
    /// would have to keep in memory what it has in registers.
    #[cold]
    #[inline(never)]
    pub(super) fn push_checked(&mut self, voltage_v: &[T; LIMBS]) -> Result<Option<Answer<T>>> {
        let without_limb_mass;
        let voltage_v = match &self.shown_of_rate {
            None => voltage_v,
            Some(shown) => {
                without_limb_mass = self.without_limb_mass(shown, voltage_v);
                &without_limb_mass
            }
        };
        let mut after = self.place(voltage_v);
        if !in_range(&after) {
            after = self.place_exactly(voltage_v, self.state.received)?;
        }
        if self.state.received < 3 {
            return self.begin(after, voltage_v);
        }
        self.take::<false>(after, voltage_v)
    }

    /// One of the first three samples.
    #[cold]
    fn begin(&mut self, after: LimbLoad<T>, voltage_v: &[T; LIMBS]) -> Result<Option<Answer<T>>> {
        if self.state.received == 2 {
            return self.first(&after, voltage_v);
        }
        self.remember(voltage_v);
        let state = &mut self.state;
        state.received += 1;
        state.before = state.now.relative_pose();
        state.now = after;
        Ok(None)
    }

    /// Any later one; `FAST` as long as it does not turn too far.
    #[inline(always)]
    fn take<const FAST: bool>(
        &mut self,
        after: LimbLoad<T>,
        voltage_v: &[T; LIMBS],
    ) -> Result<Option<Answer<T>>> {
        let now = &self.state.now;
        let torques = Torques {
            now: now.torque,
            next: after.torque,
        };
        let step = self
            .state
            .spin
            .step(self.scheme, self.constants.gyroscopic, torques);
        let motion = self.motion(&after, step.rate, step.derivative);
        let half = half_rotation(&self.state.shell, &motion);
        let unit = self.state.attitude.to_unit();
        let (mut turn, half_angle_squared) = exp(half, unit);
        let slow = half_angle_squared <= T::from_f64(HALF_ANGLE_SQUARED_LIMIT);
        if !slow {
            if FAST {
                return self.push_checked(voltage_v);
            }
            turn = self.turn_exactly(half, unit, &motion)?;
        }
        let attitude = self.state.attitude.after(turn);
        self.state.spin.take(self.scheme, step);
        self.remember(voltage_v);
        let sample = self.advance(after, motion, attitude);
        let ground = to_ground(&self.constants, &motion, attitude);
        Ok(Some(answer(sample, ground, attitude)))
    }

    #[inline(always)]
    fn place(&self, voltage_v: &[T; LIMBS]) -> LimbLoad<T> {
        let voltage_v = to_kernel_order(*voltage_v);
        if self.mask.all() {
            placement::by_series(&self.constants, voltage_v)
        } else {
            let used = self.mask.voltages(voltage_v);
            self.mask.strains.by_series(&self.constants, used)
        }
    }

    /// Keeps the row of the sample that is being received.
    #[inline(always)]
    fn remember(&mut self, voltage_v: &[T; LIMBS]) {
        self.recent[(self.state.received & 1) as usize] = *voltage_v;
    }

    /// Keeps the last two of the rows that came to `received` in one piece.
    pub(crate) fn remember_last(&mut self, rows: &[[T; LIMBS]]) {
        for (sample, row) in (0..self.state.received)
            .rev()
            .zip(rows.iter().rev())
            .take(2)
        {
            self.recent[(sample & 1) as usize] = *row;
        }
    }

    /// The first decoupled sample, where rate and attitude are given.
    #[cold]
    fn first(&mut self, after: &LimbLoad<T>, voltage_v: &[T; LIMBS]) -> Result<Option<Answer<T>>> {
        let constants = &self.constants;
        let now = &self.state.now;
        let w_r = shell::relative_rate(
            &self.state.before,
            &now.relative_pose(),
            &after.relative_pose(),
        );
        // R_r^T (w* + w_r): the rotation the other way round turns back.
        let back = Vec3::default() - now.rotation;
        let total = self.start.rate + w_r;
        let rate = constants.mass_to_principal(total + placement::turn(back, total));
        let spin = RateIntegrator::start(constants.gyroscopic, rate, now.torque);
        let motion = self.motion(after, spin.rate, spin.derivative);
        self.refuse_overflow(&motion)?;
        self.state.spin = spin;
        self.remember(voltage_v);
        self.settled = self.shown_of_rate.is_none();
        self.fast = self.settled && self.mask.all();
        let attitude = self.start.attitude;
        let sample = self.advance(*after, motion, attitude);
        let ground = to_ground(&self.constants, &motion, attitude);
        Ok(Some(answer(sample, ground, attitude)))
    }

    #[inline(always)]
    fn motion(&self, after: &LimbLoad<T>, rate: Vec3<T>, derivative: Vec3<T>) -> ShellMotion<T> {
        let state = &self.state;
        shell::motion(
            &self.constants,
            &state.before,
            &state.now.relative_pose(),
            &after.relative_pose(),
            state.now.force,
            [rate, derivative],
        )
    }

    /// Moves on by one sample and says which one that is.
    #[inline(always)]
    fn advance(
        &mut self,
        after: LimbLoad<T>,
        motion: ShellMotion<T>,
        attitude: Quaternion<T>,
    ) -> u64 {
        let state = &mut self.state;
        let sample = state.received - 1;
        state.received += 1;
        state.before = state.now.relative_pose();
        state.now = after;
        state.shell = motion;
        state.attitude = attitude;
        sample
    }
}

/// Whether the series hold. Written so that NaN goes the long way, too, where its channel is named.
#[inline(always)]
pub(crate) fn in_range<T: Scalar>(placed: &LimbLoad<T>) -> bool {
    placed.strain_squares <= T::from_f64(STRAIN_LIMIT * STRAIN_LIMIT)
}

/// A sample whose accelerations in ground axes and rate in shell axes are given, SI.
#[inline(always)]
fn answer<T: Scalar>(
    sample: u64,
    [linear, angular, rate]: [Vec3<T>; 3],
    attitude: Quaternion<T>,
) -> Answer<T> {
    SixAxis {
        sample,
        linear_ground_m_s2: T::vector(linear),
        angular_ground_rad_s2: T::vector(angular),
        rate_shell_rad_s: T::vector(rate),
        attitude: T::quaternion(attitude.w, attitude.v),
    }
}
