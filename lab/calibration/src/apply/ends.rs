//! Whether a recording begins in motion, and a run from rest to rest ends in it: voltages that change from one end on.
//!
//! At the first sample the rate is taken for zero. A sensor that turns there already is decoupled with an error that nothing shows later. So is
//! one whose channels do not begin at their zeros: those have moved since, or the recording is a part of a longer one.

use sixaxis_core::{LIMBS, LimbSet};

use super::Row;
use super::setup::Setup;
use crate::calibration::Calibration;

/// Time over which a channel changes, s, and samples of it at least: from the mean over a period of mains to that over the next one, so that
/// hum of 50 Hz cancels.
const PERIOD_S: f64 = 0.02;
const FEWEST: usize = 8;
/// Change in standard deviations of one sample and over the converter's range that is a motion's: at 60 dB and 1 Hz a channel changes by a
/// hundred of the former.
const DEVIATIONS: f64 = 10.0;
const OF_RANGE: f64 = 1e-3;
/// The same in the channel's largest change later in the recording.
const OF_THE_RUN: f64 = 0.35;
/// Standard deviations of a calibrated zero and of the mean of the first samples, and over the converter's range, by which a channel begins
/// off its zero.
const OFF_ZERO: f64 = 6.0;
const OFF_ZERO_OF_RANGE: f64 = 2e-5;
/// Periods over which a channel that stands still at the beginning is averaged, five of 50 Hz and six of 60 Hz, how often at most, and standard
/// deviations of such means' difference within which it stands.
const AVERAGED: usize = 5;
const AVERAGES: usize = 2;
const STANDS: f64 = 4.0;
/// Of the scatter of hum of 60 Hz, what a mean over 20 ms keeps at most: sqrt 2 sin(1.2 pi) / (1.2 pi).
const HUM: f64 = 0.2205;
/// Of so many places one is looked at.
const EVERY: usize = 4;

/// The samples at both ends.
#[derive(Debug, Clone)]
pub struct Ends {
    /// Samples that are looked at: two periods.
    kept: usize,
    kept_s: f64,
    least_v: Row,
    zero_v: Row,
    zero_sd_v: Row,
    noise_v: Row,
    full_scale_v: f64,
    /// Samples of the beginning that are remembered, longer than those two periods.
    remembered: usize,
    first: Vec<Row>,
    last: Vec<Row>,
    /// The largest change anywhere else, of the places that are looked at.
    most_v: Row,
    /// Samples since the beginning of the present place, and sums over its two halves, V.
    phase: usize,
    sums_v: [Row; 2],
}

impl Ends {
    /// Nothing seen yet.
    pub fn new(setup: &Setup, calibration: &Calibration, sample_rate_hz: f64) -> Self {
        let kept = 2 * FEWEST.max((PERIOD_S * sample_rate_hz).round() as usize);
        let noise_v = calibration.covariance.propagated.as_ref();
        let covariance = noise_v.and_then(|known| known.total());
        Self {
            kept,
            kept_s: kept as f64 / sample_rate_hz,
            least_v: core::array::from_fn(|limb| {
                let noise_v = noise_v.map_or(0.0, |known| known.channel_noise_v[limb]);
                (DEVIATIONS * noise_v).max(OF_RANGE * setup.full_scale_v)
            }),
            zero_v: setup.parameters.zero_drift_v,
            zero_sd_v: core::array::from_fn(|limb| {
                let variance = covariance.as_ref().map_or(0.0, |known| known[(limb, limb)]);
                variance.max(0.0).sqrt()
            }),
            noise_v: noise_v.map_or([0.0; LIMBS], |known| known.channel_noise_v),
            full_scale_v: setup.full_scale_v,
            remembered: AVERAGES * AVERAGED * kept / 2,
            first: Vec::new(),
            last: Vec::new(),
            most_v: [0.0; LIMBS],
            phase: 0,
            sums_v: Default::default(),
        }
    }

    /// Looks at the next samples, nine columns of voltages.
    pub fn look(&mut self, voltage_v: [&[f64]; LIMBS]) {
        let missing = self.kept.saturating_sub(self.first.len());
        let samples = voltage_v[0].len();
        let remembered = self.remembered.saturating_sub(self.first.len());
        for at in 0..remembered.min(samples) {
            self.first.push(voltage_v.map(|column| column[at]));
        }
        let half = self.kept / 2;
        let mut at = missing.min(samples);
        // A stream hands over a few samples at a time, of which a place has many.
        while at < samples {
            let (end, which) = match self.phase {
                phase if phase < half => (half, Some(0)),
                phase if phase < self.kept => (self.kept, Some(1)),
                _ => (EVERY * self.kept, None),
            };
            let until = samples.min(at + end - self.phase);
            if let Some(sums_v) = which.map(|which| &mut self.sums_v[which]) {
                for (sum_v, column) in sums_v.iter_mut().zip(voltage_v) {
                    *sum_v += column[at..until].iter().sum::<f64>();
                }
            }
            self.phase += until - at;
            at = until;
            if self.phase == self.kept {
                let [first_v, second_v] = core::mem::take(&mut self.sums_v);
                for (limb, most_v) in self.most_v.iter_mut().enumerate() {
                    *most_v = most_v.max((second_v[limb] - first_v[limb]).abs() / half as f64);
                }
            }
            if self.phase == EVERY * self.kept {
                self.phase = 0;
            }
        }
    }

