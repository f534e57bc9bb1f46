//! How cost grows: what `benches/examples/growth` measures, each point in a process of its own.

use serde::{Deserialize, Serialize};
use sixaxis_core::Scheme;

use super::{Machine, Spread};

/// All of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Growth {
    /// When it was measured.
    pub date_utc: String,
    /// The commit that was measured.
    pub commit: String,
    /// Whether its sources were others than that commit's.
    pub changed_since_commit: bool,
    /// The command that measures it.
    pub command: String,
    /// Whether only the small sizes were measured.
    pub quick: bool,
    /// What was measured on.
    pub machine: Machine,
    /// Processes that wanted to run, averaged over a minute, before the first point (others') and after the last.
    pub load: [Option<f64>; 2],
    /// How the rate was integrated.
    pub scheme: Scheme,
    /// Samples of each stream in lanes.
    pub samples_per_stream: usize,
    /// Motions in a session of the campaign, and their sample rate, Hz.
    pub campaign_session: (usize, f64),
    /// One for each kind of work.
    pub curves: Vec<GrowthCurve>,
}

impl Growth {
    /// The curve of one kind of work.
    pub fn of(&self, work: Work) -> Option<&GrowthCurve> {
        self.curves.iter().find(|curve| curve.work == work)
    }
}

/// What is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Work {
    /// A Parquet file of nine voltages is decoupled into one of time, accelerations, rates and attitude; by its samples.
    Decouple,
    /// The record path on an array in memory; by its samples.
    PushRecord,
    /// Streams in memory, eights of them in lanes and what is left one by one; by their number.
    PushLanes,
    /// A session on disk is calibrated, four steps and joint fit, and graded; by its trials.
    Calibrate,
    /// Sessions are played and calibrated; by their number.
    Campaign,
}

impl Work {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Decouple,
        Self::PushRecord,
        Self::PushLanes,
        Self::Calibrate,
        Self::Campaign,
    ];
}

/// Cost of one kind of work.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct GrowthCurve {
    /// The work.
    pub work: Work,
    /// By size, ascending.
    pub points: Vec<GrowthPoint>,
}

/// One size.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct GrowthPoint {
    /// How many samples, streams, trials or cases.
    pub size: u64,
    /// Processes that did it, each for itself.
    pub processes: usize,
    /// Processor time of all threads, s.
    pub processor_s: Spread,
    /// From start to end, s.
    pub wall_s: Spread,
    /// Largest memory of a process.
    pub peak_memory_bytes: u64,
}

/// `log time = log factor + exponent log size`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PowerLaw {
    /// The slope in a drawing with two logarithmic axes; none of fewer than two sizes.
    pub exponent: f64,
    /// Time at size one, s.
    pub factor_s: f64,
}

impl PowerLaw {
    /// Time at a size, s.
    pub fn at(&self, size: f64) -> f64 {
        self.factor_s * size.powf(self.exponent)
    }
}

impl GrowthCurve {
    /// The line through processor time over size, least squares of the logarithms; none of fewer than two sizes.
    pub fn power_law(&self) -> Option<PowerLaw> {
        let points = self.points.iter();
        let logs: Vec<(f64, f64)> = points
            .map(|p| ((p.size as f64).ln(), p.processor_s.median.ln()))
            .collect();
        if logs.len() < 2 {
            return None;
        }
        let mean =
            |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let product: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        let square: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
        let exponent = product / square;
        Some(PowerLaw {
            exponent,
            factor_s: (y - exponent * x).exp(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found_again() {
        let law = PowerLaw {
            exponent: 1.5,
            factor_s: 3e-4,
        };
        let points = [10, 100, 700, 20_000].map(|size| {
            let time = law.at(size as f64);
            let spread = Spread {
                median: time,
                q1: time,
                q3: time,
            };
            GrowthPoint {
                size,
                processes: 1,
                processor_s: spread,
                wall_s: spread,
                peak_memory_bytes: 0,
            }
        });
        let curve = |points: &[GrowthPoint]| GrowthCurve {
            work: Work::Calibrate,
            points: points.to_vec(),
        };
        let found = curve(&points).power_law().expect("a line");
        let off = [
            found.exponent / law.exponent - 1.0,
            found.factor_s / law.factor_s - 1.0,
        ];
        // Rounding of a few dozen operations, the factor's through an exponential of some ten.
        assert!(
            off.iter().all(|off| off.abs() < 64.0 * f64::EPSILON),
            "{off:?}"
        );
        assert_eq!(curve(&points[..1]).power_law(), None);
    }
}
