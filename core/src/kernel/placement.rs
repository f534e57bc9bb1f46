//! Nine voltages to the pose of the mass in the shell and the resultant of the limb forces, in closed form.
//!
//! Lengths are in units of the limb length L, so a limb's elongation is its strain x. In (2) the force of a limb is
//! proportional to its elongation, f = chi x, so a sample is given by its nine strains.
//!
//! # At a node
//! Three orthonormal limbs meet, and [`crate::paper::pose`] has the node's displacement along limb i:
//! xi_i = x_i + (x_i^2 - S)/2 with S = sum xi^2. Strains are 1e-5; to their third power
//!
//! ```text
//! S = A (1 - B) + C,    A = sum x^2, B = sum x, C = sum x^3.
//! ```
//!
//! The limb then points along (e_i + p)/(1 + x_i), p the displacement, and the three forces add up along axis i to
//!
//! ```text
//! chi [ x_i (1 + xi_i)/(1 + x_i) + xi_i sum_(k /= i) x_k/(1 + x_k) ]
//!   = chi [ x_i + x_i (xi_i - x_i) + xi_i sum_(k /= i) (x_k - x_k^2) ] + O(x^4).
//! ```
//!
//! # Of the mass
//! The rotation that fits three displaced nodes best is linear in the displacements but for what R_r - 1 has beyond the
//! cross product. Its normal matrix is nu^2 (1 + 1 1^T/3) (nu = n/L), which makes the fixed point explicit: with phi_0
//! the linear answer, s the sum of its components and c = s/6,
//!
//! ```text
//! phi = phi_0 + c (1 x phi_0) + (|phi_0|^2/6 - 3 c^2) phi_0 + 6 c^3 1 + O(phi^4).
//! ```
//!
//! Everything is right to the third power of the strain, so what is dropped is x^3 of a force: 3e-15 at the rig's 9 g,
//! 1e-12 at [`STRAIN_LIMIT`]. Above that, [`exactly`] takes over, which drops nothing.

use glam::DVec3;

use super::constants::Constants;
use super::number::Real;
use super::order::Limbs;
use super::vec3::{Vec3, vec3};
use crate::error::{Error, Result};
use crate::geometry::{DIRECTIONS_SHELL, Geometry, LIMBS, LIMBS_PER_NODE, NODES};
use crate::paper::pose::{Pose, node_displacement};

/// Root of the sum of squared strains up to which the series stand for the closed form.
pub const STRAIN_LIMIT: f64 = 1e-4;

/// Pose of the mass, force and torque of the limbs at one sample, in units of the limb length L and the sample interval.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LimbLoad<T: Real> {
    /// 3 r: centre of the mass, shell axes; the threefold is what the nodes add up to.
    pub position_thrice: Vec3<T>,
    /// phi: rotation vector of the mass in the shell.
    pub rotation: Vec3<T>,
    /// Resultant of the limb forces over chi, shell axes.
    pub force: Vec3<T>,
    /// Torque of the limb forces over the principal moments, principal axes.
    pub torque: Vec3<T>,
    /// Sum of squared strains.
    pub strain_squares: T,
}

impl<T: Real> LimbLoad<T> {
    /// Converted to another number type.
    #[inline(always)]
    pub(crate) fn map<U: Real>(self, f: impl Fn(T) -> U) -> LimbLoad<U> {
        LimbLoad {
            position_thrice: self.position_thrice.map(&f),
            rotation: self.rotation.map(&f),
            force: self.force.map(&f),
            torque: self.torque.map(&f),
            strain_squares: f(self.strain_squares),
        }
    }
}

/// Displacements of the nodes along their limbs, the forces there over chi, and the sums of
/// squared strains at each; three nodes at once, from their limbs' strains.
#[inline(always)]
pub(super) fn nodes<T: Real>(x: [Vec3<T>; LIMBS_PER_NODE]) -> (Limbs<T>, Limbs<T>, Vec3<T>) {
    let half = Vec3::all(x[0].constant(0.5));
    let square = [
        x[0].mul_elem(x[0]),
        x[1].mul_elem(x[1]),
        x[2].mul_elem(x[2]),
    ];
    let a = square[0] + square[1] + square[2];
    let b = x[0] + x[1] + x[2];
    let cubes = x[0].mul_elem_plus(
        square[0],
        x[1].mul_elem_plus(square[1], x[2].mul_elem(square[2])),
    );
    let half_s = half.mul_elem(a.neg_mul_elem_plus(b, a + cubes));
    let all = b - a;
    let mut displacement = x;
    let mut force = x;
    for i in 0..LIMBS_PER_NODE {
        let beyond = half.mul_elem_plus(square[i], Vec3::all(x[0].constant(0.0)) - half_s);
        displacement[i] = x[i] + beyond;
        let others = all - (x[i] - square[i]);
        force[i] = displacement[i].mul_elem_plus(others, x[i].mul_elem_plus(beyond, x[i]));
    }
    (displacement, force, a)
}

