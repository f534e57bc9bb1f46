//! One trial's part in the normal equations, its latent motion eliminated.
//!
//! Gauss-Newton's normal matrix is an arrow: the motion of a trial and what else it has for itself touch no other trial, so they
//! are eliminated here (Schur complement) and what remains is a matrix in the common unknowns alone. Its inverse is the
//! Cramer-Rao bound of the common unknowns with the motion unknown.

use alloc::vec::Vec;

use nalgebra::{Cholesky, Complex, DMatrix, DVector, Dyn};
use pulp::Arch;

use super::motion::Operator;
use super::own::Own;
use super::standard::Standard;
use super::trial::{Drive, Parts, Trial};
use super::unknowns::{GYROSCOPE_LAG, Unknowns};
use crate::geometry::LIMBS;
use crate::identify::static_load_sharing::StaticLoadSharing;

/// What a trial adds to the normal equations, and what it takes to go back to its own unknowns.
pub(super) struct Contribution {
    pub information: DMatrix<f64>,
    /// Minus half the gradient of the sum of squares.
    pub descent: DVector<f64>,
    pub squares: f64,
    own: Option<Eliminated>,
    seen: MotionFree,
}

/// Unknowns eliminated from the normal equations: their factored information, what couples them to the rest, their descent.
type Eliminated = (Cholesky<f64, Dyn>, DMatrix<f64>, DVector<f64>);

/// The trial's part with its motion eliminated and its other own unknowns still in it, nothing known of these beforehand.
struct MotionFree {
    information: DMatrix<f64>,
    descent: DVector<f64>,
    squares: f64,
    latent: Cholesky<f64, Dyn>,
    coupling: DMatrix<f64>,
    latent_descent: DVector<f64>,
}

/// The arrow before elimination: common unknowns and own ones, the motion, and what couples them.
struct Arrow {
    information: DMatrix<f64>,
    descent: DVector<f64>,
    own: DMatrix<f64>,
    own_descent: DVector<f64>,
    coupling: DMatrix<f64>,
    squares: f64,
}

impl Trial {
    /// The trial's part at the present unknowns, common and own.
    ///
    /// None if the motion is not determined by the data, which no data with noise leave open, or if the limbs' stiffnesses do not
    /// hold the mass.
    pub fn contribution(
        &self,
        unknowns: &Unknowns,
        shares: &StaticLoadSharing,
    ) -> Option<Contribution> {
        let seen = self.arrow(unknowns, shares)?.without_motion()?;
        seen.contribution(&self.own, unknowns.len())
    }

    fn arrow(&self, unknowns: &Unknowns, shares: &StaticLoadSharing) -> Option<Arrow> {
        let outer = unknowns.len() + self.own.len();
        let count = self.latent.len();
        let mut arrow = Arrow {
            information: DMatrix::zeros(outer, outer),
            descent: DVector::zeros(outer),
            own: DMatrix::zeros(count, count),
            own_descent: DVector::zeros(count),
            coupling: DMatrix::zeros(count, outer),
            squares: 0.0,
        };
        let parts = self.parts(unknowns, shares)?;
        Arch::new().dispatch(|| arrow.add_channels(self, unknowns, &parts));
        arrow.add_standard(self, unknowns);
        Some(arrow)
    }

    /// Moves the trial's own unknowns along with a step of the common ones.
    pub fn follow(&mut self, contribution: &Contribution, step: &DVector<f64>, share: f64) {
        let mut whole = step.clone();
        if let Some(changes) = contribution.own_step(step) {
            for (own, change) in self.own.iter_mut().zip(changes.iter()) {
                own.value += share * change;
            }
            let common = step.len();
            whole = whole.resize_vertically(common + changes.len(), 0.0);
            whole.rows_mut(common, changes.len()).copy_from(&changes);
        }
        let seen = &contribution.seen;
        let change = seen
            .latent
            .solve(&(&seen.latent_descent - &seen.coupling * &whole));
        self.latent.axpy(share, &change, 1.0);
    }
}

impl Contribution {
    /// The same with other spreads of the own unknowns.
    pub fn repriced(self, own: &[Own]) -> Option<Self> {
        let common = self.descent.len();
        self.seen.contribution(own, common)
    }

    /// The own unknowns' part of a step of the common ones.
    pub fn own_step(&self, step: &DVector<f64>) -> Option<DVector<f64>> {
        let (factor, across, down) = self.own.as_ref()?;
        Some(factor.solve(&(down - across * step)))
    }

    /// Variances of the trial's own unknowns but the motion, given the covariance of the common ones.
    pub fn own_variances(&self, common: &DMatrix<f64>) -> Vec<f64> {
        let Some((factor, across, _)) = &self.own else {
            return Vec::new();
        };
        let slopes = factor.solve(across);
        let spread = &slopes * common;
        let alone = factor.inverse();
        (0..alone.nrows())
            .map(|i| alone[(i, i)] + spread.row(i).dot(&slopes.row(i)))
            .collect()
    }
}

