//! The kernel's numbers in a processor's vector registers.

use core::ops::{Add, Mul, Neg, Sub};

use ::wide::f64x4;
use pulp::Simd;

use super::number::Real;
use super::vec3::SplitVec3;

/// Numbers that are worked on together, whatever the width of the processor's registers: the layout of every buffer, and
/// with it every result, is the same on all that fuse multiply and add.
pub const LANES: usize = 8;

/// Eight numbers side by side, where a cache line begins.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Row(pub [f64; LANES]);

impl Row {
    /// Eight zeros.
    pub const ZERO: Self = Self([0.0; LANES]);
}

/// A vector register's worth of numbers.
pub trait Register: Real {
    /// Proof that the processor has such registers.
    type Proof: Copy;
    /// One such number by itself, worked on with the same instructions.
    type Single: Real + From<f64> + Into<f64>;
    /// Numbers in one register.
    const LANES: usize;
    /// Registers in a row.
    const PARTS: usize = LANES / Self::LANES;

    /// The same number in each lane.
    fn splat(proof: Self::Proof, value: f64) -> Self;
    /// One register's part of a row.
    fn load(proof: Self::Proof, row: &Row, part: usize) -> Self;
    /// Writes that part.
    fn store(self, row: &mut Row, part: usize);
    /// One register's numbers from `at` on, wherever they lie.
    fn load_at(proof: Self::Proof, series: &[f64], at: usize) -> Self;
    /// Writes them there.
    fn store_at(self, series: &mut [f64], at: usize);
    /// Square root.
    fn root(self) -> Self;
    /// The larger of two numbers, lane by lane; either where one is NaN.
    fn larger(self, other: Self) -> Self;
}

/// As many lanes as one register of this processor holds, found out at run time.
#[derive(Debug, Clone, Copy)]
pub struct Wide<S: Simd, const FUSED: bool = true> {
    simd: S,
    value: S::f64s,
}

impl<S: Simd, const FUSED: bool> Wide<S, FUSED> {
    /// A register as it is.
    #[inline(always)]
    pub fn new(simd: S, value: S::f64s) -> Self {
        Self { simd, value }
    }

    /// The inverse of [`Wide::new`].
    #[inline(always)]
    pub fn parts(self) -> (S, S::f64s) {
        (self.simd, self.value)
    }
}

impl<S: Simd> Register for Wide<S> {
    type Proof = S;
    // Functions that hold such registers are compiled for a processor that fuses.
    type Single = Single<true>;
    const LANES: usize = S::F64_LANES;

    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        Self {
            simd,
            value: simd.splat_f64s(value),
        }
    }

    #[inline(always)]
    fn load(simd: S, row: &Row, part: usize) -> Self {
        let (registers, _) = S::as_simd_f64s(&row.0);
        Self {
            simd,
            value: registers[part],
        }
    }

    #[inline(always)]
    fn store(self, row: &mut Row, part: usize) {
        let (registers, _) = S::as_mut_simd_f64s(&mut row.0);
        registers[part] = self.value;
    }

    #[inline(always)]
    fn load_at(simd: S, series: &[f64], at: usize) -> Self {
        let (registers, _) = S::as_simd_f64s(&series[at..at + Self::LANES]);
        Self {
            simd,
            value: registers[0],
        }
    }

    #[inline(always)]
    fn store_at(self, series: &mut [f64], at: usize) {
        let (registers, _) = S::as_mut_simd_f64s(&mut series[at..at + Self::LANES]);
        registers[0] = self.value;
    }

    #[inline(always)]
    fn root(self) -> Self {
        let value = self.simd.sqrt_f64s(self.value);
        Self { value, ..self }
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        let value = self.simd.max_f64s(self.value, other.value);
        Self { value, ..self }
    }
}

/// Four lanes in whatever registers the program was compiled for; plain numbers where there are none.
impl Register for f64x4 {
    type Proof = ();
    type Single = Single<false>;
    const LANES: usize = 4;

    #[inline(always)]
    fn splat((): (), value: f64) -> Self {
        Self::splat(value)
    }

