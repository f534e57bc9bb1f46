//! What is known of a recording that has been decoupled.

use serde::Serialize;
use sixaxis_core::Scheme;

use super::attitude_summary::AttitudeSummary;
use super::curves::Curves;
use super::pipeline::Busy;

/// A recording that has been decoupled. Serialized, it is what `sixaxis decouple --json` prints.
#[derive(Serialize)]
pub struct Decoupled {
    /// Samples read.
    pub samples: u64,
    /// Rows written.
    pub rows: u64,
    /// The sample, from 0, that the first row belongs to.
    pub first_row_sample: u64,
    /// Its time, s.
    pub first_row_time_s: Option<f64>,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// How the rate was integrated.
    pub scheme: Scheme,
    /// Gains of the amplifier ranges, N/V.
    pub gain_n_per_v: [f64; 9],
    /// Gravity at the first sample, m/s^2, in the ground's axes.
    pub gravity_ground_m_s2: [f64; 3],
    /// Corner of the low-pass on the voltages, Hz.
    pub low_pass_hz: Option<f64>,
    /// Limbs whose channels were not read, by number from 1.
    pub excluded_limbs: Vec<usize>,
    /// Samples of each channel at the converter's limit.
    pub clipped_samples: [u64; 9],
    /// Rate left at the end of the run before the rest-to-rest correction, rad/s.
    pub end_rate_before_rad_s: Option<[f64; 3]>,
    /// Rotation left there, a rotation vector, rad.
    pub end_rotation_before_rad: Option<[f64; 3]>,
    /// How well the attitude was known, where that was followed.
    pub attitude: Option<AttitudeSummary>,
    /// How long each of the three threads worked.
    pub busy: Option<Busy>,
    /// What is wrong with the recording or the result.
    pub warnings: Vec<String>,
    /// The curves of a picture.
    #[serde(skip)]
    pub curves: Option<Box<Curves>>,
}
