//! Eight streams at once: recordings, Monte Carlo trials or candidates, one per lane of the processor's vector registers.
//!
//! Streams have nothing to do with each other, so all four stages of the kernel run as they stand, on eight numbers where
//! [`Decoupler::push`] has one; nothing is reordered and nothing waits for a stream's own last sample. What is said of
//! blocks in [`crate::decouple::record`] holds here, too: a sample beyond the series sends its chunk through
//! [`Decoupler::push`], and errors are that one's.

// The largest error says in which direction nothing is known: nine numbers, and no heap to put them on.
#![allow(clippy::result_large_err)]

mod extent;
mod reconstruct;
mod state;

use ::wide::f64x4;
use pulp::{Arch, Simd, WithSimd};

use crate::decouple::stream::Decoupler;
use crate::geometry::LIMBS;
use crate::kernel::attitude::{HALF_ANGLE_SQUARED_LIMIT, exp, half_rotation, to_ground};
use crate::kernel::constants::Constants;
use crate::kernel::placement::{self, STRAIN_LIMIT};
use crate::kernel::rate::Torques;
use crate::kernel::shell;
use crate::kernel::simd::{LANES, Register, Row, Wide};
use crate::kernel::weights::LoadWeights;
use crate::scheme::Scheme;
use extent::Extent;
use reconstruct::LaneWeights;
use state::LaneState;

/// Samples of each stream that are worked on between two looks at whether all went well.
const CHUNK: usize = 32;

/// a then w' in ground axes, m/s^2 and rad/s^2, and w* in shell axes, rad/s: nine numbers, each of eight streams.
pub type LaneSample = [Row; 9];

/// Not generic: whoever calls has one more call for 32 samples, and does not compile the kernel again for each of his closures.
type Sink<'a> = &'a mut dyn FnMut(&[LaneSample]);

/// A stream that was refused a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Refused {
    /// Which stream, from 0.
    pub lane: usize,
    /// Why.
    pub error: crate::error::Error,
}

impl core::fmt::Display for Refused {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "stream {}: {}", self.lane, self.error)
    }
}

impl core::error::Error for Refused {}

/// Decouples the next samples of eight streams that have had equally many, and hands them to `sink` in order of time, in
/// pieces of any length.
///
/// Equals [`Decoupler::push`] on each but for fused products, and leaves the decouplers ready for more by either.
///
/// # Errors
/// The first refused sample, with its stream. Every sample before it, of all streams, has been handed over; the streams
/// before the refused one have taken their share of the same row.
///
/// # Panics
/// If the streams differ in samples received, in scheme, or in length.
pub fn push_lanes(
    streams: &mut [Decoupler; LANES],
    voltage_v: [&[[f64; LIMBS]]; LANES],
    sink: Sink<'_>,
) -> core::result::Result<(), Refused> {
    assert_in_step(streams, &voltage_v);
    if streams.iter().any(Decoupler::has_limb_mass) {
        return push_each(streams, &voltage_v, sink);
    }
    if streams.iter().all(|stream| stream.mask.all()) {
        Arch::new().dispatch(Push::<false> {
            streams,
            voltage_v,
            sink,
        })
    } else {
        Arch::new().dispatch(Push::<true> {
            streams,
            voltage_v,
            sink,
        })
    }
}

/// The same without the processor's special instructions: what [`push_lanes`] is where there are none.
///
/// # Errors
/// As [`push_lanes`].
///
/// # Panics
/// As [`push_lanes`].
pub fn push_lanes_portable(
    streams: &mut [Decoupler; LANES],
    voltage_v: [&[[f64; LIMBS]]; LANES],
    sink: Sink<'_>,
) -> core::result::Result<(), Refused> {
    assert_in_step(streams, &voltage_v);
    if streams.iter().any(Decoupler::has_limb_mass) {
        return push_each(streams, &voltage_v, sink);
    }
    if streams.iter().all(|stream| stream.mask.all()) {
        let job = Push::<false> {
            streams,
            voltage_v,
            sink,
        };
        push::<f64x4, false>((), job)
    } else {
        let job = Push::<true> {
            streams,
            voltage_v,
            sink,
        };
        push::<f64x4, true>((), job)
    }
}

fn assert_in_step(streams: &[Decoupler; LANES], voltage_v: &[&[[f64; LIMBS]]; LANES]) {
    let first = &streams[0];
    let alike = streams.iter().zip(voltage_v).all(|(stream, rows)| {
        stream.received() == first.received()
            && stream.scheme() == first.scheme()
            && rows.len() == voltage_v[0].len()
    });
    assert!(
        alike,
        "streams in lanes go in step: samples received, scheme and length"
    );
}