    #[inline(always)]
    fn load((): (), row: &Row, part: usize) -> Self {
        let [a, b, c, d, e, f, g, h] = row.0;
        Self::from(if part == 0 {
            [a, b, c, d]
        } else {
            [e, f, g, h]
        })
    }

    #[inline(always)]
    fn store(self, row: &mut Row, part: usize) {
        let first = part * <Self as Register>::LANES;
        self.store_at(&mut row.0, first);
    }

    #[inline(always)]
    fn load_at((): (), series: &[f64], at: usize) -> Self {
        let four = &series[at..at + <Self as Register>::LANES];
        Self::from([four[0], four[1], four[2], four[3]])
    }

    #[inline(always)]
    fn store_at(self, series: &mut [f64], at: usize) {
        series[at..at + <Self as Register>::LANES].copy_from_slice(self.as_array());
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.fast_max(other)
    }
}

impl Real for f64x4 {
    type Storage = SplitVec3<Self>;

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::splat(value)
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        self.mul_add(factor, term)
    }

    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        self.mul_neg_add(factor, term)
    }
}

impl<S: Simd, const FUSED: bool> Add for Wide<S, FUSED> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let value = self.simd.add_f64s(self.value, other.value);
        Self { value, ..self }
    }
}

impl<S: Simd, const FUSED: bool> Sub for Wide<S, FUSED> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let value = self.simd.sub_f64s(self.value, other.value);
        Self { value, ..self }
    }
}

impl<S: Simd, const FUSED: bool> Mul for Wide<S, FUSED> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let value = self.simd.mul_f64s(self.value, other.value);
        Self { value, ..self }
    }
}

impl<S: Simd, const FUSED: bool> Neg for Wide<S, FUSED> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let value = self.simd.neg_f64s(self.value);
        Self { value, ..self }
    }
}

impl<S: Simd, const FUSED: bool> Real for Wide<S, FUSED> {
    type Storage = SplitVec3<Self>;

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::new(self.simd, self.simd.splat_f64s(value))
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        if !FUSED {
            return self * factor + term;
        }
        let value = self.simd.mul_add_f64s(self.value, factor.value, term.value);
        Self { value, ..self }
    }

    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        if !FUSED {
            return term - self * factor;
        }
        let value = self
            .simd
            .negate_mul_add_f64s(self.value, factor.value, term.value);
        Self { value, ..self }
    }
}

/// One number by itself, kept apart from its neighbours: for the one stage that goes from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Single<const FUSED: bool, P = ()> {
    /// The number.
    pub value: f64,
    /// What vectors of such numbers need: a proof that the processor has registers for them.
    pub proof: P,
}

impl<const FUSED: bool, P> Single<FUSED, P> {
    /// A number with its proof.
    #[inline(always)]
    pub fn new(value: f64, proof: P) -> Self {
        Self { value, proof }
    }
}

impl<const FUSED: bool> From<f64> for Single<FUSED> {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Self::new(value, ())
    }
}

impl<const FUSED: bool> From<Single<FUSED>> for f64 {
    #[inline(always)]
    fn from(value: Single<FUSED>) -> Self {
        value.value
    }
}

impl<const FUSED: bool, P> Add for Single<FUSED, P> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            ..self
        }
    }
}

impl<const FUSED: bool, P> Sub for Single<FUSED, P> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            ..self
        }
    }
}

impl<const FUSED: bool, P> Mul for Single<FUSED, P> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            ..self
        }
    }
}

impl<const FUSED: bool, P> Neg for Single<FUSED, P> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            ..self
        }
    }
}

impl<const FUSED: bool> Real for Single<FUSED> {
    type Storage = SplitVec3<Self>;

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::from(value)
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        #[cfg(feature = "std")]
        if FUSED {
            return Self::from(self.value.mul_add(factor.value, term.value));
        }
        Self::from(self.value.times_plus(factor.value, term.value))
    }

    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        #[cfg(feature = "std")]
        if FUSED {
            return Self::from((-self.value).mul_add(factor.value, term.value));
        }
        Self::from(self.value.neg_mul_add(factor.value, term.value))
    }
}
