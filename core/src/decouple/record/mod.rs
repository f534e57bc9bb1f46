//! A whole recording, or as much of it as has arrived: the same answers as sample by sample, several times as fast.
//!
//! # Why one stream can be worked on several samples at a time
//! Of the kernel's four stages only the spin carries anything from sample to sample that is not a plain copy of its
//! neighbours. So a block of samples goes stage by stage, each a short loop over vector registers:
//!
//! 1. *place*: every sample by itself;
//! 2. *spin*: in order, one after the other, fifteen operations each;
//! 3. *shell*: every sample by itself, from three neighbouring placements;
//! 4. *attitude*: a product of small rotations, q_k = q_0 d_1 d_2 ... d_k. A product may be bracketed at will: doubled three
//!    times, rotations over one sample become those over eight, and eight attitudes side by side step on by eight samples.
//!
//! Numbers lie in the order of time, column by column, from the voltages to the answers: a register holds consecutive samples,
//! and their neighbours are a load from one place earlier.
//!
//! # What differs from sample by sample
//! Rounding: fused products where the processor has them, and other brackets in the product of attitudes. A block with a
//! sample that the series do not cover, or with anything wrong in it, is decoded sample by sample, so errors are the same.

mod block;
mod series;
mod voltages;

use pulp::{Arch, Simd, WithSimd};

use crate::decouple::stream::Decoupler;
use crate::error::{Result, require_samples};
use crate::geometry::LIMBS;
use crate::kernel::simd::{Register, Wide};
use crate::six_axis::SixAxisColumns;
use ::wide::f64x4;
use block::Block;
use series::BLOCK;
use voltages::{Columns, Voltages};

/// Takes answers in order and in pieces of any length.
type Sink<'a> = &'a mut dyn FnMut(SixAxisColumns<'_>);

/// How the blocks of a stream's recordings were decoded. Which way a block goes depends on its samples and the state before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BlockCount {
    /// As a block.
    pub whole: u64,
    /// As a block at first, then once more sample by sample: the series or polynomials do not hold for one of its samples.
    pub again: u64,
    /// Sample by sample from the first: limbs have mass, or the shell turns too far in a sample when the block begins.
    pub singly: u64,
}

impl Decoupler {
    /// How the blocks of all recordings so far were decoded. Samples of less than a block are not in it.
    #[must_use]
    pub fn blocks(&self) -> BlockCount {
        self.blocks
    }