/// `EXCLUDING` says whether any of them excludes a limb: each case in functions of its own.
struct Push<'a, const EXCLUDING: bool> {
    streams: &'a mut [Decoupler; LANES],
    voltage_v: [&'a [[f64; LIMBS]]; LANES],
    sink: Sink<'a>,
}

impl<const EXCLUDING: bool> WithSimd for Push<'_, EXCLUDING> {
    type Output = core::result::Result<(), Refused>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        if S::IS_SCALAR {
            push::<f64x4, EXCLUDING>((), self)
        } else {
            push::<Wide<S>, EXCLUDING>(simd, self)
        }
    }
}

#[inline(always)]
fn push<R: Register, const EXCLUDING: bool>(
    proof: R::Proof,
    job: Push<'_, EXCLUDING>,
) -> core::result::Result<(), Refused> {
    let Push {
        streams,
        voltage_v,
        sink,
    } = job;
    let mut at = 0;
    let samples = voltage_v[0].len();
    let mut chunk = Chunk::<R, EXCLUDING>::new(proof, streams);
    while at < samples {
        let started = streams[0].received() >= 3;
        if started {
            at += chunk.decode_all(streams, &voltage_v.map(|rows| &rows[at..]), sink);
        }
        // The start of the streams, the rest, and a chunk that is not for the series.
        let length = (samples - at).min(if started { CHUNK } else { 1 });
        let rows = voltage_v.map(|rows| &rows[at..at + length]);
        push_each(streams, &rows, sink)?;
        at += length;
    }
    Ok(())
}

/// Row by row and stream by stream.
fn push_each(
    streams: &mut [Decoupler; LANES],
    voltage_v: &[&[[f64; LIMBS]]; LANES],
    sink: Sink<'_>,
) -> core::result::Result<(), Refused> {
    for (i, _) in voltage_v[0].iter().enumerate() {
        let mut out = [Row::ZERO; 9];
        let mut any = false;
        for (lane, stream) in streams.iter_mut().enumerate() {
            let answer = stream.push(&voltage_v[lane][i]);
            if let Some(sample) = answer.map_err(|error| Refused { lane, error })? {
                any = true;
                let vectors = [
                    sample.linear_ground_m_s2,
                    sample.angular_ground_rad_s2,
                    sample.rate_shell_rad_s,
                ];
                let numbers = vectors.iter().flat_map(|v| v.to_array());
                for (row, number) in out.iter_mut().zip(numbers) {
                    row.0[lane] = number;
                }
            }
        }
        if any {
            sink(&[out]);
        }
    }
    Ok(())
}

/// Room for a chunk, and the constants of eight sensors in vector form.
struct Chunk<R: Register, const EXCLUDING: bool> {
    proof: R::Proof,
    scheme: Scheme,
    /// Each number of eight sensors side by side.
    constants: [Row; CONSTANTS],
    /// Used if any of them excludes a limb; the voltages are then made strains.
    weights: LaneWeights,
    load_weights: [Row; LOAD_WEIGHTS],
    voltage_v: [[Row; LIMBS]; CHUNK],
    strain_squares: Extent<Row>,
    half_angle_squared: Extent<Row>,
    out: [LaneSample; CHUNK],
}

impl<R: Register, const EXCLUDING: bool> Chunk<R, EXCLUDING> {
    #[inline(always)]
    fn new(proof: R::Proof, streams: &[Decoupler; LANES]) -> Self {
        Self {
            proof,
            scheme: streams[0].scheme(),
            constants: side_by_side(streams, |stream, mut f| {
                let mut numbers = stream.constants;
                numbers.visit(&mut f);
            }),
            weights: LaneWeights::gather(streams),
            load_weights: side_by_side(streams, |stream, mut f| {
                let mut numbers = stream.mask.strains.load;
                numbers.visit(&mut f);
            }),
            voltage_v: [[Row::ZERO; LIMBS]; CHUNK],
            strain_squares: Extent::of(Row::ZERO),
            half_angle_squared: Extent::of(Row::ZERO),
            out: [[Row::ZERO; 9]; CHUNK],
        }
    }

    /// Decodes chunks until one is not for the series or there are too few rows left, and says how many rows it has taken.
    /// The streams take part only at both ends: between chunks their states stay side by side.
    #[inline(always)]
    fn decode_all(
        &mut self,
        streams: &mut [Decoupler; LANES],
        rows: &[&[[f64; LIMBS]]; LANES],
        sink: Sink<'_>,
    ) -> usize {
        let mut taken = 0;
        if rows[0].len() < CHUNK {
            return taken;
        }
        let mut state = LaneState::gather(streams);
        let mut after = state.clone();
        let (mut now, mut next) = (&mut state, &mut after);
        while rows[0].len() - taken >= CHUNK {
            self.transpose(&rows.map(|rows| &rows[taken..taken + CHUNK]));
            for part in 0..R::PARTS {
                // What other schemes remember is not carried through the loop of the usual one.
                match self.scheme {
                    Scheme::Heun => self.run(Scheme::Heun, now, next, part),
                    scheme => self.run(scheme, now, next, part),
                }
            }
            let sound = self.strain_squares.is_at_most(STRAIN_LIMIT * STRAIN_LIMIT)
                && self.half_angle_squared.is_at_most(HALF_ANGLE_SQUARED_LIMIT);
            if !sound {
                break;
            }
            core::mem::swap(&mut now, &mut next);
            taken += CHUNK;
            sink(&self.out);
        }
        if taken > 0 {
            now.scatter(streams, taken as u64);
            for (stream, rows) in streams.iter_mut().zip(rows) {
                stream.remember_last(&rows[..taken]);
            }
        }
        taken
    }

