//! One repetition of steps 2 to 4 with the limbs' compliance kept.

use sixaxis_core::identify::compliance::CompliantRows;
use sixaxis_core::identify::inertia::InertiaIdentification;
use sixaxis_core::identify::scale::{ScaleIdentification, ScalePerMass};
use sixaxis_core::paper::limb_stream::LimbSample;
use sixaxis_core::{Parameters, Scheme};

use super::{Campaign, FourSteps, at, stride};
use crate::conditioning::Conditioned;
use crate::error::Result;
use sixaxis_recordings::session::Role;

impl Campaign {
    /// Repeats steps 2 to 4 with the limbs' compliance kept, starting from what the four steps found and a k/m of the
    /// caller's, s^-2. The gyroscope's gain stays what `first` has for it.
    ///
    /// # Errors
    /// [`Error::Step`](crate::error::Error::Step): the first step which refuses its data.
    pub fn repeat_from(
        &self,
        first: &FourSteps,
        stiffness_per_mass_per_s2: f64,
    ) -> Result<FourSteps> {
        let mut parameters = Parameters {
            stiffness_per_mass_per_s2,
            ..first.found()
        };
        let scale = self
            .compliant_scale(&parameters)
            .map_err(at("step 2, repeated"))?;
        parameters.scale_per_mass_per_kg = scale.estimate.values;
        let rows = self
            .compliant_inertia(&parameters)
            .map_err(at("step 3, repeated"))?;
        let inertia = match first.rate_over_reading {
            Some((gain, _)) => rows.solve_at_gain(gain),
            None => rows.solve(),
        }
        .map_err(at("step 3, repeated"))?;
        parameters.inertia_per_mass = inertia.inertia_per_mass;
        let (curve, stiffness) = self.step_4(&parameters).map_err(at("step 4, repeated"))?;
        Ok(FourSteps {
            drift: first.drift,
            scale,
            inertia,
            rate_over_reading: first.rate_over_reading,
            gyroscope_gain_seen: first.gyroscope_gain_seen,
            stiffness,
            curve,
            design_stiffness_per_mass_per_s2: first.design_stiffness_per_mass_per_s2,
        })
    }

    fn compliant_scale(&self, parameters: &Parameters) -> sixaxis_core::Result<ScalePerMass> {
        let mut scale = ScaleIdentification::default();
        self.each_compliant(Role::Linear, parameters, |compliant, now, conditioned| {
            let a = conditioned.linear_ground_m_s2[now.sample as usize];
            compliant.push_scale(&mut scale, now, a)
        })?;
        scale.solve()
    }

    fn compliant_inertia(
        &self,
        parameters: &Parameters,
    ) -> sixaxis_core::Result<InertiaIdentification> {
        let mut inertia = InertiaIdentification::new(self.geometry);
        self.each_compliant(Role::Angular, parameters, |compliant, now, conditioned| {
            let t = now.sample as usize;
            let rate = conditioned.rate_shell_rad_s[t];
            compliant.push_inertia(&mut inertia, now, rate, conditioned.angular_shell_rad_s2[t])
        })?;
        Ok(inertia)
    }

    /// Hands out the samples of this role's trials that the steps read, with the rows of their recording.
    fn each_compliant(
        &self,
        role: Role,
        parameters: &Parameters,
        mut push: impl FnMut(&CompliantRows, &LimbSample, &Conditioned) -> sixaxis_core::Result<()>,
    ) -> sixaxis_core::Result<()> {
        for (trial, conditioned) in self.of(role) {
            let mut compliant = CompliantRows::new(
                &trial.sensor(self.geometry),
                parameters,
                &trial.settings(Scheme::Heun),
            )?;
            let stride = stride(trial) as u64;
            for voltage in &conditioned.voltage_v {
                if let Some(now) = compliant.push(voltage)?
                    && now.sample.is_multiple_of(stride)
                {
                    push(&compliant, &now, conditioned)?;
                }
            }
        }
        Ok(())
    }
}
