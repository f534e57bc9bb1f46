//! One block of samples through the kernel's stages.

use super::series::{BLOCK, FIRST, IDENTITIES, Quaternions, Series, Vectors, ZEROS, all};
use super::voltages::{Room, Voltages};
use crate::decouple::stream::{Decoupler, State};
use crate::geometry::LIMBS;
use crate::kernel::attitude::{
    HALF_ANGLE_SQUARED_LIMIT, Quaternion, exp, half_rotation, to_ground,
};
use crate::kernel::constants::Constants;
use crate::kernel::order::to_kernel_order;
use crate::kernel::placement::{self, STRAIN_LIMIT};
use crate::kernel::rate::{RateIntegrator, Torques};
use crate::kernel::reconstruct::StrainReconstruction;
use crate::kernel::shell::{self, RelativePose, ShellMotion};
use crate::kernel::simd::{LANES, Register};
use crate::kernel::vec3::{Vec3, vec3};
use crate::scheme::Scheme;
use crate::six_axis::{NUMBERS, SixAxisColumns};

/// The last sample of a block.
const LAST: usize = FIRST + BLOCK - 1;

/// What an excluded channel, which may be NaN, is taken for.
const UNREAD: [f64; BLOCK] = [0.0; BLOCK];

/// Room for one block, and the constants in vector form. `EXCLUDING` says whether any limb is excluded: one loop for both cases
/// would keep numbers of the one out of registers in the other.
pub struct Block<R: Register, const EXCLUDING: bool> {
    proof: R::Proof,
    constants: Constants<R>,
    /// Used where limbs are excluded.
    reconstruction: StrainReconstruction<R>,
    strain_squares: Series,
    position: Vectors,
    rotation: Vectors,
    force: Vectors,
    torque: Vectors,
    spin_rate: Vectors,
    spin_derivative: Vectors,
    rate: Vectors,
    rate_derivative: Vectors,
    specific_force: Vectors,
    half_angle_squared: Series,
    /// Rotations over the last samples: over one, then two, four and eight. No rotation before the block.
    turned: Quaternions,
    out: [[f64; BLOCK]; NUMBERS],
}

/// Where the registers of a block begin.
#[inline(always)]
fn places<R: Register>() -> impl DoubleEndedIterator<Item = usize> {
    (0..BLOCK / R::LANES).map(|register| FIRST + register * R::LANES)
}

impl<R: Register, const EXCLUDING: bool> Block<R, EXCLUDING> {
    #[inline(always)]
    pub fn new(proof: R::Proof, decoupler: &Decoupler) -> Self {
        Self {
            proof,
            constants: decoupler.constants.map(|value| R::splat(proof, value)),
            reconstruction: decoupler.mask.strains.map(|value| R::splat(proof, value)),
            strain_squares: all(0.0),
            position: ZEROS,
            rotation: ZEROS,
            force: ZEROS,
            torque: ZEROS,
            spin_rate: ZEROS,
            spin_derivative: ZEROS,
            rate: ZEROS,
            rate_derivative: ZEROS,
            specific_force: ZEROS,
            half_angle_squared: all(0.0),
            turned: IDENTITIES,
            out: [[0.0; BLOCK]; NUMBERS],
        }
    }