    #[inline(always)]
    fn transpose(&mut self, rows: &[&[[f64; LIMBS]]; LANES]) {
        for (lane, rows) in rows.iter().enumerate() {
            for (nine, row) in self.voltage_v.iter_mut().zip(rows.iter()) {
                for (series, value) in nine.iter_mut().zip(row) {
                    series.0[lane] = *value;
                }
            }
        }
        if EXCLUDING {
            self.weights.mask(&mut self.voltage_v);
        }
    }

    #[inline(always)]
    fn run(&mut self, scheme: Scheme, from: &LaneState, to: &mut LaneState, part: usize) {
        let proof = self.proof;
        let mut constants = Constants::splat(R::splat(proof, 0.0));
        let mut rows = self.constants.iter();
        constants.visit(&mut |zero| rows.next().map_or(zero, |row| R::load(proof, row, part)));
        let mut load_weights = LoadWeights::splat(R::splat(proof, 0.0));
        if EXCLUDING {
            let mut rows = self.load_weights.iter();
            load_weights
                .visit(&mut |zero| rows.next().map_or(zero, |row| R::load(proof, row, part)));
            self.weights
                .reconstruct(proof, &constants, &mut self.voltage_v, part);
        }
        let mut state = from.load::<R>(proof, part);
        let mut strain_squares = Extent::of(R::splat(proof, 0.0));
        let mut half_angles_squared = strain_squares;
        for step in 0..CHUNK {
            let nine = reconstruct::load(proof, &self.voltage_v[step], part);
            let after = if EXCLUDING {
                load_weights.by_strains(&constants, nine)
            } else {
                placement::by_series(&constants, nine)
            };
            strain_squares = strain_squares.with(after.strain_squares);
            let torques = Torques {
                now: state.now.torque,
                next: after.torque,
            };
            let next = state.spin.step(scheme, constants.gyroscopic, torques);
            state.spin.take(scheme, next);
            let motion = shell::motion(
                &constants,
                &state.before,
                &state.now.relative_pose(),
                &after.relative_pose(),
                state.now.force,
                [next.rate, next.derivative],
            );
            let half = half_rotation(&state.shell, &motion);
            let (turn, half_angle_squared) = exp(half, state.attitude.to_unit());
            half_angles_squared = half_angles_squared.with(half_angle_squared);
            state.attitude = state.attitude.after(turn);
            state.before = state.now.relative_pose();
            state.now = after;
            state.shell = motion;
            let [a, w_dot, w] = to_ground(&constants, &motion, state.attitude);
            let out = &mut self.out[step];
            a.x().store(&mut out[0], part);
            a.y().store(&mut out[1], part);
            a.z().store(&mut out[2], part);
            w_dot.x().store(&mut out[3], part);
            w_dot.y().store(&mut out[4], part);
            w_dot.z().store(&mut out[5], part);
            w.x().store(&mut out[6], part);
            w.y().store(&mut out[7], part);
            w.z().store(&mut out[8], part);
        }
        strain_squares.store(&mut self.strain_squares, part);
        half_angles_squared.store(&mut self.half_angle_squared, part);
        to.store(state, part);
    }
}

/// Numbers in a sensor's constants. In f32 neither of these types has any padding.
const CONSTANTS: usize = size_of::<Constants<f32>>() / size_of::<f32>();

/// Numbers in what takes the third order of excluded strains to force and torque.
const LOAD_WEIGHTS: usize = size_of::<LoadWeights<f32>>() / size_of::<f32>();

/// What `visit` goes through in each stream.
fn side_by_side<const N: usize>(
    streams: &[Decoupler; LANES],
    visit: impl Fn(&Decoupler, &mut dyn FnMut(f64) -> f64),
) -> [Row; N] {
    let mut rows = [Row::ZERO; N];
    for (lane, stream) in streams.iter().enumerate() {
        let mut numbers = rows.iter_mut();
        visit(stream, &mut |number| {
            if let Some(row) = numbers.next() {
                row.0[lane] = number;
            }
            number
        });
    }
    rows
}
