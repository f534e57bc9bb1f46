//! One block of samples through the kernel's stages.

use super::vectors::{STEPS, Series, Vectors, zeros};
use crate::decouple::record::Accelerations;
use crate::decouple::stream::{Decoupler, State, to_ground};
use crate::geometry::LIMBS;
use crate::kernel::attitude::{HALF_ANGLE_SQUARED_LIMIT, Quaternion, exp, half_rotation};
use crate::kernel::constants::Constants;
use crate::kernel::order::to_kernel_order;
use crate::kernel::placement::{self, STRAIN_LIMIT};
use crate::kernel::rate::Torques;
use crate::kernel::reconstruct::StrainReconstruction;
use crate::kernel::shell::{self, RelativePose, ShellMotion};
use crate::kernel::simd::{LANES, Register, Row};
use crate::kernel::vec3::vec3;

/// Samples of a block.
pub const BLOCK: usize = LANES * STEPS;

const ZERO: Series<STEPS> = [Row::ZERO; STEPS];

/// Room for one block, and the constants in vector form. `EXCLUDING` says whether any limb is excluded: one loop for both cases
/// would keep numbers of the one out of registers in the other.
pub struct Block<R: Register, const EXCLUDING: bool> {
    proof: R::Proof,
    constants: Constants<R>,
    /// Used where limbs are excluded.
    reconstruction: StrainReconstruction<R>,
    voltage_v: [Series<STEPS>; LIMBS],
    strain_squares: Series<STEPS>,
    position: Vectors<{ STEPS + 2 }>,
    rotation: Vectors<{ STEPS + 2 }>,
    force: Vectors<{ STEPS + 1 }>,
    torque: Vectors<{ STEPS + 1 }>,
    spin_rate: Vectors<STEPS>,
    spin_derivative: Vectors<STEPS>,
    rate: Vectors<STEPS>,
    rate_derivative: Vectors<STEPS>,
    specific_force: Vectors<STEPS>,
    half_angle_squared: Series<STEPS>,
    turned: Vectors<STEPS>,
    turned_w: Series<STEPS>,
    out: [Accelerations; BLOCK],
}

impl<R: Register, const EXCLUDING: bool> Block<R, EXCLUDING> {
    #[inline(always)]
    pub fn new(proof: R::Proof, decoupler: &Decoupler) -> Self {
        Self {
            proof,
            constants: decoupler.constants.map(|value| R::splat(proof, value)),
            reconstruction: decoupler.mask.strains.map(|value| R::splat(proof, value)),
            voltage_v: [ZERO; LIMBS],
            strain_squares: ZERO,
            position: zeros(),
            rotation: zeros(),
            force: zeros(),
            torque: zeros(),
            spin_rate: zeros(),
            spin_derivative: zeros(),
            rate: zeros(),
            rate_derivative: zeros(),
            specific_force: zeros(),
            half_angle_squared: ZERO,
            turned: zeros(),
            turned_w: ZERO,
            out: [[0.0; 6]; BLOCK],
        }
    }

    /// Decodes the next samples of a stream that has had three or more, or leaves it untouched and returns nothing where
    /// one of them needs more than the series and polynomials give.
    #[inline(always)]
    pub fn decode(
        &mut self,
        decoupler: &mut Decoupler,
        rows: &[[f64; LIMBS]; BLOCK],
    ) -> Option<&[Accelerations]> {
        self.transpose(decoupler, rows);
        self.place();
        if !all_at_most(&self.strain_squares, STRAIN_LIMIT * STRAIN_LIMIT) {
            return None;
        }
        let mut state = decoupler.state;
        self.fill_ghosts(&state);
        self.spin(decoupler, &mut state);
        self.shell();
        let junction = self.attitude(&state)?;
        self.finish(&mut state, junction);
        decoupler.state = state;
        decoupler.remember_last(rows);
        Some(&self.out)
    }