    /// Decodes a block of a stream that has had three samples or more, or leaves it untouched and returns nothing where one of
    /// them needs more than the series and polynomials give.
    #[inline(always)]
    pub fn decode(
        &mut self,
        decoupler: &mut Decoupler,
        voltage_v: &dyn Voltages,
        first: usize,
        room: &mut Room,
    ) -> Option<SixAxisColumns<'_>> {
        let mut columns = voltage_v.block(first, room);
        if EXCLUDING {
            for limb in decoupler.excluded().indices() {
                columns[limb] = &UNREAD;
            }
        }
        self.place(columns);
        if !self.strain_squares.all_at_most(STRAIN_LIMIT * STRAIN_LIMIT) {
            return None;
        }
        let mut state = decoupler.state;
        self.carry_over(&state);
        self.spin(decoupler, &mut state);
        self.shell();
        self.turns();
        if !self
            .half_angle_squared
            .all_at_most(HALF_ANGLE_SQUARED_LIMIT)
        {
            return None;
        }
        self.finish(&mut state);
        decoupler.state = state;
        decoupler.remember_last(&[
            voltage_v.row(first + BLOCK - 2),
            voltage_v.row(first + BLOCK - 1),
        ]);
        let first_sample = state.received - 1 - BLOCK as u64;
        Some(SixAxisColumns::new(first_sample, &self.out))
    }

    #[inline(always)]
    fn place(&mut self, columns: [&[f64]; LIMBS]) {
        let proof = self.proof;
        for at in places::<R>() {
            let voltage = |i: usize| R::load_at(proof, columns[i], at - FIRST);
            let nine = to_kernel_order([
                voltage(0),
                voltage(1),
                voltage(2),
                voltage(3),
                voltage(4),
                voltage(5),
                voltage(6),
                voltage(7),
                voltage(8),
            ]);
            let placed = if EXCLUDING {
                self.reconstruction.by_series(&self.constants, nine)
            } else {
                placement::by_series(&self.constants, nine)
            };
            self.position.store(at, placed.position_thrice);
            self.rotation.store(at, placed.rotation);
            self.force.store(at, placed.force);
            self.torque.store(at, placed.torque);
            self.strain_squares.store(at, placed.strain_squares);
        }
    }

    /// What the first samples need of those before them.
    #[inline(always)]
    fn carry_over(&mut self, state: &State<f64>) {
        let (before, now) = (&state.before, &state.now);
        self.position.set(FIRST - 2, before.position_thrice);
        self.position.set(FIRST - 1, now.position_thrice);
        self.rotation.set(FIRST - 2, before.rotation);
        self.rotation.set(FIRST - 1, now.rotation);
        self.force.set(FIRST - 1, now.force);
        self.torque.set(FIRST - 1, now.torque);
        self.rate.set(FIRST - 1, state.shell.rate);
        self.rate_derivative
            .set(FIRST - 1, state.shell.rate_derivative);
    }

    /// The only stage in the order of time: each sample's successor has brought its torque along.
    #[inline(always)]
    fn spin(&mut self, decoupler: &Decoupler, state: &mut State<f64>) {
        let g = decoupler.constants.gyroscopic.map(R::Single::from);
        let spin = state.spin.map(R::Single::from);
        // A loop for each scheme: one for all would carry what any of them remembers.
        let spin = match decoupler.scheme() {
            Scheme::Euler => self.spin_by(Scheme::Euler, g, spin),
            Scheme::Heun => self.spin_by(Scheme::Heun, g, spin),
            Scheme::HeunSubstepped => self.spin_by(Scheme::HeunSubstepped, g, spin),
            Scheme::AdamsBashforth2 => self.spin_by(Scheme::AdamsBashforth2, g, spin),
            Scheme::AdamsMoulton4 => self.spin_by(Scheme::AdamsMoulton4, g, spin),
            Scheme::RungeKutta4 => self.spin_by(Scheme::RungeKutta4, g, spin),
        };
        state.spin = spin.map(Into::into);
    }

    #[inline(always)]
    fn spin_by(
        &mut self,
        scheme: Scheme,
        g: Vec3<R::Single>,
        mut spin: RateIntegrator<R::Single>,
    ) -> RateIntegrator<R::Single> {
        for at in FIRST..=LAST {
            let torques: Torques<R::Single> = Torques {
                now: self.torque.get(at - 1),
                next: self.torque.get(at),
            };
            let next = spin.step(scheme, g, torques);
            spin.take(scheme, next);
            self.spin_rate.set(at, next.rate);
            self.spin_derivative.set(at, next.derivative);
        }
        spin
    }

    /// The shell's motion at the sample before each: the middle of three.
    #[inline(always)]
    fn shell(&mut self) {
        let proof = self.proof;
        for at in places::<R>() {
            let place = |at: usize| RelativePose {
                position_thrice: self.position.load(proof, at),
                rotation: self.rotation.load(proof, at),
            };
            let motion = shell::motion(
                &self.constants,
                &place(at - 2),
                &place(at - 1),
                &place(at),
                self.force.load(proof, at - 1),
                [
                    self.spin_rate.load(proof, at),
                    self.spin_derivative.load(proof, at),
                ],
            );
            self.rate.store(at, motion.rate);
            self.rate_derivative.store(at, motion.rate_derivative);
            self.specific_force.store(at, motion.specific_force);
        }
    }

    /// Rotations over the last eight samples, or since the start of the block.
    #[inline(always)]
    fn turns(&mut self) {
        let proof = self.proof;
        let one = R::splat(proof, 1.0);
        let motion = |this: &Self, at: usize| ShellMotion {
            rate: this.rate.load(proof, at),
            rate_derivative: this.rate_derivative.load(proof, at),
            // The rotation does not ask for it.
            specific_force: vec3(one, one, one),
        };
        for at in places::<R>() {
            let half = half_rotation(&motion(self, at - 1), &motion(self, at));
            let (turn, half_angle_squared) = exp(half, one);
            self.turned.store(at, turn);
            self.half_angle_squared.store(at, half_angle_squared);
        }
        // Backwards, so that what is read has not been replaced yet.
        for samples in [1, 2, 4] {
            for at in places::<R>().rev() {
                let before: Quaternion<R> = self.turned.load(proof, at - samples);
                let turned = before.after(self.turned.load(proof, at));
                self.turned.store(at, turned);
            }
        }
    }

    /// Everything to ground axes and SI, and the state on to the end of the block.
    #[inline(always)]
    fn finish(&mut self, state: &mut State<f64>) {
        let proof = self.proof;
        let unit = state.attitude.to_unit();
        let start = Quaternion {
            w: state.attitude.w * unit,
            v: state.attitude.v.times(unit),
        };
        // Each register of a row goes its own way through the block: from its attitudes eight samples ago to those now.
        for part in 0..R::PARTS {
            let mut attitude = Quaternion {
                w: R::splat(proof, start.w),
                v: start.v.map(|x| R::splat(proof, x)),
            };
            for row in 0..BLOCK / LANES {
                let out = row * LANES + part * R::LANES;
                let at = FIRST + out;
                attitude = attitude.after(self.turned.load(proof, at));
                let motion = ShellMotion {
                    rate: self.rate.load(proof, at),
                    rate_derivative: self.rate_derivative.load(proof, at),
                    specific_force: self.specific_force.load(proof, at),
                };
                let [a, w_dot, w] = to_ground(&self.constants, &motion, attitude);
                let numbers = [
                    a.x(),
                    a.y(),
                    a.z(),
                    w_dot.x(),
                    w_dot.y(),
                    w_dot.z(),
                    w.x(),
                    w.y(),
                    w.z(),
                    attitude.w,
                    attitude.v.x(),
                    attitude.v.y(),
                    attitude.v.z(),
                ];
                for (column, number) in self.out.iter_mut().zip(numbers) {
                    number.store_at(column, out);
                }
            }
        }
        let [w, x, y, z] = [9, 10, 11, 12].map(|number: usize| self.out[number][BLOCK - 1]);
        state.attitude = Quaternion {
            w,
            v: vec3(x, y, z),
        };
        state.shell = ShellMotion {
            rate: self.rate.get(LAST),
            rate_derivative: self.rate_derivative.get(LAST),
            specific_force: self.specific_force.get(LAST),
        };
        state.before = RelativePose {
            position_thrice: self.position.get(LAST - 1),
            rotation: self.rotation.get(LAST - 1),
        };
        state.now.position_thrice = self.position.get(LAST);
        state.now.rotation = self.rotation.get(LAST);
        state.now.force = self.force.get(LAST);
        state.now.torque = self.torque.get(LAST);
        state.now.strain_squares = self.strain_squares.0[LAST];
        state.received += BLOCK as u64;
    }
}