    /// The same of a run whose end is of interest, too.
    pub fn look_to_the_end(&mut self, voltage_v: [&[f64]; LIMBS]) {
        self.look(voltage_v);
        let samples = voltage_v[0].len();
        for at in samples.saturating_sub(self.kept)..samples {
            self.last.push(voltage_v.map(|column| column[at]));
        }
        self.last.drain(..self.last.len().saturating_sub(self.kept));
    }

    /// The channel, from 0, that changes most for its noise from the first half of these rows to the second, and its change, V; none if none
    /// does, or if it scatters by more about a straight line, as with hum of 60 Hz.
    fn changing(&self, rows: &[Row]) -> Option<(usize, f64)> {
        let half = rows.len() / 2;
        let mean = |limb: usize, rows: &[Row]| {
            rows.iter().map(|row| row[limb]).sum::<f64>() / rows.len() as f64
        };
        let moved = |limb: usize| {
            let means = [mean(limb, &rows[..half]), mean(limb, &rows[half..])];
            let (change_v, middle_v) = (means[1] - means[0], 0.5 * (means[0] + means[1]));
            let middle = 0.5 * (rows.len() as f64 - 1.0);
            let off = rows.iter().enumerate().map(|(at, row)| {
                let line = middle_v + change_v * (at as f64 - middle) / half as f64;
                (row[limb] - line).powi(2)
            });
            let scatter_v = (off.sum::<f64>() / rows.len() as f64).sqrt();
            (change_v.abs() > self.least_v[limb].max(scatter_v)).then_some((limb, change_v))
        };
        let over = |(limb, change_v): &(usize, f64)| change_v.abs() / self.least_v[*limb];
        (0..LIMBS)
            .filter_map(moved)
            .max_by(|a, b| over(a).total_cmp(&over(b)))
    }

    /// That the recording begins in motion.
    pub fn begins_in_motion(&self) -> Option<String> {
        if self.first.len() < self.kept {
            return None;
        }
        let (limb, change_v) = self.changing(&self.first[..self.kept])?;
        // A motion that begins gently changes by little at first.
        if change_v.abs() < OF_THE_RUN * self.most_v[limb] {
            return None;
        }
        Some(format!(
            "it begins in motion: limb {} changes by {:.3} V within the first {:.0} ms. At the first sample the rate is taken for zero; if the sensor was turning, \
             rates, attitude and all in ground axes are wrong from there on, by more than any stated deviation: cut the recording at a rest",
            limb + 1,
            change_v.abs(),
            1e3 * self.kept_s
        ))
    }

