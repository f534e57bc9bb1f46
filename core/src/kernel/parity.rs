//! The three parity rows, to second order: what strains do that no pose of the mass explains.
//!
//! With xi the nodes' displacements along the limbs ([`super::placement`]) the rows of [`crate::parity`] add up
//! e . (R_r - 1) t, whose first order in phi drops out. What is left,
//!
//! ```text
//! rho_1 = xi_1 + xi_2 + xi_4 + xi_5 - nu (phi_x^2 + (phi_y + phi_z)^2/2)
//! rho_2 = xi_1 + xi_3 + xi_7 + xi_9 - nu (phi_y^2 + (phi_z + phi_x)^2/2)
//! rho_3 = xi_5 + xi_6 + xi_8 + xi_9 - nu (phi_z^2 + (phi_x + phi_y)^2/2),
//! ```
//!
//! is zero to third order for any pose; the third order of the rotation is a cross product once more and drops out, too.

use super::placement::{Limbs, linear_rotation, nodes, shell_axes};
use super::real::Real;
use super::vector::{Vec3, vec3};

/// The sums of each row's four limbs.
#[inline(always)]
pub fn sums<T: Real>(along: Limbs<T>) -> Vec3<T> {
    let [first, second, third] = along;
    let [u, v, w] = [first + second, first + third, second + third].map(Vec3::components);
    vec3(u[0] + u[1], v[0] + v[2], w[1] + w[2])
}

/// nu (phi_x^2 + (phi_y + phi_z)^2/2) and its cyclic brothers.
#[inline(always)]
pub fn curvature<T: Real>(phi: Vec3<T>, nu: T) -> Vec3<T> {
    let yzx = phi.cycled();
    let pair = yzx + yzx.cycled();
    let half = pair.times(phi.like(0.5));
    pair.by_plus(half, phi.by(phi)).times(nu)
}

/// What the rows leave of nine strains.
#[inline(always)]
pub fn residual<T: Real>(strain: Limbs<T>, nu: T, inverse_nu: T) -> Vec3<T> {
    let (displacement, _, _) = nodes(strain);
    let phi = linear_rotation(shell_axes(displacement), inverse_nu);
    sums(displacement) - curvature(phi, nu)
}
