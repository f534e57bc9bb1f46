//! The instruments' errors through the four steps, in closed form: covariance of all 25 parameters.
//!
//! Noise of the nine channels and of both standards, trial by trial; errors of the standards' gains, the same all day; wedges,
//! each the same in every trial that it is used in. To first order all of them are linear in what a step's rows lack
//! ([`sixaxis_core::decouple::uncertainty`]); white noise of raw samples comes to the rows through the transposed conditioning. Held
//! against 20,000 simulated campaigns by `props`' example `propagation`, and against 150 by its suite.
//!
//! What is not in it: what the model neglects (limbs that give way, 1e-6 of s/m), clocks, wild samples, and whatever
//! makes noise not white.

mod step_error;

use rayon::prelude::*;
use sixaxis_core::decouple::uncertainty::influence::{
    GyroscopeShare, InertiaInfluence, ScaleInfluence,
};
use sixaxis_core::decouple::uncertainty::parameters::{Chain, Covariance, Errors};
use sixaxis_core::dsp::spectrum::noise_floor;
use sixaxis_core::parameter::DRIFT;
use sixaxis_core::{LIMBS, Result};

use self::step_error::{FourthStep, Sensitivities, StepError};
use crate::conditioning::Conditioning;
use crate::steps::{Campaign, FourSteps, rows};
use sixaxis_recordings::session::{Role, Session};

/// White noise of one trial, standard deviation of one raw sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TrialNoise {
    /// Of each limb's channel, V.
    pub channels_v: [f64; LIMBS],
    /// Of the standard accelerometer, m/s^2.
    pub accelerometer_m_s2: f64,
    /// Of the standard gyroscope, rad/s.
    pub gyroscope_rad_s: f64,
}

/// Everything that is uncertain, as standard deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct Sources {
    /// Of each zero drift, V: the static record's noise over the root of its samples, where it is white.
    pub zero_drift_v: [f64; LIMBS],
    /// Noise of each of the campaign's trials, in their order.
    pub trials: Vec<TrialNoise>,
    /// Of the accelerometer's gain, relative.
    pub accelerometer_gain: f64,
    /// Of the gyroscope's gain, relative.
    pub gyroscope_gain: f64,
    /// Of each wedge's direction, about either axis square to it, rad.
    pub wedge_rad: f64,
}

impl Sources {
    /// As the recordings themselves show them: noise under the motion, drift by the means of the static record's batches. Gains
    /// as the certificates' classes allow them: an even spread over a class c has the standard deviation c over the root
    /// of 3. Nothing shows the wedges here.
    ///
    /// # Errors
    /// A trial too short to separate noise from motion.
    pub fn seen(
        campaign: &Campaign,
        steps: &FourSteps,
        accelerometer_class: f64,
        gyroscope_class: f64,
    ) -> Result<Self> {
        let trials = campaign
            .trials
            .par_iter()
            .map(|(trial, _)| {
                let mut noise = TrialNoise {
                    accelerometer_m_s2: noise_floor(&trial.accelerometer_m_s2)?,
                    gyroscope_rad_s: noise_floor(&trial.gyroscope_rad_s)?,
                    ..TrialNoise::default()
                };
                for limb in 0..LIMBS {
                    noise.channels_v[limb] = trial.noise_v(limb)?;
                }
                Ok(noise)
            })
            .collect::<Result<_>>()?;
        Ok(Self {
            zero_drift_v: steps.drift.standard_error_v,
            trials,
            accelerometer_gain: accelerometer_class / 3.0_f64.sqrt(),
            gyroscope_gain: gyroscope_class / 3.0_f64.sqrt(),
            wedge_rad: 0.0,
        })
    }

    /// Noise of one sample of each channel, V: the median over the trials.
    pub fn typical_noise_v(&self) -> [f64; LIMBS] {
        core::array::from_fn(|limb| {
            let mut noise: Vec<f64> = self.trials.iter().map(|t| t.channels_v[limb]).collect();
            noise.sort_by(f64::total_cmp);
            noise.get(noise.len() / 2).copied().unwrap_or(0.0)
        })
    }
}

/// What the instruments' errors come to; none where the recordings do not let it be told.
pub fn of_session(
    session: &Session,
    campaign: &Campaign,
    conditioning: &Conditioning,
    steps: &FourSteps,
) -> Option<(Sources, Propagated)> {
    let (accelerometer, gyroscope) = (&session.accelerometer, &session.gyroscope);
    let gain = |stated: Option<f64>, class: f64| stated.unwrap_or(class) / 100.0;
    let mut sources = Sources::seen(
        campaign,
        steps,
        gain(accelerometer.gain_percent, accelerometer.class_percent),
        gain(gyroscope.gain_percent, gyroscope.class_percent),
    )
    .ok()?;
    // Only where the session says so: what the workshop did is in no recording.
    let stated = session.rig.as_ref().and_then(|rig| rig.wedge_deg);
    sources.wedge_rad = stated.unwrap_or(0.0).to_radians();
    let found = propagate(campaign, conditioning, steps, &sources).ok()?;
    let finite = found.total().iter().all(|x| x.is_finite());
    finite.then_some((sources, found))
}

