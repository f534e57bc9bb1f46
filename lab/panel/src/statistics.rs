//! What nine channels show right now: range, mean, noise floor, clipping, and whether the sensor rests.

use serde::Serialize;
use sixaxis_core::LIMBS;

/// Length of a window, s.
pub const WINDOW_S: f64 = 0.25;
/// Samples of a window at least.
const FEWEST: u64 = 16;
/// At rest, a channel's standard deviation is at most so many times its white noise.
const REST: f64 = 1.5;
/// Of white noise the two differ by chance, by 1.3 over the root of a window's samples; five times that is chance. Of nine channels at rest one is
/// beyond in 0.7 % of windows of [`FEWEST`] samples, 0.1 % of 25, and less of more.
const CHANCE: f64 = 5.0 * 1.3;
/// Variance of third differences over that of white noise: 1 + 9 + 9 + 1. Their mean square and not the median of the core's
/// `noise_floor`, which may be 0 below half a converter's step: such a sensor would never rest.
const THIRD_DIFFERENCES: f64 = 20.0;

/// One channel in one window.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Channel {
    /// Smallest sample, V.
    pub min_v: f64,
    /// Largest sample, V.
    pub max_v: f64,
    /// Mean, V: the zero drift, while the sensor rests.
    pub mean_v: f64,
    /// Standard deviation, V.
    pub deviation_v: f64,
    /// White noise, V, from third differences, in which a motion of some Hz is not seen.
    pub noise_v: f64,
    /// Samples at the converter's limit since counting began.
    pub clipped: u64,
    /// Samples that are not finite since counting began.
    pub not_finite: u64,
}

/// Sums of a window that is not complete.
#[derive(Debug, Clone, Copy)]
struct Sums {
    min: f64,
    max: f64,
    /// First sample, which the sums are about: a mean of volts has noise of millivolts on it.
    origin: f64,
    sum: f64,
    squares: f64,
    differences: f64,
    last: [f64; 3],
    samples: u64,
    differenced: u64,
}

impl Sums {
    const NONE: Self = Self {
        min: f64::INFINITY,
        max: f64::NEG_INFINITY,
        origin: 0.0,
        sum: 0.0,
        squares: 0.0,
        differences: 0.0,
        last: [0.0; 3],
        samples: 0,
        differenced: 0,
    };

    fn take(&mut self, u: f64) {
        if self.samples == 0 {
            self.origin = u;
        }
        self.min = self.min.min(u);
        self.max = self.max.max(u);
        let from_origin = u - self.origin;
        self.sum += from_origin;
        self.squares += from_origin * from_origin;
        if self.samples >= 3 {
            let [a, b, c] = self.last;
            let difference = u - 3.0 * c + 3.0 * b - a;
            self.differences += difference * difference;
            self.differenced += 1;
        }
        self.last = [self.last[1], self.last[2], u];
        self.samples += 1;
    }

    fn channel(&self, before: Channel) -> Channel {
        let samples = self.samples.max(1) as f64;
        let mean = self.sum / samples;
        Channel {
            min_v: self.min,
            max_v: self.max,
            mean_v: self.origin + mean,
            deviation_v: (self.squares / samples - mean * mean).max(0.0).sqrt(),
            noise_v: (self.differences / THIRD_DIFFERENCES / self.differenced.max(1) as f64).sqrt(),
            ..before
        }
    }
}

/// Statistics of the stream.
#[derive(Debug, Clone)]
pub struct Statistics {
    full_scale_v: f64,
    window: u64,
    sums: [Sums; LIMBS],
    samples: u64,
    /// The last complete window.
    pub channels: [Channel; LIMBS],
    /// Whether the sensor rested in the last complete window, all of it.
    pub at_rest: bool,
}

impl Statistics {
    /// Nothing seen.
    pub fn new(full_scale_v: f64, sample_rate_hz: f64) -> Self {
        Self {
            full_scale_v,
            window: ((WINDOW_S * sample_rate_hz) as u64).max(FEWEST),
            sums: [Sums::NONE; LIMBS],
            samples: 0,
            channels: [Channel::default(); LIMBS],
            at_rest: false,
        }
    }