    #[inline(always)]
    fn transpose(&mut self, decoupler: &Decoupler, rows: &[[f64; LIMBS]; BLOCK]) {
        for lane in 0..LANES {
            for step in 0..STEPS {
                let row = &rows[lane * STEPS + step];
                for (series, value) in self.voltage_v.iter_mut().zip(row) {
                    series[step].0[lane] = *value;
                }
            }
        }
        if !EXCLUDING {
            return;
        }
        // An excluded channel may be NaN.
        for (limb, series) in self.voltage_v.iter_mut().enumerate() {
            if decoupler.excluded().contains(limb) {
                *series = ZERO;
            }
        }
    }

    #[inline(always)]
    fn place(&mut self) {
        for step in 0..STEPS {
            for part in 0..R::PARTS {
                let voltage = |i: usize| R::load(self.proof, &self.voltage_v[i][step], part);
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
                self.position.store(step + 2, part, placed.position_thrice);
                self.rotation.store(step + 2, part, placed.rotation);
                self.force.store(step + 1, part, placed.force);
                self.torque.store(step + 1, part, placed.torque);
                placed
                    .strain_squares
                    .store(&mut self.strain_squares[step], part);
            }
        }
    }

    #[inline(always)]
    fn fill_ghosts(&mut self, state: &State<f64>) {
        let (before, now) = (&state.before, &state.now);
        self.position
            .fill_ghosts([before.position_thrice, now.position_thrice]);
        self.rotation.fill_ghosts([before.rotation, now.rotation]);
        self.force.fill_ghosts([now.force]);
        self.torque.fill_ghosts([now.torque]);
    }

    /// The only stage in the order of time: each sample's successor has brought its torque along.
    #[inline(always)]
    fn spin(&mut self, decoupler: &Decoupler, state: &mut State<f64>) {
        let scheme = decoupler.scheme();
        let g = decoupler.constants.gyroscopic.map(R::Single::from);
        let mut spin = state.spin.map(R::Single::from);
        for lane in 0..LANES {
            for step in 0..STEPS {
                let torques: Torques<R::Single> = Torques {
                    now: self.torque.get(step, lane),
                    next: self.torque.get(step + 1, lane),
                };
                let next = spin.step(scheme, g, torques);
                spin.take(scheme, next);
                self.spin_rate.set(step, lane, next.rate);
                self.spin_derivative.set(step, lane, next.derivative);
            }
        }
        state.spin = spin.map(Into::into);
    }

    /// The shell's motion at the sample before each: the middle of three.
    #[inline(always)]
    fn shell(&mut self) {
        let proof = self.proof;
        for step in 0..STEPS {
            for part in 0..R::PARTS {
                let place = |row: usize| RelativePose {
                    position_thrice: self.position.load(proof, row, part),
                    rotation: self.rotation.load(proof, row, part),
                };
                let motion = shell::motion(
                    &self.constants,
                    &place(step),
                    &place(step + 1),
                    &place(step + 2),
                    self.force.load(proof, step, part),
                    [
                        self.spin_rate.load(proof, step, part),
                        self.spin_derivative.load(proof, step, part),
                    ],
                );
                self.rate.store(step, part, motion.rate);
                self.rate_derivative
                    .store(step, part, motion.rate_derivative);
                self.specific_force.store(step, part, motion.specific_force);
            }
        }
    }

    /// Rotations since the start of each segment, and the attitude at each start; nothing if one step turns too far.
    #[inline(always)]
    fn attitude(&mut self, state: &State<f64>) -> Option<[Quaternion<f64>; LANES]> {
        let proof = self.proof;
        let one = R::splat(proof, 1.0);
        let zero = R::splat(proof, 0.0);
        let motion = |this: &Self, step: usize, part: usize| ShellMotion {
            rate: this.rate.load(proof, step, part),
            rate_derivative: this.rate_derivative.load(proof, step, part),
            // The rotation does not ask for it.
            specific_force: vec3(zero, zero, zero),
        };
        for part in 0..R::PARTS {
            let mut last = motion(self, 0, part);
            let mut turned = Quaternion {
                w: one,
                v: vec3(zero, zero, zero),
            };
            for step in 0..STEPS {
                if step > 0 {
                    let now = motion(self, step, part);
                    let (turn, half_angle_squared) = exp(half_rotation(&last, &now), one);
                    turned = turned.after(turn);
                    half_angle_squared.store(&mut self.half_angle_squared[step], part);
                    last = now;
                }
                turned.w.store(&mut self.turned_w[step], part);
                self.turned.store(step, part, turned.v);
            }
        }
        // From the end of one segment to the start of the next, and each start from the one before.
        let mut starts = [state.attitude; LANES];
        let mut last = state.shell;
        let mut attitude = state.attitude;
        for (lane, start) in starts.iter_mut().enumerate() {
            let first = self.motion(0, lane);
            let (turn, half_angle_squared) = exp(half_rotation(&last, &first), attitude.to_unit());
            self.half_angle_squared[0].0[lane] = half_angle_squared;
            *start = attitude.after(turn);
            attitude = start.after(self.segment(lane));
            last = self.motion(STEPS - 1, lane);
        }
        all_at_most(&self.half_angle_squared, HALF_ANGLE_SQUARED_LIMIT).then_some(starts)
    }

