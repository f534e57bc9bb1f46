//! Whether a recording begins in motion, and a run from rest to rest ends in it: voltages that change from one end on.
//!
//! At the first sample the rate is taken for zero. A sensor that turns there already is decoupled with an error that nothing shows later.

use sixaxis_core::LIMBS;

use super::Row;
use super::setup::Setup;
use crate::calibration::Calibration;

/// Time over which channels change, s, and samples of it at least.
const WINDOW_S: f64 = 5e-3;
const FEWEST: usize = 8;
/// Whole periods of mains of 50 and of 60 Hz, s: after these hum is where it was, and a motion is not.
const MAINS_S: f64 = 0.1;
/// Change over the window, in standard deviations of one sample and over the converter's range, that is a motion's: at 60 dB and 1 Hz a
/// channel changes by thirty of the former.
const DEVIATIONS: f64 = 10.0;
const OF_RANGE: f64 = 1e-3;

/// The samples at both ends.
#[derive(Debug, Clone)]
pub struct Ends {
    window: usize,
    kept: usize,
    window_s: f64,
    least_v: Row,
    first: Vec<Row>,
    last: Vec<Row>,
    said: bool,
}

impl Ends {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(setup: &Setup, calibration: &Calibration, sample_rate_hz: f64) -> Self {
        let window = FEWEST.max((WINDOW_S * sample_rate_hz) as usize);
        let noise_v = calibration.covariance.propagated.as_ref();
        Self {
            window,
            kept: window + (MAINS_S * sample_rate_hz).round() as usize,
            window_s: window as f64 / sample_rate_hz,
            least_v: core::array::from_fn(|limb| {
                let noise_v = noise_v.map_or(0.0, |known| known.channel_noise_v[limb]);
                (DEVIATIONS * noise_v).max(OF_RANGE * setup.full_scale_v)
            }),
            first: Vec::new(),
            last: Vec::new(),
            said: false,
        }
    }

    /// Looks at the next samples, nine columns of voltages.
    pub fn look(&mut self, voltage_v: [&[f64]; LIMBS]) {
        let missing = self.kept.saturating_sub(self.first.len());
        for at in 0..missing.min(voltage_v[0].len()) {
            self.first.push(voltage_v.map(|column| column[at]));
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

    /// The channel, from 0, that changes most for its noise over the rows at one end, and its change, V; none if none does, or if it is where
    /// it was some periods of mains away, as hum is.
    fn changing(&self, end: &[Row], away: &[Row]) -> Option<(usize, f64)> {
        let middle = 0.5 * (end.len() as f64 - 1.0);
        let places = || (0..end.len()).map(|at| at as f64 - middle);
        let squares: f64 = places().map(|place| place * place).sum();
        let change_v = |limb: usize| {
            let slope: f64 = places()
                .zip(end)
                .map(|(place, row)| place * row[limb])
                .sum();
            2.0 * middle * slope / squares
        };
        let (limb, change_v) = (0..LIMBS)
            .map(|limb| (limb, change_v(limb)))
            .filter(|(limb, change_v)| change_v.abs() > self.least_v[*limb])
            .max_by(|a, b| {
                let over = |(limb, change_v): &(usize, f64)| change_v.abs() / self.least_v[*limb];
                over(a).total_cmp(&over(b))
            })?;
        let apart: f64 = end.iter().zip(away).map(|(a, b)| a[limb] - b[limb]).sum();
        (apart.abs() / end.len() as f64 > 0.5 * change_v.abs()).then_some((limb, change_v))
    }

    /// Said once, that the recording begins in motion.
    pub fn begins_in_motion(&mut self) -> Option<String> {
        if self.said || self.first.len() < self.kept {
            return None;
        }
        self.said = true;
        let away = &self.first[self.kept - self.window..];
        let (limb, change_v) = self.changing(&self.first[..self.window], away)?;
        Some(format!(
            "it begins in motion: limb {} changes by {:.3} V within the first {:.1} ms. At the first sample the rate is taken for zero; if the sensor was turning, \
             rates, attitude and all in ground axes are wrong from there on, by more than any stated deviation: cut the recording at a rest",
            limb + 1,
            change_v.abs(),
            1e3 * self.window_s
        ))
    }

    /// That a run ends in motion.
    #[must_use]
    pub fn ends_in_motion(&self) -> Option<String> {
        if self.last.len() < self.kept {
            return None;
        }
        let end = &self.last[self.kept - self.window..];
        let (limb, change_v) = self.changing(end, &self.last[..self.window])?;
        Some(format!(
            "it ends in motion: limb {} changes by {:.3} V within the last {:.1} ms, and --rest-to-rest takes off whatever makes the rate there zero: the result is wrong",
            limb + 1,
            change_v.abs(),
            1e3 * self.window_s
        ))
    }
}
