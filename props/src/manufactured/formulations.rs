//! One sensor, three derivations.
//!
//! All three are given the limb forces and the relative pose as functions of time and asked for the motion of the shell.
//!
//! | | state | equation of motion |
//! |---|---|---|
//! | [`Shell`] | rate of the *shell*, attitude of the shell | (8), (9) and (3) as printed, through `sixaxis-core` |
//! | [`Mass`] | rate of the *mass*, attitude of the mass | Euler's equation in the mass's axes; the shell by kinematics, without a second difference in what is integrated |
//! | [`Canonical`] | quaternion of the mass and its conjugate momentum | Hamilton's equations on quaternions |
//!
//! For the third: with W = 2 G(q) q' (G the 3 x 4 matrix of body rates, G G^T = 1 on unit quaternions) the kinetic
//! energy gives p = 2 G^T I W. H = W.I W/2 with W = I^-1 G(q) p/2, and since G(q) p = -G(p) q, Hamilton's equations are
//! as good as symmetric: q' = G(q)^T W/2, p' = G(p)^T W/2 + 2 G(q)^T torque.

use glam::{DMat3, DQuat, DVec3};
use sixaxis_core::paper::dynamics::{Instant, MassInertia};
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::paper::relative_motion::RelativeMotion;
use sixaxis_core::paper::wrench::LimbWrench;

use super::motion::{Manufactured, Moment};

/// The shell at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShellMotion {
    /// a, ground axes, m/s^2.
    pub linear_ground_m_s2: DVec3,
    /// w', ground axes, rad/s^2.
    pub angular_ground_rad_s2: DVec3,
    /// w*, shell axes, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// R, shell axes to ground axes.
    pub attitude: DQuat,
}

/// A derivation: what is integrated, and how the shell's motion is read from it.
pub trait Formulation: Copy {
    /// State that belongs to a shell at the given attitude and rate.
    fn start(sensor: &Manufactured, moment: &Moment, attitude: DQuat, rate: DVec3) -> Self;
    /// Time derivative of the state.
    fn slope(&self, sensor: &Manufactured, moment: &Moment) -> Self;
    /// self + slope h.
    fn plus(&self, slope: &Self, h: f64) -> Self;
    /// The shell's motion.
    fn shell(&self, sensor: &Manufactured, moment: &Moment) -> ShellMotion;
}

/// Integrates from rest at attitude 1 with classical Runge-Kutta, `steps` to the sample, and returns `samples` samples.
pub fn solve<F: Formulation>(
    sensor: &Manufactured,
    sample_rate_hz: f64,
    samples: usize,
    steps: usize,
) -> Vec<ShellMotion> {
    let h = 1.0 / (sample_rate_hz * steps as f64);
    let mut now = sensor.at(0.0);
    let mut state = F::start(sensor, &now, DQuat::IDENTITY, DVec3::ZERO);
    let mut result = Vec::with_capacity(samples);
    for sample in 0..samples {
        result.push(state.shell(sensor, &now));
        for step in 0..steps {
            let from = (sample * steps + step) as f64;
            let (middle, end) = (sensor.at((from + 0.5) * h), sensor.at((from + 1.0) * h));
            let k1 = state.slope(sensor, &now);
            let k2 = state.plus(&k1, 0.5 * h).slope(sensor, &middle);
            let k3 = state.plus(&k2, 0.5 * h).slope(sensor, &middle);
            let k4 = state.plus(&k3, h).slope(sensor, &end);
            let inner = k2.plus(&k3, 1.0);
            let mean = k1.plus(&inner, 2.0).plus(&k4, 1.0);
            state = state.plus(&mean, h / 6.0);
            now = end;
        }
    }
    result
}

/// q' of a body with rate `rate` in its own axes.
fn quaternion_slope(q: DQuat, rate: DVec3) -> DQuat {
    // Hamilton's product, written out: the library's may assume unit quaternions.
    let v = DVec3::new(q.x, q.y, q.z);
    let vector = q.w * rate + v.cross(rate);
    DQuat::from_xyzw(vector.x, vector.y, vector.z, -v.dot(rate)) * 0.5
}