    /// Takes nine voltages; true when a window is complete with them.
    pub fn push(&mut self, row: &[f64; LIMBS]) -> bool {
        for ((u, sums), channel) in row.iter().zip(&mut self.sums).zip(&mut self.channels) {
            if u.is_finite() {
                sums.take(*u);
                channel.clipped += u64::from(u.abs() >= self.full_scale_v);
            } else {
                channel.not_finite += 1;
            }
        }
        self.samples += 1;
        let complete = self.samples == self.window;
        if complete {
            for (channel, sums) in self.channels.iter_mut().zip(&mut self.sums) {
                *channel = std::mem::replace(sums, Sums::NONE).channel(*channel);
            }
            let most = f64::max(REST, 1.0 + CHANCE / (self.window as f64).sqrt());
            self.at_rest = self
                .channels
                .iter()
                .all(|c| c.deviation_v <= most * c.noise_v);
            self.samples = 0;
        }
        complete
    }

    /// Counts from zero again.
    pub fn clear_counts(&mut self) {
        for channel in &mut self.channels {
            (channel.clipped, channel.not_finite) = (0, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(state: &mut u64) -> f64 {
        let mut unit = || {
            *state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (*state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| unit()).sum::<f64>() - 6.0
    }

    #[test]
    fn stat_noise_is_told_from_motion() {
        let mut statistics = Statistics::new(10.0, 10_000.0);
        let mut state = 1;
        for (moving, rests) in [(0.0, true), (1.0, false)] {
            for k in 0..2_500 {
                let motion = moving * (core::f64::consts::TAU * 5.0 * f64::from(k) / 1e4).sin();
                let row = core::array::from_fn(|_| 2.0 + motion + 1e-3 * noise(&mut state));
                statistics.push(&row);
            }
            assert_eq!(statistics.at_rest, rests);
            for channel in &statistics.channels {
                assert!((channel.noise_v / 1e-3 - 1.0).abs() < 0.1, "{channel:?}");
            }
        }
    }

    /// At any rate that the page takes a sensor that stands still is seen to, in all windows but one in fifty at most, and one that moves by ten
    /// times its noise is seen to move.
    #[test]
    fn stat_rest_is_told_at_every_rate() {
        let mut state = 2;
        for rate_hz in [10.0, 32.0, 64.0, 100.0, 200.0, 1e3, 1e4] {
            for amplitude in [0.0, 1e-2] {
                let mut statistics = Statistics::new(10.0, rate_hz);
                let (mut windows, mut at_rest) = (0, 0);
                for k in 0.. {
                    let phase = core::f64::consts::TAU * f64::from(k) / 12.0_f64.max(rate_hz / 3.0);
                    let motion = amplitude * phase.sin();
                    let row = core::array::from_fn(|_| motion + 1e-3 * noise(&mut state));
                    if statistics.push(&row) {
                        windows += 1;
                        at_rest += u32::from(statistics.at_rest);
                        if windows == 400 || f64::from(k) > 40.0 * rate_hz {
                            break;
                        }
                    }
                }
                let rested = amplitude == 0.0;
                let wrong = if rested { windows - at_rest } else { at_rest };
                assert!(
                    50 * wrong <= windows,
                    "{rate_hz} Hz, {amplitude}: {wrong} of {windows}"
                );
            }
        }
    }

    #[test]
    fn law_clipped_and_broken_samples_are_counted() {
        let mut statistics = Statistics::new(10.0, 100.0);
        let mut row = [0.0; LIMBS];
        (row[2], row[5]) = (-10.0, f64::NAN);
        (0..25).for_each(|_| {
            statistics.push(&row);
        });
        assert_eq!(statistics.channels[2].clipped, 25);
        assert_eq!(statistics.channels[5].not_finite, 25);
        statistics.clear_counts();
        assert_eq!(statistics.channels[2].clipped, 0);
    }
}
