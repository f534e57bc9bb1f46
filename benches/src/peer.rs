//! The peer: the paper's equations as one would first write them down with nalgebra.
//!
//! Nothing is rearranged for speed or rounding, nothing is done badly on purpose. Vectors carry the paper's letters.
//! Differences from the core that bear on the ratios:
//!
//! * The pose comes from Gauss-Newton on the nine lengths, started at the last sample's pose: one iteration while
//!   little moves, otherwise two. The core has a closed form at each node. `pose/compound_5hz` compares the two alone.
//! * Heun only, and the attitude by the mean rate of a step (second order); the core's attitude is of fourth order.
//! * Inputs are not checked for NaN; the core's are.
//! * The static preload of the limbs is the core's: it is found once, before anything is timed.
//! * Steps 2 and 3 hold the tall matrix of (13) and (18) and take its pseudo-inverse by singular values, as (14) and
//!   (19) are printed; the core streams rows into a triangle and returns covariance and condition as well. In step 3
//!   that triangle has twelve columns, for the gyroscope's gain to be found from, where (18) has six.

use glam::{DQuat, DVec3};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, SMatrix, SVector, Vector3};
use sixaxis_core::geometry::DIRECTIONS_SHELL;
use sixaxis_core::identify::inertia::regressor;
use sixaxis_core::paper::preload::static_preload_m_s2;
use sixaxis_core::{Geometry, LIMBS, Parameters};

use crate::problem::{Answer, InertiaRows, Recorded, ScaleRows};

type V3 = Vector3<f64>;

/// Gauss-Newton stops at a step of this size, m (rotations times half an edge). One more iteration would gain a factor
/// of 1e-5, the angle by which limbs tilt: 1e-18 m, less than the last digit of a limb's length.
const CONVERGED_M: f64 = 1e-13;
/// Cap on the iterations.
const ITERATIONS: usize = 20;
/// Singular values below this share of the largest count as zero.
const RANK_TOLERANCE: f64 = 1e-12;

fn v3(v: DVec3) -> V3 {
    V3::new(v.x, v.y, v.z)
}

fn dvec3(v: V3) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

/// Pose of the mass in the shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeerPose {
    /// r, shell axes, m.
    pub r: V3,
    /// Rotation vector phi with R_r = exp(phi), rad.
    pub phi: V3,
}

impl PeerPose {
    /// Mass where unloaded limbs hold it.
    #[must_use]
    pub fn unloaded() -> Self {
        Self {
            r: V3::zeros(),
            phi: V3::zeros(),
        }
    }

    /// Position and rotation vector for [`crate::validate`].
    #[must_use]
    pub fn to_glam(self) -> (DVec3, DVec3) {
        (dvec3(self.r), dvec3(self.phi))
    }
}

/// The hinges of the drawing.
#[derive(Debug, Clone)]
pub struct PeerGeometry {
    /// t_i, mass axes, m.
    t: [V3; LIMBS],
    /// b_i, shell axes, m.
    b: [V3; LIMBS],
    /// L, m.
    length: f64,
    /// n, m.
    half_edge: f64,
}

impl PeerGeometry {
    /// From the drawing.
    #[must_use]
    pub fn new(geometry: &Geometry) -> Self {
        Self {
            t: geometry.mass_hinges_m().map(v3),
            b: geometry.shell_hinges_m().map(v3),
            length: geometry.limb_length_m,
            half_edge: geometry.half_edge_m,
        }
    }

    /// The pose with the nine lengths L + `elongation_m`: least squares by Gauss-Newton from `start`.
    #[must_use]
    pub fn pose(&self, elongation_m: &[f64; LIMBS], start: PeerPose) -> PeerPose {
        let mut pose = start;
        for _ in 0..ITERATIONS {
            let rotation = Rotation3::new(pose.phi);
            let mut jacobian = SMatrix::<f64, LIMBS, 6>::zeros();
            let mut residual = SVector::<f64, LIMBS>::zeros();
            for i in 0..LIMBS {
                let t = rotation * self.t[i];
                let limb = pose.r + t - self.b[i];
                let e = limb.normalize();
                // d l_i = e_i . dr + (t_i x e_i) . dphi
                jacobian.fixed_view_mut::<1, 3>(i, 0).tr_copy_from(&e);
                jacobian
                    .fixed_view_mut::<1, 3>(i, 3)
                    .tr_copy_from(&t.cross(&e));
                residual[i] = self.length + elongation_m[i] - limb.norm();
            }
            let normal = jacobian.transpose() * jacobian;
            let Some(cholesky) = normal.cholesky() else {
                break;
            };
            let step = cholesky.solve(&(jacobian.transpose() * residual));
            let (dr, dphi) = (
                V3::new(step[0], step[1], step[2]),
                V3::new(step[3], step[4], step[5]),
            );
            pose.r += dr;
            pose.phi += dphi;
            if dr.norm() + self.half_edge * dphi.norm() < CONVERGED_M {
                break;
            }
        }
        pose
    }
}

