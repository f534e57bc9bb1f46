//! The order of nine limbs in the kernel's vectors.

use super::number::Real;
use super::vec3::{Vec3, vec3};
use crate::geometry::{LIMBS, LIMBS_PER_NODE};

/// Numbers of nine limbs in kernel order: each vector has one limb of each node.
pub type Limbs<T> = [Vec3<T>; LIMBS_PER_NODE];

/// From the paper's order to kernel order: the first vector has the limbs 1, 5, 9 of the three nodes, each further vector the
/// next limb, cyclically, at every node but the first. The limbs of a parity relation at two nodes then stand where one cyclic
/// permutation of a vector brings them together, and all components of a vector have the same sign in (5).
#[inline(always)]
pub fn to_kernel_order<T: Real>(nine: [T; LIMBS]) -> Limbs<T> {
    let [a, b, c, d, e, f, g, h, i] = nine;
    [vec3(a, e, i), vec3(b, f, g), vec3(c, d, h)]
}

/// From kernel order to the paper's: inverse of [`to_kernel_order`].
#[inline(always)]
pub fn from_kernel_order<T: Real>(rows: Limbs<T>) -> [T; LIMBS] {
    let [[a, e, i], [b, f, g], [c, d, h]] = rows.map(Vec3::components);
    [a, b, c, d, e, f, g, h, i]
}