    /// Takes the next samples, as many as there are, and hands the answers that they complete to `sink`, in order and in
    /// pieces of any length.
    ///
    /// Equals [`Decoupler::push`] on one after the other but for rounding (1.5e-12 of full scale over up to 1,200 samples in suite `paths`, which allows 1e-11;
    /// a wild voltage that is accepted turns the sensor so fast that rounding grows to the size of the answer), and leaves
    /// the decoupler ready for more by either.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`]: every sample before the refused one is decoupled and handed over, and the decoupler
    /// is as it was before the refused one.
    pub fn push_record(
        &mut self,
        voltage_v: &[[f64; LIMBS]],
        sink: &mut dyn FnMut(SixAxisColumns<'_>),
    ) -> Result<()> {
        self.dispatch(&voltage_v, sink)
    }

    /// [`Decoupler::push_record`] of nine columns, as a file has them: the same bits, and nothing is moved.
    ///
    /// # Errors
    /// As [`Decoupler::push_record`]; [`crate::Error::TooFewSamples`] for a column that is shorter than the longest, before any
    /// sample is taken.
    pub fn push_columns(
        &mut self,
        voltage_v: [&[f64]; LIMBS],
        sink: &mut dyn FnMut(SixAxisColumns<'_>),
    ) -> Result<()> {
        let longest = voltage_v.iter().map(|column| column.len()).max();
        let needed = longest.unwrap_or(0);
        for column in voltage_v {
            require_samples("a column of voltages", needed, column.len())?;
        }
        self.dispatch(&Columns(voltage_v), sink)
    }

    /// The same without the processor's special instructions: what [`Decoupler::push_record`] is where there are none.
    ///
    /// # Errors
    /// As [`Decoupler::push_record`].
    pub fn push_record_portable(
        &mut self,
        voltage_v: &[[f64; LIMBS]],
        sink: &mut dyn FnMut(SixAxisColumns<'_>),
    ) -> Result<()> {
        if self.mask.all() {
            decode::<f64x4, false>((), self, &voltage_v, sink)
        } else {
            decode::<f64x4, true>((), self, &voltage_v, sink)
        }
    }

    fn dispatch(&mut self, voltage_v: &dyn Voltages, sink: Sink) -> Result<()> {
        if self.mask.all() {
            Arch::new().dispatch(Decode::<false> {
                decoupler: self,
                voltage_v,
                sink,
            })
        } else {
            Arch::new().dispatch(Decode::<true> {
                decoupler: self,
                voltage_v,
                sink,
            })
        }
    }

    // A function of its own: the loops of a block are laid out better without it.
    #[inline(never)]
    fn push_each(
        &mut self,
        voltage_v: &dyn Voltages,
        samples: core::ops::Range<usize>,
        sink: Sink,
    ) -> Result<()> {
        for sample in samples {
            let row = voltage_v.row(sample);
            let answer = if self.state.turns_far() {
                self.push_checked(&row)
            } else {
                self.push(&row)
            };
            if let Some(answer) = answer? {
                let numbers = answer.numbers().map(|number| [number]);
                sink(SixAxisColumns::new(answer.sample, &numbers));
            }
        }
        Ok(())
    }
}

/// With limbs excluded or not, each in functions of its own.
struct Decode<'a, const EXCLUDING: bool> {
    decoupler: &'a mut Decoupler,
    voltage_v: &'a dyn Voltages,
    sink: Sink<'a>,
}

impl<const EXCLUDING: bool> WithSimd for Decode<'_, EXCLUDING> {
    type Output = Result<()>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Result<()> {
        // Processors known to have no vector unit that fuses go the portable way.
        if S::IS_SCALAR {
            decode::<f64x4, EXCLUDING>((), self.decoupler, self.voltage_v, self.sink)
        } else {
            decode::<Wide<S>, EXCLUDING>(simd, self.decoupler, self.voltage_v, self.sink)
        }
    }
}

#[inline(always)]
fn decode<R: Register, const EXCLUDING: bool>(
    proof: R::Proof,
    decoupler: &mut Decoupler,
    voltage_v: &dyn Voltages,
    sink: Sink,
) -> Result<()> {
    let samples = voltage_v.len();
    // The start of a stream has fewer neighbours than the block's loops count on.
    let missing = 3_usize.saturating_sub(decoupler.received() as usize);
    let mut first = missing.min(samples);
    decoupler.push_each(voltage_v, 0..first, sink)?;
    if samples - first >= BLOCK {
        let mut block = Block::<R, EXCLUDING>::new(proof, decoupler);
        let mut room = [[0.0; BLOCK]; LIMBS];
        while samples - first >= BLOCK {
            // Where the open loop has run away no block would succeed, and limbs with mass need the rate first: none is tried.
            let tried = !decoupler.has_limb_mass() && !decoupler.state.turns_far();
            let done = if tried {
                block.decode(decoupler, voltage_v, first, &mut room)
            } else {
                None
            };
            match done {
                Some(done) => {
                    sink(done);
                    decoupler.blocks.whole += 1;
                }
                None => {
                    decoupler.push_each(voltage_v, first..first + BLOCK, sink)?;
                    if tried {
                        decoupler.blocks.again += 1;
                    } else {
                        decoupler.blocks.singly += 1;
                    }
                }
            }
            first += BLOCK;
        }
    }
    decoupler.push_each(voltage_v, first..samples, sink)
}
