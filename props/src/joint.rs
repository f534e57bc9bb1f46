//! Small campaigns for the joint estimator: played, collected, fitted, and held against the truth.

use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;
use sixaxis_calibration::joint::{JointReport, Knowledge, Loss, fit};
use sixaxis_calibration::steps::{Campaign, FourSteps, GyroscopeGain};
use sixaxis_campaign::prepared::prepare;
use sixaxis_core::LIMBS;
use sixaxis_core::identify::joint::room::Room;
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_recordings::session::{Role, Session};
use sixaxis_reference::laboratory::instruments::Instruments;
use sixaxis_reference::laboratory::plan::{Engine, SensorChoice, SessionPlan};
use sixaxis_reference::laboratory::session::simulate_session;

/// A plan that is fitted in hundredths of a second: a random sensor on limbs that do not give way, six of the paper's ten trials, a
/// quarter of the sample rate. Enough of the latter that the run-up's harmonics are not folded back.
pub fn small(seed: u64) -> SessionPlan {
    let mut plan = SessionPlan {
        seed,
        sensor: SensorChoice::Random,
        engine: Engine::Rigid,
        trials_per_step: 6,
        sample_rate_hz: 500.0,
        static_duration_s: 60.0,
        ..SessionPlan::default()
    };
    plan.rig.wedge_error_deg = 0.05;
    plan
}

/// A plan without noise, sampled fast enough that the reference's gyroscope, which takes the rate for a cubic between samples,
/// is right to a millionth.
pub fn noise_free(seed: u64) -> SessionPlan {
    let mut plan = small(seed);
    plan.sample_rate_hz = 2000.0;
    plan.chain.signal_to_noise_db = f64::INFINITY;
    plan.chain.resolution_bits = 0;
    plan.instruments.signal_to_noise_db = f64::INFINITY;
    plan
}

/// A campaign with its answer.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// What the laboratory writes down.
    pub session: Session,
    /// Its trials.
    pub campaign: Campaign,
    /// The four steps.
    pub steps: FourSteps,
    /// The joint fit.
    pub joint: JointReport,
    /// The 25 as they are.
    pub truth: [f64; PARAMETERS],
    /// The instruments as they are.
    pub instruments: Instruments,
}

impl Fitted {
    /// Plays a plan and fits it with nothing open that the plan does not spoil: what the fit states is then its bound.
    ///
    /// # Errors
    /// What stops it, in words.
    pub fn of(plan: &SessionPlan) -> Result<Self, String> {
        Self::in_room(plan, Room::NONE)
    }

    /// Plays a plan and fits it with what a room leaves open.
    ///
    /// # Errors
    /// What stops it, in words.
    pub fn in_room(plan: &SessionPlan, room: Room) -> Result<Self, String> {
        let played = simulate_session(plan).map_err(|e| e.to_string())?;
        let truth = played.truth.parameters.to_paper_order();
        let campaign = prepare(&played.session, played.recordings).campaign;
        let class = played.session.gyroscope.class_percent / 100.0;
        let steps = campaign
            .identify(GyroscopeGain::Certified { class })
            .map_err(|e| e.to_string())?;
        let mut knowledge = Knowledge::of(&played.session);
        knowledge.certificates.room = room;
        let joint = fit(&campaign, &steps, &knowledge, Loss::Squares).map_err(|e| e.to_string())?;
        Ok(Self {
            session: played.session,
            campaign,
            steps,
            joint,
            truth,
            instruments: played.truth.instruments,
        })
    }

    /// Errors of drifts, scale factors and inertias with the accelerometer's gain told, each over its bound: what is left is
    /// noise.
    pub fn standardised(&self) -> [f64; PARAMETERS - 1] {
        let estimate = &self.joint.estimate;
        let found = estimate.values(self.instruments.accelerometer_gain_error);
        let bound = estimate.deviations();
        core::array::from_fn(|p| (found[p] - self.truth[p]) / bound[p])
    }

    /// The same over what is stated, the accelerometer's gain apart: how far sensitivities move is in that as well.
    pub fn over_stated(&self) -> [f64; PARAMETERS - 1] {
        let estimate = &self.joint.estimate;
        let found = estimate.values(self.instruments.accelerometer_gain_error);
        let stated = self.joint.noise_covariance();
        core::array::from_fn(|p| {
            let deviation = stated[(p, p)].sqrt().hypot(self.joint.moved(p));
            (found[p] - self.truth[p]) / deviation
        })
    }