/// Newton and Euler as the paper prints them, by the code under test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell {
    rate: DVec3,
    attitude: DQuat,
}

impl Shell {
    fn instant(sensor: &Manufactured, moment: &Moment) -> Instant {
        let [position, velocity, acceleration] = moment.position.0;
        let [rate, angular_acceleration] = moment.rotation.rate();
        let pose = Pose {
            position_shell_m: position,
            rotation_rad: moment.rotation_vector_rad(),
        };
        let relative = RelativeMotion {
            pose,
            velocity_shell_m_s: velocity,
            rate_shell_rad_s: rate,
            acceleration_shell_m_s2: acceleration,
            angular_acceleration_shell_rad_s2: angular_acceleration,
        };
        let wrench = LimbWrench::at_pose(&sensor.geometry, &pose, &moment.force_per_mass_m_s2);
        let inertia = MassInertia::new(&sensor.parameters.inertia_per_mass);
        Instant::new(relative, wrench, &inertia)
    }
}

impl Formulation for Shell {
    fn start(_: &Manufactured, _: &Moment, attitude: DQuat, rate: DVec3) -> Self {
        Self { rate, attitude }
    }

    fn slope(&self, sensor: &Manufactured, moment: &Moment) -> Self {
        Self {
            rate: Self::instant(sensor, moment).angular_acceleration_shell_rad_s2(self.rate),
            attitude: quaternion_slope(self.attitude, self.rate),
        }
    }

    fn plus(&self, slope: &Self, h: f64) -> Self {
        Self {
            rate: self.rate + slope.rate * h,
            attitude: self.attitude + slope.attitude * h,
        }
    }

    fn shell(&self, sensor: &Manufactured, moment: &Moment) -> ShellMotion {
        let instant = Self::instant(sensor, moment);
        let angular = instant.angular_acceleration_shell_rad_s2(self.rate);
        let specific = instant.specific_force_shell_m_s2(self.rate, angular);
        let attitude = self.attitude.normalize();
        ShellMotion {
            linear_ground_m_s2: attitude * specific + sensor.gravity_ground_m_s2,
            angular_ground_rad_s2: attitude * angular,
            rate_shell_rad_s: self.rate,
            attitude,
        }
    }
}

/// The shell's motion by kinematics, from rate, angular acceleration (mass axes) and attitude of the mass.
pub fn shell_from_mass(
    sensor: &Manufactured,
    moment: &Moment,
    rate: DVec3,
    angular: DVec3,
    attitude: DQuat,
) -> ShellMotion {
    let mass = DMat3::from_quat(attitude.normalize());
    let shell = moment.shell_attitude(attitude.normalize());
    let turn = moment.rotation;
    let [w_r, eps] = turn.rate();
    let rate_shell = turn.matrix() * rate - w_r;
    let angular_shell = turn.derivatives[0] * rate + turn.matrix() * angular - eps;
    // The shell's origin is the mass's centre less Q s, s = R_r^T r: the offset in mass axes.
    let [s, ds, dds] = turn.back(&moment.position).0;
    let offset = dds + angular.cross(s) + rate.cross(rate.cross(s)) + 2.0 * rate.cross(ds);
    ShellMotion {
        linear_ground_m_s2: mass * (moment.force_mass_m_s2 - offset) + sensor.gravity_ground_m_s2,
        angular_ground_rad_s2: shell * angular_shell,
        rate_shell_rad_s: rate_shell,
        attitude: DQuat::from_mat3(&shell),
    }
}

/// Rate of the mass, in its own axes, that belongs to a rate of the shell.
pub fn mass_rate(moment: &Moment, rate_shell: DVec3) -> DVec3 {
    moment.rotation.matrix().transpose() * (rate_shell + moment.rotation.rate()[0])
}

/// Attitude of the mass in a shell of the given attitude.
pub fn mass_attitude(moment: &Moment, attitude: DQuat) -> DQuat {
    DQuat::from_mat3(&(DMat3::from_quat(attitude) * moment.rotation.matrix())).normalize()
}

