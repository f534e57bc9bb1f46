//! From prepared trials to 25 parameters with their intervals: four steps, propagated errors, taps, joint fit.

use sixaxis_core::decouple::uncertainty::Covariance;
use sixaxis_recordings::session::Session;

use crate::diagnosis::still;
use crate::error::Result;
use crate::interval::rest::put_rest;
use crate::interval::{LeftOut, put_taps, report};
use crate::joint::misfit::Misfit;
use crate::joint::{self, JointReport, Knowledge, Loss};
use crate::prepare::PreparedSession;
use crate::progress::Progress;
use crate::propagation::{self, Propagated, Sources};
use crate::report::ParameterReport;
use crate::steps::{FourSteps, GyroscopeGain};
use crate::tap::Taps;

/// The parameters by both estimators.
#[derive(Debug)]
pub struct Estimate {
    /// The four steps, with the certificate's word on the gyroscope's gain.
    pub steps: FourSteps,
    /// Steps 2 and 3 without one wedge after the other.
    pub left_out: LeftOut,
    /// The instruments' errors and what they come to in the parameters; none where the recordings do not show their noise.
    pub propagated: Option<(Sources, Propagated)>,
    /// The 25 parameters by the four steps; k/m by taps where there are any.
    pub four_steps: Vec<ParameterReport>,
    /// The taps.
    pub taps: Taps,
    /// What the joint fit knows beforehand.
    pub knowledge: Knowledge,
    /// The joint fit, which starts from the four steps, or why it refuses; parameters that are no sensor's are refused, too.
    pub joint: core::result::Result<JointReport, String>,
    /// By how much the trials contradict the joint fit's model, whether it was finished or given up; none where it refuses for another reason.
    pub misfit: Option<Misfit>,
}

impl Estimate {
    /// Estimates the parameters of a prepared session, the joint fit with this loss.
    ///
    /// # Errors
    /// [`crate::Error::Step`]: the first of the four steps that refuses its data.
    pub fn of(
        session: &Session,
        prepared: &PreparedSession,
        loss: Loss,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let campaign = &prepared.campaign;
        progress.stage("four steps", 2);
        let class = session.gyroscope.class_percent / 100.0;
        let steps = campaign.identify(GyroscopeGain::Certified { class })?;
        progress.part();
        let left_out = LeftOut::fit(campaign, &steps);
        progress.part();
        let propagated = propagation::of_session(session, campaign, &prepared.conditioning, &steps);
        let noise = propagated.as_ref().map(|(_, found)| found.noise);
        let mut four_steps = report(session, &steps, &left_out, noise.as_ref());
        let taps = Taps::identify(
            &prepared.taps,
            campaign.geometry,
            &steps.used(),
            &campaign.design,
            &four_steps,
        );
        put_taps(&mut four_steps, &taps);
        if let Some(rest) = &prepared.at_rest {
            let moving = campaign.trials.iter().map(|(trial, _)| trial);
            put_rest(&mut four_steps, rest, &still::steps_v(rest, moving));
        }
        progress.stage("joint fit", 1);
        let mut knowledge = Knowledge::of(session);
        knowledge.take_taps(&taps);
        let joint = joint::fit(campaign, &steps, &knowledge, loss);
        let misfit = match &joint {
            Ok(joint) => Some(joint.misfit),
            Err(refusal) => Misfit::of_refusal(refusal),
        };
        let joint = joint.map_err(|error| error.to_string()).and_then(|joint| {
            joint
                .parameters(campaign.design.stiffness_per_mass_per_s2)
                .validate()
                .map_err(|error| no_sensor(&error))?;
            Ok(joint)
        });
        progress.part();
        Ok(Self {
            steps,
            left_out,
            propagated,
            four_steps,
            taps,
            knowledge,
            joint,
            misfit,
        })
    }

    /// Covariance of the four steps' parameters from noise alone.
    pub fn noise(&self) -> Option<&Covariance> {
        self.propagated.as_ref().map(|(_, found)| &found.noise)
    }
}

/// Why a fit's parameters are no sensor's. What gives way under the sensor adds to its acceleration as the square of the frequency, as soft
/// limbs do.
fn no_sensor(error: &sixaxis_core::Error) -> String {
    match error {
        sixaxis_core::Error::OutOfRange {
            name: "stiffness_per_mass_per_s2",
            value,
            ..
        } => format!(
            "the fit takes k/m = {value:.1e} 1/s², which no limbs have: what the sensor is mounted on may give way, or ring"
        ),
        error => error.to_string(),
    }
}
