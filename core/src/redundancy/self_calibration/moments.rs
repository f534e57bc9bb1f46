//! A recording as means and products of its block means: all that the ratios need, in constant memory.
//!
//! Samples are averaged over blocks first. Noise in the regressors then falls with the block's length and its bias with it,
//! noise that is correlated over less than a block is white again, and a sample costs nine multiplications and, for its second differences, nine more. Motion faster than
//! a block is lost, which costs information and nothing else: the equations are linear but for their second order, whose
//! mean is taken at the mean.
//!
//! The second order is known well enough from the calibration that is to be checked: it is some hundred-thousandths of a force, and a scale
//! factor that is off by a per cent changes it by a per cent of that.

use nalgebra::{SMatrix, SVector};

use super::ratios::{Limits, ScaleRatios};
use crate::error::{Error, Result};
use crate::geometry::LIMBS;
use crate::kernel::constants::Constants;
use crate::kernel::order::from_kernel_order;
use crate::kernel::placement::{OVERSTRAIN, refuse};
use crate::model::{Model, Parameters, Sensor, Settings};
use crate::redundancy::parity::{ROWS, SIGNATURES};
use crate::redundancy::residual;

/// Strains and, behind them, what the rows have of second order.
pub(super) const COLUMNS: usize = LIMBS + ROWS;
/// Time over which samples are averaged unless somebody says otherwise, s.
pub const BLOCK_S: f64 = 0.01;

pub(super) type Products = SMatrix<f64, COLUMNS, COLUMNS>;
/// A block's strains and second orders. Arrays here: the library's products may panic as far as the linker can see.
type Row = [f64; COLUMNS];
type Sums = [Row; COLUMNS];

/// Takes a recording sample by sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Accumulator {
    constants: Constants<f64>,
    strain_per_v: [f64; LIMBS],
    strain_at_zero: [f64; LIMBS],
    block: u32,
    filled: u32,
    sum: [f64; LIMBS],
    /// The last two samples' strains, and the sum of squares of second differences.
    last: [[f64; LIMBS]; 2],
    roughness: [f64; LIMBS],
    samples: usize,
    blocks: u64,
    /// First block: what the others are counted from, so that a large offset swallows no digits.
    origin: Row,
    /// The block before, from there.
    before: Row,
    mean: Row,
    scatter: Sums,
    lagged: Sums,
}

impl Accumulator {
    /// For a sensor with the calibration that is to be checked; `block` samples are averaged (0 counts as 1).
    /// [`Self::of_usual_blocks`] chooses.
    ///
    /// `settings` say the sign of (2) and, for a tared signal, gravity at rest, whose share of the second order is otherwise lost.
    ///
    /// # Errors
    /// Those of [`crate::Decoupler::new`].
    pub fn new(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        block: u32,
    ) -> Result<Self> {
        let constants = Constants::new(&Model::new(sensor, parameters, settings)?)?;
        Ok(Self {
            strain_per_v: from_kernel_order(constants.strain_per_v),
            strain_at_zero: from_kernel_order(constants.strain_at_zero),
            constants,
            block: block.max(1),
            filled: 0,
            sum: [0.0; LIMBS],
            last: [[0.0; LIMBS]; 2],
            roughness: [0.0; LIMBS],
            samples: 0,
            blocks: 0,
            origin: [0.0; COLUMNS],
            before: [0.0; COLUMNS],
            mean: [0.0; COLUMNS],
            scatter: [[0.0; COLUMNS]; COLUMNS],
            lagged: [[0.0; COLUMNS]; COLUMNS],
        })
    }

    /// As [`Self::new`], with blocks of [`BLOCK_S`].
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_usual_blocks(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
    ) -> Result<Self> {
        // A float to integer conversion stops at the largest.
        let block = (BLOCK_S * settings.sample_rate_hz) as u32;
        Self::new(sensor, parameters, settings, block)
    }

    /// Samples averaged to one block.
    #[must_use]
    pub const fn block(&self) -> u32 {
        self.block
    }

    /// Samples taken so far.
    #[must_use]
    pub const fn samples(&self) -> usize {
        self.samples
    }

    /// Takes one sample, V. Neither allocates nor panics.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::Overstrained`]: the sample is not taken.
    #[inline]
    pub fn push(&mut self, voltage_v: &[f64; LIMBS]) -> Result<()> {
        let mut strain = [0.0; LIMBS];
        let mut sound = true;
        for (((x, u), slope), zero) in strain
            .iter_mut()
            .zip(voltage_v)
            .zip(&self.strain_per_v)
            .zip(&self.strain_at_zero)
        {
            *x = u * slope + zero;
            sound &= x.abs() < OVERSTRAIN;
        }
        if !sound {
            return self.refused(voltage_v);
        }
        for (sum, x) in self.sum.iter_mut().zip(strain) {
            *sum += x;
        }
        if self.samples >= 2 {
            let [before, last] = &self.last;
            for (((rough, x), b), a) in self.roughness.iter_mut().zip(strain).zip(last).zip(before)
            {
                let bend = (x - b) - (b - a);
                *rough += bend * bend;
            }
        }
        self.last = [self.last[1], strain];
        self.samples += 1;
        self.filled += 1;
        if self.filled == self.block {
            self.close_block();
        }
        Ok(())
    }

    #[cold]
    fn refused(&self, voltage_v: &[f64; LIMBS]) -> Result<()> {
        refuse(&self.constants, voltage_v, self.samples)
    }

