//! What the joint fit adds to the summaries.

use serde::Serialize;
use sixaxis_calibration::calibrate::CalibratedSession;
use sixaxis_calibration::joint::nuisances::Nuisances;
use sixaxis_calibration::report::{Estimator, ParameterReport};

use crate::commands::common::wrapped;

/// For scripts.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Summary<'a> {
    /// It was done.
    Fitted {
        /// Squares per degree of freedom: 1 where an ordinary room and white noise are all there is.
        misfit: f64,
        /// What noise alone leaves of that at most.
        misfit_limit: f64,
        /// Factor by which its intervals have been widened for a misfit.
        intervals_widened: f64,
        degrees_of_freedom: usize,
        parameters: Vec<ParameterReport>,
        /// What instruments and wedges turned out to be.
        nuisances: Box<Nuisances>,
    },
    /// Why not.
    Refused(&'a str),
}

impl<'a> Summary<'a> {
    /// Of a calibrated.
    pub fn of(calibrated: &'a CalibratedSession) -> Option<Self> {
        Some(match calibrated.joint.as_ref()? {
            Ok(joint) => Self::Fitted {
                misfit: joint.misfit.per_degree,
                misfit_limit: joint.misfit.limit(),
                intervals_widened: joint.misfit.wider(),
                degrees_of_freedom: joint.misfit.degrees_of_freedom,
                parameters: joint.parameter_reports(&calibrated.four_steps),
                nuisances: Box::new(joint.nuisances()),
            },
            Err(cause) => Self::Refused(cause),
        })
    }
}

/// For people: whose the parameters are, unless they are the four steps'.
pub fn print(out: &mut String, calibrated: &CalibratedSession) {
    if calibrated.estimator == Estimator::FourSteps {
        return;
    }
    let line = match &calibrated.joint {
        Some(Ok(joint)) => {
            let too_few = joint.misfit.too_few();
            format!(
                "by {}: misfit {:.3}, where noise alone leaves at most {:.3}{}",
                calibrated.estimator.name(),
                joint.misfit.per_degree,
                joint.misfit.limit(),
                too_few.map_or(String::new(), |words| format!("; {words}"))
            )
        }
        _ => format!(
            "by the four steps, and not kept: {} refuses",
            calibrated.estimator.name()
        ),
    };
    wrapped(out, "  ", "  ", &line);
}
