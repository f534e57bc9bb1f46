//! Series of numbers, vectors and quaternions of a block, in the order of time.

use crate::kernel::attitude::Quaternion;
use crate::kernel::number::Real;
use crate::kernel::simd::{LANES, Register};
use crate::kernel::vec3::{Vec3, vec3};

/// Samples of a block.
pub const BLOCK: usize = 128;
/// Where a block's first sample stands; before it the last ones of the block before. As many as make a cache line.
pub const FIRST: usize = LANES;

/// One number of every sample of a block, behind some of the block before.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct Series(pub [f64; FIRST + BLOCK]);

impl Series {
    #[inline(always)]
    pub fn load<R: Register>(&self, proof: R::Proof, at: usize) -> R {
        R::load_at(proof, &self.0, at)
    }

    #[inline(always)]
    pub fn store<R: Register>(&mut self, at: usize, value: R) {
        value.store_at(&mut self.0, at);
    }

    /// Whether every number of the block is; NaN is not.
    #[inline(always)]
    pub fn all_at_most(&self, limit: f64) -> bool {
        let block = self.0[FIRST..].iter();
        block.fold(true, |all, value| all & (*value <= limit))
    }
}

/// A number throughout.
pub const fn all(number: f64) -> Series {
    Series([number; FIRST + BLOCK])
}

/// Three of them: the components of vectors.
#[derive(Clone, Copy)]
pub struct Vectors {
    x: Series,
    y: Series,
    z: Series,
}

/// The zero vector throughout.
pub const ZEROS: Vectors = Vectors {
    x: all(0.0),
    y: all(0.0),
    z: all(0.0),
};

impl Vectors {
    #[inline(always)]
    pub fn load<R: Register>(&self, proof: R::Proof, at: usize) -> Vec3<R> {
        vec3(
            self.x.load(proof, at),
            self.y.load(proof, at),
            self.z.load(proof, at),
        )
    }

    #[inline(always)]
    pub fn store<R: Register>(&mut self, at: usize, v: Vec3<R>) {
        let [x, y, z] = v.components();
        self.x.store(at, x);
        self.y.store(at, y);
        self.z.store(at, z);
    }

    #[inline(always)]
    pub fn get<T: Real + From<f64>>(&self, at: usize) -> Vec3<T> {
        vec3(
            self.x.0[at].into(),
            self.y.0[at].into(),
            self.z.0[at].into(),
        )
    }

    #[inline(always)]
    pub fn set<T: Real + Into<f64>>(&mut self, at: usize, v: Vec3<T>) {
        let [x, y, z] = v.components();
        self.x.0[at] = x.into();
        self.y.0[at] = y.into();
        self.z.0[at] = z.into();
    }
}

/// Quaternions.
#[derive(Clone, Copy)]
pub struct Quaternions {
    w: Series,
    v: Vectors,
}

/// No rotation throughout.
pub const IDENTITIES: Quaternions = Quaternions {
    w: all(1.0),
    v: ZEROS,
};

impl Quaternions {
    #[inline(always)]
    pub fn load<R: Register>(&self, proof: R::Proof, at: usize) -> Quaternion<R> {
        Quaternion {
            w: self.w.load(proof, at),
            v: self.v.load(proof, at),
        }
    }

    #[inline(always)]
    pub fn store<R: Register>(&mut self, at: usize, q: Quaternion<R>) {
        self.w.store(at, q.w);
        self.v.store(at, q.v);
    }
}
