//! What a trial that is still to come is worth: by how much it narrows the intervals of the parameters that it bears on.
//!
//! By the linear theory of steps 2 and 3. A trial tells a channel's scale factor as well as its direction loads that limb, and the six
//! inertias as well as its axis turns them; every trial is as precise as its amplifiers' range, which is set for its largest signal.
//! What an interval owes to the trials shrinks with their information; what it owes to the standards' certificates stays.

use glam::DVec3;
use nalgebra::{Matrix6, Vector6};
use serde::Serialize;
use sixaxis_calibration::report::ParameterReport;
use sixaxis_core::identify::inertia::between;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{InertiaPerMass, LIMBS, Parameter};
use sixaxis_recordings::session::{Entry, Role, Session};

/// Narrowing of the intervals, as shares of their widths.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Worth {
    /// Of the one that narrows most.
    pub most: f64,
    /// Its parameter.
    pub parameter: String,
    /// Mean over scale factors and inertias.
    pub mean: f64,
}

/// What some trials tell, in units that a parameter's two sums share.
#[derive(Debug, Clone)]
pub struct Information {
    shares: StaticLoadSharing,
    design: InertiaPerMass,
    scale: [f64; LIMBS],
    inertia: Matrix6<f64>,
}

impl Information {
    /// Of no trial; none for lengths that hold no mass.
    pub fn none(session: &Session) -> Option<Self> {
        Some(Self {
            shares: StaticLoadSharing::new(&session.sensor.geometry()).ok()?,
            design: session.sensor.design().inertia_per_mass,
            scale: [0.0; LIMBS],
            inertia: Matrix6::zeros(),
        })
    }

    /// With a trial more.
    #[must_use]
    pub fn with(mut self, entry: &Entry) -> Self {
        let Some(n) = entry
            .direction
            .and_then(|direction| DVec3::from_array(direction).try_normalize())
        else {
            return self;
        };
        let largest = |loads: &[f64; LIMBS]| loads.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        match entry.role {
            Role::Linear => {
                let loads = core::array::from_fn(|i| self.shares.of_acceleration(i).dot(n));
                let range = largest(&loads);
                for (sum, load) in self.scale.iter_mut().zip(loads) {
                    *sum += (load / range).powi(2);
                }
            }
            Role::Angular => {
                let torque = self.design.matrix_mass_m2() * n;
                let arms: [DVec3; LIMBS] = core::array::from_fn(|i| self.shares.of_torque_per_m(i));
                let range = largest(&arms.map(|t| t.dot(torque)));
                for t in arms {
                    let row = Vector6::from(between(t, n)) / range;
                    self.inertia += row * row.transpose();
                }
            }
            _ => {}
        }
        self
    }

    /// Variance of a parameter, in units of its own; none where the trials leave it open.
    fn variance(&self, parameter: Parameter) -> Option<f64> {
        let variance = match parameter {
            Parameter::Scale(limb) => 1.0 / self.scale[limb],
            Parameter::Inertia(entry) => self.inertia.try_inverse()?[(entry, entry)],
            _ => return None,
        };
        (variance.is_finite() && variance > 0.0).then_some(variance)
    }

    /// What a trial would add to these.
    pub fn worth(&self, entry: &Entry, parameters: &[ParameterReport]) -> Option<Worth> {
        if !matches!(entry.role, Role::Linear | Role::Angular) {
            return None;
        }
        let more = self.clone().with(entry);
        let (mut sum, mut count) = (0.0, 0.0);
        let mut most = (0.0, None);
        for report in parameters {
            let (Some(before), Some(half)) =
                (self.variance(report.parameter), report.half_width_95)
            else {
                continue;
            };
            let after = more.variance(report.parameter)?;
            let of_standards = report.from_standards.unwrap_or(0.0).min(half);
            let of_trials = half * half - of_standards * of_standards;
            let next = (of_trials * after / before + of_standards * of_standards).sqrt();
            let narrowing = 1.0 - next / half;
            sum += narrowing;
            count += 1.0;
            if narrowing > most.0 {
                most = (narrowing, Some(report.parameter));
            }
        }
        Some(Worth {
            most: most.0,
            parameter: most.1?.to_string(),
            mean: sum / count,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::settings::Settings;
    use sixaxis_reference::laboratory::plan::Engine;

    fn settings() -> Settings {
        Settings {
            seed: 1,
            sample_rate_hz: 1000.0,
            trials_per_step: 6,
            engine: Engine::Rigid,
        }
    }

    fn report(parameter: Parameter, half: f64, standards: f64) -> ParameterReport {
        ParameterReport {
            parameter,
            unit: String::new(),
            estimate: 1.0,
            design: 1.0,
            half_width_95: Some(half),
            from_noise: None,
            from_trials: None,
            from_standards: Some(standards),
            dominated_by: String::new(),
            determined: true,
            remark: String::new(),
        }
    }

    #[test]
    fn law_repeats_count_as_repeats() {
        let day = settings().day();
        let session = settings().session();
        let planned = |role| {
            day.iter()
                .map(|(entry, _)| entry)
                .filter(move |e| e.role == role)
        };
        for (role, parameters) in [
            (
                Role::Linear,
                (0..LIMBS).map(Parameter::Scale).collect::<Vec<_>>(),
            ),
            (Role::Angular, (0..6).map(Parameter::Inertia).collect()),
        ] {
            let reports: Vec<ParameterReport> =
                parameters.iter().map(|p| report(*p, 2.0, 0.0)).collect();
            let once = planned(role)
                .fold(Information::none(&session).expect("a mass"), |sum, e| {
                    sum.with(e)
                });
            // The whole day again halves every variance, trial by trial.
            let mut so_far = once.clone();
            let mut left = vec![1.0; parameters.len()];
            for entry in planned(role) {
                let more = so_far.clone().with(entry);
                for (left, p) in left.iter_mut().zip(&parameters) {
                    let ratio =
                        more.variance(*p).expect("told") / so_far.variance(*p).expect("told");
                    assert!(ratio < 1.0 + 1e-9, "{p}: {ratio}");
                    *left *= ratio;
                }
                let worth = so_far.worth(entry, &reports).expect("it narrows something");
                assert!(worth.most > 0.0 && worth.mean > 0.0 && worth.mean <= worth.most);
                so_far = more;
            }
            assert!(
                left.iter().all(|share| (share - 0.5).abs() < 1e-9),
                "{left:?}"
            );
            // What the standards leave does not shrink.
            let first = planned(role).next().expect("a trial");
            let held: Vec<ParameterReport> =
                parameters.iter().map(|p| report(*p, 2.0, 1.999)).collect();
            assert!(once.worth(first, &held).expect("a little").most < 1e-3);
        }
        let validation = planned(Role::Validation).next().expect("a run");
        assert_eq!(
            Information::none(&session)
                .expect("a mass")
                .worth(validation, &[]),
            None
        );
    }
}