    fn close_block(&mut self) {
        let strain = self.sum.map(|sum| sum / f64::from(self.block));
        self.sum = [0.0; LIMBS];
        self.filled = 0;
        let left = residual(&strain, self.constants.nu);
        let mut sums = [0.0; ROWS];
        for (x, signature) in strain.iter().zip(SIGNATURES) {
            for (sum, in_row) in sums.iter_mut().zip(signature) {
                *sum += x * f64::from(in_row);
            }
        }
        let mut row = [0.0; COLUMNS];
        let second_order = sums.into_iter().zip(left).map(|(sum, left)| sum - left);
        for (place, x) in row.iter_mut().zip(strain.into_iter().chain(second_order)) {
            *place = x;
        }
        if self.blocks == 0 {
            self.origin = row;
        }
        self.blocks += 1;
        let share = 1.0 / self.blocks as f64;
        let (mut from_old, mut from_new) = ([0.0; COLUMNS], [0.0; COLUMNS]);
        for (((x, origin), mean), (old, new)) in row
            .iter_mut()
            .zip(self.origin)
            .zip(&mut self.mean)
            .zip(from_old.iter_mut().zip(&mut from_new))
        {
            *x -= origin;
            *old = *x - *mean;
            *mean += *old * share;
            *new = *x - *mean;
        }
        add_product(&mut self.scatter, &from_old, &from_new);
        add_product(&mut self.lagged, &row, &self.before);
        self.before = row;
    }

    /// The moments of all whole blocks.
    #[must_use]
    pub fn moments(&self) -> Moments {
        let n = self.blocks as f64;
        let (mean, last) = (SVector::from(self.mean), SVector::from(self.before));
        let matrix = |sums: &Sums| Products::from_fn(|i, j| sums[i][j]);
        let scatter = matrix(&self.scatter);
        // sum (row_t - mean)(row_(t-1) - mean)^T; the first row is the origin.
        let lagged = matrix(&self.lagged)
            - (mean * n) * mean.transpose()
            - mean * (mean * n - last).transpose()
            + mean * mean.transpose() * (n - 1.0);
        Moments {
            scatter: (scatter + scatter.transpose()) * 0.5,
            lagged: (lagged + lagged.transpose()) * 0.5,
            blocks: self.blocks,
            records: 1,
            roughness: self.roughness,
        }
    }

    /// Scale ratios from what has been taken so far: equals [`Self::moments`]'s [`Moments::ratios`].
    ///
    /// # Errors
    /// Those of [`Moments::ratios`].
    pub fn ratios(&self, limits: &Limits) -> Result<ScaleRatios> {
        self.moments().ratios(limits)
    }
}

fn add_product(sums: &mut Sums, a: &Row, b: &Row) {
    for (sums, a) in sums.iter_mut().zip(a) {
        for (sum, b) in sums.iter_mut().zip(b) {
            *sum += a * b;
        }
    }
}

/// Second moments of one or more recordings' block means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// sum (z - mean)(z - mean)^T over blocks.
    pub(super) scatter: Products,
    /// The same of neighbouring blocks, made symmetric.
    pub(super) lagged: Products,
    /// Blocks.
    pub(super) blocks: u64,
    /// Recordings, each with a mean of its own.
    pub(super) records: u64,
    /// Sum of squares of the samples' second differences, strain^2: compares the noise of the two limbs of an ambiguous pair.
    pub(super) roughness: [f64; LIMBS],
}

impl Moments {
    /// Of a whole recording at hand: bit for bit what an [`Accumulator`] finds sample by sample.
    ///
    /// # Errors
    /// Those of [`Accumulator::of_usual_blocks`] and [`Accumulator::push`].
    pub fn of(
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        voltage_v: &[[f64; LIMBS]],
    ) -> Result<Self> {
        let mut taken = Accumulator::of_usual_blocks(sensor, parameters, settings)?;
        for sample in voltage_v {
            taken.push(sample)?;
        }
        Ok(taken.moments())
    }

    /// Together with another recording, taken with the same calibration, gains and block length. Either keeps zero drifts of
    /// its own: each may have been tared anew.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self {
            scatter: self.scatter + other.scatter,
            lagged: self.lagged + other.lagged,
            blocks: self.blocks + other.blocks,
            records: self.records + other.records,
            roughness: core::array::from_fn(|i| self.roughness[i] + other.roughness[i]),
        }
    }

    /// Blocks.
    #[must_use]
    pub const fn blocks(&self) -> u64 {
        self.blocks
    }

    /// The same without the second order: what a sensor of infinitely stiff limbs would show. For comparisons.
    #[must_use]
    pub fn to_first_order(&self) -> Self {
        let cut = |m: &Products| {
            Products::from_fn(|i, j| {
                if i < LIMBS && j < LIMBS {
                    m[(i, j)]
                } else {
                    0.0
                }
            })
        };
        Self {
            scatter: cut(&self.scatter),
            lagged: cut(&self.lagged),
            ..*self
        }
    }

    /// Ratios of the scale factors, c_i over the calibration's.
    ///
    /// # Errors
    /// [`Error::TooFewSamples`]; [`Error::UnobservableScaleRatios`] where the motion does not tell all of them as well as `limits` ask;
    /// [`Error::NotConverged`]; [`Error::Overflow`] for voltages whose squares no f64 holds.
    pub fn ratios(&self, limits: &Limits) -> Result<ScaleRatios> {
        limits.validate()?;
        if !self.scatter.iter().all(|x| x.is_finite()) {
            return Err(Error::overflow("scale ratios", 0));
        }
        super::fit::fit(self, limits)
    }
}
