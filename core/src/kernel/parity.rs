//! The three parity rows, to second order: what strains do that no pose of the mass explains.
//!
//! With xi the nodes' displacements along the limbs ([`super::placement`]) the rows of [`crate::redundancy::parity`] add up
//! e . (R_r - 1) t, whose first order in phi drops out. What is left,
//!
//! ```text
//! rho_1 = xi_1 + xi_2 + xi_4 + xi_5 - nu (phi_x^2 + (phi_y + phi_z)^2/2)
//! rho_2 = xi_1 + xi_3 + xi_7 + xi_9 - nu (phi_y^2 + (phi_z + phi_x)^2/2)
//! rho_3 = xi_5 + xi_6 + xi_8 + xi_9 - nu (phi_z^2 + (phi_x + phi_y)^2/2),
//! ```
//!
//! is zero to third order for any pose; the third order of the rotation is a cross product once more and drops out, too, so
//! with phi to second order the rows are zero to fourth.

use super::number::Real;
use super::order::Limbs;
use super::placement::{linear_rotation, nodes, shell_axes};
use super::vec3::{Vec3, vec3};

/// The sums of each row's four limbs.
#[inline(always)]
pub fn sums<T: Real>(along: Limbs<T>) -> Vec3<T> {
    let [a, b] = halves(along);
    let [x, z, y] = (a + b).components();
    vec3(x, y, z)
}

/// nu (phi_x^2 + (phi_y + phi_z)^2/2) and its cyclic permutations.
#[inline(always)]
pub fn curvature<T: Real>(phi: Vec3<T>, nu: T) -> Vec3<T> {
    let yzx = phi.cycled();
    let pair = yzx + yzx.cycled();
    let half = pair.times(phi.constant(0.5));
    pair.mul_elem_plus(half, phi.mul_elem(phi)).times(nu)
}

/// What the rows leave of nine strains, to second order.
#[inline(always)]
pub fn residual<T: Real>(strain: Limbs<T>, nu: T, inverse_nu: T) -> Vec3<T> {
    let (displacement, _, _) = nodes(strain);
    let phi = linear_rotation(shell_axes(displacement), inverse_nu);
    sums(displacement) - curvature(phi, nu)
}

/// The two halves of the rows, in the order 1, 3, 2 in which they fall out of limbs side by side: x1 + x4 and x2 + x5 of the
/// first. To first order their sum is nothing, and their difference 2 nu (phi_x, phi_z, phi_y).
#[inline(always)]
pub fn halves<T: Real>(along: Limbs<T>) -> [Vec3<T>; 2] {
    let [u, v, w] = along;
    [u + w.cycled(), v + u.cycled()]
}

/// -2 times the second order alone of what the rows leave, in the order 1, 3, 2, from the strains and the difference of their
/// halves.
///
/// What xi has beside x is -(S - x^2)/2; over a row's four limbs that is half of S at both nodes and of the squares of the two
/// other limbs there.
#[inline(always)]
pub fn second_order<T: Real>(strain: Limbs<T>, difference: Vec3<T>, inverse_nu: T) -> Vec3<T> {
    let [u, v, w] = strain;
    let (u, v, w) = (u.mul_elem(u), v.mul_elem(v), w.mul_elem(w));
    let at_node = u + v + w;
    let twice = (at_node + w) + (at_node + v).cycled();
    twice + curvature(difference, inverse_nu * inverse_nu.constant(0.5))
}

/// What the rows leave of the nodes' displacements along their limbs, to third order, in the order 1, 3, 2, from the sums of
/// their halves; phi is the rotation that fits them.
#[inline(always)]
pub fn left<T: Real>(sums: Vec3<T>, phi: Vec3<T>, nu: T) -> Vec3<T> {
    let [x, y, z] = phi.components();
    // Its axes in the order of the rows: the curvature knows no handedness.
    sums - curvature(vec3(x, z, y), nu)
}
