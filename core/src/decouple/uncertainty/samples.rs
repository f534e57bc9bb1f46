//! Standard deviations of each decoupled sample, as a stream beside the decoupler.
//!
//! Beside the decoupler run the equations (8), (9) and (3), linearised. With tau = sum (f/m) t x e and s = sum (f/m) e, in
//! shell axes, an error of the parameters or of a voltage makes
//!
//! ```text
//! dw*' = (I/m)^-1 (d tau - dI w*' - w* x dI w* - dw* x I w* - w* x I dw*)
//! dphi' = dw* - w* x dphi                          attitude R (1 + [dphi]x)
//! da = R (ds + dphi x s),   d alpha = R (dw*' + dphi x w*').
//! ```
//!
//! The 24 parameters' errors enter as the columns of a square root of their covariance, each a vector that is carried along:
//! a sum of squares over columns is the variance. Noise of the voltages is new at every sample; its share in dw* and dphi is
//! a covariance, P' = A P + P A^T + Q. What a sample's own noise does to its own acceleration comes on top, and there the
//! limbs' compliance counts: the mass's motion in the shell is differentiated twice, which lowers noise at 10 kHz by 14 to 26 % (the paper's sensor).
//!
//! Zeros stay where they are: where they wander ([`super::zero_wander`]) [`crate::aided::ErrorFilter`] follows that. Neglected: compliance in the sensitivities, some six millionths at 5 Hz; and k/m, on which a decoupled sample does not depend there.
//!
//! Good to 1 % in the root mean square where the attitude is known to a hundredth of a radian, single deviations to 3.4 % (20,000 campaigns in
//! `props`' example `propagation`); to 1.5 and 8 % up to three hundredths, to 7 and 25 % up to a tenth, beyond first order.

use glam::{DMat3, DQuat, DVec3};
use nalgebra::SMatrix;

use super::error_model::{ChannelNoise, ErrorModel, PARAMETRIC};
use super::parameters::Covariance;
use super::root::square_root;
use crate::columns::{column, cross, matrix, stacked};
use crate::error::{Error, Result, require, require_finite};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::model::{InertiaPerMass, Parameters, Sensor, Settings};
use crate::paper::pose::Pose;
use crate::parameter::{DRIFT, INERTIA, SCALE};
use crate::redundancy::reconstruction::Reconstruction;
use crate::six_axis::SixAxis;

/// Standard deviations of one decoupled sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Of a, ground axes, m/s^2.
    pub linear_ground_m_s2: DVec3,
    /// Of w', ground axes, rad/s^2.
    pub angular_ground_rad_s2: DVec3,
    /// Of w*, shell axes, rad/s.
    pub rate_shell_rad_s: DVec3,
    /// Of the attitude, about the shell's axes, rad.
    pub attitude_shell_rad: DVec3,
}

impl Spread {
    /// The six standard deviations in the order of [`SixAxis::accelerations`].
    #[must_use]
    pub fn accelerations(&self) -> [f64; 6] {
        let (a, alpha) = (self.linear_ground_m_s2, self.angular_ground_rad_s2);
        [a.x, a.y, a.z, alpha.x, alpha.y, alpha.z]
    }
}

/// One column of the square root of the parameters' covariance, and what it does.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cause {
    /// Torque, m^2/s^2, and force, m/s^2, of the drift's errors: the same at all samples.
    drift_torque: DVec3,
    drift_force: DVec3,
    /// Relative errors of the scale factors.
    scale: [f64; LIMBS],
    inertia_m2: DMat3,
    /// dw*, its derivative, and dphi.
    rate: DVec3,
    derivative: DVec3,
    turn: DVec3,
}

/// Runs beside a decoupler.
///
/// No allocation, no panic, bounded work per sample.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleUncertainty {
    model: ErrorModel,
    step_s: f64,
    causes: [Cause; PARAMETRIC],
    /// Covariance that the voltages' noise has left in (dw*, dphi) up to the sample before.
    noise: SMatrix<f64, 6, 6>,
    /// Of the torque's noise, over I/m: what integrates.
    torque_noise: SMatrix<f64, 3, 3>,
    /// Covariance of (force, dw*') from one sample's noise: what a sample shows at once, shell axes.
    direct: SMatrix<f64, 6, 6>,
    /// Of dw*' with (force, dw*') from slow noise: between what integrates and what shows at once.
    shared: SMatrix<f64, 3, 6>,
    /// w* at the sample before.
    rate_before: Option<DVec3>,
}

