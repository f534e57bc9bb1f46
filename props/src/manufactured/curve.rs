//! Vectors and rotations as functions of time, with their first two derivatives by the product rule.

use core::f64::consts::TAU;

use glam::{DMat3, DVec3};

/// A scalar and its first two derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scalar(pub [f64; 3]);

impl Scalar {
    /// a cos + b sin.
    pub fn harmonic(a: f64, b: f64, frequency_hz: f64, time_s: f64) -> Self {
        let omega = TAU * frequency_hz;
        let (sin, cos) = (omega * time_s).sin_cos();
        let value = a * cos + b * sin;
        Self([value, omega * (b * cos - a * sin), -omega * omega * value])
    }
}

impl core::ops::Mul for Scalar {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let ([a0, a1, a2], [b0, b1, b2]) = (self.0, other.0);
        Self([
            a0 * b0,
            a1 * b0 + a0 * b1,
            a2 * b0 + 2.0 * a1 * b1 + a0 * b2,
        ])
    }
}

/// A vector and its first two derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vector(pub [DVec3; 3]);

impl Vector {
    /// From three components.
    pub fn from_components(x: Scalar, y: Scalar, z: Scalar) -> Self {
        Self(core::array::from_fn(|i| DVec3::new(x.0[i], y.0[i], z.0[i])))
    }
}

/// A rotation and its first two derivatives; the distance from the identity is kept apart, so that rotations of a
/// millionth lose no digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// R - 1.
    pub minus_identity: DMat3,
    /// R' and R''.
    pub derivatives: [DMat3; 2],
}

impl Rotation {
    /// About a fixed unit axis.
    pub fn about(axis: DVec3, angle: Scalar) -> Self {
        let cross = cross_matrix(axis);
        let square = cross * cross;
        let [angle, first, second] = angle.0;
        let (half_sin, half_cos) = (0.5 * angle).sin_cos();
        let sin = 2.0 * half_sin * half_cos;
        let minus_identity = cross * sin + square * (2.0 * half_sin * half_sin);
        let slope = (DMat3::IDENTITY + minus_identity) * cross;
        Self {
            minus_identity,
            derivatives: [
                slope * first,
                slope * second + slope * cross * (first * first),
            ],
        }
    }

    /// R itself.
    pub fn matrix(&self) -> DMat3 {
        DMat3::IDENTITY + self.minus_identity
    }

    /// This rotation after another: the matrix product.
    pub fn after(&self, other: &Self) -> Self {
        let (a, b) = (self.matrix(), other.matrix());
        let ([a1, a2], [b1, b2]) = (self.derivatives, other.derivatives);
        Self {
            minus_identity: self.minus_identity * b + other.minus_identity,
            derivatives: [a1 * b + a * b1, a2 * b + (a1 * b1) * 2.0 + a * b2],
        }
    }

    /// R^T v.
    pub fn back(&self, v: &Vector) -> Vector {
        let [r0, r1, r2] = [self.matrix(), self.derivatives[0], self.derivatives[1]]
            .map(|matrix| matrix.transpose());
        let [v0, v1, v2] = v.0;
        Vector([
            r0 * v0,
            r1 * v0 + r0 * v1,
            r2 * v0 + 2.0 * (r1 * v1) + r0 * v2,
        ])
    }

    /// Angular velocity w with R' = \[w\]x R, and its derivative.
    pub fn rate(&self) -> [DVec3; 2] {
        let back = self.matrix().transpose();
        let [r1, r2] = self.derivatives;
        [vee(r1 * back), vee(r2 * back + r1 * r1.transpose())]
    }
}

/// \[v\]x.
pub fn cross_matrix(v: DVec3) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(0.0, v.z, -v.y),
        DVec3::new(-v.z, 0.0, v.x),
        DVec3::new(v.y, -v.x, 0.0),
    )
}

/// The vector of a matrix's skew part.
fn vee(m: DMat3) -> DVec3 {
    0.5 * DVec3::new(
        m.y_axis.z - m.z_axis.y,
        m.z_axis.x - m.x_axis.z,
        m.x_axis.y - m.y_axis.x,
    )
}