/// Numbers along the limbs as vectors in shell axes, one for each node: the signed axes of (5).
#[inline(always)]
pub(super) fn shell_axes<T: Real>(along: Limbs<T>) -> [Vec3<T>; NODES] {
    let [first, second, third] = along;
    let minus = Vec3::all(second.constant(-1.0));
    let first = first.components();
    let second = second.mul_elem(minus).components();
    let third = third.mul_elem(minus).components();
    [
        vec3(third[0], second[0], first[0]),
        vec3(second[1], first[1], third[1]),
        vec3(first[2], third[2], second[2]),
    ]
}

/// Strains of the nine limbs.
#[inline(always)]
pub(crate) fn limb_strains<T: Real>(constants: &Constants<T>, voltage_v: Limbs<T>) -> Limbs<T> {
    let [u, v, w] = voltage_v;
    let (slope, at_zero) = (&constants.strain_per_v, &constants.strain_at_zero);
    [
        u.mul_elem_plus(slope[0], at_zero[0]),
        v.mul_elem_plus(slope[1], at_zero[1]),
        w.mul_elem_plus(slope[2], at_zero[2]),
    ]
}

/// sum t_j x R_r^T F_j over nu: the torque in mass axes, where the arms are as in (6).
///
/// With the forces at the nodes on the x, y and z axis as columns of K, the sum is the axial vector of R_r^T K. To second
/// order in phi, and y = K phi, that is t + (tr K - phi . t/2) phi - y + phi x y/2, t the axial vector of K.
#[inline(always)]
fn turned_back<T: Real>(phi: Vec3<T>, force: [Vec3<T>; NODES]) -> Vec3<T> {
    let [on_z, on_y, on_x] = force;
    let half = phi.constant(0.5);
    let t = Vec3::moment(force);
    let y = on_z.times_plus(phi.z(), on_y.times_plus(phi.y(), on_x.times(phi.x())));
    let trace = on_x.x() + on_y.y() + on_z.z();
    let along = half.neg_mul_add(phi.dot(t), trace);
    let less = y.cross_plus(phi.times(half), y);
    phi.times_plus(along, t) - less
}

/// phi_0, the least-squares rotation of three displaced nodes to first order: about the nodes' mean -nu/3 (1, 1, 1), where the
/// translation drops out.
#[inline(always)]
pub(super) fn linear_rotation<T: Real>(displacement: [Vec3<T>; NODES], inverse_nu: T) -> Vec3<T> {
    let third = inverse_nu.constant(1.0 / 3.0);
    let sixth = inverse_nu.constant(1.0 / 6.0);
    let all = displacement[0] + displacement[1] + displacement[2];
    let m = all
        .ones_cross()
        .times_plus(third, Vec3::moment(displacement));
    let mean = m.sum() * sixth;
    (m - Vec3::all(mean)).times(inverse_nu)
}

/// Places the mass by the series; good while `strain_squares` is at most the square of [`STRAIN_LIMIT`].
#[inline(always)]
pub fn by_series<T: Real>(constants: &Constants<T>, voltage_v: Limbs<T>) -> LimbLoad<T> {
    let (displacement, force, squares) = nodes(limb_strains(constants, voltage_v));
    by_nodes(constants, displacement, force, squares)
}

