//! Series of numbers and vectors of a block, eight segments side by side.

use crate::kernel::number::Real;
use crate::kernel::simd::{LANES, Register, Row};
use crate::kernel::vec3::{Vec3, vec3};

/// Samples of each lane of a block.
pub const STEPS: usize = 16;

/// One number of every sample of a block, one row a step: first the ghost rows, which repeat the end of the segment before,
/// then the block's own.
pub type Series<const ROWS: usize> = [Row; ROWS];
/// Three of them: the components of vectors.
#[derive(Clone, Copy)]
pub struct Vectors<const ROWS: usize> {
    x: Series<ROWS>,
    y: Series<ROWS>,
    z: Series<ROWS>,
}

pub const fn zeros<const ROWS: usize>() -> Vectors<ROWS> {
    Vectors {
        x: [Row::ZERO; ROWS],
        y: [Row::ZERO; ROWS],
        z: [Row::ZERO; ROWS],
    }
}

impl<const ROWS: usize> Vectors<ROWS> {
    #[inline(always)]
    pub fn load<R: Register>(&self, proof: R::Proof, row: usize, part: usize) -> Vec3<R> {
        vec3(
            R::load(proof, &self.x[row], part),
            R::load(proof, &self.y[row], part),
            R::load(proof, &self.z[row], part),
        )
    }

    #[inline(always)]
    pub fn store<R: Register>(&mut self, row: usize, part: usize, v: Vec3<R>) {
        let [x, y, z] = v.components();
        x.store(&mut self.x[row], part);
        y.store(&mut self.y[row], part);
        z.store(&mut self.z[row], part);
    }

    #[inline(always)]
    pub fn get<T: Real + From<f64>>(&self, row: usize, lane: usize) -> Vec3<T> {
        vec3(
            self.x[row].0[lane].into(),
            self.y[row].0[lane].into(),
            self.z[row].0[lane].into(),
        )
    }

    #[inline(always)]
    pub fn set<T: Real + Into<f64>>(&mut self, row: usize, lane: usize, v: Vec3<T>) {
        let [x, y, z] = v.components();
        self.x[row].0[lane] = x.into();
        self.y[row].0[lane] = y.into();
        self.z[row].0[lane] = z.into();
    }

    /// Fills the ghost rows of each segment from the end of the one before; the first segment's come from `before`,
    /// oldest first.
    #[inline(always)]
    pub fn fill_ghosts<const GHOSTS: usize>(&mut self, before: [Vec3<f64>; GHOSTS]) {
        for (ghost, first) in before.into_iter().enumerate() {
            for series in [&mut self.x, &mut self.y, &mut self.z] {
                let Row(last) = series[STEPS + ghost];
                series[ghost].0[1..].copy_from_slice(&last[..LANES - 1]);
            }
            self.set(ghost, 0, first);
        }
    }
}