/// Covariances of the 25 parameters by cause, in the order of [`sixaxis_core::parameter::Parameter`].
#[derive(Debug, Clone, PartialEq)]
pub struct Propagated {
    /// The chain of the steps.
    pub chain: Chain,
    /// The steps' own errors of noise.
    pub own_noise: Covariance,
    /// Change of the parameters for an accelerometer, and a gyroscope, that reads too much by the whole of a reading.
    pub per_gain: [Errors; 2],
    /// Noise, gains' standard deviations, wedges.
    pub noise: Covariance,
    /// Of the two gains.
    pub standards: Covariance,
    /// Of the wedges.
    pub wedges: Covariance,
}

impl Propagated {
    /// All causes together.
    pub fn total(&self) -> Covariance {
        self.noise + self.standards + self.wedges
    }
}

/// What the angular trials' word on the gyroscope's gain counted in step 3.
pub fn gyroscope_share(steps: &FourSteps) -> GyroscopeShare {
    match (steps.rate_over_reading, steps.gyroscope_gain_seen) {
        (None, _) => GyroscopeShare::TRUSTED,
        (Some((gamma, _)), None) => GyroscopeShare {
            rate_over_reading: gamma,
            // Identified, unless only the certificate spoke, which leaves the reading as it is.
            of_trials: if gamma == 1.0 { 0.0 } else { 1.0 },
        },
        (Some((gamma, together)), Some((_, seen))) => GyroscopeShare {
            rate_over_reading: gamma,
            // Weights go by the inverse squares.
            of_trials: (together / seen).powi(2),
        },
    }
}

/// Carries the sources through steps 1 to 4, as `steps` took them, of a campaign that `conditioning` has conditioned.
///
/// Without trials of step 4, or with such that do not determine the compliance, its row and column are zero.
///
/// # Errors
/// Those of the conditioning and of the decoupler. A source list that is shorter than the campaign leaves the last trials
/// without noise.
pub fn propagate(
    campaign: &Campaign,
    conditioning: &Conditioning,
    steps: &FourSteps,
    sources: &Sources,
) -> Result<Propagated> {
    let parameters = steps.found();
    let gain = gyroscope_share(steps);
    let readings = campaign.of(Role::Angular).flat_map(|(trial, conditioned)| {
        rows(trial).map(|t| {
            (
                conditioned.rate_shell_rad_s[t],
                conditioned.angular_shell_rad_s2[t],
            )
        })
    });
    let sensitivities = Sensitivities {
        geometry: campaign.geometry,
        conditioning,
        parameters: &parameters,
        scale: ScaleInfluence::new(&steps.scale),
        inertia: InertiaInfluence::new(&steps.inertia, gain, readings),
        fourth: FourthStep::new(campaign, &parameters)?,
    };
    let quiet = TrialNoise::default();
    let owns: Vec<Option<StepError>> = campaign
        .trials
        .par_iter()
        .enumerate()
        .map(|(index, (trial, conditioned))| {
            let noise = sources.trials.get(index).unwrap_or(&quiet);
            match trial.role {
                Role::Linear => sensitivities.linear(trial, conditioned, noise).map(Some),
                Role::Angular => sensitivities.angular(trial, conditioned, noise).map(Some),
                Role::HighFrequencyLinear => {
                    sensitivities.fast_linear(trial, conditioned, noise, index)
                }
                Role::Static | Role::Tap | Role::Validation => Ok(None),
            }
        })
        .collect::<Result<_>>()?;
    let mut chain = Chain::default();
    let mut own_noise = Covariance::zeros();
    for (i, sd) in DRIFT.zip(sources.zero_drift_v) {
        own_noise[(i, i)] = sd * sd;
    }
    let mut own_gain = [Errors::zeros(); 2];
    // In the trials' order, whatever thread was first.
    for own in owns.iter().flatten() {
        own.add_to(&mut chain, &mut own_noise, &mut own_gain);
    }
    let total = chain.total();
    let per_gain = own_gain.map(|own| total * own);
    let standards = [sources.accelerometer_gain, sources.gyroscope_gain]
        .iter()
        .zip(&per_gain)
        .map(|(sd, errors)| errors * errors.transpose() * (sd * sd))
        .sum();
    let tilts = step_error::wedge_errors(&sensitivities, campaign);
    let wedges = tilts
        .iter()
        .map(|own| {
            let errors = total * own;
            errors * errors.transpose() * sources.wedge_rad.powi(2)
        })
        .sum();
    Ok(Propagated {
        noise: chain.covariance(&own_noise),
        chain,
        own_noise,
        per_gain,
        standards,
        wedges,
    })
}