    /// That channels of limbs that are not `excluded` begin off their zeros, in a recording that does not begin in motion; none in one that is
    /// too short for means in which hum of 50 and of 60 Hz cancels.
    pub fn begins_off_zero(&self, excluded: LimbSet) -> Option<String> {
        let half = self.kept / 2;
        if self.first.len() < AVERAGED * half || self.changing(&self.first[..self.kept]).is_some() {
            return None;
        }
        let off = |limb: usize| {
            let mean_v = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
            let values: Vec<f64> = self.first.iter().map(|row| row[limb]).collect();
            let scatter_v = |values: &[f64]| {
                let middle_v = mean_v(values);
                let squares = values.iter().map(|v| (v - middle_v).powi(2));
                (squares.sum::<f64>() / (values.len() - 1) as f64).sqrt()
            };
            // A low-pass takes noise off the samples, and not off their mean.
            let noise_v = scatter_v(&values[..half]).max(self.noise_v[limb]) / (half as f64).sqrt();
            let periods: Vec<f64> = values.chunks_exact(half).map(mean_v).collect();
            // What hum and a motion that begins at rest add to the periods' means shows in how these scatter.
            let sd_v = |periods: &[f64]| noise_v.max(scatter_v(periods));
            let (first, second) = periods.split_at(AVERAGED);
            let stands_v = STANDS * (2.0 / AVERAGED as f64).sqrt() * sd_v(first);
            let stands = second.len() >= AVERAGED
                && (mean_v(&second[..AVERAGED]) - mean_v(first)).abs() < stands_v;
            let periods = &periods[..if stands { AVERAGES } else { 1 } * AVERAGED];
            let mean_sd_v = sd_v(periods) / (periods.len() as f64).sqrt();
            let least_v = OFF_ZERO * self.zero_sd_v[limb].hypot(mean_sd_v);
            let off_v = mean_v(periods) - self.zero_v[limb];
            let resolved_v = OFF_ZERO_OF_RANGE * self.full_scale_v;
            if off_v.abs() > least_v.max(resolved_v) {
                return Some((limb, off_v));
            }
            // A motion may begin sooner: the periods until then, and what hum leaves of their mean.
            let still =
                |mean_v: &&f64| (**mean_v - first[0]).abs() < STANDS * 2_f64.sqrt() * noise_v;
            let until = first.iter().take_while(still).count().max(1);
            let least_v = OFF_ZERO * self.zero_sd_v[limb].hypot(noise_v / (until as f64).sqrt())
                + HUM * scatter_v(&values[..half]);
            let off_v = mean_v(&first[..until]) - self.zero_v[limb];
            let moved_v = first[until - 1] - first[0];
            let is_off = off_v.abs() > least_v.max(resolved_v).max(2.0 * moved_v.abs());
            is_off.then_some((limb, off_v))
        };
        let off: Vec<(usize, f64)> = (0..LIMBS)
            .filter(|limb| !excluded.contains(*limb))
            .filter_map(off)
            .collect();
        let (limb, most_v) = (off.iter()).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        Some(format!(
            "{} of its channels do not begin at their calibrated zeros, limb {} stands {:+.2} mV off its: at the first sample the sensor is taken to be at rest, as \
             when the channels were zeroed. If zeros have moved since the calibration, or this is a part of a longer recording, rates, attitude and all in ground \
             axes drift by more than any stated deviation",
            off.len(),
            limb + 1,
            1e3 * most_v
        ))
    }

    /// That a run ends in motion.
    pub fn ends_in_motion(&self) -> Option<String> {
        let whole = self.last.len() == self.kept;
        let (limb, change_v) = whole.then(|| self.changing(&self.last))??;
        Some(format!(
            "it ends in motion: limb {} changes by {:.3} V within the last {:.0} ms, and --rest-to-rest takes off whatever makes the rate there zero: the result is wrong",
            limb + 1,
            change_v.abs(),
            1e3 * self.kept_s
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE_V: f64 = 7e-3;

    /// Channels at rest at their zeros but for an offset of limb 4, with white noise and hum of 60 Hz of any phase.
    fn said(rate_hz: f64, hum_v: f64, off_v: f64) -> Option<String> {
        let kept = 2 * (PERIOD_S * rate_hz) as usize;
        let mut ends = Ends {
            kept,
            kept_s: 2.0 * PERIOD_S,
            least_v: [DEVIATIONS * NOISE_V; LIMBS],
            zero_v: [0.1; LIMBS],
            zero_sd_v: [1e-5; LIMBS],
            noise_v: [NOISE_V; LIMBS],
            full_scale_v: 10.0,
            remembered: AVERAGES * AVERAGED * kept / 2,
            first: Vec::new(),
            last: Vec::new(),
            most_v: [0.0; LIMBS],
            phase: 0,
            sums_v: Default::default(),
        };
        // Twelve uniform numbers less six are nearly normal.
        let mut state = 1_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let columns: [Vec<f64>; LIMBS] = core::array::from_fn(|limb| {
            let value = |sample: usize| {
                let normal = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
                let turns = 60.0 * sample as f64 / rate_hz + limb as f64 / LIMBS as f64;
                let hum_v = hum_v * (core::f64::consts::TAU * turns).sin();
                let off_v = if limb == 3 { off_v } else { 0.0 };
                0.1 + off_v + hum_v + NOISE_V * normal
            };
            (0..(0.3 * rate_hz) as usize).map(value).collect()
        });
        ends.look(columns.each_ref().map(|column| &column[..]));
        assert_eq!(ends.begins_in_motion(), None);
        ends.begins_off_zero(LimbSet::EMPTY)
    }

    #[test]
    fn hum_of_sixty_hertz_moves_no_zero() {
        for (rate_hz, hum_v) in [(5e4, 0.0), (5e4, 0.05), (1e5, 0.02), (1e4, 0.05)] {
            assert_eq!(said(rate_hz, hum_v, 0.0), None, "{rate_hz} {hum_v}");
            let off = said(rate_hz, hum_v, 0.02).expect("a zero that has moved");
            assert!(
                off.contains("1 of its channels") && off.contains("limb 4 stands +"),
                "{off}"
            );
        }
    }
}