/// As [`by_series`], starting from displacements of and forces on the nodes along their limbs, and the squared strains there.
#[inline(always)]
pub(super) fn by_nodes<T: Real>(
    constants: &Constants<T>,
    displacement: Limbs<T>,
    force: Limbs<T>,
    squares: Vec3<T>,
) -> LimbLoad<T> {
    let displacement = shell_axes(displacement);
    let force = shell_axes(force);
    let strain_squares = squares.sum();

    let sixth = squares.constant(1.0 / 6.0);
    let all = displacement[0] + displacement[1] + displacement[2];
    let linear = linear_rotation(displacement, constants.inverse_nu);
    let s = linear.sum();
    let c = s * sixth;
    let c2 = c * c;
    let third_power = c2 * s;
    let curved = linear
        .ones_cross()
        .times_plus(c, linear.times_plus(c2 * s.constant(-3.0), linear));
    let short = curved + Vec3::all(third_power);
    let rotation = linear.times_plus(linear.dot(linear) * sixth, short);

    // 3 r = sum of the nodes - 3 (R_r - 1) t_mean = sum of the nodes + nu (R_r - 1) 1. The sine's cubic term in R_r - 1
    // is what the short rotation is short of.
    let one = c.constant(1.0);
    let turned = turn(short, Vec3::all(one));
    let position_thrice = turned.times_plus(constants.nu, all);
    let torque = turned_back(rotation, force);
    LimbLoad {
        position_thrice,
        rotation,
        force: force[0] + force[1] + force[2],
        torque: constants.torque_to_principal(torque),
        strain_squares,
    }
}

/// (R - 1) v for the rotation vector phi, to its second power: phi x (v + phi x v/2).
#[inline(always)]
pub fn turn<T: Real>(phi: Vec3<T>, v: Vec3<T>) -> Vec3<T> {
    let half = phi.times(v.constant(0.5));
    phi.cross(half.cross_plus(v, v))
}

/// Strain at which a limb is refused: what the formulas make of such limbs no longer means anything.
pub const OVERSTRAIN: f64 = 0.5;

/// Places the mass without any series. `sample` is for errors.
///
/// # Errors
/// [`Error::NotFinite`] names the channel, [`Error::Overstrained`] one whose limb changes its length by
/// [`OVERSTRAIN`]; the errors of [`Pose::from_elongations`].
#[cold]
pub fn exactly(
    constants: &Constants<f64>,
    voltage_v: &[f64; LIMBS],
    sample: usize,
) -> Result<LimbLoad<f64>> {
    refuse(constants, voltage_v, sample)?;
    exactly_by_strains(constants, &strains(constants, voltage_v))
}

/// As [`exactly`], starting from strains instead of voltages.
///
/// # Errors
/// Those of [`Pose::from_elongations`].
pub(super) fn exactly_by_strains(
    constants: &Constants<f64>,
    x: &[f64; LIMBS],
) -> Result<LimbLoad<f64>> {
    let nu = constants.nu;
    let geometry = Geometry {
        limb_length_m: 1.0,
        half_edge_m: nu,
    };
    let pose = Pose::from_elongations(&geometry, x)?;
    let back = pose.rotation_matrix().transpose();
    let mut force = DVec3::ZERO;
    let mut torque = DVec3::ZERO;
    for n in 0..NODES {
        let p = node_displacement(&geometry, x, n)?;
        let mut at_node = DVec3::ZERO;
        for limb in n * LIMBS_PER_NODE..(n + 1) * LIMBS_PER_NODE {
            at_node += (DIRECTIONS_SHELL[limb] + p) * (x[limb] / (1.0 + x[limb]));
        }
        force += at_node;
        torque += geometry.node_mass_m(n).cross(back * at_node) / nu;
    }
    let numbers = |v: DVec3| vec3(v.x, v.y, v.z);
    Ok(LimbLoad {
        position_thrice: numbers(3.0 * pose.position_shell_m),
        rotation: numbers(pose.rotation_rad),
        force: numbers(force),
        torque: constants.torque_to_principal(numbers(torque)),
        strain_squares: x.iter().map(|x| x * x).sum(),
    })
}

pub(super) fn strains(constants: &Constants<f64>, voltage_v: &[f64; LIMBS]) -> [f64; LIMBS] {
    core::array::from_fn(|i| constants.strain(i, voltage_v[i]))
}

/// Refuses voltages that are not finite and strains of [`OVERSTRAIN`] or more. `sample` is for errors.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::Overstrained`].
pub fn refuse(constants: &Constants<f64>, voltage_v: &[f64; LIMBS], sample: usize) -> Result<()> {
    let x = strains(constants, voltage_v);
    for (i, (&strain, &value)) in x.iter().zip(voltage_v).enumerate() {
        let channel = i + 1;
        if !value.is_finite() {
            return Err(Error::NotFinite {
                channel,
                sample,
                value,
            });
        }
        if strain.abs() >= OVERSTRAIN {
            return Err(Error::Overstrained {
                channel,
                sample,
                strain,
            });
        }
    }
    Ok(())
}
