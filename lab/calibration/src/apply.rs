//! Recordings of any length to accelerations, in bounded memory: what `sixaxis decouple` does.
//!
//! Samples flow through the files in this order:
//!
//! | file | holds |
//! |---|---|
//! | [`check_grade`] | whether the calibration is one to decouple with |
//! | [`setup`] | what is known of one recording: gains, gravity, channels, rate, and from where |
//! | [`axis_noise`] | what the channels' noise makes of the accelerations at rest |
//! | [`voltages`] | nine columns, as they go from file to decoder |
//! | [`recording`] | nine voltages on one clock from a file, block by block, with what is wrong with them |
//! | `at_limit` | which samples at the end of the converter's range are failed channels |
//! | `flat_crests` | which channels an amplifier cuts off |
//! | [`frozen`] | whether all of them stand still where they cannot |
//! | [`conditioning_stream`] | delays, the amplifier's high-pass, a low-pass, as streams |
//! | [`aids`] | what the user knows of the motion beside the recording |
//! | [`aided`] | a decoder that uses it, each at its time |
//! | `attitude_agreement` | whether a file's attitudes are those that the channels show |
//! | [`attitude`] | how well the attitude is known |
//! | [`attitude_summary`] | what became of it |
//! | [`columns`] | which columns are written, in which axes |
//! | [`curves`] | the accelerations over time, for a picture |
//! | [`decoding`] | voltages to rows of the answer |
//! | [`ends`] | whether a recording begins, or a run from rest to rest ends, in motion |
//! | `noise_level` | whether its channels are noisier than those that were calibrated with |
//! | [`mean_acceleration`] | whether the accelerations are those of a motion |
//! | [`coordination`] | whether the limb forces add up to zero where they must |
//! | [`fault_watch`] | the same with the fault monitor |
//! | [`exclusions`] | which limbs it excludes and suspects from which sample on |
//! | [`pipeline`] | the same, with a thread for reading and one for writing |
//! | [`first_pass`] | a pass of which nothing is written: what the monitor finds |
//! | [`rest_to_rest`] | a whole run in memory, with the rest-to-rest correction |
//! | [`decoupled`] | what is known of a recording when it is done |
//! | [`job`] | all of this for one recording and one result |
//! | [`stream_clock`] | the stamps of a stream of text, held against its rate |
//! | [`text_stream`] | rows of text from standard input to rows on standard output |
//!
//! The answer to a recording does not depend on how it was cut into blocks nor on the timing of the threads: blocks are cut
//! anew at fixed samples before anything is computed from them.

pub mod aided;
pub mod aids;
mod at_limit;
pub mod attitude;
pub mod attitude_agreement;
pub mod attitude_summary;
pub mod axis_noise;
pub mod check_grade;
pub mod columns;
pub mod conditioning_stream;
pub mod coordination;
pub mod curves;
pub mod decoding;
pub mod decoupled;
pub mod ends;
pub mod exclusions;
pub mod fault_watch;
mod first_pass;
mod flat_crests;
mod frozen;
pub mod job;
pub mod mean_acceleration;
mod noise_level;
pub mod rest_to_rest;
mod stream_clock;
pub mod text_stream;
pub mod voltages;

pub mod pipeline;
pub mod recording;
pub mod setup;
pub mod statements;

use sixaxis_core::LIMBS;

/// Nine voltages, V.
pub type Row = [f64; LIMBS];

/// Samples that are worked on at a time: a multiple of the kernel's block, large against the cost of handing over, small against
/// the memory (7 MB for all blocks under way).
pub const CHUNK: usize = 1 << 14;

/// Names limb and sample of an error of the mathematics as the recording has them.
pub fn explain(error: &sixaxis_core::Error, place: &str, names: &[String; LIMBS]) -> anyhow::Error {
    use sixaxis_core::Error;
    let name = |channel: usize| {
        names
            .get(channel.wrapping_sub(1))
            .map_or("", String::as_str)
    };
    match *error {
        Error::NotFinite {
            channel,
            sample,
            value,
        } => anyhow::anyhow!(
            "{place}: channel {:?} (limb {channel}), sample {sample}: {value} is not a finite number; cut the recording there or mend it",
            name(channel)
        ),
        Error::Overstrained {
            channel,
            sample,
            strain,
        } => anyhow::anyhow!(
            "{place}: channel {:?} (limb {channel}), sample {sample}: the voltage would change the limb's length by {strain:.3} of it; check the unit (V or mV) and the gain of this recording",
            name(channel)
        ),
        Error::Overflow { sample, .. } => anyhow::anyhow!(
            "{place}: sample {sample}: the rate, which is integrated in an open loop, has run away; check gains, signs of the channels and zero drift (--rest-to-rest takes off what is constant, between rests)"
        ),
        ref other => anyhow::anyhow!("{place}: {other}"),
    }
}