    /// e^T C^-1 e of all errors at once, the accelerometer's gain told, C the covariance that the fit states: of normal errors
    /// chi-square with 24 degrees of freedom.
    ///
    /// # Panics
    /// For a covariance that is none.
    pub fn squares_over_covariance(&self) -> f64 {
        let deviations = self.joint.estimate.deviations();
        let covariance = self.joint.estimate.parameter_covariance();
        let correlation =
            SMatrix::<f64, { PARAMETERS - 1 }, { PARAMETERS - 1 }>::from_fn(|a, b| {
                covariance[(a, b)] / (deviations[a] * deviations[b])
            });
        let z = SVector::from(self.standardised());
        let solved = correlation
            .cholesky()
            .expect("a covariance is positive definite")
            .solve(&z);
        z.dot(&solved)
    }

    /// Errors of scale factors and inertias, the accelerometer's gain told, over the value and over the mean moment.
    pub fn relative(&self) -> [f64; PARAMETERS - 10] {
        let found = self
            .joint
            .estimate
            .values(self.instruments.accelerometer_gain_error);
        let moment = self.truth[18..21].iter().sum::<f64>() / 3.0;
        core::array::from_fn(|i| {
            let p = 9 + i;
            let size = if p < 18 { self.truth[p].abs() } else { moment };
            (found[p] - self.truth[p]).abs() / size
        })
    }
}

/// Scale factors by (14) on the raw samples, 1/kg: plain least squares, which takes the channels in its regressor for exact.
///
/// # Errors
/// Those of step 2.
pub fn plain_least_squares(
    campaign: &Campaign,
    steps: &FourSteps,
) -> sixaxis_core::Result<[f64; LIMBS]> {
    let mut step = ScaleIdentification::default();
    let linear = campaign.trials.iter().map(|(trial, _)| trial);
    for trial in linear.filter(|trial| trial.role == Role::Linear) {
        for (voltage, a) in trial.voltage_v.iter().zip(&trial.accelerometer_m_s2) {
            let force = trial.gains.measured_force_n(voltage, &steps.drift.drift_v);
            step.push(&force, trial.direction_ground * *a)?;
        }
    }
    Ok(step.solve()?.estimate.values)
}

/// Means and mean squares of some numbers over many campaigns, from independent seeds, in their order.
pub fn moments<const N: usize>(cases: &[[f64; N]]) -> ([f64; N], [f64; N]) {
    let n = cases.len() as f64;
    let mean = |of: &dyn Fn(f64) -> f64| {
        core::array::from_fn(|p| cases.iter().map(|case| of(case[p])).sum::<f64>() / n)
    };
    (mean(&|z| z), mean(&|z| z * z))
}

/// Mean errors of the nine scale factors in their own standard deviations, by plain least squares and by the joint fit, over
/// campaigns of the paper's sensor that differ in their noise alone.
///
/// # Errors
/// What stops a campaign, with its seed.
pub fn bias_of_scale(
    seeds: core::ops::Range<u64>,
    noise_db: f64,
) -> Result<[[f64; LIMBS]; 2], String> {
    let errors: Vec<[[f64; LIMBS]; 2]> = seeds
        .into_par_iter()
        .map(|seed| {
            let mut plan = small(seed);
            plan.sensor = SensorChoice::Paper;
            plan.chain.signal_to_noise_db = noise_db;
            plan.instruments.class_percent = RIGHT_PERCENT;
            plan.rig.wedge_error_deg = 0.0;
            let case = Fitted::of(&plan).map_err(|cause| format!("seed {seed}: {cause}"))?;
            let plain = plain_least_squares(&case.campaign, &case.steps)
                .map_err(|e| format!("seed {seed}: {e}"))?;
            let truth = &case.truth[LIMBS..2 * LIMBS];
            let joint = &case.joint.values[LIMBS..2 * LIMBS];
            Ok([
                core::array::from_fn(|i| plain[i] - truth[i]),
                core::array::from_fn(|i| joint[i] - truth[i]),
            ])
        })
        .collect::<Result<_, String>>()?;
    Ok([0, 1].map(|which| {
        let own: Vec<[f64; LIMBS]> = errors.iter().map(|case| case[which]).collect();
        let (mean, square) = moments(&own);
        core::array::from_fn(|i| mean[i] / (square[i] - mean[i] * mean[i]).sqrt())
    }))
}

/// Class of instruments whose gains are as good as right, %.
const RIGHT_PERCENT: f64 = 1e-6;
