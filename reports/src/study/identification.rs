//! The four steps, one after the other, on a campaign's recordings.

use anyhow::{Context, Result};
use rayon::prelude::*;
use sixaxis_core::identify::compliance::CompliantRows;
use sixaxis_core::identify::inertia::{InertiaEstimate, InertiaIdentification};
use sixaxis_core::identify::scale::{ScaleIdentification, ScalePerMass};
use sixaxis_core::identify::stiffness::{self, StiffnessPerMass};
use sixaxis_core::identify::stiffness_search::{self, RateNorms, rate_norm_sums};
use sixaxis_core::identify::zero_drift::{self, ZeroDrift};
use sixaxis_core::signal::SignalChain;
use sixaxis_core::{Geometry, LIMBS, Parameters, Scheme, Sensor, Settings};
use sixaxis_reference::campaign::{Laboratory, Role, Trial};
use sixaxis_reference::paper;
use sixaxis_reference::recording::{Recording, SimulatedRun};

use super::cleaning::{Cleaned, Cleaning};

/// Rows per cycle of the drive that steps 2 and 3 take from a recording. Neighbouring samples of a low-passed record
/// say nothing new and would make the covariance too small.
const ROWS_PER_CYCLE: f64 = 40.0;

/// What the four steps found.
#[derive(Debug, Clone)]
pub struct FourSteps {
    /// Step 1.
    pub drift: ZeroDrift,
    /// Step 2.
    pub scale: ScalePerMass,
    /// Step 3.
    pub inertia: InertiaEstimate,
    /// True rate over the gyroscope's reading and its standard error, where step 3 was asked for it.
    pub rate_over_reading: Option<(f64, f64)>,
    /// Step 4.
    pub stiffness: StiffnessPerMass,
    /// Step 4's curve.
    pub curve: Vec<(f64, f64)>,
}

impl FourSteps {
    /// The 25 parameters as found.
    #[must_use]
    pub fn found(&self) -> Parameters {
        Parameters {
            zero_drift_v: self.drift.drift_v,
            scale_per_mass_per_kg: self.scale.estimate.values,
            inertia_per_mass: self.inertia.inertia_per_mass,
            stiffness_per_mass_per_s2: self.stiffness.grid_minimum_per_s2,
        }
    }

    /// The 25 parameters to decouple with: where step 4 does not determine k/m, the design's.
    #[must_use]
    pub fn used(&self) -> Parameters {
        let mut used = self.found();
        if !self.stiffness.verdict.is_determined() {
            used.stiffness_per_mass_per_s2 = paper::DESIGN_STIFFNESS_PER_MASS_PER_S2;
        }
        used
    }
}

/// A campaign as the laboratory has it: recordings with their roles, cleaned.
pub struct Session {
    /// Ten minutes at rest.
    pub at_rest: Recording,
    /// Steps 2 to 4.
    pub trials: Vec<(Role, Recording, Cleaned)>,
}

