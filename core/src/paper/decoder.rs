//! The paper's decoder: (11), (2), the pose, (8) by improved Euler, (9), then (3).

#[cfg(feature = "alloc")]
use alloc::vec::Vec;

use glam::{DMat3, DQuat, DVec3};

use super::attitude;
use super::dynamics::{Instant, MassInertia};
use super::limb_stream::LimbStream;
use super::wrench::LimbWrench;
use crate::error::Result;
use crate::geometry::LIMBS;
use crate::model::Model;
use crate::six_axis::SixAxis;

/// The variable that improved Euler steps. On a grid of samples the two are different discretisations of (8), of the same order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RateVariable {
    /// w*, the rate of the shell in shell axes, as printed.
    #[default]
    Shell,
    /// W = R_r^T (w* + w_r), the rate of the mass in mass axes, as [`crate::Decoupler`] has it: in W' = R_r^T (w*' + eps + w* x w_r)
    /// the differentiated eps of (8) cancels.
    Mass,
}

/// Decoder made of the equations as printed, with nothing rearranged: the oracle of every other decoder of this crate.
///
/// Takes nine voltages and returns the sample before them, as [`crate::Decoupler`] does; the first and the last sample of a
/// recording yield nothing. Integrates by improved Euler (Heun), whatever [`crate::Settings::scheme`] asks for. With
/// [`RateVariable::Mass`] it equals [`crate::Decoupler`] with [`crate::Scheme::Heun`] to rounding (test
/// `ref_the_paths_are_the_printed_formulas`, 1e-12 of the peak).
#[derive(Debug, Clone, PartialEq)]
pub struct Decoder {
    limbs: LimbStream,
    inertia: MassInertia,
    variable: RateVariable,
    gravity_ground_m_s2: DVec3,
    step_s: f64,
    start: (DVec3, DQuat),
    last: Option<State>,
}

/// Decodes a recording, nine voltages a row, V: elements belong to samples 1, 2, ... of it.
///
/// # Errors
/// Those of [`Decoder::new`] and [`Decoder::push`].
#[cfg(feature = "alloc")]
pub fn decouple(
    model: &Model,
    variable: RateVariable,
    voltage_v: &[[f64; LIMBS]],
) -> Result<Vec<SixAxis>> {
    let mut answers = Vec::with_capacity(voltage_v.len());
    Decoder::new(model, variable)?.push_all(voltage_v, |sample| answers.push(*sample))?;
    Ok(answers)
}

/// What a step starts from.
#[derive(Debug, Clone, Copy, PartialEq)]
struct State {
    /// The integrated variable and its derivative.
    stepped: [DVec3; 2],
    /// w* and w*'.
    shell: [DVec3; 2],
    /// R.
    attitude: DQuat,
}

impl Decoder {
    /// Prepares a decoder that steps `variable`.
    ///
    /// # Errors
    /// Those of [`LimbStream::new`].
    pub fn new(model: &Model, variable: RateVariable) -> Result<Self> {
        let settings = model.settings();
        Ok(Self {
            limbs: LimbStream::new(model)?,
            inertia: MassInertia::new(&model.parameters().inertia_per_mass),
            variable,
            gravity_ground_m_s2: settings.gravity_ground_m_s2,
            step_s: 1.0 / settings.sample_rate_hz,
            start: (settings.initial_rate_shell_rad_s, settings.initial_attitude),
            last: None,
        })
    }

    /// Takes the next nine voltages, V, and returns the sample before them, once there are three.
    ///
    /// # Errors
    /// Those of [`LimbStream::push`].
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<Option<SixAxis>> {
        // (10), (11), (2), the pose and its differences.
        let Some(limbs) = self.limbs.push(voltage_v)? else {
            return Ok(None);
        };
        // The sums of (3) and (8).
        let wrench = LimbWrench::at_pose(
            self.limbs.geometry(),
            &limbs.relative.pose,
            &limbs.force_per_mass_m_s2,
        );
        let instant = Instant::new(limbs.relative, wrench, &self.inertia);
        let at = Stepped {
            variable: self.variable,
            instant: &instant,
            mass_to_shell: limbs.relative.pose.rotation_matrix(),
        };
        let h = self.step_s;
        // (8) by improved Euler.
        let value = match self.last {
            None => at.of_shell_rate(self.start.0),
            Some(State {
                stepped: [w, k], ..
            }) => w + 0.5 * h * (k + at.slope(w + h * k)),
        };
        let rate = at.shell_rate(value);
        let derivative = instant.angular_acceleration_shell_rad_s2(rate);
        // (9).
        let attitude = match self.last {
            None => self.start.1,
            Some(State {
                shell: [w, w_dot],
                attitude,
                ..
            }) => attitude::advance(attitude, [w, rate], [w_dot, derivative], h),
        };
        self.last = Some(State {
            stepped: [value, at.slope(value)],
            shell: [rate, derivative],
            attitude,
        });
        // (3).
        let specific_force = instant.specific_force_shell_m_s2(rate, derivative);
        Ok(Some(SixAxis {
            sample: limbs.sample,
            linear_ground_m_s2: attitude * specific_force + self.gravity_ground_m_s2,
            angular_ground_rad_s2: attitude * derivative,
            rate_shell_rad_s: rate,
            attitude,
        }))
    }

    /// [`Decoder::push`] for every row of a recording; `sink` takes the answers in order.
    ///
    /// # Errors
    /// Those of [`Decoder::push`], at the first row that is refused.
    pub fn push_all(
        &mut self,
        voltage_v: &[[f64; LIMBS]],
        mut sink: impl FnMut(&SixAxis),
    ) -> Result<()> {
        for row in voltage_v {
            if let Some(answer) = self.push(row)? {
                sink(&answer);
            }
        }
        Ok(())
    }
}

/// The integrated variable at one instant.
struct Stepped<'a> {
    variable: RateVariable,
    instant: &'a Instant,
    /// R_r.
    mass_to_shell: DMat3,
}

impl Stepped<'_> {
    /// The variable that belongs to a rate w* of the shell.
    fn of_shell_rate(&self, rate: DVec3) -> DVec3 {
        match self.variable {
            RateVariable::Shell => rate,
            RateVariable::Mass => {
                self.mass_to_shell.transpose() * (rate + self.instant.relative.rate_shell_rad_s)
            }
        }
    }

    /// w* that belongs to a value of the variable: inverse of [`Self::of_shell_rate`].
    fn shell_rate(&self, value: DVec3) -> DVec3 {
        match self.variable {
            RateVariable::Shell => value,
            RateVariable::Mass => {
                self.mass_to_shell * value - self.instant.relative.rate_shell_rad_s
            }
        }
    }

    /// Time derivative of the variable: (8), and for the mass W' = R_r^T (w*' + eps + w* x w_r).
    fn slope(&self, value: DVec3) -> DVec3 {
        let rate = self.shell_rate(value);
        let derivative = self.instant.angular_acceleration_shell_rad_s2(rate);
        match self.variable {
            RateVariable::Shell => derivative,
            RateVariable::Mass => {
                let relative = &self.instant.relative;
                self.mass_to_shell.transpose()
                    * (derivative
                        + relative.angular_acceleration_shell_rad_s2
                        + rate.cross(relative.rate_shell_rad_s))
            }
        }
    }
}
