//! What each channel shows of each trial's motion, in a few numbers.
//!
//! A rig's run moves along one direction d, so everything in it follows one waveform w: the acceleration, or the angular
//! acceleration where nothing travels. Each channel's force is fitted by
//!
//! c u = offset + trend s + x w + z w' + y s w' + v w_rate^2,   s from -1 to 1 over the run
//!
//! x is the channel's response; z/x is the time by which the standard instrument lags behind the sensor (w(t + lag) is about
//! w + lag w'), y/x what that lag grows by in half a run, a clock that runs at another speed; the trend is drift; v belongs to
//! w x I w. The residual is what none of these explains.

use nalgebra::{DMatrix, DVector};
use sixaxis_core::LIMBS;
use sixaxis_core::dsp::differentiate::Differentiator;

use crate::conditioning::Conditioned;
use crate::frequency::frequency;
use crate::steps::stride;
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Terms of the fit.
const TERMS: usize = 6;
/// Samples next to either end that a filter's extension reaches into are not fitted: this share of the run.
const MARGIN: f64 = 0.01;
/// Singular values below this share of the largest are not resolved: a waveform without travel has no w x I w.
const RESOLVED: f64 = 1e-9;

/// One channel's response to one trial. Forces are measured ones, N.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChannelResponse {
    /// Offset in the middle of the run, N.
    pub offset_n: f64,
    /// Its standard error, N.
    pub offset_error_n: f64,
    /// Drift from the beginning to the end of the run, N.
    pub drift_n: f64,
    /// x: force over the waveform.
    pub response: f64,
    /// Standard error of x.
    pub standard_error: f64,
    /// z: force over the waveform's derivative, times s.
    pub lagging: f64,
    /// y: what z grows by in half a run.
    pub lagging_growth: f64,
    /// Root mean square of what is left, N.
    pub residual_n: f64,
    /// Root mean square of the force without offset, N.
    pub signal_n: f64,
    /// Standard error of the drift, N.
    pub drift_error_n: f64,
}

impl core::ops::Mul<f64> for ChannelResponse {
    type Output = Self;

    /// Of a channel by another gain, or of turned polarity.
    fn mul(self, factor: f64) -> Self {
        let size = factor.abs();
        Self {
            offset_n: factor * self.offset_n,
            offset_error_n: size * self.offset_error_n,
            drift_n: factor * self.drift_n,
            response: factor * self.response,
            standard_error: size * self.standard_error,
            lagging: factor * self.lagging,
            lagging_growth: factor * self.lagging_growth,
            residual_n: size * self.residual_n,
            signal_n: size * self.signal_n,
            drift_error_n: size * self.drift_error_n,
        }
    }
}

/// All channels' responses to one trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// The nine.
    pub channels: [ChannelResponse; LIMBS],
    /// Largest size of the waveform, m/s^2 or rad/s^2.
    pub peak: f64,
    /// Largest acceleration, m/s^2.
    pub peak_linear_m_s2: f64,
    /// Largest rate, rad/s.
    pub peak_rate_rad_s: f64,
    /// Linear acceleration over the waveform: 1 where the waveform is the linear acceleration, 0 in a trial that only turns.
    pub linear_over_waveform: f64,
    /// Angular acceleration over the waveform: 1 where the waveform is the angular acceleration.
    pub angular_over_waveform: f64,
    /// Whether the waveform is the linear acceleration.
    pub travels: bool,
    /// Length of the run, s.
    pub duration_s: f64,
    /// Frequency of the drive once up to speed, Hz, from the waveform itself.
    pub frequency_hz: Option<f64>,
}