impl MotionFree {
    /// With what is known of the own unknowns beforehand, and these eliminated.
    fn contribution(self, own: &[Own], common: usize) -> Option<Contribution> {
        let block = |row: usize, column: usize, (rows, columns): (usize, usize)| {
            let mut block = DMatrix::zeros(rows, columns);
            for c in 0..columns {
                let whole = self.information.column(column + c);
                let part = &whole.as_slice()[row..row + rows];
                block.column_mut(c).as_mut_slice().copy_from_slice(part);
            }
            block
        };
        let count = own.len();
        let mut information = block(0, 0, (common, common));
        let mut descent = self.descent.rows(0, common).clone_owned();
        let mut squares = self.squares;
        let mut eliminated = None;
        if count > 0 {
            let mut of_own = block(common, common, (count, count));
            let mut down = self.descent.rows(common, count).clone_owned();
            for (place, own) in own.iter().enumerate() {
                let weight = 1.0 / (own.deviation * own.deviation);
                of_own[(place, place)] += weight;
                down[place] -= weight * own.value;
                squares += weight * own.value * own.value;
            }
            let factor = Cholesky::new(of_own)?;
            let across = block(common, 0, (count, common));
            eliminate(&factor, &across, &down, &mut information, &mut descent);
            eliminated = Some((factor, across, down));
        }
        Some(Contribution {
            information,
            descent,
            squares,
            own: eliminated,
            seen: self,
        })
    }
}

impl Arrow {
    #[inline(always)]
    fn add_channels(&mut self, trial: &Trial, unknowns: &Unknowns, parts: &Parts) {
        let all = parts.all.len();
        let gram = DMatrix::from_fn(all, all, |a, b| parts.all[a].dot(&parts.all[b]));
        let seen: Vec<Vec<DVector<f64>>> = parts
            .by_latent
            .iter()
            .map(|o| parts.all.iter().map(|p| o.transposed_times(p)).collect())
            .collect();
        let series = parts.by_latent.len();
        let mut pairs = DMatrix::<f64>::zeros(series, series);
        for limb in 0..LIMBS {
            let weight = 1.0 / trial.noise_variance(limb);
            let gain = trial.volts_per_force(unknowns, limb);
            let columns = trial.columns(unknowns, parts, limb);
            let residual =
                trial.shown(unknowns, limb).as_ref() - trial.prediction(unknowns, parts, limb);
            self.squares += weight * residual.norm_squared();
            let toward = DVector::from_iterator(all, parts.all.iter().map(|p| p.dot(&residual)));
            // Columns as combinations of the parts, so that the parts' products serve all of them.
            let mut of_parts = DMatrix::<f64>::zeros(all, columns.len());
            for (place, (_, combination)) in columns.iter().enumerate() {
                for (part, factor) in combination {
                    of_parts[(*part, place)] += factor;
                }
            }
            let products = of_parts.tr_mul(&(&gram * &of_parts));
            let descents = of_parts.tr_mul(&toward);
            for (i, (a, _)) in columns.iter().enumerate() {
                self.descent[*a] += weight * descents[i];
                for (j, (b, _)) in columns.iter().enumerate() {
                    self.information[(*a, *b)] += weight * products[(i, j)];
                }
            }
            for (m, share) in parts.shares.iter().enumerate() {
                let by_latent = gain * share.value[limb];
                let toward = parts.by_latent[m].transposed_times(&residual);
                self.own_descent.axpy(weight * by_latent, &toward, 1.0);
                for (a, from_a) in &columns {
                    let mut column = self.coupling.column_mut(*a);
                    for (s, c) in from_a {
                        column.axpy(weight * by_latent * c, &seen[m][*s], 1.0);
                    }
                }
                for (l, other) in parts.shares.iter().enumerate() {
                    pairs[(m, l)] += weight * by_latent * gain * other.value[limb];
                }
            }
        }
        for m in 0..series {
            for l in m..series {
                Operator::add_gram(
                    &parts.by_latent[m],
                    &parts.by_latent[l],
                    m == l,
                    pairs[(m, l)],
                    &mut self.own,
                );
            }
        }
    }

