//! Three f64 in one vector register, for one stream on a processor with registers of four.

use wide::f64x4;

use super::vec3::{Select, Vec3Storage};

/// x, y, z in lanes 0 to 2; lane 3 is padding and is never read.
#[derive(Debug, Clone, Copy)]
pub struct PackedVec3(f64x4);

impl Select for PackedVec3 {
    #[inline(always)]
    fn and(self, bits: Self) -> Self {
        Self(self.0 & bits.0)
    }
}

impl Vec3Storage<f64> for PackedVec3 {
    #[inline(always)]
    fn new(x: f64, y: f64, z: f64) -> Self {
        Self(f64x4::from([x, y, z, z]))
    }

    #[inline(always)]
    fn components(self) -> [f64; 3] {
        let [x, y, z, _] = self.0.to_array();
        [x, y, z]
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
        Self(self.0.mul_add(other.0, term.0))
    }

    #[inline(always)]
    fn neg_mul_elem_plus(self, other: Self, term: Self) -> Self {
        Self(self.0.mul_neg_add(other.0, term.0))
    }

    #[inline(always)]
    fn all(value: f64) -> Self {
        Self(f64x4::splat(value))
    }

    #[inline(always)]
    fn cycled(self) -> Self {
        // One shuffle, once the compiler has seen it.
        let [x, y, z, w] = self.0.to_array();
        Self(f64x4::from([y, z, x, w]))
    }

    #[inline(always)]
    fn dot(self, other: Self) -> f64 {
        let [x, y, z, _] = (self.0 * other.0).to_array();
        x + y + z
    }

    #[inline(always)]
    fn cross_plus(self, other: Self, term: Self) -> Self {
        self.cross(other).plus(term)
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
