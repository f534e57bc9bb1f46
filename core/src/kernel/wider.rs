//! A single stream in wider registers than the program was compiled for, where the processor turns out to have them.
//!
//! A program for any x86-64 has registers of two numbers. Three components in one register halve the instructions of a sample, so
//! a decoupler keeps its constants in that form, too, if there are registers of four. Products are not fused, and additions are in
//! the same order: the same program gives the same bits in either width. What lies beyond the series, rotations of
//! 0.1 rad a sample and more, has sine and cosine of the system's library, which may choose by processor.

#[cfg(all(feature = "std", target_arch = "x86_64", not(target_feature = "avx")))]
mod avx2;

use core::convert::Infallible;
use core::fmt::Debug;

use super::constants::Constants;
use super::number::Real;
use super::reconstruct::StrainReconstruction;
use super::vec3::Vec3;

/// Constants in wider registers.
pub trait Wider<T: Real>: Clone + PartialEq + Debug {
    /// Whether there may be any.
    const POSSIBLE: bool;

    /// A number beside others in such a register.
    type Number: Real;
    /// Proof that the processor has them.
    type Proof: Copy;

    /// Nothing where the processor has no such registers.
    fn new(constants: &Constants<T>, strains: &StrainReconstruction<T>) -> Option<Self>;
    /// The constants.
    fn constants(&self) -> &Constants<Self::Number>;
    /// The weights of excluded limbs' strains.
    fn strains(&self) -> &StrainReconstruction<Self::Number>;
    /// The proof.
    fn proof(&self) -> Self::Proof;
    /// Does `work`, compiled for such registers if it is `inline(always)`.
    fn run<A>(proof: Self::Proof, work: impl FnOnce() -> A) -> A;
    /// Into such a register.
    fn widen(&self) -> impl Fn(T) -> Self::Number + Copy + use<Self, T>;
    /// Out of it.
    fn narrow(number: Self::Number) -> T;
    /// Keeps accelerations and rate of a sample for who is outside of [`Self::run`].
    fn keep(&mut self, ground: [Vec3<Self::Number>; 3]);
    /// What was kept last.
    fn kept(&self) -> [Vec3<T>; 3];
}

/// What a double-precision stream may find.
#[cfg(all(feature = "std", target_arch = "x86_64", not(target_feature = "avx")))]
pub type WiderF64 = avx2::Avx2;
/// What a double-precision stream may find: nothing that the program was not compiled for.
#[cfg(not(all(feature = "std", target_arch = "x86_64", not(target_feature = "avx"))))]
pub type WiderF64 = Infallible;

/// No wider registers to be had.
impl<T: Real> Wider<T> for Infallible {
    const POSSIBLE: bool = false;

    type Number = T;
    type Proof = Self;

    #[inline(always)]
    fn new(_: &Constants<T>, _: &StrainReconstruction<T>) -> Option<Self> {
        None
    }

    #[inline(always)]
    fn constants(&self) -> &Constants<T> {
        match *self {}
    }

    #[inline(always)]
    fn strains(&self) -> &StrainReconstruction<T> {
        match *self {}
    }

    #[inline(always)]
    fn proof(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn run<A>(proof: Self, _: impl FnOnce() -> A) -> A {
        match proof {}
    }

    #[inline(always)]
    fn widen(&self) -> impl Fn(T) -> T + Copy + use<T> {
        |number| number
    }

    #[inline(always)]
    fn narrow(number: T) -> T {
        number
    }

    #[inline(always)]
    fn keep(&mut self, _: [Vec3<T>; 3]) {}

    #[inline(always)]
    fn kept(&self) -> [Vec3<T>; 3] {
        match *self {}
    }
}
