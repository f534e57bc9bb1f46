//! The shell's attitude over any number type: [`crate::paper::attitude`] in units of the sample interval.

use glam::DVec3;

use super::constants::Constants;
use super::number::{Real, Scalar};
use super::shell::ShellMotion;
use super::vec3::{Vec3, vec3};
use crate::paper::attitude;

/// Half angle of one step, squared, up to which the polynomials below hold to rounding: a tenth of a radian from one
/// sample to the next, eighteen times the rig's fastest at 10 kHz.
pub const HALF_ANGLE_SQUARED_LIMIT: f64 = 0.0025;

/// A quaternion w + x i + y j + z k.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quaternion<T: Real> {
    /// Real part.
    pub w: T,
    /// Imaginary part.
    pub v: Vec3<T>,
}

/// Half of the rotation vector between two samples: quadrature of Hermite and the coning term.
#[inline(always)]
pub fn half_rotation<T: Real>(from: &ShellMotion<T>, to: &ShellMotion<T>) -> Vec3<T> {
    let small = from
        .rate
        .cross_plus(to.rate, from.rate_derivative - to.rate_derivative);
    (from.rate + to.rate).times_plus(
        to.rate.constant(0.25),
        small.times(to.rate.constant(1.0 / 24.0)),
    )
}

/// exp of twice a half rotation, both parts times `scale`, and the half angle squared.
#[inline(always)]
pub fn exp<T: Real>(half: Vec3<T>, scale: T) -> (Quaternion<T>, T) {
    let z = half.dot(half);
    // Taylor series of sin(x)/x and cos(x) in z = x^2. At the limit the first dropped terms are 1e-16 and 1e-15; what
    // the latter does to the angle is smaller by x, and what it does to the length, the next scale makes good.
    let sinc = z
        .times_plus(z.constant(-1.0 / 5040.0), z.constant(1.0 / 120.0))
        .times_plus(z, z.constant(-1.0 / 6.0))
        .times_plus(z, z.constant(1.0));
    let cosine = z
        .times_plus(z.constant(-1.0 / 720.0), z.constant(1.0 / 24.0))
        .times_plus(z, z.constant(-0.5))
        .times_plus(z, z.constant(1.0));
    let q = Quaternion {
        w: cosine * scale,
        v: half.times(sinc * scale),
    };
    (q, z)
}

/// The same for a rotation of any size; nothing if it is not a finite number.
pub fn exp_exactly<T: Scalar>(half: Vec3<T>, scale: T) -> Option<Quaternion<T>> {
    let [x, y, z] = half.components().map(T::to_f64);
    let q = attitude::exp(2.0 * DVec3::new(x, y, z));
    q.is_finite().then(|| Quaternion {
        w: T::from_f64(q.w) * scale,
        v: vec3(T::from_f64(q.x), T::from_f64(q.y), T::from_f64(q.z)).times(scale),
    })
}

impl<T: Real> Quaternion<T> {
    /// Converted to another number type.
    #[inline(always)]
    pub(crate) fn map<U: Real>(self, f: impl Fn(T) -> U) -> Quaternion<U> {
        Quaternion {
            w: f(self.w),
            v: self.v.map(&f),
        }
    }

    /// First `other`, then `self`.
    #[inline(always)]
    pub fn after(self, other: Self) -> Self {
        let (p, q) = (self, other);
        let v = q.v.times_plus(p.w, p.v.times(q.w));
        Self {
            w: p.w.times_plus(q.w, -p.v.dot(q.v)),
            v: p.v.cross_plus(q.v, v),
        }
    }

    /// What takes a quaternion a rounding away from unit length back to it: one step of Newton for the inverse root.
    #[inline(always)]
    pub fn to_unit(self) -> T {
        let squares = self.w.times_plus(self.w, self.v.dot(self.v));
        squares.times_plus(self.w.constant(-0.5), self.w.constant(1.5))
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
        self.v + self.v
    }
}

/// a, w' in ground axes and w* in shell axes, SI.
#[inline(always)]
pub(crate) fn to_ground<T: Real>(
    constants: &Constants<T>,
    motion: &ShellMotion<T>,
    attitude: Quaternion<T>,
) -> [Vec3<T>; 3] {
    let twice = attitude.twice_v();
    let force = attitude.rotate(twice, motion.specific_force);
    let angular = attitude.rotate(twice, motion.rate_derivative);
    [
        force.times_plus(constants.m_per_s2, constants.gravity_ground_m_s2),
        angular.times(constants.per_s2),
        motion.rate.times(constants.per_s),
    ]
}
