//! The number that the kernel's formulas are written in: one f64, one f32, or eight lanes of f64 at once.
//!
//! Every formula stands once. What differs between a microcontroller, a server's vector unit and a plain loop is the
//! type behind it, and with it the rounding of a product that is added to something: fused where the processor fuses.

use core::convert::Infallible;
use core::ops::{Add, Mul, Neg, Sub};

use super::vec3::{Select, SplitVec3, Vec3, Vec3F64, Vec3Storage};
use super::wider::{Wider, WiderF64};
use glam::{DQuat, DVec3, Quat, Vec3 as GlamVec3};

/// A real number, or several side by side.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// How three of them are stored.
    type Storage: Vec3Storage<Self>;

    /// `value` in the type of `self`, in every lane. A method, because a vector type is only at hand where the processor has it.
    fn constant(self, value: f64) -> Self;

    /// `self * factor + term`, rounded once where the processor does.
    fn times_plus(self, factor: Self, term: Self) -> Self;

    /// `term - self * factor`.
    fn neg_mul_add(self, factor: Self, term: Self) -> Self;
}

/// A single number that a decoupler can be built on.
pub trait Scalar:
    Real<Storage: Select> + PartialOrd + core::fmt::Debug + Default + 'static
{
    /// Vector type of the public interface.
    type Vector: Copy + PartialEq + core::fmt::Debug;
    /// Quaternion type of the public interface.
    type Quaternion: Copy + PartialEq + core::fmt::Debug;
    /// Registers beyond those that the program was compiled for.
    type Wider: Wider<Self>;

    /// Rounded from f64.
    fn from_f64(value: f64) -> Self;
    /// Exactly.
    fn to_f64(self) -> f64;
    /// All bits set, or none.
    fn bits(set: bool) -> Self;
    /// Bit by bit: zero where none is set, itself where all are. Looks at no value, so that NaN is like any other.
    fn and(self, bits: Self) -> Self;
    /// Three numbers as a vector.
    fn vector(v: Vec3<Self>) -> Self::Vector;
    /// Four numbers as a quaternion.
    fn quaternion(w: Self, v: Vec3<Self>) -> Self::Quaternion;
}

macro_rules! scalar {
    ($float:ty, $bits:ty, $three:ty, $vector:ty, $quaternion:ty, $wider:ty) => {
        impl Real for $float {
            type Storage = $three;

            #[inline(always)]
            fn constant(self, value: f64) -> Self {
                value as $float
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
            fn neg_mul_add(self, factor: Self, term: Self) -> Self {
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
            type Wider = $wider;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $float
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn bits(set: bool) -> Self {
                Self::from_bits(if set { <$bits>::MAX } else { 0 })
            }

            #[inline(always)]
            fn and(self, bits: Self) -> Self {
                Self::from_bits(self.to_bits() & bits.to_bits())
            }

            #[inline(always)]
            fn vector(v: Vec3<Self>) -> Self::Vector {
                <$vector>::new(v.x(), v.y(), v.z())
            }

            #[inline(always)]
            fn quaternion(w: Self, v: Vec3<Self>) -> Self::Quaternion {
                <$quaternion>::from_xyzw(v.x(), v.y(), v.z(), w)
            }
        }
    };
}

scalar!(f64, u64, Vec3F64, DVec3, DQuat, WiderF64);
scalar!(f32, u32, SplitVec3<f32>, GlamVec3, Quat, Infallible);
