//! Every path is held against push before it is timed.

use glam::DVec3;
use sixaxis_core::Decoupler;
use sixaxis_core::six_axis::Accelerations;

use crate::timing::Voltages;

/// Largest difference of any path from push over its peak. Rounding of the torque adds up to a rate and that to an
/// attitude, so it grows with the square of the length: to 5e-11 over 1e6 samples. Twenty times that is allowed, and
/// what 1e5 samples are allowed to shorter records.
pub const ROUNDING_PER_SAMPLE_SQUARED: f64 = 1e-21;

pub const ROUNDING_LEAST: f64 = 1e-11;

/// Slices of a block that together are the block repeated to `samples` samples.
pub fn pieces(block: &[Voltages], samples: usize) -> impl Iterator<Item = &[Voltages]> + Clone {
    let starts = (0..samples).step_by(block.len());
    starts.map(move |start| &block[..block.len().min(samples - start)])
}

/// Walks beside another path with push and notes how far the two are apart.
pub struct Beside<I> {
    pub decoupler: Decoupler,
    pub voltage_v: I,
    /// Largest difference and largest answer so far, linear and angular.
    pub difference: [f64; 2],
    pub peak: [f64; 2],
    pub samples: usize,
}

impl<'a, I: Iterator<Item = &'a Voltages>> Beside<I> {
    pub fn new(ready: &Decoupler, voltage_v: I) -> Self {
        Self {
            decoupler: ready.clone(),
            voltage_v,
            difference: [0.0; 2],
            peak: [0.0; 2],
            samples: 0,
        }
    }

    pub fn compare(&mut self, rows: impl IntoIterator<Item = Accelerations>) {
        for row in rows {
            let ours = loop {
                let voltage = self.voltage_v.next().expect("no more answers than samples");
                if let Some(sample) = self.decoupler.push(voltage).expect("a recorded sample") {
                    break [sample.linear_ground_m_s2, sample.angular_ground_rad_s2];
                }
            };
            for (half, ours) in ours.into_iter().enumerate() {
                let difference = (ours - DVec3::from_slice(&row[3 * half..])).length();
                // NaN, once there, stays.
                if difference > self.difference[half] || difference.is_nan() {
                    self.difference[half] = difference;
                }
                self.peak[half] = self.peak[half].max(ours.length());
            }
            self.samples += 1;
        }
    }

    /// The larger of both differences over their peaks.
    pub fn judge(self, what: &str, samples: usize) -> f64 {
        assert_eq!(self.samples + 2, samples, "{what}: answers are missing");
        let [linear, angular] = [0, 1].map(|half| self.difference[half] / self.peak[half]);
        let limit = ROUNDING_LEAST.max(ROUNDING_PER_SAMPLE_SQUARED * (samples as f64).powi(2));
        assert!(
            linear <= limit && angular <= limit,
            "{what} is not timed, because its answer is off by {linear:.1e} and {angular:.1e} of push's, allowed is {limit:.1e}"
        );
        linear.max(angular)
    }
}

/// The record path held against push, sample by sample.
pub fn judge_record<'a>(
    what: &str,
    ready: &Decoupler,
    given: impl Iterator<Item = &'a [Voltages]> + Clone,
    samples: usize,
) -> f64 {
    let mut beside = Beside::new(ready, given.clone().flatten());
    let mut decoupler = ready.clone();
    for piece in given {
        decoupler
            .push_record(piece, &mut |done| {
                beside.compare(done.iter().map(|answer| answer.accelerations()));
            })
            .expect("samples of a recorded run");
    }
    beside.judge(what, samples)
}
