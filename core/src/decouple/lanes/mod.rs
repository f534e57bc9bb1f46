//! Eight streams at once: recordings, Monte Carlo trials or candidates, one per lane of the processor's vector registers.
//!
//! Streams have nothing to do with each other, so all four stages of the kernel run as they stand, on eight numbers where
//! [`Decoupler::push`] has one; nothing is reordered and nothing waits for a stream's own last sample. What is said of
//! blocks in [`crate::decouple::record`] holds here, too: a sample beyond the series sends its chunk through
//! [`Decoupler::push`], and errors are that one's.

// The largest error says in which direction nothing is known: nine numbers, and no heap to put them on.
#![allow(clippy::result_large_err)]

mod state;

use ::wide::f64x4;
use pulp::{Arch, Simd, WithSimd};

use crate::decouple::stream::{Decoupler, to_ground};
use crate::geometry::LIMBS;
use crate::kernel::attitude::{HALF_ANGLE_SQUARED_LIMIT, exp, half_rotation};
use crate::kernel::constants::Constants;
use crate::kernel::order::to_kernel_order;
use crate::kernel::placement::{self, STRAIN_LIMIT};
use crate::kernel::rate::Torques;
use crate::kernel::reconstruct::StrainReconstruction;
use crate::kernel::shell;
use crate::kernel::simd::{LANES, Register, Row, Wide};
use crate::scheme::Scheme;
use state::LaneState;

/// Samples of each stream that are worked on between two looks at whether all went well.
const CHUNK: usize = 32;

/// a then w' in ground axes, m/s^2 and rad/s^2, and w* in shell axes, rad/s: nine numbers, each of eight streams.
pub type LaneSample = [Row; 9];

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
    sink: &mut impl FnMut(&[LaneSample]),
) -> core::result::Result<(), Refused> {
    let first = &streams[0];
    let alike = streams.iter().zip(&voltage_v).all(|(stream, rows)| {
        stream.received() == first.received()
            && stream.scheme() == first.scheme()
            && rows.len() == voltage_v[0].len()
    });
    assert!(
        alike,
        "streams in lanes go in step: samples received, scheme and length"
    );
    if streams.iter().all(|stream| stream.mask.all()) {
        Arch::new().dispatch(Push::<_, false> {
            streams,
            voltage_v,
            sink,
        })
    } else {
        Arch::new().dispatch(Push::<_, true> {
            streams,
            voltage_v,
            sink,
        })
    }
}

/// `EXCLUDING` says whether any of them excludes a limb: each case in functions of its own.
struct Push<'a, F, const EXCLUDING: bool> {
    streams: &'a mut [Decoupler; LANES],
    voltage_v: [&'a [[f64; LIMBS]]; LANES],
    sink: &'a mut F,
}

impl<F: FnMut(&[LaneSample]), const EXCLUDING: bool> WithSimd for Push<'_, F, EXCLUDING> {
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
    job: Push<'_, impl FnMut(&[LaneSample]), EXCLUDING>,
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
        let length = (samples - at).min(if started { CHUNK } else { 1 });
        let rows = voltage_v.map(|rows| &rows[at..at + length]);
        let done = started && length == CHUNK && chunk.decode(streams, &rows);
        if done {
            sink(&chunk.out);
        } else {
            push_each(streams, &rows, sink)?;
        }
        at += length;
    }
    Ok(())
}

