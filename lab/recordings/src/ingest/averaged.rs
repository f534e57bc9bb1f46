//! A static record of any length in bounded memory: each channel averaged in groups, which double as the record goes on.

/// Values that a static record is averaged down to, or twice as many: enough for a trend and for batch means.
const STATIC_ROWS: usize = 1 << 16;

/// One channel of a static record. Below 131,072 samples are kept as they are; samples that do not fill the last
/// group are left out.
#[derive(Debug, Clone)]
pub struct Averaged {
    values: Vec<f64>,
    sum: f64,
    in_group: u32,
    group: u32,
}

impl Default for Averaged {
    fn default() -> Self {
        Self {
            values: Vec::new(),
            sum: 0.0,
            in_group: 0,
            group: 1,
        }
    }
}

impl Averaged {
    /// Adds a sample.
    pub fn push(&mut self, value: f64) {
        self.sum += value;
        self.in_group += 1;
        if self.in_group == self.group {
            self.values.push(self.sum / f64::from(self.group));
            (self.sum, self.in_group) = (0.0, 0);
        }
        if self.values.len() == 2 * STATIC_ROWS {
            let (pairs, _) = self.values.as_chunks::<2>();
            self.values = pairs.iter().map(|[a, b]| 0.5 * (a + b)).collect();
            self.group *= 2;
        }
    }

    /// Samples averaged to one value.
    pub fn group(&self) -> u32 {
        self.group
    }

    /// The values.
    pub fn finish(self) -> Vec<f64> {
        self.values
    }
}
