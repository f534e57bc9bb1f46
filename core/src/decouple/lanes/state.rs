//! The state of eight streams, number by number beside each other.

use crate::decouple::stream::{Decoupler, State};
use crate::kernel::attitude::Quaternion;
use crate::kernel::number::Real;
use crate::kernel::placement::LimbLoad;
use crate::kernel::shell::{RelativePose, ShellMotion};
use crate::kernel::simd::{LANES, Register, Row};
use crate::kernel::vec3::Vec3;

/// Numbers in a stream's state.
const NUMBERS: usize = 56;

/// Eight streams' states; what is no number is the same in all of them.
pub struct LaneState {
    rows: [Row; NUMBERS],
    /// The first stream's, for what is no number.
    pattern: State<f64>,
}

impl LaneState {
    pub fn gather(streams: &[Decoupler; LANES]) -> Self {
        let mut rows = [Row::ZERO; NUMBERS];
        for (lane, stream) in streams.iter().enumerate() {
            let mut state = stream.state;
            let mut numbers = rows.iter_mut();
            visit(&mut state, &mut |number| {
                if let Some(row) = numbers.next() {
                    row.0[lane] = number;
                }
                number
            });
        }
        Self {
            rows,
            pattern: streams[0].state,
        }
    }

    /// Back to the streams, which have taken `taken` samples more.
    pub fn scatter(&self, streams: &mut [Decoupler; LANES], taken: u64) {
        for (lane, stream) in streams.iter_mut().enumerate() {
            let mut state = self.pattern;
            let mut numbers = self.rows.iter();
            visit(&mut state, &mut |number| {
                numbers.next().map_or(number, |row| row.0[lane])
            });
            state.received += taken;
            stream.state = state;
        }
    }

    #[inline(always)]
    pub fn load<R: Register>(&self, proof: R::Proof, part: usize) -> State<R> {
        let zero = R::splat(proof, 0.0);
        let zeros = Vec3::all(zero);
        let place = RelativePose {
            position_thrice: zeros,
            rotation: zeros,
        };
        let mut state = State {
            received: self.pattern.received,
            before: place,
            now: LimbLoad {
                position_thrice: zeros,
                rotation: zeros,
                force: zeros,
                torque: zeros,
                strain_squares: zero,
            },
            spin: self.pattern.spin.map(|_| zero),
            shell: ShellMotion {
                rate: zeros,
                rate_derivative: zeros,
                specific_force: zeros,
            },
            attitude: Quaternion { w: zero, v: zeros },
        };
        let mut rows = self.rows.iter();
        visit(&mut state, &mut |zero| {
            rows.next().map_or(zero, |row| R::load(proof, row, part))
        });
        state
    }

    #[inline(always)]
    pub fn store<R: Register>(&mut self, mut state: State<R>, part: usize) {
        let mut rows = self.rows.iter_mut();
        visit(&mut state, &mut |number: R| {
            if let Some(row) = rows.next() {
                number.store(row, part);
            }
            number
        });
        self.pattern.spin.keep_count(&state.spin);
    }
}

/// Every number of a state in its place, always in the same order.
#[inline(always)]
fn visit<T: Real>(state: &mut State<T>, f: &mut impl FnMut(T) -> T) {
    let State {
        received: _,
        before,
        now,
        spin,
        shell,
        attitude,
    } = state;
    before.position_thrice.visit(f);
    before.rotation.visit(f);
    now.position_thrice.visit(f);
    now.rotation.visit(f);
    now.force.visit(f);
    now.torque.visit(f);
    now.strain_squares = f(now.strain_squares);
    spin.visit(f);
    shell.rate.visit(f);
    shell.rate_derivative.visit(f);
    shell.specific_force.visit(f);
    attitude.w = f(attitude.w);
    attitude.v.visit(f);
}