    #[inline(always)]
    fn motion(&self, step: usize, lane: usize) -> ShellMotion<f64> {
        ShellMotion {
            rate: self.rate.get(step, lane),
            rate_derivative: self.rate_derivative.get(step, lane),
            specific_force: self.specific_force.get(step, lane),
        }
    }

    /// Rotation over a whole segment.
    #[inline(always)]
    fn segment(&self, lane: usize) -> Quaternion<f64> {
        Quaternion {
            w: self.turned_w[STEPS - 1].0[lane],
            v: self.turned.get(STEPS - 1, lane),
        }
    }

    /// Everything to ground axes, into rows, and the state on to the end of the block.
    #[inline(always)]
    fn finish(&mut self, state: &mut State<f64>, starts: [Quaternion<f64>; LANES]) {
        let proof = self.proof;
        let of = |get: fn(&Quaternion<f64>) -> f64| Row(starts.each_ref().map(get));
        let start = [
            of(|q| q.w),
            of(|q| q.v.x()),
            of(|q| q.v.y()),
            of(|q| q.v.z()),
        ];
        let mut ground = [Row::ZERO; 6];
        for step in 0..STEPS {
            for part in 0..R::PARTS {
                let [w, x, y, z] = [0, 1, 2, 3].map(|i| R::load(proof, &start[i], part));
                let attitude = Quaternion {
                    w,
                    v: vec3(x, y, z),
                }
                .after(Quaternion {
                    w: R::load(proof, &self.turned_w[step], part),
                    v: self.turned.load(proof, step, part),
                });
                let motion = ShellMotion {
                    rate: self.rate.load(proof, step, part),
                    rate_derivative: self.rate_derivative.load(proof, step, part),
                    specific_force: self.specific_force.load(proof, step, part),
                };
                let [a, w_dot, _] = to_ground(&self.constants, &motion, attitude);
                a.x().store(&mut ground[0], part);
                a.y().store(&mut ground[1], part);
                a.z().store(&mut ground[2], part);
                w_dot.x().store(&mut ground[3], part);
                w_dot.y().store(&mut ground[4], part);
                w_dot.z().store(&mut ground[5], part);
            }
            for lane in 0..LANES {
                let row = &mut self.out[lane * STEPS + step];
                for (value, series) in row.iter_mut().zip(&ground) {
                    *value = series.0[lane];
                }
            }
        }
        let last = LANES - 1;
        state.attitude = starts[last].after(self.segment(last));
        state.shell = self.motion(STEPS - 1, last);
        state.before = RelativePose {
            position_thrice: self.position.get(STEPS, last),
            rotation: self.rotation.get(STEPS, last),
        };
        state.now.position_thrice = self.position.get(STEPS + 1, last);
        state.now.rotation = self.rotation.get(STEPS + 1, last);
        state.now.force = self.force.get(STEPS, last);
        state.now.torque = self.torque.get(STEPS, last);
        state.now.strain_squares = self.strain_squares[STEPS - 1].0[last];
        state.received += BLOCK as u64;
    }
}

/// Whether every number is; NaN is not.
#[inline(always)]
fn all_at_most(series: &Series<STEPS>, limit: f64) -> bool {
    series
        .iter()
        .flat_map(|row| row.0)
        .fold(true, |all, value| all & (value <= limit))
}
