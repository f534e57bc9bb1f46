//! The number that the kernel's formulas are written in: one f64, one f32, or eight lanes of f64 at once.
//!
//! Every formula stands once. What differs between a microcontroller, a server's vector unit and a plain loop is the
//! type behind it, and with it the rounding of a product that is added to something: fused where the processor fuses.

use core::ops::{Add, Mul, Neg, Sub};

use glam::{DQuat, DVec3, Quat, Vec3 as GlamVec3};

/// A real number, or several side by side.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// The same constant in each of them. Takes a value because vector types only exist where the processor has them.
    #[must_use]
    fn like(self, constant: f64) -> Self;

    /// `self * factor + term`, rounded once where the processor does.
    #[must_use]
    fn times_plus(self, factor: Self, term: Self) -> Self;

    /// `term - self * factor`.
    #[must_use]
    fn times_from(self, factor: Self, term: Self) -> Self;
}

/// A single number that a decoupler can be built on.
pub trait Scalar: Real + PartialOrd + core::fmt::Debug + Default + 'static {
    /// Three of them, for people.
    type Vector: Copy + PartialEq + core::fmt::Debug;
    /// A unit quaternion of them, for people.
    type Quaternion: Copy + PartialEq + core::fmt::Debug;

    /// Rounded from f64.
    fn from_f64(value: f64) -> Self;
    /// Exactly.
    fn to_f64(self) -> f64;
    /// Three numbers as a vector.
    fn vector(v: Vec3<Self>) -> Self::Vector;
    /// Four numbers as a quaternion.
    fn quaternion(w: Self, v: Vec3<Self>) -> Self::Quaternion;
}

macro_rules! scalar {
    ($float:ty, $vector:ty, $quaternion:ty) => {
        impl Real for $float {
            #[inline(always)]
            fn like(self, constant: f64) -> Self {
                constant as $float
            }

            #[inline(always)]
            fn times_plus(self, factor: Self, term: Self) -> Self {
                // Only where the build's processor has the instruction: elsewhere a library function would be called.
                #[cfg(all(
                    feature = "std",
                    any(target_feature = "fma", target_arch = "aarch64")
                ))]
                return self.mul_add(factor, term);
                #[cfg(not(all(
                    feature = "std",
                    any(target_feature = "fma", target_arch = "aarch64")
                )))]
                return self * factor + term;
            }

            #[inline(always)]
            fn times_from(self, factor: Self, term: Self) -> Self {
                #[cfg(all(
                    feature = "std",
                    any(target_feature = "fma", target_arch = "aarch64")
                ))]
                return (-self).mul_add(factor, term);
                #[cfg(not(all(
                    feature = "std",
                    any(target_feature = "fma", target_arch = "aarch64")
                )))]
                return term - self * factor;
            }
        }

        impl Scalar for $float {
            type Vector = $vector;
            type Quaternion = $quaternion;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $float
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn vector(v: Vec3<Self>) -> Self::Vector {
                <$vector>::new(v.x, v.y, v.z)
            }

            #[inline(always)]
            fn quaternion(w: Self, v: Vec3<Self>) -> Self::Quaternion {
                <$quaternion>::from_xyzw(v.x, v.y, v.z, w)
            }
        }
    };
}

scalar!(f64, DVec3, DQuat);
scalar!(f32, GlamVec3, Quat);

/// Three components along fixed axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vec3<T> {
    /// First component.
    pub x: T,
    /// Second component.
    pub y: T,
    /// Third component.
    pub z: T,
}

/// Three components.
#[inline(always)]
pub const fn vec3<T>(x: T, y: T, z: T) -> Vec3<T> {
    Vec3 { x, y, z }
}

impl<T: Real> Vec3<T> {
    /// A constant of the components' type: [`Real::like`].
    #[inline(always)]
    pub fn like(self, constant: f64) -> T {
        self.x.like(constant)
    }

    /// All three times a number.
    #[inline(always)]
    pub fn times(self, factor: T) -> Self {
        vec3(self.x * factor, self.y * factor, self.z * factor)
    }

    /// `self * factor + term`.
    #[inline(always)]
    pub fn times_plus(self, factor: T, term: Self) -> Self {
        vec3(
            self.x.times_plus(factor, term.x),
            self.y.times_plus(factor, term.y),
            self.z.times_plus(factor, term.z),
        )
    }

    /// `self . other`.
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        let xy = self.x.times_plus(other.x, self.y * other.y);
        self.z.times_plus(other.z, xy)
    }

    /// `self x other`.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        vec3(
            self.z.times_from(other.y, self.y * other.z),
            self.x.times_from(other.z, self.z * other.x),
            self.y.times_from(other.x, self.x * other.y),
        )
    }

    /// `term + self x other`.
    #[inline(always)]
    pub fn cross_plus(self, other: Self, term: Self) -> Self {
        vec3(
            self.y
                .times_plus(other.z, self.z.times_from(other.y, term.x)),
            self.z
                .times_plus(other.x, self.x.times_from(other.z, term.y)),
            self.x
                .times_plus(other.y, self.y.times_from(other.x, term.z)),
        )
    }

    /// `(1, 1, 1) x self`.
    #[inline(always)]
    pub fn ones_cross(self) -> Self {
        vec3(self.z - self.y, self.x - self.z, self.y - self.x)
    }

    /// Sum of the three.
    #[inline(always)]
    pub fn sum(self) -> T {
        self.x + self.y + self.z
    }
}

impl<T> Vec3<T> {
    /// Another number type, component by component.
    #[inline(always)]
    pub fn map<U>(self, mut f: impl FnMut(T) -> U) -> Vec3<U> {
        vec3(f(self.x), f(self.y), f(self.z))
    }
}

impl<T: Scalar> Vec3<T> {
    /// Whether all three are finite.
    pub fn is_finite(self) -> bool {
        [self.x, self.y, self.z]
            .iter()
            .all(|x| x.to_f64().is_finite())
    }
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        vec3(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<T: Real> Sub for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        vec3(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}
