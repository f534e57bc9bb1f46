//! The stages between a source's voltages and the decoder, and beside them the same without the low-pass, for the fault monitor.
//!
//! The monitor holds single rows to the channels' white noise. A low-pass makes neighbouring rows alike and spreads a failure: by such rows the
//! monitor names limbs that have not failed.

use std::collections::VecDeque;

use anyhow::Result;
use sixaxis_calibration::apply::Row;
use sixaxis_calibration::apply::conditioning_stream::{ConditioningConfig, ConditioningStream};
use sixaxis_calibration::apply::voltages::Voltages;
use sixaxis_core::LIMBS;
use sixaxis_core::decouple::uncertainty::ZeroWander;
use sixaxis_recordings::session::Outliers;

use crate::control::Stages;

/// Hampel's test of the outlier stage: samples on either side, standard deviations.
const OUTLIERS: Outliers = Outliers {
    half_width: 5,
    sigmas: 5.0,
};

/// A sample that has passed the stages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ready {
    /// Behind all of them, V.
    pub row: Row,
    /// Behind those before the low-pass, V.
    pub before_low_pass: Row,
}

/// The stages of nine channels.
pub struct Conditioning {
    all: ConditioningStream,
    /// The same stages but for the low-pass, where there is one.
    before_low_pass: Option<ConditioningStream>,
    received: Voltages,
    filtered: Voltages,
    unfiltered: Voltages,
    ready: VecDeque<Ready>,
}

impl Conditioning {
    /// At rest; `delays_s` are those of the channels against the clock.
    ///
    /// # Errors
    /// Corners that the sample rate does not allow.
    pub fn new(
        stages: &Stages,
        delays_s: Option<[f64; LIMBS]>,
        sample_rate_hz: f64,
    ) -> Result<Self> {
        let config = ConditioningConfig {
            delays_s,
            outliers: stages.outliers.then_some(OUTLIERS),
            amplifier_high_pass_hz: stages.high_pass_hz,
            low_pass_hz: stages.low_pass_hz,
            causal: true,
            ..ConditioningConfig::default()
        };
        let before = || ConditioningStream::new(&config.unfiltered(), sample_rate_hz);
        Ok(Self {
            all: ConditioningStream::new(&config, sample_rate_hz)?,
            before_low_pass: stages.low_pass_hz.map(|_| before()).transpose()?,
            received: Voltages::default(),
            filtered: Voltages::default(),
            unfiltered: Voltages::default(),
            ready: VecDeque::new(),
        })
    }

    /// Takes a sample.
    pub fn push(&mut self, voltage_v: &Row) {
        self.received.push(voltage_v);
        self.all.push(&mut self.received, &mut self.filtered);
        if let Some(before) = &mut self.before_low_pass {
            self.received.push(voltage_v);
            before.push(&mut self.received, &mut self.unfiltered);
        }
        // A low-pass that runs forwards only hands out as many samples as it takes: as many come out of both.
        let before = match &self.before_low_pass {
            Some(_) => &self.unfiltered,
            None => &self.filtered,
        };
        let pairs = self.filtered.rows().zip(before.rows());
        self.ready.extend(pairs.map(|(row, before_low_pass)| Ready {
            row,
            before_low_pass,
        }));
        self.filtered.clear();
        self.unfiltered.clear();
    }

    /// How zeros wander where a high-pass is undone, for the fault monitor.
    pub fn zero_wander(&self) -> Option<ZeroWander> {
        let seen = self.before_low_pass.as_ref().unwrap_or(&self.all);
        seen.zero_wander()
    }

    /// The next sample that has passed.
    pub fn pop(&mut self) -> Option<Ready> {
        self.ready.pop_front()
    }
}
