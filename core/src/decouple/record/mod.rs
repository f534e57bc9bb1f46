//! A whole recording, or as much of it as has arrived: the same answers as sample by sample, several times as fast.
//!
//! # Why one stream can be worked on eight samples at a time
//! Of the kernel's four stages only the spin carries anything from sample to sample that is not a plain copy of its
//! neighbours. So a block of samples goes stage by stage, each a short loop over vector registers:
//!
//! 1. *place*: every sample by itself;
//! 2. *spin*: in order, one after the other, fifteen operations each;
//! 3. *shell*: every sample by itself, from three neighbouring placements;
//! 4. *attitude*: a product of small rotations, q_k = q_0 d_1 d_2 ... d_k. A product may be bracketed at will: eight
//!    segments of the block are multiplied up side by side, then each is set behind the ones before it.
//!
//! A block is stored with one segment per lane: step s of lane l is sample l STEPS + s. Neighbours in time are then
//! neighbours in memory, rows apart and never across lanes, but for the first rows of each segment, which are copied from
//! the end of the segment before.
//!
//! # What differs from sample by sample
//! Rounding: fused products where the processor has them, and other brackets in the product of attitudes. A block with a
//! sample that the series do not cover, or with anything wrong in it, is decoded sample by sample, so errors are the same.

mod block;
mod vectors;

use pulp::{Arch, Simd, WithSimd};

use crate::decouple::stream::Decoupler;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::kernel::simd::{Register, Wide};
use ::wide::f64x4;
use block::{BLOCK, Block};

/// a then w' in ground axes, m/s^2 and rad/s^2.
pub type Accelerations = [f64; 6];

impl Decoupler {
    /// Takes the next samples, as many as there are, and hands the accelerations that they complete to `sink`, in order
    /// and in pieces of any length.
    ///
    /// Equals [`Decoupler::push`] on one after the other but for rounding (1e-13 of full scale over 1e4 samples), and leaves
    /// the decoupler ready for more by either.
    ///
    /// # Errors
    /// Those of [`Decoupler::push`]: every sample before the refused one is decoupled and handed over, and the decoupler
    /// is as it was before the refused one.
    pub fn push_record(
        &mut self,
        voltage_v: &[[f64; LIMBS]],
        sink: &mut impl FnMut(&[Accelerations]),
    ) -> Result<()> {
        if self.mask.all() {
            Arch::new().dispatch(Decode::<_, false> {
                decoupler: self,
                voltage_v,
                sink,
            })
        } else {
            Arch::new().dispatch(Decode::<_, true> {
                decoupler: self,
                voltage_v,
                sink,
            })
        }
    }

    /// The same without the processor's special instructions: what [`Decoupler::push_record`] is where there are none.
    ///
    /// # Errors
    /// As [`Decoupler::push_record`].
    pub fn push_record_portable(
        &mut self,
        voltage_v: &[[f64; LIMBS]],
        sink: &mut impl FnMut(&[Accelerations]),
    ) -> Result<()> {
        if self.mask.all() {
            decode::<f64x4, false>((), self, voltage_v, sink)
        } else {
            decode::<f64x4, true>((), self, voltage_v, sink)
        }
    }

    fn push_each(
        &mut self,
        voltage_v: &[[f64; LIMBS]],
        sink: &mut impl FnMut(&[Accelerations]),
    ) -> Result<()> {
        for row in voltage_v {
            if let Some(sample) = self.push(row)? {
                sink(&[sample.accelerations()]);
            }
        }
        Ok(())
    }
}

/// Without limbs or not, each in functions of its own.
struct Decode<'a, F, const EXCLUDING: bool> {
    decoupler: &'a mut Decoupler,
    voltage_v: &'a [[f64; LIMBS]],
    sink: &'a mut F,
}

impl<F: FnMut(&[Accelerations]), const EXCLUDING: bool> WithSimd for Decode<'_, F, EXCLUDING> {
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
    voltage_v: &[[f64; LIMBS]],
    sink: &mut impl FnMut(&[Accelerations]),
) -> Result<()> {
    // The start of a stream has fewer neighbours than the block's loops count on.
    let missing = 3_usize.saturating_sub(decoupler.received() as usize);
    let (head, mut rest) = voltage_v.split_at(missing.min(voltage_v.len()));
    decoupler.push_each(head, sink)?;
    if rest.len() >= BLOCK {
        let mut block = Block::<R, EXCLUDING>::new(proof, decoupler);
        while let Some((rows, after)) = rest.split_first_chunk::<BLOCK>() {
            match block.decode(decoupler, rows) {
                Some(done) => sink(done),
                None => decoupler.push_each(rows, sink)?,
            }
            rest = after;
        }
    }
    decoupler.push_each(rest, sink)
}
