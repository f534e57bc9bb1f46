//! Delays between channels: a series read between its samples, by the polynomial through the six nearest ones.
//!
//! A sine of frequency f and sample rate F comes out too small by up to (2 pi f/F)^6/205 of its amplitude, halfway between two
//! samples and without phase there (test `order_delay`): 3e-10 at F/100, 4.7e-6 at F/20, 3e-4 at F/10. In the first and the last
//! step of a record, where all six samples lie on one side, it is up to 4.8 times as much (the test allows five), and in the step beside it 1.4 times (computed once).

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use super::resample::MIN_SAMPLES;
use super::stage::{self, Stage};
use crate::error::{Result, require, require_positive, require_samples};

/// Samples on either side that a value rests on.
const REACH: usize = 3;
const NODES: usize = 2 * REACH;

/// How far, in roundings, a delay may lie from a whole number of samples and still mean it.
const ROUNDINGS: f64 = 4.0;

/// The series at k - `samples` for each of its own places k, as a stage: see [`delayed`].
#[derive(Debug, Clone, PartialEq)]
pub struct Delay {
    /// Sample k is read at k + whole + share.
    whole: i64,
    share: f64,
    inside: [f64; NODES],
    /// The samples that may still be read, and the place of the first of them in the record.
    around: VecDeque<f64>,
    first: i64,
    next: i64,
    held: usize,
    ends: [f64; 2],
}

impl Delay {
    /// Longest delay, samples.
    pub const LONGEST: f64 = 1e9;

    /// A delay in samples, negative to bring a series forward.
    ///
    /// # Errors
    /// [`crate::Error::OutOfRange`] for one that is not finite or longer than [`Self::LONGEST`].
    pub fn new(samples: f64) -> Result<Self> {
        require(
            (-Self::LONGEST..=Self::LONGEST).contains(&samples),
            "delay, samples",
            samples,
            "finite and at most 1e9 either way",
        )?;
        let slack = ROUNDINGS * f64::EPSILON * samples.abs().max(1.0);
        let mut whole = (-samples + slack) as i64;
        if whole as f64 > -samples + slack {
            whole -= 1;
        }
        let share = -samples - whole as f64;
        let share = if share < slack { 0.0 } else { share };
        Ok(Self {
            whole,
            share,
            inside: weights((REACH - 1) as f64 + share, NODES),
            around: VecDeque::new(),
            first: 0,
            next: 0,
            held: 0,
            ends: [0.0; 2],
        })
    }

    /// Samples so far that were read outside the record and took the value of the nearest one.
    #[must_use]
    pub const fn held(&self) -> usize {
        self.held
    }

    fn taken(&self) -> i64 {
        self.first + self.around.len() as i64
    }

    /// Reads the next sample from those that are there.
    fn read(&mut self) -> f64 {
        let at = self.next + self.whole;
        self.next += 1;
        let taken = self.taken();
        if at < 0 || at >= taken || (at == taken - 1 && self.share > 0.0) {
            self.held += 1;
            return self.ends[usize::from(at >= 0)];
        }
        // Towards the ends the first and the last six samples' polynomial.
        let reach = REACH as i64 - 1;
        let nodes = taken.min(NODES as i64);
        let from = (at - reach).clamp(0, taken - nodes);
        let before = (from.min(taken - NODES as i64) - self.first).max(0);
        self.around.drain(..before as usize);
        self.first += before;
        let start = (from - self.first) as usize;
        if self.share == 0.0 {
            return self.around[start + (at - from) as usize];
        }
        let weights = if at - from == reach && nodes == NODES as i64 {
            self.inside
        } else {
            weights((at - from) as f64 + self.share, nodes as usize)
        };
        let nodes = self.around.range(start..start + nodes as usize);
        nodes.zip(weights).map(|(x, weight)| weight * x).sum()
    }
}

/// Weights of `nodes` samples, one step apart, for the value at `place` counted from the first of them.
fn weights(place: f64, nodes: usize) -> [f64; NODES] {
    core::array::from_fn(|k| {
        (0..nodes)
            .filter(|node| *node != k)
            .map(|node| (place - node as f64) / (k as f64 - node as f64))
            .product()
    })
}

impl Stage for Delay {
    fn push(&mut self, samples: &[f64], out: &mut Vec<f64>) {
        for x in samples {
            if self.taken() == 0 {
                self.ends[0] = *x;
            }
            self.ends[1] = *x;
            self.around.push_back(*x);
            let taken = self.taken();
            while taken >= NODES as i64
                && self.next < taken
                && self.next + self.whole + (REACH as i64) < taken
            {
                let read = self.read();
                out.push(read);
            }
        }
    }

    fn finish(&mut self, out: &mut Vec<f64>) -> Result<()> {
        while self.next < self.taken() {
            let read = self.read();
            out.push(read);
        }
        Ok(())
    }
}

/// The series at t - `delay_s` for each of its own instants t, and the number of samples held at an end.
///
/// Brings a channel whose samples are taken `delay_s` *after* the clock tick they are filed under (a multiplexed
/// converter's later channels) to the tick; a negative delay brings it back from before the tick. Left alone, a delay d
/// is an error of 2 pi f d of the amplitude: 0.3 % at 50 Hz and 10 microseconds.
///
/// The length stays, so that channels stay side by side. The instants that fall outside the record, the first or,
/// for a negative delay, the last |`delay_s`| times the sample rate rounded up, take the nearest sample's value; their
/// number is returned, and a strict caller cuts them off all channels. A whole number of samples changes no bit of them.
///
/// # Errors
/// [`crate::Error::OutOfRange`] for a sample rate that is not positive and finite or a delay that is not finite or leaves no instant
/// within the record; [`crate::Error::TooFewSamples`] below [`MIN_SAMPLES`]; [`crate::Error::NotFinite`], [`crate::Error::Overflow`].
pub fn delayed(series: &[f64], delay_s: f64, sample_rate_hz: f64) -> Result<(Vec<f64>, usize)> {
    require_positive("sample_rate_hz", sample_rate_hz)?;
    require_samples("delay", MIN_SAMPLES, series.len())?;
    let shift = delay_s * sample_rate_hz;
    // A range, so that NaN is refused, too.
    require(
        (0.0..=(series.len() - 1) as f64).contains(&shift.abs()),
        "delay_s",
        delay_s,
        "finite and at most the record's duration",
    )?;
    let mut stage = Delay::new(shift)?;
    let mut moved = series.to_vec();
    stage::whole("delay", &mut stage, &mut moved)?;
    Ok((moved, stage.held))
}
