//! The onset of the decay in the recording of a tap, and the part of the decay that is used.

use alloc::vec::Vec;

use crate::dsp::outlier::median;
use crate::geometry::LIMBS;

/// From the largest sample to where the contact is over, s: the contact of a hammer's tip lasts 0.1 to 0.3 ms, and
/// the response is largest in its second half. A contact that lasts longer shows in the residuals.
const CONTACT_S: f64 = 0.15e-3;
/// Length of a stretch over which the size of the decay is measured, s.
const STRETCH_S: f64 = 1e-3;
/// Size, over that of the first stretch, below which the rest of the decay is not used.
const FADED: f64 = 0.01;

/// A tap as it shows in the nine channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Onset {
    /// Each channel's level without motion: its median. Most of a record is before the tap, after it, or of either sign.
    pub level_v: [f64; LIMBS],
    /// Each channel's largest departure from it.
    pub peak_v: [f64; LIMBS],
    /// First sample at which the contact should be over.
    pub decay_from: usize,
}

/// Finds the largest sample, all channels together.
pub(super) fn find(voltage_v: &[[f64; LIMBS]], sample_rate_hz: f64) -> Onset {
    let level_v: [f64; LIMBS] = core::array::from_fn(|limb| {
        let mut series: Vec<f64> = voltage_v.iter().map(|row| row[limb]).collect();
        median(&mut series)
    });
    let mut peak_v = [0.0_f64; LIMBS];
    let (mut largest, mut at) = (0.0, 0);
    for (sample, row) in voltage_v.iter().enumerate() {
        for (limb, peak) in peak_v.iter_mut().enumerate() {
            *peak = peak.max((row[limb] - level_v[limb]).abs());
        }
        let size = squares(row, &level_v);
        if size > largest {
            (largest, at) = (size, sample);
        }
    }
    Onset {
        level_v,
        peak_v,
        decay_from: at + 1 + (CONTACT_S * sample_rate_hz) as usize,
    }
}

/// End of the useful decay from a sample on.
pub(super) fn end(
    voltage_v: &[[f64; LIMBS]],
    onset: &Onset,
    from: usize,
    sample_rate_hz: f64,
) -> usize {
    let length = ((STRETCH_S * sample_rate_hz) as usize).max(1);
    let decay = voltage_v.get(from..).unwrap_or_default();
    let sizes = decay.chunks(length).map(|stretch| {
        let sum: f64 = stretch.iter().map(|row| squares(row, &onset.level_v)).sum();
        sum / stretch.len() as f64
    });
    let mut first = None;
    for (stretch, size) in sizes.enumerate() {
        let first = *first.get_or_insert(size);
        if size < FADED * FADED * first {
            return from + stretch * length;
        }
    }
    voltage_v.len()
}

fn squares(row: &[f64; LIMBS], level_v: &[f64; LIMBS]) -> f64 {
    row.iter()
        .zip(level_v)
        .map(|(u, level)| (u - level) * (u - level))
        .sum()
}