/// What the limbs say at one sample: everything in (3) and (8) but w*.
#[derive(Debug, Clone, Copy)]
struct Sensed {
    r: V3,
    v: V3,
    a_r: V3,
    w_r: V3,
    eps: V3,
    /// sum (f_i/m) e_i
    force: V3,
    /// sum (f_i/m) t_i x e_i
    torque: V3,
    /// I*
    inertia: Matrix3<f64>,
    inertia_inverse: Matrix3<f64>,
}

impl Sensed {
    /// Eq. (8).
    fn rate_derivative(&self, w: V3) -> V3 {
        let total = w + self.w_r;
        self.inertia_inverse * (self.torque - total.cross(&(self.inertia * total)))
            - self.eps
            - w.cross(&self.w_r)
    }

    /// Eq. (3) for R^T (a - g).
    fn specific_force(&self, w: V3, w_dot: V3) -> V3 {
        self.force
            - self.a_r
            - w_dot.cross(&self.r)
            - w.cross(&w.cross(&self.r))
            - 2.0 * w.cross(&self.v)
    }
}

/// One decoupled sample.
#[derive(Debug, Clone, Copy)]
pub struct PeerSample {
    /// Index of the voltage sample.
    pub sample: u64,
    /// a, ground axes, m/s^2.
    pub a: V3,
    /// w', ground axes, rad/s^2.
    pub w_dot_ground: V3,
    /// w*, shell axes, rad/s.
    pub w: V3,
    /// w*', shell axes, rad/s^2.
    pub w_dot: V3,
    /// R.
    pub attitude: Rotation3<f64>,
}

impl From<&PeerSample> for Answer {
    fn from(s: &PeerSample) -> Self {
        let q = nalgebra::UnitQuaternion::from_rotation_matrix(&s.attitude);
        Self {
            sample: s.sample,
            linear_ground_m_s2: dvec3(s.a),
            angular_ground_rad_s2: dvec3(s.w_dot_ground),
            rate_shell_rad_s: dvec3(s.w),
            attitude: DQuat::from_xyzw(q.i, q.j, q.k, q.w),
        }
    }
}

/// Decoupler by (3), (8) with Heun, and (9).
#[derive(Debug, Clone)]
pub struct PeerDecoupler {
    geometry: PeerGeometry,
    drift_v: SVector<f64, LIMBS>,
    /// (s_i/m) c_i
    sensitivity: SVector<f64, LIMBS>,
    preload: SVector<f64, LIMBS>,
    stiffness: f64,
    inertia: Matrix3<f64>,
    gravity: V3,
    h: f64,
    received: u64,
    /// Pose and limb forces of the last two samples, oldest first.
    window: [(PeerPose, SVector<f64, LIMBS>); 2],
    last: Option<PeerSample>,
}

impl PeerDecoupler {
    /// Ready for the first sample of a recording.
    ///
    /// # Panics
    /// If gravity finds no equilibrium.
    #[must_use]
    pub fn new(problem: &Recorded, parameters: &Parameters) -> Self {
        let recording = &problem.recording;
        let preload = static_preload_m_s2(
            &Geometry::PAPER,
            parameters.stiffness_per_mass_per_s2,
            recording.gravity_ground_m_s2,
        )
        .expect("a static equilibrium");
        let i = parameters.inertia_per_mass;
        Self {
            geometry: PeerGeometry::new(&Geometry::PAPER),
            drift_v: parameters.zero_drift_v.into(),
            sensitivity: SVector::from(parameters.scale_per_mass_per_kg)
                .component_mul(&SVector::from(recording.gain_n_per_v)),
            preload: preload.into(),
            stiffness: parameters.stiffness_per_mass_per_s2,
            inertia: Matrix3::new(
                i.xx_m2, i.xy_m2, i.xz_m2, i.xy_m2, i.yy_m2, i.yz_m2, i.xz_m2, i.yz_m2, i.zz_m2,
            ),
            gravity: v3(recording.gravity_ground_m_s2),
            h: 1.0 / recording.sample_rate_hz,
            received: 0,
            window: [(PeerPose::unloaded(), SVector::zeros()); 2],
            last: None,
        }
    }

    /// Takes nine voltages and returns the sample before them, once there are three.
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Option<PeerSample> {
        // (10), (11)
        let voltage = SVector::<f64, LIMBS>::from(*voltage_v);
        let force = self.sensitivity.component_mul(&(voltage - self.drift_v)) + self.preload;
        // (2)
        let elongation = -force / self.stiffness;
        let after = self.geometry.pose(&elongation.into(), self.window[1].0);

        let [(before, _), (now, now_force)] = self.window;
        self.window = [self.window[1], (after, force)];
        self.received += 1;
        if self.received < 3 {
            return None;
        }
        let sensed = self.sense(before, now, after, now_force);
        let answer = match self.last {
            None => {
                let w = V3::zeros();
                self.answer(1, &sensed, w, Rotation3::identity())
            }
            Some(last) => {
                // (8) by Heun
                let f0 = last.w_dot;
                let f1 = sensed.rate_derivative(last.w + self.h * f0);
                let w = last.w + 0.5 * self.h * (f0 + f1);
                // (9): R' = R [w*]x with the mean rate of the step
                let attitude = last.attitude * Rotation3::new(0.5 * self.h * (last.w + w));
                self.answer(last.sample + 1, &sensed, w, attitude)
            }
        };
        self.last = Some(answer);
        Some(answer)
    }

