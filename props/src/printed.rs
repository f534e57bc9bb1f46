//! Eqs. (3) and (8) as the paper prints them, in SI units, with nothing rearranged; and a decoupler made of them.
//!
//! The core gets the same answers from other formulas (`sixaxis_core::kernel`). Here the pose comes from the closed form
//! with its fixed-point iteration, tensors are 3 x 3 and inverted, angles go through sines. w* is the shell's angular velocity in shell axes (the
//! paper's auxiliary angular velocity); forces come per mass, m/s^2, torques per mass, m^2/s^2, inertia per mass, m^2.

use glam::{DMat3, DVec3};
use sixaxis_core::paper::attitude;
use sixaxis_core::paper::limb_stream::LimbStream;
use sixaxis_core::paper::pose::RelativeMotion;
use sixaxis_core::paper::wrench::LimbWrench;
use sixaxis_core::{InertiaPerMass, LIMBS, Parameters, Sensor, Settings};

/// Everything in (3) and (8) at one instant except the shell's own rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant {
    /// Motion of the mass in the shell.
    pub relative: RelativeMotion,
    /// Resultant of the limb forces.
    pub wrench: LimbWrench,
    /// I* = R_r (I/m) R_r^T, shell axes, m^2.
    inertia_shell_m2: DMat3,
    /// Its inverse.
    inertia_shell_inverse: DMat3,
}

impl Instant {
    /// Collects what the limbs say at one instant.
    #[must_use]
    pub fn new(relative: RelativeMotion, wrench: LimbWrench, inertia: &MassInertia) -> Self {
        let rotation = relative.pose.rotation_matrix();
        let back = rotation.transpose();
        Self {
            relative,
            wrench,
            inertia_shell_m2: rotation * inertia.tensor_mass_m2 * back,
            inertia_shell_inverse: rotation * inertia.inverse_mass * back,
        }
    }

    /// Angular acceleration w*' of the shell in shell axes, rad/s^2: eq. (8).
    #[must_use]
    pub fn angular_acceleration_shell_rad_s2(&self, rate_shell_rad_s: DVec3) -> DVec3 {
        let w_r = self.relative.rate_shell_rad_s;
        let total = rate_shell_rad_s + w_r;
        self.inertia_shell_inverse
            * (self.wrench.torque_shell_m2_s2 - total.cross(self.inertia_shell_m2 * total))
            - self.relative.angular_acceleration_shell_rad_s2
            - rate_shell_rad_s.cross(w_r)
    }

    /// R^T (a - g): acceleration of the shell less gravity, in shell axes, m/s^2: eq. (3) turned into {1}.
    #[must_use]
    pub fn specific_force_shell_m_s2(
        &self,
        rate_shell_rad_s: DVec3,
        angular_acceleration_shell_rad_s2: DVec3,
    ) -> DVec3 {
        let w = rate_shell_rad_s;
        let r = self.relative.pose.position_shell_m;
        self.wrench.force_shell_m_s2
            - self.relative.acceleration_shell_m_s2
            - angular_acceleration_shell_rad_s2.cross(r)
            - w.cross(w.cross(r))
            - 2.0 * w.cross(self.relative.velocity_shell_m_s)
    }
}

/// I/m and its inverse in mass axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassInertia {
    tensor_mass_m2: DMat3,
    inverse_mass: DMat3,
}

impl MassInertia {
    /// Inverts a tensor that [`InertiaPerMass::validate`] has accepted.
    #[must_use]
    pub fn new(inertia_per_mass: &InertiaPerMass) -> Self {
        let tensor_mass_m2 = inertia_per_mass.matrix_mass_m2();
        Self {
            tensor_mass_m2,
            inverse_mass: tensor_mass_m2.inverse(),
        }
    }

    /// I/m in mass axes, m^2.
    #[must_use]
    pub fn tensor_mass_m2(&self) -> DMat3 {
        self.tensor_mass_m2
    }
}

/// a and w' in ground axes, m/s^2 and rad/s^2.
pub type Accelerations = [DVec3; 2];

/// Decouples a recording by Heun, the mass's rate as state: the discretisation of the core's default.
///
/// Elements belong to samples 1, 2, ... of the recording.
///
/// # Panics
/// If the sensor or a sample is refused.
#[must_use]
pub fn decouple(
    sensor: &Sensor,
    parameters: &Parameters,
    settings: &Settings,
    voltage_v: &[[f64; LIMBS]],
) -> Vec<Accelerations> {
    let mut limbs = LimbStream::new(sensor, parameters, settings).expect("a sound sensor");
    let inertia = MassInertia::new(&parameters.inertia_per_mass);
    let h = 1.0 / settings.sample_rate_hz;
    let mut attitude = settings.initial_attitude;
    // W and W', mass axes; then w* and w*'.
    let mut mass: Option<[DVec3; 2]> = None;
    let mut shell = [settings.initial_rate_shell_rad_s, DVec3::ZERO];
    let mut answers = Vec::with_capacity(voltage_v.len());
    for row in voltage_v {
        let Some(sample) = limbs.push(row).expect("a sound sample") else {
            continue;
        };
        let relative = sample.relative;
        let wrench = LimbWrench::at_pose(
            limbs.geometry(),
            &relative.pose,
            &sample.force_per_mass_m_s2,
        );
        let out = relative.pose.rotation_matrix();
        let torque = out.transpose() * wrench.torque_shell_m2_s2;
        let slope =
            |w: DVec3| inertia.inverse_mass * (torque - w.cross(inertia.tensor_mass_m2 * w));
        let w_r = relative.rate_shell_rad_s;
        let w = match mass {
            None => out.transpose() * (shell[0] + w_r),
            Some([w, k]) => w + 0.5 * h * (k + slope(w + h * k)),
        };
        let rate = out * w - w_r;
        let derivative =
            out * slope(w) + w_r.cross(rate) - relative.angular_acceleration_shell_rad_s2;
        if mass.is_some() {
            let ends = [[shell[0], rate], [shell[1], derivative]];
            attitude = attitude::advance(attitude, ends[0], ends[1], h);
        }
        mass = Some([w, slope(w)]);
        shell = [rate, derivative];
        let force =
            Instant::new(relative, wrench, &inertia).specific_force_shell_m_s2(rate, derivative);
        answers.push([
            attitude * force + settings.gravity_ground_m_s2,
            attitude * derivative,
        ]);
    }
    answers
}
