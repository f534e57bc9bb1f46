//! Three numbers in one vector register, for one stream on a processor with registers of four.

use wide::f64x4;

use super::number::Real;
use super::vec3::{Select, Vec3Storage};

/// x, y, z in lanes 0 to 2; lane 3 is padding and is never read.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub struct PackedVec3<F>(F);

/// Four numbers of type `T` in one register.
pub trait Four<T>: Real {
    /// Whether sums are taken in the order of [`super::vec3::SplitVec3`].
    const ORDER_OF_SPLIT: bool;
    /// The same number in each lane.
    fn all(number: T) -> Self;
    /// One number a lane.
    fn from_lanes(numbers: [T; 4]) -> Self;
    /// One number a lane.
    fn lanes(self) -> [T; 4];
}

impl Four<f64> for f64x4 {
    const ORDER_OF_SPLIT: bool = cfg!(not(target_feature = "avx"));

    #[inline(always)]
    fn all(number: f64) -> Self {
        Self::splat(number)
    }

    #[inline(always)]
    fn from_lanes(numbers: [f64; 4]) -> Self {
        Self::from(numbers)
    }

    #[inline(always)]
    fn lanes(self) -> [f64; 4] {
        self.to_array()
    }
}

impl Select for PackedVec3<f64x4> {
    #[inline(always)]
    fn and(self, bits: Self) -> Self {
        Self(self.0 & bits.0)
    }
}

impl<T: Real, F: Four<T>> Vec3Storage<T> for PackedVec3<F> {
    #[inline(always)]
    fn new(x: T, y: T, z: T) -> Self {
        Self(F::from_lanes([x, y, z, z]))
    }

    #[inline(always)]
    fn components(self) -> [T; 3] {
        let [x, y, z, _] = self.0.lanes();
        [x, y, z]
    }

    #[inline(always)]
    fn padded(self) -> [T; 4] {
        self.0.lanes()
    }

    #[inline(always)]
    fn from_padded(lanes: [T; 4]) -> Self {
        Self(F::from_lanes(lanes))
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }

    #[inline(always)]
    fn mul_elem(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }

    #[inline(always)]
    fn mul_elem_plus(self, other: Self, term: Self) -> Self {
        Self(self.0.times_plus(other.0, term.0))
    }

    #[inline(always)]
    fn neg_mul_elem_plus(self, other: Self, term: Self) -> Self {
        Self(self.0.neg_mul_add(other.0, term.0))
    }

    #[inline(always)]
    fn all(value: T) -> Self {
        Self(F::all(value))
    }

    #[inline(always)]
    fn cycled(self) -> Self {
        // One shuffle, once the compiler has seen it.
        let [x, y, z, w] = self.0.lanes();
        Self(F::from_lanes([y, z, x, w]))
    }

    #[inline(always)]
    fn dot(self, other: Self) -> T {
        let [x, y, z, _] = (self.0 * other.0).lanes();
        x + y + z
    }

    #[inline(always)]
    fn cross_plus(self, other: Self, term: Self) -> Self {
        if !F::ORDER_OF_SPLIT {
            return self.cross(other).plus(term);
        }
        // One shuffle more, none of them at the end, and those of a vector in several products are done once.
        let (yzx, other_yzx) = (self.cycled(), other.cycled());
        let less = yzx.cycled().neg_mul_elem_plus(other_yzx, term);
        yzx.mul_elem_plus(other_yzx.cycled(), less)
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        other
            .neg_mul_elem_plus(self.cycled(), self.mul_elem(other.cycled()))
            .cycled()
    }

    #[inline(always)]
    fn moment([a, b, c]: [Self; 3]) -> Self {
        let [ax, ay, _] = a.components();
        let [bx, _, bz] = b.components();
        let [_, cy, cz] = c.components();
        Self::new(ay, cz, bx).minus(Self::new(bz, ax, cy))
    }
}