    /// The standard; its mean is its own offset and says nothing, but where the ends at rest tell the two apart.
    fn add_standard(&mut self, trial: &Trial, unknowns: &Unknowns) {
        let Standard {
            response,
            by_lag,
            gain,
        } = trial.standard(unknowns);
        let reading = 1.0 + unknowns.values[gain];
        let weight = 1.0 / trial.noise_variance(LIMBS);
        let shown = &trial.data.coordinates[LIMBS];
        if let Some(mean) = trial.mean_shown() {
            let at = 2 * trial.grid.harmonics;
            let weight = 1.0 / (mean.deviation * mean.deviation);
            let by_gain = trial.latent[at];
            let residual = mean.value - reading * by_gain;
            self.squares += weight * residual * residual;
            self.own[(at, at)] += weight * reading * reading;
            self.own_descent[at] += weight * reading * residual;
            self.coupling[(at, gain)] += weight * reading * by_gain;
            self.information[(gain, gain)] += weight * by_gain * by_gain;
            self.descent[gain] += weight * by_gain * residual;
        }
        for k in 0..trial.grid.harmonics {
            let q = Complex::new(trial.latent[2 * k], trial.latent[2 * k + 1]);
            let by_latent = response[k] * reading;
            let residual = Complex::new(shown[2 * k + 1], shown[2 * k + 2]) - by_latent * q;
            self.squares += weight * residual.norm_sqr();
            let own = weight * by_latent.norm_sqr();
            let toward = by_latent.conj() * residual * weight;
            for (part, toward) in [toward.re, toward.im].into_iter().enumerate() {
                self.own[(2 * k + part, 2 * k + part)] += own;
                self.own_descent[2 * k + part] += toward;
            }
            let by_gain = (gain, response[k] * q);
            let by_lag = (GYROSCOPE_LAG, by_lag[k] * q * reading);
            let columns: &[(usize, Complex<f64>)] = match trial.drive {
                Drive::Linear => &[by_gain],
                Drive::Angular => &[by_gain, by_lag],
            };
            for (a, slope_a) in columns {
                self.descent[*a] += weight * (slope_a.conj() * residual).re;
                let coupled = by_latent.conj() * slope_a * weight;
                self.coupling[(2 * k, *a)] += coupled.re;
                self.coupling[(2 * k + 1, *a)] += coupled.im;
                for (b, slope_b) in columns {
                    self.information[(*a, *b)] += weight * (slope_a.conj() * slope_b).re;
                }
            }
        }
    }

    /// Takes the motion out.
    fn without_motion(mut self) -> Option<MotionFree> {
        let latent = Cholesky::new(self.own)?;
        eliminate(
            &latent,
            &self.coupling,
            &self.own_descent,
            &mut self.information,
            &mut self.descent,
        );
        Some(MotionFree {
            information: self.information,
            descent: self.descent,
            squares: self.squares,
            latent,
            coupling: self.coupling,
            latent_descent: self.own_descent,
        })
    }
}

/// Takes the Schur complement of eliminated unknowns, B^T A^-1 B with A = L L^T, as the square of L^-1 B: half the triangular
/// systems, and symmetric to the bit.
fn eliminate(
    factor: &Cholesky<f64, Dyn>,
    coupling: &DMatrix<f64>,
    down: &DVector<f64>,
    information: &mut DMatrix<f64>,
    descent: &mut DVector<f64>,
) {
    let lower = factor.l_dirty();
    // A trial has no part in unknowns of other wedges and of the other drive.
    let touched: Vec<usize> = (0..coupling.ncols())
        .filter(|c| coupling.column(*c).as_slice().iter().any(|x| *x != 0.0))
        .collect();
    if touched.is_empty() {
        return;
    }
    // Transposed: all of them go down the factor side by side, and the product of two matrices is blocked for the caches, where that with
    // a transpose is not.
    let mut transposed = coupling.select_columns(&touched).transpose();
    Arch::new().dispatch(|| solve_lower(lower, &mut transposed));
    let across = transposed.transpose();
    let mut down = down.clone();
    lower.solve_lower_triangular_unchecked_mut(&mut down);
    let taken = &transposed * &across;
    for (place, column) in touched.iter().enumerate() {
        descent[*column] -= across.column(place).dot(&down);
        let mut whole = information.column_mut(*column);
        let whole = whole.as_mut_slice();
        for (row, taken) in touched.iter().zip(taken.column(place).as_slice()) {
            whole[*row] -= taken;
        }
    }
}

/// Solves L x = b for each row b of a matrix. A factor with nothing beside its diagonal, as that of a linear trial, costs next to nothing.
#[inline(always)]
fn solve_lower(lower: &DMatrix<f64>, rows: &mut DMatrix<f64>) {
    let width = rows.nrows();
    let values = rows.as_mut_slice();
    for at in 0..lower.nrows() {
        let (before, from_here) = values.split_at_mut(at * width);
        let here = &mut from_here[..width];
        let beside = lower.row(at);
        let mut of_four = before.chunks_exact(4 * width);
        for (group, known) in of_four.by_ref().enumerate() {
            let [a, b, c, d] = core::array::from_fn(|i| beside[4 * group + i]);
            if [a, b, c, d] == [0.0; 4] {
                continue;
            }
            let (first, rest) = known.split_at(width);
            let (second, rest) = rest.split_at(width);
            let (third, fourth) = rest.split_at(width);
            let known = first.iter().zip(second).zip(third.iter().zip(fourth));
            for (x, ((first, second), (third, fourth))) in here.iter_mut().zip(known) {
                *x = *x - a * first - b * second - c * third - d * fourth;
            }
        }
        let rest = of_four.remainder().chunks_exact(width);
        for (known, factor) in rest.zip(beside.iter().skip(at / 4 * 4)) {
            for (x, known) in here.iter_mut().zip(known) {
                *x -= factor * known;
            }
        }
        let diagonal = beside[at];
        here.iter_mut().for_each(|x| *x /= diagonal);
    }
}

#[cfg(test)]
mod tests;