/// Euler's equation of the mass in its own axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mass {
    rate: DVec3,
    attitude: DQuat,
}

fn euler(inertia: DMat3, rate: DVec3, torque: DVec3) -> DVec3 {
    inertia.inverse() * (torque - rate.cross(inertia * rate))
}

impl Formulation for Mass {
    fn start(_: &Manufactured, moment: &Moment, attitude: DQuat, rate: DVec3) -> Self {
        Self {
            rate: mass_rate(moment, rate),
            attitude: mass_attitude(moment, attitude),
        }
    }

    fn slope(&self, sensor: &Manufactured, moment: &Moment) -> Self {
        Self {
            rate: euler(
                sensor.inertia_mass_m2(),
                self.rate,
                moment.torque_mass_m2_s2,
            ),
            attitude: quaternion_slope(self.attitude, self.rate),
        }
    }

    fn plus(&self, slope: &Self, h: f64) -> Self {
        Self {
            rate: self.rate + slope.rate * h,
            attitude: self.attitude + slope.attitude * h,
        }
    }

    fn shell(&self, sensor: &Manufactured, moment: &Moment) -> ShellMotion {
        let angular = self.slope(sensor, moment).rate;
        shell_from_mass(sensor, moment, self.rate, angular, self.attitude)
    }
}

/// Quaternion of the mass and its conjugate momentum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Canonical {
    attitude: DQuat,
    momentum: DQuat,
}

/// G(q) v: body vector of a four-vector.
fn body(q: DQuat, v: DQuat) -> DVec3 {
    DVec3::new(
        -q.x * v.w + q.w * v.x + q.z * v.y - q.y * v.z,
        -q.y * v.w - q.z * v.x + q.w * v.y + q.x * v.z,
        -q.z * v.w + q.y * v.x - q.x * v.y + q.w * v.z,
    )
}

/// G(q)^T u: four-vector of a body vector.
fn four(q: DQuat, u: DVec3) -> DQuat {
    DQuat::from_xyzw(
        q.w * u.x - q.z * u.y + q.y * u.z,
        q.z * u.x + q.w * u.y - q.x * u.z,
        -q.y * u.x + q.x * u.y + q.w * u.z,
        -q.x * u.x - q.y * u.y - q.z * u.z,
    )
}

impl Canonical {
    /// Rate of the mass in its own axes; G(q) p grows with |q|, which numerical drift moves off 1.
    fn rate(&self, sensor: &Manufactured) -> DVec3 {
        let unit = self.attitude.length_squared();
        sensor.inertia_mass_m2().inverse() * body(self.attitude, self.momentum) * (0.5 / unit)
    }
}

impl Formulation for Canonical {
    fn start(sensor: &Manufactured, moment: &Moment, attitude: DQuat, rate: DVec3) -> Self {
        let attitude = mass_attitude(moment, attitude);
        let angular_momentum = sensor.inertia_mass_m2() * mass_rate(moment, rate);
        Self {
            attitude,
            momentum: four(attitude, angular_momentum) * 2.0,
        }
    }

    fn slope(&self, sensor: &Manufactured, moment: &Moment) -> Self {
        let rate = self.rate(sensor);
        Self {
            attitude: four(self.attitude, rate) * 0.5,
            momentum: four(self.momentum, rate) * 0.5
                + four(self.attitude, moment.torque_mass_m2_s2) * 2.0,
        }
    }

    fn plus(&self, slope: &Self, h: f64) -> Self {
        Self {
            attitude: self.attitude + slope.attitude * h,
            momentum: self.momentum + slope.momentum * h,
        }
    }

    fn shell(&self, sensor: &Manufactured, moment: &Moment) -> ShellMotion {
        // W' from Hamilton's own derivatives: (I W)' = (G' p + G p')/2 on unit quaternions.
        let slope = self.slope(sensor, moment);
        let momentum_slope =
            0.5 * (body(slope.attitude, self.momentum) + body(self.attitude, slope.momentum));
        let angular = sensor.inertia_mass_m2().inverse() * momentum_slope;
        shell_from_mass(sensor, moment, self.rate(sensor), angular, self.attitude)
    }
}
