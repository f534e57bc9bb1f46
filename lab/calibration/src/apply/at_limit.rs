//! Which samples at the end of the converter's range are failed channels, and which are of a sensor that was driven too hard.

use sixaxis_core::LIMBS;
use sixaxis_core::redundancy::fault::monitor::QUIET;

use super::voltages::Voltages;

/// Channels that stand at the end of the range and are failed ones for the fault monitor. Where more of them do, at once or one after another,
/// the sensor was driven too hard: that is no failure, and the monitor could not do without them.
const BLINDED: usize = 2;
/// Samples within which that is one after another: as many as the monitor does without a limb at least.
pub(super) const NEAR: u64 = QUIET;

/// The samples at which each channel stands at the end of the range, ascending.
#[derive(Debug, Clone, Default)]
pub(super) struct AtLimit {
    samples: [Vec<u64>; LIMBS],
}

impl AtLimit {
    /// A limb stands there at a sample, later than any so far.
    pub fn push(&mut self, limb: usize, sample: u64) {
        self.samples[limb].push(sample);
    }

    /// How often a limb does within [`NEAR`] of a sample, and of how many samples that is.
    fn near(&self, limb: usize, sample: u64) -> (usize, u64) {
        let (from, to) = (sample.saturating_sub(NEAR), sample + NEAR);
        let before = |end: u64| self.samples[limb].partition_point(|&at| at < end);
        (before(to + 1) - before(from), to + 1 - from)
    }

    /// Whether one that stands there at a sample is a failed channel: few do about then, or few nearly all the time, beside which others may clip.
    fn has_failed(&self, limb: usize, sample: u64) -> bool {
        let of = |limb: usize| self.near(limb, sample);
        let stays = |limb: usize| {
            let (there, of) = of(limb);
            2 * there as u64 > of
        };
        let count = |is: &dyn Fn(usize) -> bool| (0..LIMBS).filter(|limb| is(*limb)).count();
        count(&|limb| of(limb).0 > 0) <= BLINDED || (stays(limb) && count(&stays) <= BLINDED)
    }

    /// Makes voltages of few limbs there, which the monitor could take for the others' failure, NaN. Those of many stay, and the monitor is
    /// not to look at such samples. The columns begin with sample `first`, and what follows within [`NEAR`] is known.
    pub fn blind(&mut self, first: u64, voltage_v: &mut Voltages) {
        let end = first + voltage_v.samples() as u64;
        for limb in 0..LIMBS {
            for place in 0..self.samples[limb].len() {
                let at = self.samples[limb][place];
                if (first..end).contains(&at) && self.has_failed(limb, at) {
                    voltage_v.columns[limb][(at - first) as usize] = f64::NAN;
                }
            }
        }
        let samples = self.samples.iter_mut();
        samples.for_each(|samples| samples.retain(|&at| at + NEAR >= end));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which of the limbs that stand at the end of the range at these samples are blinded, in blocks of that many samples.
    fn blinded(clips: &[(usize, u64)], block: u64) -> Vec<bool> {
        let samples = 4 * NEAR;
        let mut all: Vec<_> = clips.to_vec();
        all.sort_by_key(|clip| clip.1);
        let (mut limits, mut known) = (AtLimit::default(), 0);
        let mut out: [Vec<f64>; LIMBS] = Default::default();
        for first in (0..samples).step_by(block as usize) {
            let end = (first + block).min(samples);
            for &(limb, at) in &all[known..] {
                if at < end + block.max(NEAR) {
                    limits.push(limb, at);
                    known += 1;
                }
            }
            let column = vec![1.0; (end - first) as usize];
            let mut voltage_v = Voltages {
                columns: core::array::from_fn(|_| column.clone()),
            };
            limits.blind(first, &mut voltage_v);
            for (out, column) in out.iter_mut().zip(&voltage_v.columns) {
                out.extend(column);
            }
        }
        let is_nan = |(limb, at): &(usize, u64)| out[*limb][*at as usize].is_nan();
        assert_eq!(
            out.iter().flatten().filter(|v| v.is_nan()).count(),
            clips.iter().filter(|clip| is_nan(clip)).count()
        );
        clips.iter().map(is_nan).collect()
    }

    #[test]
    fn blocks_do_not_decide_who_has_failed() {
        for block in [NEAR, NEAR + 1, 2 * NEAR, 4 * NEAR] {
            for last in [2 * NEAR - 15, 2 * NEAR + 5] {
                let near = [(0, 2 * NEAR - 35), (4, 2 * NEAR - 25), (5, last)];
                assert_eq!(blinded(&near, block), [false; 3], "{block} {last}");
                assert_eq!(blinded(&near[1..], block), [true; 2], "{block} {last}");
            }
            let apart = [
                (0, 10),
                (4, NEAR + 11),
                (5, 2 * NEAR + 12),
                (8, 3 * NEAR + 13),
            ];
            assert_eq!(blinded(&apart, block), [true; 4], "{block}");
            // One that stays there has failed whatever others do for a moment, of which more than two are too many.
            let mut stays: Vec<_> = (100..4 * NEAR).map(|at| (3, at)).collect();
            stays.extend([(0, 2 * NEAR), (6, 2 * NEAR + 1)]);
            let clipped = stays.len() - 2;
            let found = blinded(&stays, block);
            assert_eq!(found[..clipped], vec![true; clipped], "{block}");
            assert_eq!(found[clipped..], [false; 2], "{block}");
            let chain = [(0, 10), (4, NEAR), (5, 2 * NEAR)];
            assert_eq!(blinded(&chain, block), [true, false, true], "{block}");
        }
    }
}
