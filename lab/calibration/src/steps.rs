//! The four steps, one after the other, on a campaign's trials. How they are repeated is in [`repeated`].

mod repeated;

use glam::DVec3;
use rayon::prelude::*;
use sixaxis_core::identify::compliance_fit::ComplianceFit;
use sixaxis_core::identify::inertia::{InertiaEstimate, InertiaIdentification};
use sixaxis_core::identify::scale::{ScaleIdentification, ScalePerMass};
use sixaxis_core::identify::stiffness::{self, StiffnessPerMass};
use sixaxis_core::identify::stiffness_search::{self, RateNorms, rate_norm_sums};
use sixaxis_core::identify::zero_drift::{self, ZeroDrift};
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::{Geometry, LIMBS, LimbLaw, Parameters, Scheme, Sensor, Settings};

use crate::conditioning::Conditioned;
use crate::error::{Error, Result};
use crate::trial::Trial;
use sixaxis_recordings::session::Role;

/// Rows per cycle of the drive that steps 2 and 3 take from a trial. Neighbouring samples of a low-passed record say
/// nothing new and would make the covariance too small.
const ROWS_PER_CYCLE: f64 = 40.0;

/// Step 4's curve: k/m, 1/s^2, and mean |w*|, rad/s.
pub type Curve = Vec<(f64, f64)>;

/// What the four steps found.
#[derive(Debug, Clone, PartialEq)]
pub struct FourSteps {
    /// Step 1.
    pub drift: ZeroDrift,
    /// Step 2.
    pub scale: ScalePerMass,
    /// Step 3.
    pub inertia: InertiaEstimate,
    /// True rate over the gyroscope's reading and its standard error, where step 3 was asked for it.
    pub rate_over_reading: Option<(f64, f64)>,
    /// The same by the angular trials alone, with its jackknife's standard deviation, where the certificate was asked, too.
    pub gyroscope_gain_seen: Option<(f64, f64)>,
    /// Step 4; none if the campaign has no trials for it, or they cannot be decoupled.
    pub stiffness: Option<StiffnessPerMass>,
    /// Step 4's curve: k/m, 1/s^2, and mean |w*|, rad/s.
    pub curve: Curve,
    /// k/m of the design.
    pub design_stiffness_per_mass_per_s2: f64,
}

impl FourSteps {
    /// The 25 parameters as found; k/m is the design's if there was no step 4.
    pub fn found(&self) -> Parameters {
        Parameters {
            zero_drift_v: self.drift.drift_v,
            scale_per_mass_per_kg: self.scale.estimate.values,
            inertia_per_mass: self.inertia.inertia_per_mass,
            stiffness_per_mass_per_s2: self
                .stiffness
                .as_ref()
                .map_or(self.design_stiffness_per_mass_per_s2, |s| {
                    s.grid_minimum_per_s2
                }),
        }
    }

    /// Whether step 4 determines k/m.
    pub fn stiffness_is_determined(&self) -> bool {
        self.stiffness
            .as_ref()
            .is_some_and(|s| s.verdict.is_determined())
    }

    /// The 25 parameters to decouple with: where step 4 does not determine k/m, the design's.
    pub fn used(&self) -> Parameters {
        let mut used = self.found();
        if !self.stiffness_is_determined() {
            used.stiffness_per_mass_per_s2 = self.design_stiffness_per_mass_per_s2;
        }
        used
    }
}

/// What step 3 believes of the standard gyroscope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GyroscopeGain {
    /// It is right.
    Trusted,
    /// It is a seventh unknown.
    Identified,
    /// It is a seventh unknown of which the certificate says something: the angular trials' word and the certificate's, each
    /// weighed by how well it is known.
    Certified {
        /// Largest relative error that the certificate allows.
        class: f64,
    },
}

/// A campaign as the analysis has it: trials, conditioned.
#[derive(Debug, Clone)]
pub struct Campaign {
    /// The sensor's lengths.
    pub geometry: Geometry,
    /// Design values.
    pub design: Parameters,
    /// Nine voltages at rest, V.
    pub static_voltage_v: Vec<[f64; LIMBS]>,
    /// Trials of all roles but the static one.
    pub trials: Vec<(Trial, Conditioned)>,
}

impl Campaign {
    pub(crate) fn of(&self, role: Role) -> impl Iterator<Item = (&Trial, &Conditioned)> + Clone {
        self.trials
            .iter()
            .filter(move |(trial, _)| trial.role == role)
            .map(|(trial, conditioned)| (trial, conditioned))
    }

