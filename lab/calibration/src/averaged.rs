//! A static record of any length in bounded memory: averaged in groups that double as the record goes on.

use sixaxis_core::LIMBS;

use crate::trial::Readings;

/// Rows that a static record is averaged down to, or twice as many: enough for a trend and batch means, whatever its length.
const STATIC_ROWS: usize = 1 << 16;

/// A static record as it is read. Below twice [`STATIC_ROWS`] rows stand as they came; samples that do not fill the last group
/// are left out.
#[derive(Debug, Clone)]
pub struct Averaged {
    voltage_v: Vec<[f64; LIMBS]>,
    sum: [f64; LIMBS],
    in_group: u32,
    group: u32,
}

impl Default for Averaged {
    fn default() -> Self {
        Self {
            voltage_v: Vec::new(),
            sum: [0.0; LIMBS],
            in_group: 0,
            group: 1,
        }
    }
}

impl Averaged {
    /// Adds a sample, V.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) {
        for (sum, u) in self.sum.iter_mut().zip(voltage_v) {
            *sum += u;
        }
        self.in_group += 1;
        if self.in_group == self.group {
            let mean = self.sum.map(|s| s / f64::from(self.group));
            self.voltage_v.push(mean);
            (self.sum, self.in_group) = ([0.0; LIMBS], 0);
        }
        if self.voltage_v.len() == 2 * STATIC_ROWS {
            self.voltage_v = self
                .voltage_v
                .chunks_exact(2)
                .map(|pair| core::array::from_fn(|i| 0.5 * (pair[0][i] + pair[1][i])))
                .collect();
            self.group *= 2;
        }
    }

    /// The rows and the rate that they have, where the record has `sample_rate_hz`.
    #[must_use]
    pub fn finish(self, sample_rate_hz: f64) -> Readings {
        Readings {
            sample_rate_hz: sample_rate_hz / f64::from(self.group),
            voltage_v: self.voltage_v,
            accelerometer_m_s2: Vec::new(),
            gyroscope_rad_s: Vec::new(),
        }
    }
}
