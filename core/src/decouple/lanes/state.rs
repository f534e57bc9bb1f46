//! The state of eight streams, number by number beside each other.

use crate::decouple::stream::{Decoupler, State};
use crate::kernel::attitude::Quaternion;
use crate::kernel::number::Real;
use crate::kernel::placement::LimbLoad;
use crate::kernel::rate::RateIntegrator;
use crate::kernel::shell::{RelativePose, ShellMotion};
use crate::kernel::simd::{LANES, Register, Row};

/// Flags of [`RateIntegrator`], with their padding.
const FLAGS_BYTES: usize = size_of::<(f32, u8, bool)>() - size_of::<f32>();

/// Numbers in a stream's state, counted in f32, where nothing else is padded.
const NUMBERS: usize = {
    let bytes = size_of::<RelativePose<f32>>()
        + size_of::<LimbLoad<f32>>()
        + size_of::<RateIntegrator<f32>>()
        + size_of::<ShellMotion<f32>>()
        + size_of::<Quaternion<f32>>();
    (bytes - FLAGS_BYTES) / size_of::<f32>()
};

/// The states of eight streams. Counters and flags are equal in all of them.
#[derive(Clone)]
pub struct LaneState {
    rows: [Row; NUMBERS],
    /// Counters and flags, equal in all streams; taken from stream 0.
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
        let number = R::splat(proof, 0.0);
        let zero = |_| number;
        let mut state = State {
            received: self.pattern.received,
            before: self.pattern.before.map(zero),
            now: self.pattern.now.map(zero),
            spin: self.pattern.spin.map(zero),
            shell: self.pattern.shell.map(zero),
            attitude: self.pattern.attitude.map(zero),
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

/// Every number of a state in its place, always in the same order. Fields are named one by one, so that a new one does not compile
/// until it is carried along.
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
    let RelativePose {
        position_thrice,
        rotation,
    } = before;
    position_thrice.visit(f);
    rotation.visit(f);
    let LimbLoad {
        position_thrice,
        rotation,
        force,
        torque,
        strain_squares,
    } = now;
    position_thrice.visit(f);
    rotation.visit(f);
    force.visit(f);
    torque.visit(f);
    *strain_squares = f(*strain_squares);
    spin.visit(f);
    let ShellMotion {
        rate,
        rate_derivative,
        specific_force,
    } = shell;
    rate.visit(f);
    rate_derivative.visit(f);
    specific_force.visit(f);
    let Quaternion { w, v } = attitude;
    *w = f(*w);
    v.visit(f);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scheme;
    use crate::fixture::decoupler;

    #[test]
    fn there_is_room_for_every_number() {
        let stream = decoupler(Scheme::Heun);
        let mut visited = [0; 4];
        let [state, constants, strain, load] = &mut visited;
        let counted = |count: &mut usize, number: f64| {
            *count += 1;
            number
        };
        visit(&mut stream.state.clone(), &mut |x| counted(state, x));
        stream
            .constants
            .clone()
            .visit(&mut |x| counted(constants, x));
        let mut weights = stream.mask.strains;
        weights.strain.visit(&mut |x| counted(strain, x));
        weights.load.visit(&mut |x| counted(load, x));
        assert_eq!(
            visited,
            [
                NUMBERS,
                super::super::CONSTANTS,
                super::super::reconstruct::WEIGHTS,
                super::super::LOAD_WEIGHTS
            ]
        );
    }
}
