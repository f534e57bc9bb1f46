//! Registers of four numbers of a processor of level x86-64-v3, in a program compiled for any x86-64.

use pulp::f64x4;
use pulp::x86::V3;

use super::Wider;
use crate::kernel::constants::Constants;
use crate::kernel::number::Real;
use crate::kernel::packed_vec3::{Four, PackedVec3};
use crate::kernel::reconstruct::StrainReconstruction;
use crate::kernel::simd::{Single, Wide};
use crate::kernel::vec3::Vec3;

/// A number with the proof that there are registers for it and its neighbours.
type Number = Single<false, V3>;

/// Constants in registers of four.
#[derive(Debug, Clone)]
pub struct Avx2 {
    v3: V3,
    constants: Constants<Number>,
    strains: StrainReconstruction<Number>,
    kept: [Vec3<Number>; 3],
}

/// Equal where the numbers are that these were made of, which their owner compares.
impl PartialEq for Avx2 {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Wider<f64> for Avx2 {
    const POSSIBLE: bool = true;

    type Number = Number;
    type Proof = V3;

    fn new(constants: &Constants<f64>, strains: &StrainReconstruction<f64>) -> Option<Self> {
        let v3 = V3::try_new()?;
        Some(Self {
            v3,
            constants: constants.map(|value| Single::new(value, v3)),
            strains: strains.map(|value| Single::new(value, v3)),
            kept: [Vec3::all(Single::new(0.0, v3)); 3],
        })
    }

    #[inline(always)]
    fn constants(&self) -> &Constants<Number> {
        &self.constants
    }

    #[inline(always)]
    fn strains(&self) -> &StrainReconstruction<Number> {
        &self.strains
    }

    #[inline(always)]
    fn proof(&self) -> V3 {
        self.v3
    }

    #[inline(always)]
    fn run<A>(v3: V3, work: impl FnOnce() -> A) -> A {
        v3.vectorize(work)
    }

    #[inline(always)]
    fn widen(&self) -> impl Fn(f64) -> Number + Copy + use<> {
        let v3 = self.v3;
        move |value| Single::new(value, v3)
    }

    #[inline(always)]
    fn narrow(number: Number) -> f64 {
        number.value
    }

    #[inline(always)]
    fn keep(&mut self, ground: [Vec3<Number>; 3]) {
        self.kept = ground;
    }

    #[inline(always)]
    fn kept(&self) -> [Vec3<f64>; 3] {
        self.kept.map(|v| v.map(Self::narrow))
    }
}

impl Real for Number {
    type Storage = PackedVec3<Wide<V3, false>>;

    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self { value, ..self }
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn neg_mul_add(self, factor: Self, term: Self) -> Self {
        term - self * factor
    }
}

impl Four<Number> for Wide<V3, false> {
    const ORDER_OF_SPLIT: bool = true;

    #[inline(always)]
    fn all(number: Number) -> Self {
        Self::new(number.proof, number.proof.splat_f64x4(number.value))
    }

    #[inline(always)]
    fn from_lanes([a, b, c, d]: [Number; 4]) -> Self {
        Self::new(a.proof, f64x4(a.value, b.value, c.value, d.value))
    }

    #[inline(always)]
    fn lanes(self) -> [Number; 4] {
        let (v3, f64x4(a, b, c, d)) = self.parts();
        [
            Single::new(a, v3),
            Single::new(b, v3),
            Single::new(c, v3),
            Single::new(d, v3),
        ]
    }
}
