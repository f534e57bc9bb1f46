//! Vectors and tensors of three between glam, which has them in formulas, and nalgebra, which solves for them: numbers are moved, not changed.

use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, Vector3, Vector6};

/// A vector as nalgebra has it.
#[must_use]
#[inline]
pub fn column(v: DVec3) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// A vector as glam has it.
#[inline]
pub(crate) fn vector(v: Vector3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

/// A matrix as nalgebra has it.
#[inline]
pub(crate) fn matrix(m: DMat3) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| m.col(j)[i])
}

/// \[v\]x: cross product from the left.
#[inline]
pub(crate) fn cross(v: DVec3) -> DMat3 {
    DMat3::from_cols(v.cross(DVec3::X), v.cross(DVec3::Y), v.cross(DVec3::Z))
}

/// One vector above another: force and torque, or what moves along and what turns.
#[inline]
pub(crate) fn stacked(upper: DVec3, lower: DVec3) -> Vector6<f64> {
    Vector6::new(upper.x, upper.y, upper.z, lower.x, lower.y, lower.z)
}

/// Inverse of [`stacked`].
#[inline]
pub(crate) fn halves(six: &Vector6<f64>) -> [DVec3; 2] {
    [
        DVec3::new(six[0], six[1], six[2]),
        DVec3::new(six[3], six[4], six[5]),
    ]
}