    /// Runs the four steps.
    ///
    /// # Errors
    /// [`Error::Step`]: the first step which refuses its data.
    pub fn identify(&self, gyroscope: GyroscopeGain) -> Result<FourSteps> {
        let drift = zero_drift::identify(&self.static_voltage_v)
            .map_err(at("step 1, the static record"))?;
        let scale = self.scale(&drift, |_| true).map_err(at("step 2"))?;
        let mut parameters = Parameters {
            zero_drift_v: drift.drift_v,
            scale_per_mass_per_kg: scale.estimate.values,
            ..self.design
        };
        let angular = self.angular(&parameters, |_| true).map_err(at("step 3"))?;
        let mut gyroscope_gain_seen = None;
        let (inertia, rate_over_reading) = match gyroscope {
            GyroscopeGain::Trusted => (angular.solve().map_err(at("step 3"))?, None),
            GyroscopeGain::Identified => {
                let found = angular.solve_with_gain().map_err(at("step 3"))?;
                let gain = (found.rate_over_reading, found.standard_error);
                (found.inertia, Some(gain))
            }
            GyroscopeGain::Certified { class } => {
                let (gain, seen) = self.certified_gain(&parameters, &angular, class);
                gyroscope_gain_seen = seen;
                let inertia = angular.solve_at_gain(gain.0).map_err(at("step 3"))?;
                (inertia, Some(gain))
            }
        };
        parameters.inertia_per_mass = inertia.inertia_per_mass;
        let (curve, stiffness) = self.step_4(&parameters).map_err(at("step 4"))?;
        Ok(FourSteps {
            drift,
            scale,
            inertia,
            rate_over_reading,
            gyroscope_gain_seen,
            stiffness,
            curve,
            design_stiffness_per_mass_per_s2: self.design.stiffness_per_mass_per_s2,
        })
    }

    /// True rate over the gyroscope's reading and its standard deviation, and the same by the trials alone. What the trials say is as good as they agree when one
    /// after the other is left out; a class is an even spread, whose standard deviation is its half width over the root of 3.
    fn certified_gain(
        &self,
        parameters: &Parameters,
        angular: &InertiaIdentification,
        class: f64,
    ) -> ((f64, f64), Option<(f64, f64)>) {
        let certified = class / 3.0_f64.sqrt();
        let trials = self.of(Role::Angular).count();
        let left_out: Vec<f64> = (0..trials)
            .filter_map(|out| {
                let rows = self.angular(parameters, |index| index != out).ok()?;
                Some(rows.solve_with_gain().ok()?.rate_over_reading)
            })
            .collect();
        match (angular.solve_with_gain(), jackknife(&left_out)) {
            (Ok(found), Some(spread)) => {
                let seen = spread.max(found.standard_error);
                let (a, b) = (1.0 / (certified * certified), 1.0 / (seen * seen));
                let gain = (a + b * found.rate_over_reading) / (a + b);
                (
                    (gain, 1.0 / (a + b).sqrt()),
                    Some((found.rate_over_reading, seen)),
                )
            }
            _ => ((1.0, certified), None),
        }
    }

    fn step_4(
        &self,
        parameters: &Parameters,
    ) -> sixaxis_core::Result<(Curve, Option<StiffnessPerMass>)> {
        if self.of(Role::HighFrequencyLinear).next().is_none() {
            return Ok((Vec::new(), None));
        }
        let curve = self.search(parameters, Scheme::Heun, 1, LimbLaw::CompressionShortens)?;
        let judged = stiffness::judge(&curve)?;
        Ok((curve, Some(judged)))
    }

    /// Step 2 on those of its trials, numbered from 0, that `takes` takes.
    ///
    /// # Errors
    /// A sample that is not finite, a motion that does not excite every unknown.
    pub fn scale(
        &self,
        drift: &ZeroDrift,
        takes: impl Fn(usize) -> bool,
    ) -> sixaxis_core::Result<ScalePerMass> {
        let mut step = ScaleIdentification::default();
        for (index, (trial, conditioned)) in self.of(Role::Linear).enumerate() {
            if !takes(index) {
                continue;
            }
            for sample in rows(trial) {
                let force = trial
                    .gains
                    .measured_force_n(&conditioned.voltage_v[sample], &drift.drift_v);
                step.push(&force, conditioned.linear_ground_m_s2[sample])?;
            }
        }
        step.solve()
    }