/// Row by row and stream by stream.
fn push_each(
    streams: &mut [Decoupler; LANES],
    voltage_v: &[&[[f64; LIMBS]]; LANES],
    sink: &mut impl FnMut(&[LaneSample]),
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
    /// Likewise, used if any of them excludes a limb.
    weights: [Row; WEIGHTS],
    voltage_v: [[Row; LIMBS]; CHUNK],
    strain_squares: [Row; CHUNK],
    half_angle_squared: [Row; CHUNK],
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
            weights: side_by_side(streams, |stream, mut f| {
                let mut numbers = stream.mask.strains;
                numbers.visit(&mut f);
            }),
            voltage_v: [[Row::ZERO; LIMBS]; CHUNK],
            strain_squares: [Row::ZERO; CHUNK],
            half_angle_squared: [Row::ZERO; CHUNK],
            out: [[Row::ZERO; 9]; CHUNK],
        }
    }

    /// Decodes a chunk, or leaves the streams untouched and says no.
    #[inline(always)]
    fn decode(
        &mut self,
        streams: &mut [Decoupler; LANES],
        rows: &[&[[f64; LIMBS]]; LANES],
    ) -> bool {
        for (lane, rows) in rows.iter().enumerate() {
            for (nine, row) in self.voltage_v.iter_mut().zip(rows.iter()) {
                for (series, value) in nine.iter_mut().zip(row) {
                    series.0[lane] = *value;
                }
            }
            // An excluded channel may be NaN.
            for limb in streams[lane].excluded().indices() {
                for nine in &mut self.voltage_v {
                    nine[limb].0[lane] = 0.0;
                }
            }
        }
        let mut state = LaneState::gather(streams);
        for part in 0..R::PARTS {
            self.run(&mut state, part);
        }
        let sound = all_at_most(&self.strain_squares, STRAIN_LIMIT * STRAIN_LIMIT)
            & all_at_most(&self.half_angle_squared, HALF_ANGLE_SQUARED_LIMIT);
        if sound {
            state.scatter(streams, CHUNK as u64);
            for (stream, rows) in streams.iter_mut().zip(rows) {
                stream.remember_last(rows);
            }
        }
        sound
    }

    #[inline(always)]
    fn run(&mut self, lanes: &mut LaneState, part: usize) {
        let proof = self.proof;
        let mut constants = Constants::splat(R::splat(proof, 0.0));
        let mut rows = self.constants.iter();
        constants.visit(&mut |zero| rows.next().map_or(zero, |row| R::load(proof, row, part)));
        let mut reconstruction = StrainReconstruction::splat(R::splat(proof, 0.0));
        let mut rows = self.weights.iter();
        if EXCLUDING {
            reconstruction
                .visit(&mut |zero| rows.next().map_or(zero, |row| R::load(proof, row, part)));
        }
        let mut state = lanes.load::<R>(proof, part);
        for step in 0..CHUNK {
            let row = &self.voltage_v[step];
            let nine = to_kernel_order([
                R::load(proof, &row[0], part),
                R::load(proof, &row[1], part),
                R::load(proof, &row[2], part),
                R::load(proof, &row[3], part),
                R::load(proof, &row[4], part),
                R::load(proof, &row[5], part),
                R::load(proof, &row[6], part),
                R::load(proof, &row[7], part),
                R::load(proof, &row[8], part),
            ]);
            let after = if EXCLUDING {
                reconstruction.by_series(&constants, nine)
            } else {
                placement::by_series(&constants, nine)
            };
            after
                .strain_squares
                .store(&mut self.strain_squares[step], part);
            let torques = Torques {
                now: state.now.torque,
                next: after.torque,
            };
            let next = state.spin.step(self.scheme, constants.gyroscopic, torques);
            state.spin.take(self.scheme, next);
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
            half_angle_squared.store(&mut self.half_angle_squared[step], part);
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
        lanes.store(state, part);
    }
}

/// Numbers in a sensor's constants. In f32 neither of these types has any padding.
const CONSTANTS: usize = size_of::<Constants<f32>>() / size_of::<f32>();

/// Numbers in what reconstructs the strains of a sensor's excluded limbs.
const WEIGHTS: usize = size_of::<StrainReconstruction<f32>>() / size_of::<f32>();

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

/// Whether every number is; NaN is not.
#[inline(always)]
fn all_at_most(series: &[Row], limit: f64) -> bool {
    series
        .iter()
        .flat_map(|row| row.0)
        .fold(true, |all, value| all & (value <= limit))
}
