//! Frequency of a drive, as a series shows it.
//!
//! Zero crossings tell it, by the median cycle. Where that is far from what is stated, rig or frame may vibrate on top of the motion, or an
//! instrument may show noise alone: the series is looked at once more with what is fast taken off.

use sixaxis_core::dsp::spectrum::noise_floor;

use crate::diagnosis::structure::varies_as_noise;
use crate::series::deviation;

/// Factor from the stated frequency at which another one is looked at once more.
const FAR: f64 = 1.5;
/// Factor from the stated frequency within which the second look finds a drive: its low-pass leaves a fifth at the upper end.
const WITHIN: f64 = 2.5;
/// The second look's low-pass is the mean over this share of a stated cycle, twice: 0.81 is left at the stated frequency, 0.41 at twice that,
/// less than a twentieth from four times on.
const AVERAGED: f64 = 0.25;
/// Share of the series' deviation that the slow motion has at least: what is left of a faster drive has less.
const SLOW_SHARE: f64 = 0.2;
/// Times what noise leaves after averaging that the slow motion has at least.
const ABOVE_NOISE: f64 = 3.0;
/// Share by which cycles of a drive up to speed differ, and share of all cycles that are so alike: run-up and run-down have the rest.
const ALIKE: f64 = 0.1;
const ALIKE_CYCLES: f64 = 0.5;

/// Frequency of a series once up to speed, Hz, by which a drive that is stated to turn at `stated_hz` turns.
///
/// None for less than three whole cycles, and for noise.
pub(crate) fn frequency(series: &[f64], sample_rate_hz: f64, stated_hz: f64) -> Option<f64> {
    let seen_hz = sample_rate_hz / median(&mut cycles(series))?;
    if (1.0 / FAR..=FAR).contains(&(seen_hz / stated_hz)) {
        return Some(seen_hz);
    }
    below_vibration(series, sample_rate_hz, stated_hz)
        .or_else(|| (!varies_as_noise(series)).then_some(seen_hz))
}

/// The frequency of what is left of a series below vibration, where that is a drive's.
fn below_vibration(series: &[f64], sample_rate_hz: f64, stated_hz: f64) -> Option<f64> {
    let half = (0.5 * AVERAGED * sample_rate_hz / stated_hz).round();
    // Written so that NaN, of no stated frequency, is none.
    if !(half >= 1.0 && 2.0 * half < series.len() as f64) {
        return None;
    }
    let slow = averaged(&averaged(series, half as usize), half as usize);
    // Of two means over n samples white noise leaves (2 / 3 n)^(1/2).
    let of_noise = noise_floor(series).ok()? * (2.0 / (3.0 * (2.0 * half + 1.0))).sqrt();
    let least = (SLOW_SHARE * deviation(series)).max(ABOVE_NOISE * of_noise);
    let mut cycles = cycles(&slow);
    let middle = median(&mut cycles).filter(|_| deviation(&slow) > least)?;
    let alike = cycles
        .iter()
        .filter(|cycle| (*cycle / middle - 1.0).abs() < ALIKE);
    let steady = alike.count() as f64 >= ALIKE_CYCLES * cycles.len() as f64;
    let slow_hz = sample_rate_hz / middle;
    (steady && (1.0 / WITHIN..=WITHIN).contains(&(slow_hz / stated_hz))).then_some(slow_hz)
}

/// Means over so many samples on either side; at the ends over those that there are.
fn averaged(series: &[f64], half: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    for value in series {
        sums.push(sums[sums.len() - 1] + value);
    }
    (0..series.len())
        .map(|n| {
            let (from, to) = (n.saturating_sub(half), (n + half + 1).min(series.len()));
            (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}

/// Lengths of the cycles of a series, samples.
fn cycles(series: &[f64]) -> Vec<f64> {
    let peak = series.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    // Upward crossings of zero, each after a dip below a third of the peak, so that noise about zero does not count.
    let mut crossings = Vec::new();
    let mut armed = false;
    for (i, pair) in series.windows(2).enumerate() {
        armed |= pair[0] < -peak / 3.0;
        if armed && pair[0] < 0.0 && pair[1] >= 0.0 {
            crossings.push(i as f64 + pair[0] / (pair[0] - pair[1]));
            armed = false;
        }
    }
    crossings.windows(2).map(|w| w[1] - w[0]).collect()
}

/// The cycle in the middle, of which the run-up and the run-down have one each; none of less than three.
fn median(cycles: &mut [f64]) -> Option<f64> {
    if cycles.len() < 3 {
        return None;
    }
    cycles.sort_unstable_by(f64::total_cmp);
    Some(cycles[cycles.len() / 2])
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use super::*;

    const RATE_HZ: f64 = 1000.0;
    /// Share by which crossings that vibration moves leave a frequency open: of seven cycles, one is a median.
    const OPEN: f64 = 0.02;

    /// Twelve seconds of a drive at some Hz with a vibration and noise of a reproducible kind.
    fn series(drive_hz: f64, vibration: (f64, f64), noise: f64) -> Vec<f64> {
        let mut state = 0.5_f64;
        (0..12_000)
            .map(|n| {
                state = (state * 997.0 + 0.123).fract();
                let t = n as f64 / RATE_HZ;
                (TAU * drive_hz * t).sin()
                    + vibration.1 * (TAU * vibration.0 * t).sin()
                    + noise * (state - 0.5)
            })
            .collect()
    }

    #[test]
    fn inv_a_drive_is_seen_below_its_vibration() {
        for hz in [43.0, 70.0, 120.0] {
            for share in [0.3, 0.6, 1.0] {
                for (drive_hz, stated_hz) in [(1.0, 1.0), (2.0, 1.0), (0.5, 1.0)] {
                    let shaken = series(drive_hz, (hz, share), 0.1);
                    let seen_hz = frequency(&shaken, RATE_HZ, stated_hz).expect("a drive");
                    let case = format!("{share} at {hz} Hz on {drive_hz} Hz: {seen_hz}");
                    assert!((seen_hz / drive_hz - 1.0).abs() < OPEN, "{case}");
                }
            }
        }
    }

    #[test]
    fn neg_a_drive_that_turns_otherwise_is_no_vibration() {
        for stated_hz in [0.02, 0.1, 0.3, 1.8, 6.0, 60.0, 1000.0] {
            let seen_hz = frequency(&series(1.0, (50.0, 0.0), 0.01), RATE_HZ, stated_hz);
            let seen_hz = seen_hz.expect("a drive");
            assert!((seen_hz - 1.0).abs() < OPEN, "{stated_hz}: {seen_hz}");
        }
    }

    #[test]
    fn neg_noise_has_no_frequency() {
        for stated_hz in [0.5, 1.0, 2.0, 5.0] {
            let still: Vec<f64> = series(1.0, (50.0, 0.0), 1.0)
                .iter()
                .zip(series(1.0, (50.0, 0.0), 0.0))
                .map(|(noisy, pure)| noisy - pure)
                .collect();
            assert_eq!(frequency(&still, RATE_HZ, stated_hz), None, "{stated_hz}");
        }
    }
}