    /// Step 3's data with the given drift and scale factors, from those of its trials, numbered from 0, that `takes` takes.
    ///
    /// # Errors
    /// A sample that is not finite.
    pub fn angular(
        &self,
        parameters: &Parameters,
        takes: impl Fn(usize) -> bool,
    ) -> sixaxis_core::Result<InertiaIdentification> {
        let mut step = InertiaIdentification::new(self.geometry);
        for (index, (trial, conditioned)) in self.of(Role::Angular).enumerate() {
            if !takes(index) {
                continue;
            }
            let chain = SignalChain::new(&trial.gains, parameters);
            for sample in rows(trial) {
                step.push(
                    &chain.force_per_mass_m_s2(&conditioned.voltage_v[sample]),
                    conditioned.rate_shell_rad_s[sample],
                    conditioned.angular_shell_rad_s2[sample],
                )?;
            }
        }
        Ok(step)
    }

    /// Step 4 by least squares: the compliance m/k, s^2, that makes the mean square of w* smallest, from two decodes a trial.
    ///
    /// # Errors
    /// Those of the decoupler; a motion in which w* does not change with the compliance.
    pub fn compliance(&self, parameters: &Parameters) -> sixaxis_core::Result<f64> {
        self.compliance_fit(parameters, |_, _| ())?.solve()
    }

    /// All trials of step 4 in its closed form. `each` sees, sample by sample, the trial's place in the campaign and by how much w*
    /// changes with the compliance, (rad/s)/s^2.
    pub(crate) fn compliance_fit(
        &self,
        parameters: &Parameters,
        mut each: impl FnMut(usize, DVec3),
    ) -> sixaxis_core::Result<ComplianceFit> {
        let mut fit = ComplianceFit::default();
        for (index, (trial, conditioned)) in self.trials.iter().enumerate() {
            if trial.role == Role::HighFrequencyLinear {
                fit.push_trial(
                    &trial.sensor(self.geometry),
                    parameters,
                    &trial.settings(Scheme::Heun),
                    &conditioned.voltage_v,
                    |slope| each(index, slope),
                )?;
            }
        }
        Ok(fit)
    }

    /// Step 4's curve over the paper's grid, from every `stride`-th sample.
    ///
    /// # Errors
    /// Those of the decoupler.
    pub fn search(
        &self,
        parameters: &Parameters,
        scheme: Scheme,
        stride: usize,
        limb_law: LimbLaw,
    ) -> sixaxis_core::Result<Curve> {
        let trials: Vec<(Sensor, Settings, Vec<[f64; LIMBS]>)> = self
            .of(Role::HighFrequencyLinear)
            .map(|(trial, conditioned)| {
                let mut settings = trial.settings(scheme);
                settings.sample_rate_hz /= stride as f64;
                settings.limb_law = limb_law;
                let rows = conditioned
                    .voltage_v
                    .iter()
                    .copied()
                    .step_by(stride)
                    .collect();
                (trial.sensor(self.geometry), settings, rows)
            })
            .collect();
        let grid: Vec<f64> = stiffness::paper_grid().collect();
        // In pairs, as the search has them side by side; summed in their own order, whatever thread was first.
        let pairs: Vec<RateNorms> = trials
            .par_chunks(2)
            .map(|pair| {
                let pair: Vec<stiffness_search::Trial> = pair
                    .iter()
                    .map(|(sensor, settings, voltage_v)| stiffness_search::Trial {
                        sensor,
                        settings,
                        voltage_v,
                    })
                    .collect();
                rate_norm_sums(parameters, &pair, &grid)
            })
            .collect::<sixaxis_core::Result<_>>()?;
        let samples: usize = pairs.iter().map(|pair| pair.samples).sum();
        let sum = |candidate: usize| pairs.iter().map(|pair| pair.sums[candidate]).sum::<f64>();
        Ok(grid
            .iter()
            .enumerate()
            .map(|(i, &k)| (k, sum(i) / samples as f64))
            .collect())
    }
}

/// Standard deviation of an estimate by the jackknife: (n-1)/n times the sum of squares about the mean, rooted. None for fewer
/// than three fits.
pub fn jackknife(values: &[f64]) -> Option<f64> {
    let n = values.len() as f64;
    if values.len() < 3 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
    Some(((n - 1.0) / n * squares).sqrt())
}

fn at(step: &'static str) -> impl Fn(sixaxis_core::Error) -> Error {
    move |source| Error::Step {
        step,
        source: Box::new(source),
    }
}

/// Every how many samples steps 2 and 3 take a row from a trial.
pub fn stride(trial: &Trial) -> usize {
    (trial.sample_rate_hz / trial.frequency_hz / ROWS_PER_CYCLE).max(1.0) as usize
}

/// The samples of a trial that steps 2 and 3 take.
pub fn rows(trial: &Trial) -> impl Iterator<Item = usize> {
    (0..trial.voltage_v.len()).step_by(stride(trial))
}
