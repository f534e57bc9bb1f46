//! The shell's attitude over any number type: [`crate::attitude`] in units of the sample interval.

use super::real::{Real, Vec3, vec3};
use super::shell::ShellMotion;

/// Half angle of one step, squared, up to which the polynomials below hold to rounding; a shell that turns by more
/// than half a radian from one sample to the next cannot be followed by any scheme.
pub const HALF_ANGLE_SQUARED_LIMIT: f64 = 0.0625;

/// A quaternion w + x i + y j + z k.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quaternion<T> {
    /// Real part.
    pub w: T,
    /// Imaginary part.
    pub v: Vec3<T>,
}

/// Half of the rotation vector between two samples: quadrature of Hermite and the coning term.
#[inline(always)]
pub fn half_rotation<T: Real>(from: &ShellMotion<T>, to: &ShellMotion<T>) -> Vec3<T> {
    let c = |value: f64| to.rate.x.like(value);
    let small = from
        .rate
        .cross_plus(to.rate, from.rate_derivative - to.rate_derivative);
    (from.rate + to.rate).times_plus(c(0.25), small.times(c(1.0 / 24.0)))
}

/// exp of twice a half rotation, and the half angle squared.
#[inline(always)]
pub fn exp<T: Real>(half: Vec3<T>) -> (Quaternion<T>, T) {
    let z = half.dot(half);
    let c = |value: f64| z.like(value);
    // Taylor series of sin(x)/x and cos(x) in z = x^2; the first dropped terms are 1e-17 at the limit.
    let sinc = [
        -1.0 / 39_916_800.0,
        1.0 / 362_880.0,
        -1.0 / 5_040.0,
        1.0 / 120.0,
        -1.0 / 6.0,
        1.0,
    ];
    let cosine = [
        -1.0 / 3_628_800.0,
        1.0 / 40_320.0,
        -1.0 / 720.0,
        1.0 / 24.0,
        -0.5,
        1.0,
    ];
    let horner = |p: [f64; 6]| {
        p[1..]
            .iter()
            .fold(c(p[0]), |sum, &p| sum.times_plus(z, c(p)))
    };
    let q = Quaternion {
        w: horner(cosine),
        v: half.times(horner(sinc)),
    };
    (q, z)
}

impl<T: Real> Quaternion<T> {
    /// First `other`, then `self`.
    #[inline(always)]
    pub fn after(self, other: Self) -> Self {
        let (p, q) = (self, other);
        let v = q.v.times_plus(p.w, p.v.times(q.w));
        Self {
            w: p.v.x.times_from(
                q.v.x,
                p.v.y.times_from(q.v.y, p.v.z.times_from(q.v.z, p.w * q.w)),
            ),
            v: p.v.cross_plus(q.v, v),
        }
    }

    /// Back to unit length from a rounding away: one step of Newton for the inverse root.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        let c = |value: f64| self.w.like(value);
        let squares = self.w.times_plus(self.w, self.v.dot(self.v));
        let factor = squares.times_plus(c(-0.5), c(1.5));
        Self {
            w: self.w * factor,
            v: self.v.times(factor),
        }
    }

    /// `twice_v` is 2 v, worked out once for several vectors: p + 2 v x (w p + v x p).
    #[inline(always)]
    pub fn rotate(self, twice_v: Vec3<T>, p: Vec3<T>) -> Vec3<T> {
        let inner = self.v.cross_plus(p, p.times(self.w));
        twice_v.cross_plus(inner, p)
    }

    /// 2 v.
    #[inline(always)]
    pub fn twice_v(self) -> Vec3<T> {
        vec3(
            self.v.x + self.v.x,
            self.v.y + self.v.y,
            self.v.z + self.v.z,
        )
    }
}