impl Session {
    /// Records and cleans a simulated campaign.
    ///
    /// # Errors
    /// Those of the cleaning.
    pub fn record(
        laboratory: &Laboratory,
        simulated: &[(Trial, SimulatedRun)],
        cleaning: Cleaning,
    ) -> Result<Self> {
        let rest = simulated
            .first()
            .and_then(|(_, run)| run.limb_force_per_mass_m_s2.first())
            .copied()
            .unwrap_or([0.0; LIMBS]);
        let trials = simulated
            .par_iter()
            .enumerate()
            .map(|(index, (trial, run))| {
                let recording = laboratory.record(run, index);
                let cleaned = cleaning.clean(&recording)?;
                Ok((trial.role, recording, cleaned))
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(Self {
            at_rest: laboratory.record_static(rest),
            trials,
        })
    }

    fn of(&self, role: Role) -> impl Iterator<Item = (&Recording, &Cleaned)> + Clone {
        self.trials
            .iter()
            .filter(move |(r, _, _)| *r == role)
            .map(|(_, recording, cleaned)| (recording, cleaned))
    }

    /// Runs the four steps.
    ///
    /// # Errors
    /// That of the first step which refuses its data.
    pub fn identify(&self, gyroscope: Gyroscope) -> Result<FourSteps> {
        let drift = zero_drift::identify(&self.at_rest.voltage_v).context("step 1")?;
        let scale = self.scale(&drift).context("step 2")?;
        let mut parameters = Parameters {
            zero_drift_v: drift.drift_v,
            scale_per_mass_per_kg: scale.estimate.values,
            ..paper::design_parameters()
        };
        let angular = self.angular(&parameters).context("step 3")?;
        let (inertia, rate_over_reading) = match gyroscope {
            Gyroscope::Trusted => (angular.solve().context("step 3")?, None),
            Gyroscope::GainIdentified => {
                let found = angular.solve_with_gain().context("step 3")?;
                let gain = (found.rate_over_reading, found.standard_error);
                (found.inertia, Some(gain))
            }
        };
        parameters.inertia_per_mass = inertia.inertia_per_mass;
        let curve = self
            .search(&parameters, Scheme::Heun, 1, Sign::Corrected)
            .context("step 4")?;
        let stiffness = stiffness::judge(&curve).context("step 4")?;
        Ok(FourSteps {
            drift,
            scale,
            inertia,
            rate_over_reading,
            stiffness,
            curve,
        })
    }

    /// Repeats steps 2 to 4 with the limbs' compliance kept, starting from what the four steps found.
    ///
    /// # Errors
    /// That of the first step which refuses its data.
    pub fn repeat(&self, first: &FourSteps) -> Result<FourSteps> {
        let mut parameters = first.used();
        let mut scale = ScaleIdentification::default();
        for (recording, cleaned) in self.of(Role::Linear) {
            let mut compliant = compliant(recording, &parameters)?;
            let stride = stride(recording) as u64;
            for voltage in &cleaned.voltage_v {
                if let Some(now) = compliant.push(voltage)?
                    && now.sample.is_multiple_of(stride)
                {
                    let a = cleaned.linear_ground_m_s2[now.sample as usize];
                    compliant.push_scale(&mut scale, &now, a)?;
                }
            }
        }
        let scale = scale.solve().context("step 2, repeated")?;
        parameters.scale_per_mass_per_kg = scale.estimate.values;
        let mut inertia = InertiaIdentification::new(Geometry::PAPER);
        for (recording, cleaned) in self.of(Role::Angular) {
            let mut compliant = compliant(recording, &parameters)?;
            let stride = stride(recording) as u64;
            for voltage in &cleaned.voltage_v {
                if let Some(now) = compliant.push(voltage)?
                    && now.sample.is_multiple_of(stride)
                {
                    compliant.push_inertia(
                        &mut inertia,
                        &now,
                        cleaned.rate_shell_rad_s[now.sample as usize],
                        cleaned.angular_shell_rad_s2[now.sample as usize],
                    )?;
                }
            }
        }
        let inertia = inertia.solve().context("step 3, repeated")?;
        parameters.inertia_per_mass = inertia.inertia_per_mass;
        let curve = self.search(&parameters, Scheme::Heun, 1, Sign::Corrected)?;
        Ok(FourSteps {
            drift: first.drift,
            scale,
            inertia,
            rate_over_reading: None,
            stiffness: stiffness::judge(&curve)?,
            curve,
        })
    }

    fn scale(&self, drift: &ZeroDrift) -> Result<ScalePerMass> {
        let mut step = ScaleIdentification::default();
        for (recording, cleaned) in self.of(Role::Linear) {
            for sample in rows(recording) {
                let force = recording
                    .gains
                    .measured_force_n(&cleaned.voltage_v[sample], &drift.drift_v);
                step.push(&force, cleaned.linear_ground_m_s2[sample])?;
            }
        }
        Ok(step.solve()?)
    }

    /// Step 3's data with the given drift and scale factors.
    ///
    /// # Errors
    /// A sample that is not finite.
    pub fn angular(&self, parameters: &Parameters) -> Result<InertiaIdentification> {
        let mut step = InertiaIdentification::new(Geometry::PAPER);
        for (recording, cleaned) in self.of(Role::Angular) {
            let chain = SignalChain::new(&recording.gains, parameters);
            for sample in rows(recording) {
                step.push(
                    &chain.force_per_mass_m_s2(&cleaned.voltage_v[sample]),
                    cleaned.rate_shell_rad_s[sample],
                    cleaned.angular_shell_rad_s2[sample],
                )?;
            }
        }
        Ok(step)
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
        sign: Sign,
    ) -> Result<Vec<(f64, f64)>> {
        let trials: Vec<(Sensor, Settings, Vec<[f64; LIMBS]>)> = self
            .of(Role::FastLinear)
            .map(|(recording, cleaned)| {
                let mut settings = settings(recording, scheme);
                settings.sample_rate_hz /= stride as f64;
                settings.limb_law = sign.law();
                let rows = cleaned.voltage_v.iter().copied().step_by(stride).collect();
                (sensor(recording), settings, rows)
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

/// What step 3 believes of the standard gyroscope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gyroscope {
    /// Its gain is right.
    Trusted,
    /// Its gain is a seventh unknown.
    GainIdentified,
}

/// Sign of eq. (2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// Compression shortens.
    Corrected,
    /// As printed.
    AsPrinted,
}

impl Sign {
    fn law(self) -> sixaxis_core::LimbLaw {
        match self {
            Self::Corrected => sixaxis_core::LimbLaw::CompressionShortens,
            Self::AsPrinted => sixaxis_core::LimbLaw::AsPrinted,
        }
    }
}

/// The sensor as a recording's amplifier range makes it.
#[must_use]
pub fn sensor(recording: &Recording) -> Sensor {
    Sensor {
        geometry: Geometry::PAPER,
        gains: recording.gains,
    }
}

/// Decoupler settings that go with a recording.
#[must_use]
pub fn settings(recording: &Recording, scheme: Scheme) -> Settings {
    Settings {
        scheme,
        gravity_ground_m_s2: recording.gravity_ground_m_s2,
        ..Settings::new(recording.sample_rate_hz)
    }
}

fn compliant(
    recording: &Recording,
    parameters: &Parameters,
) -> sixaxis_core::Result<CompliantRows> {
    CompliantRows::new(
        &sensor(recording),
        parameters,
        &settings(recording, Scheme::Heun),
    )
}

fn stride(recording: &Recording) -> usize {
    (recording.sample_rate_hz / recording.frequency_hz / ROWS_PER_CYCLE).max(1.0) as usize
}

fn rows(recording: &Recording) -> impl Iterator<Item = usize> {
    (0..recording.voltage_v.len()).step_by(stride(recording))
}