/// Measures the responses to one trial. `force_n` is what is to be explained: measured forces less what is known of
/// gravity. None: too short to be fitted, or nothing moves.
pub fn measure(
    trial: &Trial,
    conditioned: &Conditioned,
    force_n: &[[f64; LIMBS]],
) -> Option<Response> {
    let d = trial.direction_ground;
    let along = |v: &[glam::DVec3]| -> Vec<f64> { v.iter().map(|x| x.dot(d)).collect() };
    let linear = along(&conditioned.linear_ground_m_s2);
    let angular = along(&conditioned.angular_shell_rad_s2);
    let rate = along(&conditioned.rate_shell_rad_s);
    let peak_of = |series: &[f64]| series.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let travels = match trial.role {
        Role::Angular => false,
        Role::Validation => peak_of(&linear) > ARM_M * peak_of(&angular),
        Role::Static | Role::Linear | Role::HighFrequencyLinear | Role::Tap => true,
    };
    let waveform = if travels { &linear } else { &angular };
    let samples = waveform.len();
    let differentiator = Differentiator::new(3, 4, trial.sample_rate_hz).ok()?;
    let derivative = differentiator.derivative(waveform).ok()?;
    let margin = (MARGIN * samples as f64) as usize;
    let rows: Vec<usize> = (margin..samples.saturating_sub(margin))
        .step_by(stride(trial))
        .collect();
    if rows.len() < 4 * TERMS || peak_of(waveform) == 0.0 {
        return None;
    }
    let s = |row: usize| 2.0 * row as f64 / (samples - 1) as f64 - 1.0;
    let turns = match trial.role {
        Role::Angular => true,
        Role::Validation => peak_of(&rate) > TURNING_RAD_S,
        Role::Static | Role::Linear | Role::HighFrequencyLinear | Role::Tap => false,
    };
    let mut design = DMatrix::from_fn(rows.len(), TERMS, |i, term| {
        let row = rows[i];
        match term {
            0 => 1.0,
            1 => s(row),
            2 => waveform[row],
            3 => derivative[row],
            4 => s(row) * derivative[row],
            _ if turns => rate[row] * rate[row],
            _ => 0.0,
        }
    });
    // Columns of one size, so that one threshold serves all.
    let sizes: Vec<f64> = (0..TERMS)
        .map(|term| design.column(term).norm())
        .map(|norm| if norm > 0.0 { norm } else { 1.0 })
        .collect();
    for (term, size) in sizes.iter().enumerate() {
        design.column_mut(term).unscale_mut(*size);
    }
    let svd = design.clone().try_svd(true, true, f64::EPSILON, 1000)?;
    let (u, v_t) = (svd.u.as_ref()?, svd.v_t.as_ref()?);
    let cut = RESOLVED * svd.singular_values.max();
    let inverse: Vec<f64> = svd
        .singular_values
        .iter()
        .map(|s| if *s > cut { 1.0 / s } else { 0.0 })
        .collect();
    let variance = |term: usize| -> f64 {
        (0..TERMS)
            .map(|k| (v_t[(k, term)] * inverse[k]).powi(2))
            .sum::<f64>()
    };
    // What a standard reads in the mean of a run from rest to rest is its own offset.
    let mean_waveform = rows.iter().map(|row| waveform[*row]).sum::<f64>() / rows.len() as f64;
    let channels = core::array::from_fn(|limb| {
        let right = DVector::from_iterator(rows.len(), rows.iter().map(|r| force_n[*r][limb]));
        let mut projected = u.transpose() * &right;
        for (p, inv) in projected.iter_mut().zip(&inverse) {
            *p *= inv;
        }
        let solution = v_t.transpose() * projected;
        let residual = &right - &design * &solution;
        let value = |term: usize| solution[term] / sizes[term];
        let mean = right.mean();
        let free = (rows.len() - TERMS) as f64;
        let noise = (residual.norm_squared() / free).sqrt();
        let error = |term: usize| noise * variance(term).sqrt() / sizes[term];
        ChannelResponse {
            offset_n: value(0) + value(2) * mean_waveform,
            offset_error_n: error(0),
            drift_n: 2.0 * value(1),
            response: value(2),
            standard_error: error(2),
            lagging: value(3),
            lagging_growth: value(4),
            residual_n: noise,
            signal_n: (right.map(|x| (x - mean) * (x - mean)).mean()).sqrt(),
            drift_error_n: 2.0 * error(1),
        }
    });
    let squares: f64 = waveform.iter().map(|w| w * w).sum();
    let over_waveform = |series: &[f64]| -> f64 {
        let product = waveform.iter().zip(series).map(|(w, a)| w * a);
        product.sum::<f64>() / squares
    };
    Some(Response {
        channels,
        peak: peak_of(waveform),
        peak_linear_m_s2: peak_of(&linear),
        peak_rate_rad_s: peak_of(&rate),
        linear_over_waveform: match trial.role {
            Role::Angular => 0.0,
            _ if travels => 1.0,
            _ => over_waveform(&linear),
        },
        angular_over_waveform: if turns { over_waveform(&angular) } else { 0.0 },
        travels,
        duration_s: samples as f64 / trial.sample_rate_hz,
        frequency_hz: frequency(waveform, trial.sample_rate_hz, trial.frequency_hz),
    })
}

/// Arm over which an angular acceleration asks for as much force as a linear one, m: the radius of gyration of a mass of a few
/// centimetres. Which of both a validation run's waveform is does not hang on its exact size.
const ARM_M: f64 = 0.01;
/// Rate below which nothing turns: a tenth of a degree a second is a gyroscope's noise.
const TURNING_RAD_S: f64 = 2e-3;
