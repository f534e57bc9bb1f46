//! What a calibration is worth in truth: its parameters against the true sensor, and a validation run decoupled with it against
//! the simulator's state.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use sixaxis_calibration::calibrate::CalibratedSession;
use sixaxis_calibration::report::Estimator;
use sixaxis_core::parameter::{DRIFT, INERTIA, SCALE};
use sixaxis_reference::laboratory::session::SimulatedSession;
use sixaxis_reference::motion::TrueMotion;

use super::validation_run::ValidationRun;
use crate::compare::worse;

/// Interval widths by which a parameter of a good calibration may be off.
pub const WIDTHS: f64 = 2.0;
/// What "good" states of a decoupled validation run, of the peak: the session's limit as it is left out.
pub const STATED_DECOUPLING: f64 = 0.075;

/// Errors of a calibration, magnitudes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Harm {
    /// Largest error of scale factors and inertias, relative; products of inertia over the mean moment.
    pub parameter: f64,
    /// Largest of these errors over the half width of the parameter's 95 % interval; none if an interval is missing or 0.
    pub over_interval: Option<f64>,
    /// Largest error of the zero drifts, V.
    pub drift_v: f64,
    /// Largest of them over its interval; none if an interval is missing or 0.
    pub drift_over_interval: Option<f64>,
    /// Largest error of the accelerations of [`super::validation_run::RUN`], corrected from rest to rest as the verdict's own are, in sensor axes, over the
    /// peak of the vector: the change of the specific force, or the angular acceleration. None if it cannot be decoupled.
    pub decoupling: Option<f64>,
    /// The same of the linear and of the angular accelerations, but for what the accelerometer's gain makes of the scale factors, and
    /// against the motion in the band of the run's low-pass: what that takes off, ramps and a rod's harmonics, no calibration decides.
    pub beyond_gain: Option<[f64; 2]>,
}

impl Harm {
    /// Of what was judged; none without a calibration.
    pub fn of(judged: &CalibratedSession, played: &SimulatedSession) -> Option<Self> {
        let calibration = judged.calibration.as_ref()?;
        let truth = played.truth.parameters.to_paper_order();
        let inertia = &played.truth.parameters.inertia_per_mass;
        let moment_m2 = (inertia.xx_m2 + inertia.yy_m2 + inertia.zz_m2) / 3.0;
        let found = calibration.parameters.to_paper_order();
        let intervals = &calibration.intervals;
        let error = |i: usize| (found[i] - truth[i]).abs();
        let size = |i: usize| {
            if i < INERTIA.start + 3 {
                truth[i].abs()
            } else {
                moment_m2
            }
        };
        let over_interval = |mut all: core::ops::Range<usize>| {
            all.try_fold(0.0_f64, |worst, i| {
                let half_width = intervals.get(i)?.half_width_95?;
                Some(worse(worst, error(i) / half_width))
            })
        };
        let of_fits = SCALE.start..INERTIA.end;
        let finite = |errors: &[f64; 2]| errors.iter().all(|x| x.is_finite());
        let assumed = match (&judged.joint, judged.estimator) {
            (Some(Ok(joint)), Estimator::Joint | Estimator::JointRobust) => joint.gain.mean(),
            _ => 0.0,
        };
        let scaled = (1.0 + played.truth.instruments.accelerometer_gain_error) / (1.0 + assumed);
        let run = ValidationRun::of(judged, calibration, played);
        let run = run.as_ref().and_then(|run| {
            let truth: Vec<_> = run
                .truth
                .iter()
                .map(|truth| felt(truth, run.gravity_m_s2))
                .collect();
            Some((run, run.corrected()?, truth))
        });
        let run = run.as_ref();
        let decoupling = run.map(|(_, ours, truth)| errors(ours, truth, truth, 1.0));
        let in_band = || {
            let (run, ours, truth) = run?;
            Some(errors(ours, &run.in_band(truth)?, truth, scaled))
        };
        Some(Self {
            parameter: of_fits.clone().map(|i| error(i) / size(i)).fold(0.0, worse),
            over_interval: over_interval(of_fits).filter(|x| x.is_finite()),
            drift_v: DRIFT.map(error).fold(0.0, worse),
            drift_over_interval: over_interval(DRIFT).filter(|x| x.is_finite()),
            decoupling: decoupling
                .filter(finite)
                .map(|[linear, angular]| worse(linear, angular)),
            beyond_gain: in_band().filter(finite),
        })
    }

    /// A parameter beyond twice its interval, or a decoupled run beyond what is stated.
    pub fn breaks_the_promise(&self) -> bool {
        self.breaks_it_at_rest()
            || self.over_interval.is_none_or(|x| x > WIDTHS)
            || self.decoupling.is_none_or(|x| x > STATED_DECOUPLING)
    }

    /// A zero drift beyond twice its interval. One that is right although its interval is 0 keeps nothing: nobody measured it.
    pub fn breaks_it_at_rest(&self) -> bool {
        self.drift_over_interval.is_none_or(|x| x > WIDTHS)
    }
}

/// Largest errors of the linear and angular accelerations over their true peaks, where the linear ones are to be `scaled` times
/// the expected ones.
fn errors(
    ours: &[(usize, [DVec3; 2])],
    expected: &[[DVec3; 2]],
    truth: &[[DVec3; 2]],
    scaled: f64,
) -> [f64; 2] {
    let (mut off, mut peak) = ([0.0_f64; 2], [0.0_f64; 2]);
    for (sample, ours) in ours {
        let (Some(expected), Some(truth)) = (expected.get(*sample), truth.get(*sample)) else {
            return [f64::NAN; 2];
        };
        for (kind, scaled) in [scaled, 1.0].into_iter().enumerate() {
            off[kind] = worse(off[kind], (ours[kind] - expected[kind] * scaled).length());
            peak[kind] = worse(peak[kind], truth[kind].length());
        }
    }
    [off[0] / peak[0], off[1] / peak[1]]
}

/// What a sensor that keeps its axes feels: the change of the specific force since the rest, m/s^2, and the angular acceleration,
/// rad/s^2, shell axes.
fn felt(truth: &TrueMotion, gravity_m_s2: DVec3) -> [DVec3; 2] {
    let back = truth.attitude.inverse();
    [
        back * (truth.linear_ground_m_s2 - gravity_m_s2) + gravity_m_s2,
        back * truth.angular_ground_rad_s2,
    ]
}