    fn sense(
        &self,
        before: PeerPose,
        now: PeerPose,
        after: PeerPose,
        force: SVector<f64, LIMBS>,
    ) -> Sensed {
        let h = self.h;
        let phi_dot = (after.phi - before.phi) / (2.0 * h);
        let phi_ddot = (after.phi - 2.0 * now.phi + before.phi) / (h * h);
        let rotation = Rotation3::new(now.phi);
        let mut force_sum = V3::zeros();
        let mut torque_sum = V3::zeros();
        for i in 0..LIMBS {
            let t = rotation * self.geometry.t[i];
            let e = (now.r + t - self.geometry.b[i]).normalize();
            force_sum += force[i] * e;
            torque_sum += force[i] * t.cross(&e);
        }
        let inertia = rotation.matrix() * self.inertia * rotation.matrix().transpose();
        Sensed {
            r: now.r,
            v: (after.r - before.r) / (2.0 * h),
            a_r: (after.r - 2.0 * now.r + before.r) / (h * h),
            // From a rotation vector's rate to an angular velocity, to the first power of phi.
            w_r: phi_dot + 0.5 * now.phi.cross(&phi_dot),
            eps: phi_ddot + 0.5 * now.phi.cross(&phi_ddot),
            force: force_sum,
            torque: torque_sum,
            inertia,
            inertia_inverse: inertia.try_inverse().unwrap_or_else(Matrix3::zeros),
        }
    }

    fn answer(&self, sample: u64, sensed: &Sensed, w: V3, attitude: Rotation3<f64>) -> PeerSample {
        let w_dot = sensed.rate_derivative(w);
        PeerSample {
            sample,
            a: attitude * sensed.specific_force(w, w_dot) + self.gravity,
            w_dot_ground: attitude * w_dot,
            w,
            w_dot,
            attitude,
        }
    }
}

/// Streams a whole recording through a copy of `ready`: the peer of [`crate::problem::decouple`].
pub fn decouple(
    ready: &PeerDecoupler,
    voltage_v: &[[f64; LIMBS]],
    mut sink: impl FnMut(&PeerSample),
) {
    let mut decoupler = ready.clone();
    for row in voltage_v {
        decoupler.push(row).iter().for_each(&mut sink);
    }
}

/// Sum of |w*| over a recording and the number of samples in it: the peer of step 4 for one candidate.
#[must_use]
pub fn rate_norm_sum(problem: &Recorded, parameters: &Parameters) -> (f64, usize) {
    let (mut sum, mut count) = (0.0, 0);
    decouple(
        &PeerDecoupler::new(problem, parameters),
        &problem.recording.voltage_v,
        |sample| {
            sum += sample.w.norm();
            count += 1;
        },
    );
    (sum, count)
}

fn pseudo_inverse<const N: usize>(matrix: DMatrix<f64>, right_side: &DVector<f64>) -> [f64; N] {
    let svd = matrix.svd(true, true);
    let tolerance = RANK_TOLERANCE * svd.singular_values.max();
    let x = svd
        .solve(right_side, tolerance)
        .expect("singular vectors were asked for");
    core::array::from_fn(|i| x[i])
}

/// Step 2 by (13) and (14): s_i/m, 1/kg.
///
/// # Panics
/// Never: the singular vectors are computed.
#[must_use]
pub fn scale_per_mass(rows: &ScaleRows) -> [f64; LIMBS] {
    let n = rows.0.len();
    let mut matrix = DMatrix::zeros(3 * n, LIMBS);
    let mut right_side = DVector::zeros(3 * n);
    for (k, (force, acceleration)) in rows.0.iter().enumerate() {
        for axis in 0..3 {
            for i in 0..LIMBS {
                matrix[(3 * k + axis, i)] = force[i] * DIRECTIONS_SHELL[i][axis];
            }
            right_side[3 * k + axis] = acceleration[axis];
        }
    }
    pseudo_inverse(matrix, &right_side)
}

/// Step 3 by (18) and (19): I1 to I6 over m, m^2.
///
/// # Panics
/// Never: the singular vectors are computed.
#[must_use]
pub fn inertia_per_mass(rows: &InertiaRows) -> [f64; 6] {
    let n = rows.0.len();
    let hinges = Geometry::PAPER.mass_hinges_m();
    let mut matrix = DMatrix::zeros(3 * n, 6);
    let mut right_side = DVector::zeros(3 * n);
    for (k, (force, rate, derivative)) in rows.0.iter().enumerate() {
        let mut torque = V3::zeros();
        for i in 0..LIMBS {
            torque += force[i] * v3(hinges[i]).cross(&v3(DIRECTIONS_SHELL[i]));
        }
        for (axis, row) in regressor(*rate, *derivative).iter().enumerate() {
            for (i, entry) in row.iter().enumerate() {
                matrix[(3 * k + axis, i)] = *entry;
            }
            right_side[3 * k + axis] = torque[axis];
        }
    }
    pseudo_inverse(matrix, &right_side)
}