impl SampleUncertainty {
    /// Prepares a stream beside a decoupler with the same sensor, parameters and settings, without the channels of the same limbs.
    ///
    /// `covariance` is that of the parameters, in the order of [`crate::parameter`].
    ///
    /// # Errors
    /// Those of [`crate::Decoupler::new`] and [`Reconstruction::new`]; [`Error::OutOfRange`] for a covariance that none can be, or noise that is negative
    /// or not finite.
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        excluded: LimbSet,
        covariance: &Covariance,
        noise: &ChannelNoise,
    ) -> Result<Self> {
        // Every argument that the decoupler has, too, is checked as it checks it.
        let mut model = ErrorModel::new(sensor, parameters, settings, noise)?;
        for value in noise.white_v.into_iter().chain(noise.correlation) {
            require_finite("channel noise", value)?;
        }
        for value in noise.white_v {
            require(value >= 0.0, "channel noise", value, "not negative")?;
        }
        model.set_excluded(excluded)?;
        let root = square_root(covariance)?;
        let causes = core::array::from_fn(|j| {
            let column = root.column(j);
            let inertia = core::array::from_fn(|i| column[INERTIA.start + i]);
            let mut cause = Cause {
                drift_torque: DVec3::ZERO,
                drift_force: DVec3::ZERO,
                scale: core::array::from_fn(|i| {
                    column[SCALE.start + i] / parameters.scale_per_mass_per_kg[i]
                }),
                inertia_m2: InertiaPerMass::from_paper_order(inertia).matrix_mass_m2(),
                rate: DVec3::ZERO,
                derivative: DVec3::ZERO,
                turn: DVec3::ZERO,
            };
            for (i, [along, about]) in model.wrench.into_iter().enumerate() {
                let force = -model.chain.sensitivity_m_s2_per_v()[i] * column[DRIFT.start + i];
                cause.drift_force += along * force;
                cause.drift_torque += about * force;
            }
            cause
        });
        let mut stream = Self {
            model,
            step_s: 1.0 / settings.sample_rate_hz,
            causes,
            noise: SMatrix::zeros(),
            torque_noise: SMatrix::zeros(),
            direct: SMatrix::zeros(),
            shared: SMatrix::zeros(),
            rate_before: None,
        };
        stream.add_noise(sensor, parameters, settings, noise)?;
        Ok(stream)
    }

    /// Sums up what one volt of noise on each channel does.
    fn add_noise(
        &mut self,
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        noise: &ChannelNoise,
    ) -> Result<()> {
        let compliance = 1.0 / parameters.stiffness_per_mass_per_s2;
        let per_step2 = 1.0 / (self.step_s * self.step_s);
        let [own, next, after_next] = noise.correlation;
        let excluded = self.model.excluded();
        let reconstruction =
            Reconstruction::new(excluded)?.with_stiffness(&settings.stiffness_ratio);
        for i in (0..LIMBS).filter(|i| !excluded.contains(*i)) {
            // A probe small enough that the pose is linear in it.
            let probe_m = LINEAR_STRAIN * sensor.geometry.limb_length_m;
            let mut elongation = [0.0; LIMBS];
            elongation[i] = probe_m;
            for made in excluded.indices() {
                elongation[made] = probe_m * reconstruction.share(made, i);
            }
            let pose = Pose::from_elongations(&sensor.geometry, &elongation)?;
            // A volt more is more compression, a shorter limb.
            let sensitivity = self.model.chain.sensitivity_m_s2_per_v()[i];
            let per_volt = -sensitivity * compliance / probe_m;
            let [forced, torque] = self.model.wrench[i].map(|v| v * sensitivity);
            let turned = self.model.inverse * torque;
            // What the mass's acceleration in the shell takes off, at the neighbours and, twice and the other way, here.
            let moved = stacked(
                pose.position_shell_m * (per_volt * per_step2),
                pose.rotation_rad * (per_volt * per_step2),
            );
            let slow = stacked(forced, turned);
            let (here, beside) = (slow + moved * 2.0, -moved);
            let variance = noise.white_v[i] * noise.white_v[i];
            let crossed = here * beside.transpose();
            self.direct += (here * here.transpose() * own
                + (crossed + crossed.transpose()) * (2.0 * next)
                + beside * beside.transpose() * (2.0 * (own + after_next)))
                * variance;
            self.torque_noise += column(turned) * column(turned).transpose() * variance;
            self.shared += column(turned) * slow.transpose() * variance;
        }
        Ok(())
    }

    /// Takes the next decoupled sample and the voltages of that same sample; says how well it is known.
    ///
    /// The first sample is taken to be known in rate and attitude, as the settings have them.
    ///
    /// # Errors
    /// [`Error::Overflow`] if a standard deviation is not finite.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS], sample: &SixAxis) -> Result<Spread> {
        let rotation = sample.attitude;
        let rate = sample.rate_shell_rad_s;
        let derivative = rotation.inverse() * sample.angular_ground_rad_s2;
        let sensed = self.model.sensed(voltage_v);
        // In this order, unlike the model's own sum: published results have its rounding.
        let limbs = self.model.wrench.iter().zip(&sensed);
        let force = limbs.fold(self.model.preload_force, |sum, ([along, _], sensed)| {
            sum + *along * *sensed
        });
        let gyroscopic = self.model.gyroscopic(rate);
        let first = self.rate_before.is_none();
        let spread = [
            self.carry(rate, derivative, force, &sensed, &gyroscopic, rotation),
            self.accumulate(first, rate, derivative, force, &gyroscopic, rotation),
        ];
        self.rate_before = Some(rate);
        let total: [DVec3; 4] = core::array::from_fn(|k| {
            let sum = spread[0][k] + spread[1][k];
            DVec3::new(sqrt(sum.x), sqrt(sum.y), sqrt(sum.z))
        });
        if !total.iter().all(|v| v.is_finite()) {
            return Err(Error::overflow(
                "uncertainty of a sample",
                sample.sample as usize,
            ));
        }
        let [linear, angular, rate, turn] = total;
        Ok(Spread {
            linear_ground_m_s2: linear,
            angular_ground_rad_s2: angular,
            rate_shell_rad_s: rate,
            attitude_shell_rad: turn,
        })
    }

    /// Carries the parameters' errors to this sample; variances of a, w', w* and attitude.
    fn carry(
        &mut self,
        rate: DVec3,
        derivative: DVec3,
        force: DVec3,
        sensed: &[f64; LIMBS],
        gyroscopic: &DMat3,
        rotation: DQuat,
    ) -> [DVec3; 4] {
        let h = self.step_s;
        let mut sum = [DVec3::ZERO; 4];
        for cause in &mut self.causes {
            let (mut torque, mut more_force) = (cause.drift_torque, cause.drift_force);
            let scaled = sensed.iter().zip(cause.scale);
            for ((force, error), [along, about]) in scaled.zip(&self.model.wrench) {
                let more = force * error;
                more_force += *along * more;
                torque += *about * more;
            }
            let lacking = cause.inertia_m2 * derivative + rate.cross(cause.inertia_m2 * rate);
            let drive = self.model.inverse * (torque - lacking);
            // Heun, as the decoupler itself; the first sample's rate and attitude are given.
            if let Some(before) = self.rate_before {
                let expected = cause.rate + cause.derivative * h;
                let there = drive + *gyroscopic * expected;
                let turning = cause.rate - before.cross(cause.turn);
                let next_rate = cause.rate + (cause.derivative + there) * (0.5 * h);
                let turned = cause.turn + turning * h;
                cause.turn += (turning + next_rate - rate.cross(turned)) * (0.5 * h);
                cause.rate = next_rate;
            }
            cause.derivative = drive + *gyroscopic * cause.rate;
            let linear = rotation * (more_force + cause.turn.cross(force));
            let angular = rotation * (cause.derivative + cause.turn.cross(derivative));
            for (s, v) in sum
                .iter_mut()
                .zip([linear, angular, cause.rate, cause.turn])
            {
                *s += v * v;
            }
        }
        sum
    }

    /// Noise up to this sample; variances of a, w', w* and attitude.
    fn accumulate(
        &mut self,
        first: bool,
        rate: DVec3,
        derivative: DVec3,
        force: DVec3,
        gyroscopic: &DMat3,
        rotation: DQuat,
    ) -> [DVec3; 4] {
        let h = self.step_s;
        let mut shows = SMatrix::<f64, 6, 6>::zeros();
        shows
            .fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&matrix(-cross(force)));
        shows
            .fixed_view_mut::<3, 3>(3, 0)
            .copy_from(&matrix(*gyroscopic));
        shows
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&matrix(-cross(derivative)));
        // Half a step of a sample's torque lies before it, half behind; none before the first.
        let half = if first { 0.0 } else { 0.5 * h };
        let mut now = self.noise;
        let mut in_rate = now.fixed_view_mut::<3, 3>(0, 0);
        in_rate += self.torque_noise * (half * half);
        let mut crossed = SMatrix::<f64, 6, 6>::zeros();
        crossed
            .fixed_view_mut::<3, 6>(0, 0)
            .copy_from(&(self.shared * half));
        let crossed = shows * crossed;
        let seen = shows * now * shows.transpose() + crossed + crossed.transpose() + self.direct;
        // Over to the next sample: F = 1 + hA + (hA)^2/2.
        let mut a = SMatrix::<f64, 6, 6>::zeros();
        a.fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&matrix(*gyroscopic));
        a.fixed_view_mut::<3, 3>(3, 0)
            .copy_from(&SMatrix::identity());
        a.fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&matrix(-cross(rate)));
        a *= h;
        let step = SMatrix::<f64, 6, 6>::identity() + a + a * a * 0.5;
        let into = SMatrix::<f64, 6, 3>::from_fn(|i, j| if i == j { 1.0 } else { 0.0 });
        let enters = step * into * half + into * (0.5 * h);
        self.noise =
            step * self.noise * step.transpose() + enters * self.torque_noise * enters.transpose();
        let r = matrix(DMat3::from_quat(rotation));
        let ground = |from: usize| {
            let block = r * seen.fixed_view::<3, 3>(from, from) * r.transpose();
            DVec3::new(block[(0, 0)], block[(1, 1)], block[(2, 2)])
        };
        let diagonal = |from: usize| {
            DVec3::new(
                now[(from, from)],
                now[(from + 1, from + 1)],
                now[(from + 2, from + 2)],
            )
        };
        [ground(0), ground(3), diagonal(0), diagonal(3)]
    }
}

/// Strain at which a pose is linear in it to a hundred-millionth.
const LINEAR_STRAIN: f64 = 1e-8;
