//! The state of eight streams, number by number beside each other.

use crate::decoupler::{Decoupler, State};
use crate::kernel::attitude::Quaternion;
use crate::kernel::placement::Placement;
use crate::kernel::real::{Vec3, vec3};
use crate::kernel::shell::{Place, ShellMotion};
use crate::kernel::spin::Spin;
use crate::kernel::wide::{LANES, Register, Row};

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
            visit(&mut state, &mut |number: &mut f64| {
                if let Some(row) = numbers.next() {
                    row.0[lane] = *number;
                }
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
            visit(&mut state, &mut |number: &mut f64| {
                if let Some(row) = numbers.next() {
                    *number = row.0[lane];
                }
            });
            state.received += taken;
            stream.state = state;
        }
    }

    #[inline(always)]
    pub fn load<R: Register>(&self, proof: R::Proof, part: usize) -> State<R> {
        let zero = R::splat(proof, 0.0);
        let zeros = vec3(zero, zero, zero);
        let place = Place {
            position_thrice: zeros,
            rotation: zeros,
        };
        let mut state = State {
            received: self.pattern.received,
            before: place,
            now: Placement {
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
        let mut next = 0;
        visit(&mut state, &mut |number: &mut R| {
            *number = R::load(proof, &self.rows[next], part);
            next += 1;
        });
        state
    }

    #[inline(always)]
    pub fn store<R: Register>(&mut self, mut state: State<R>, part: usize) {
        let mut next = 0;
        let rows = &mut self.rows;
        visit(&mut state, &mut |number: &mut R| {
            number.store(&mut rows[next], part);
            next += 1;
        });
        self.pattern.spin.keep_count(&state.spin);
    }
}

/// Every number of a state, always in the same order.
#[inline(always)]
fn visit<T: Copy>(state: &mut State<T>, f: &mut impl FnMut(&mut T)) {
    let State {
        received: _,
        before,
        now,
        spin,
        shell,
        attitude,
    } = state;
    three(&mut before.position_thrice, f);
    three(&mut before.rotation, f);
    three(&mut now.position_thrice, f);
    three(&mut now.rotation, f);
    three(&mut now.force, f);
    three(&mut now.torque, f);
    f(&mut now.strain_squares);
    Spin::visit(spin, f);
    three(&mut shell.rate, f);
    three(&mut shell.rate_derivative, f);
    three(&mut shell.specific_force, f);
    f(&mut attitude.w);
    three(&mut attitude.v, f);
}

#[inline(always)]
fn three<T>(v: &mut Vec3<T>, f: &mut impl FnMut(&mut T)) {
    f(&mut v.x);
    f(&mut v.y);
    f(&mut v.z);
}
