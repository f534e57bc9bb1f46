//! One trial's part in the normal equations, its latent motion eliminated.
//!
//! Gauss-Newton's normal matrix is an arrow: the motion of a trial and its amplifiers' transients touch no other trial, so they
//! are eliminated here (Schur complement) and what remains is a matrix in the common unknowns alone. Its inverse is the
//! Cramer-Rao bound of the common unknowns with the motion unknown.

use alloc::vec::Vec;

use nalgebra::{Cholesky, Complex, DMatrix, DVector, Dyn};

use super::motion::Operator;
use super::shares::Shares;
use super::trial::{Drive, Parts, Standard, Trial};
use super::unknowns::{GYROSCOPE_LAG, Unknowns};
use crate::geometry::LIMBS;

/// What a trial adds to the normal equations, and what it takes to go back to its own unknowns.
pub(super) struct Contribution {
    pub information: DMatrix<f64>,
    /// Minus half the gradient of the sum of squares.
    pub descent: DVector<f64>,
    pub squares: f64,
    back: Back,
}

/// Unknowns eliminated from the normal equations: their factored information, what couples them to the rest, their descent.
type Eliminated = (Cholesky<f64, Dyn>, DMatrix<f64>, DVector<f64>);

struct Back {
    latent: Cholesky<f64, Dyn>,
    coupling: DMatrix<f64>,
    descent: DVector<f64>,
    transient: Option<Eliminated>,
}

/// The arrow before elimination: common unknowns and transients, the motion, and what couples them.
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
    /// None if the motion is not determined by the data, which no data with noise leave open.
    pub fn contribution(&self, unknowns: &Unknowns, shares: &Shares) -> Option<Contribution> {
        self.arrow(unknowns, shares).eliminate(unknowns.len())
    }

    fn arrow(&self, unknowns: &Unknowns, shares: &Shares) -> Arrow {
        let common = unknowns.len();
        let transients = self.transients();
        let count = 2 * self.grid.harmonics;
        let mut arrow = Arrow {
            information: DMatrix::zeros(common + transients, common + transients),
            descent: DVector::zeros(common + transients),
            own: DMatrix::zeros(count, count),
            own_descent: DVector::zeros(count),
            coupling: DMatrix::zeros(count, common + transients),
            squares: 0.0,
        };
        let parts = self.parts(unknowns, shares);
        arrow.add_channels(self, unknowns, &parts);
        arrow.add_standard(self, unknowns);
        arrow
    }

    /// Moves the trial's own unknowns along with a step of the common ones.
    pub fn follow(&mut self, contribution: &Contribution, step: &DVector<f64>, share: f64) {
        let back = &contribution.back;
        let mut whole = step.clone();
        if let Some((factor, across, down)) = &back.transient {
            let own = factor.solve(&(down - across * step));
            for (b, change) in self.transient.iter_mut().zip(own.iter()) {
                *b += share * change;
            }
            let common = step.len();
            whole = whole.resize_vertically(common + own.len(), 0.0);
            whole.rows_mut(common, own.len()).copy_from(&own);
        }
        let change = back
            .latent
            .solve(&(&back.descent - &back.coupling * &whole));
        self.latent.axpy(share, &change, 1.0);
    }
}

impl Arrow {
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
            let weight = 1.0 / trial.data.variance[limb];
            let gain = trial.volts_per_force(unknowns, limb);
            let columns = trial.columns(unknowns, parts, limb);
            let residual = &trial.data.coordinates[limb] - trial.prediction(unknowns, parts, limb);
            self.squares += weight * residual.norm_squared();
            let toward: Vec<f64> = parts.all.iter().map(|p| p.dot(&residual)).collect();
            for (a, from_a) in &columns {
                self.descent[*a] +=
                    weight * from_a.iter().map(|(s, c)| c * toward[*s]).sum::<f64>();
                for (b, from_b) in &columns {
                    self.information[(*a, *b)] += weight
                        * from_a
                            .iter()
                            .flat_map(|(s, c)| from_b.iter().map(move |(t, d)| (*s, *t, c * d)))
                            .map(|(s, t, product)| product * gram[(s, t)])
                            .sum::<f64>();
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

    /// The standard; its mean is its own offset and says nothing.
    fn add_standard(&mut self, trial: &Trial, unknowns: &Unknowns) {
        let Standard {
            response,
            by_lag,
            gain,
        } = trial.standard(unknowns);
        let reading = 1.0 + unknowns.values[gain];
        let weight = 1.0 / trial.data.variance[LIMBS];
        let shown = &trial.data.coordinates[LIMBS];
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

    /// Takes the motion out, then the transients.
    fn eliminate(mut self, common: usize) -> Option<Contribution> {
        let latent = Cholesky::new(self.own)?;
        let solved = latent.solve(&self.coupling);
        self.information.gemm_tr(-1.0, &self.coupling, &solved, 1.0);
        self.descent.gemv_tr(-1.0, &solved, &self.own_descent, 1.0);
        let transients = self.descent.len() - common;
        let mut information = self
            .information
            .view((0, 0), (common, common))
            .clone_owned();
        let mut descent = self.descent.rows(0, common).clone_owned();
        let transient = if transients == 0 {
            None
        } else {
            let block = (transients, transients);
            let factor =
                Cholesky::new(self.information.view((common, common), block).clone_owned())?;
            let across = self
                .information
                .view((common, 0), (transients, common))
                .clone_owned();
            let down = self.descent.rows(common, transients).clone_owned();
            let solved = factor.solve(&across);
            information.gemm_tr(-1.0, &across, &solved, 1.0);
            descent.gemv_tr(-1.0, &solved, &down, 1.0);
            Some((factor, across, down))
        };
        Some(Contribution {
            information,
            descent,
            squares: self.squares,
            back: Back {
                latent,
                coupling: self.coupling,
                descent: self.own_descent,
                transient,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use glam::DVec3;

    use super::super::harmonics::{Grid, project};
    use super::super::unknowns::{
        ACCELEROMETER_GAIN, AMPLIFIER_CORNER, ANGLES, COMPLIANCE, DRIFT, GYROSCOPE_GAIN, INERTIA,
        MASS_PER_SCALE, WEDGES, Wedge,
    };
    use super::*;
    use crate::geometry::Geometry;
    use crate::scalar::sin_cos;
    use crate::signal::Gains;

    /// Central differences over 1e-4 of an unknown's size leave this of the squares over that size.
    const FINITE_DIFFERENCES: f64 = 1e-5;
    /// Rounds of the motion's own Gauss-Newton: it settles in three.
    const ROUNDS: usize = 8;

    /// Drive, whether gravity turns, whether the amplifiers are high-passes.
    const CASES: [(Drive, bool, bool); 5] = [
        (Drive::Linear, false, false),
        (Drive::Linear, false, true),
        (Drive::Angular, false, false),
        (Drive::Angular, true, false),
        (Drive::Angular, true, true),
    ];

    fn size_of_unknown(u: usize) -> f64 {
        match u {
            u if u < MASS_PER_SCALE => 1.0,
            u if u < INERTIA => 0.2,
            u if u < COMPLIANCE => 2e-4,
            COMPLIANCE => 1e-5,
            _ => 0.1,
        }
    }

    fn trial(drive: Drive, gravity_turns: bool, amplifier: bool) -> (Trial, Unknowns) {
        let grid = Grid {
            samples: 400,
            step_s: 2e-3,
            harmonics: 12,
        };
        let wave = |n: usize, c: usize| {
            let t = n as f64 * grid.step_s;
            let phase = c as f64;
            sin_cos(20.0 * t + phase).0 + 0.3 * sin_cos(47.0 * t - phase).1
        };
        let data = project(&grid, |n| core::array::from_fn(|c| wave(n, c)));
        let wedge = Wedge::new(DVec3::new(1.0, 2.0, 1.0).normalize());
        let mut values = DVector::zeros(WEDGES + ANGLES);
        for limb in 0..LIMBS {
            values[DRIFT + limb] = 0.01 * limb as f64;
            values[MASS_PER_SCALE + limb] = 0.2 + 0.01 * limb as f64;
        }
        for (j, i) in [2.4e-4, 2.5e-4, 2.9e-4, 1e-6, -2e-6, 3e-6]
            .into_iter()
            .enumerate()
        {
            values[INERTIA + j] = i;
        }
        values[COMPLIANCE] = 1e-5;
        values[ACCELEROMETER_GAIN] = 0.01;
        values[GYROSCOPE_GAIN] = -0.02;
        values[GYROSCOPE_LAG] = 0.016;
        values[AMPLIFIER_CORNER] = 0.7;
        values[WEDGES] = 1e-4;
        values[WEDGES + 1] = -2e-4;
        values[WEDGES + 2] = 3e-4;
        let mut trial = Trial {
            drive,
            latent: DVector::zeros(2 * grid.harmonics),
            data,
            gains: Gains::uniform(0.5),
            wedge: 0,
            gravity_m_s2: DVec3::new(0.0, 3.0, -9.0),
            gravity_turns,
            amplifier,
            accelerometer_lag_s: 1e-3,
            transient: [0.1; LIMBS],
            grid,
        };
        trial.data.variance = core::array::from_fn(|c| 1e-2 * (1.0 + c as f64));
        let unknowns = Unknowns {
            values,
            wedges: vec![wedge],
        };
        trial.start(&unknowns);
        (trial, unknowns)
    }

    #[test]
    fn inv_descent_is_the_gradient() {
        let shares = Shares::new(&Geometry::PAPER).expect("the paper's drawing");
        for (drive, turns, amplifier) in CASES {
            let (mut trial, unknowns) = trial(drive, turns, amplifier);
            let still = DVector::zeros(unknowns.len());
            for _ in 0..ROUNDS {
                let part = trial.contribution(&unknowns, &shares).expect("determined");
                trial.follow(&part, &still, 1.0);
            }
            // With the motion at its best, the gradient with the motion held is the whole gradient.
            let analytic = trial
                .contribution(&unknowns, &shares)
                .expect("determined")
                .descent;
            let squares = |u: usize, change: f64| {
                let mut moved = unknowns.clone();
                moved.values[u] += change;
                trial
                    .contribution(&moved, &shares)
                    .expect("determined")
                    .squares
            };
            for u in 0..unknowns.len() {
                let size = size_of_unknown(u);
                let h = 1e-4 * size;
                let numeric = -0.5 * (squares(u, h) - squares(u, -h)) / (2.0 * h);
                let scale = trial
                    .contribution(&unknowns, &shares)
                    .expect("determined")
                    .squares
                    / size;
                assert!(
                    (numeric - analytic[u]).abs() < FINITE_DIFFERENCES * scale,
                    "{drive:?} {turns} {amplifier}: unknown {u}: {numeric:e} by differences, {:e}",
                    analytic[u]
                );
            }
        }
    }

    /// Central differences of a linear function and rounding leave this of a block's largest entry; what is quadratic in the
    /// residual is not there.
    const BLOCKS: f64 = 1e-6;

    /// Where the data are what the model predicts, the descents' derivatives are the normal matrix and nothing else.
    #[test]
    fn inv_blocks_are_the_descents_derivatives() {
        let shares = Shares::new(&Geometry::PAPER).expect("the paper's drawing");
        for (drive, turns, amplifier) in CASES {
            let (mut trial, mut unknowns) = trial(drive, turns, amplifier);
            // Gravity's derivatives by the wedge's angles are those of small ones.
            unknowns.values.rows_mut(WEDGES, ANGLES).fill(0.0);
            let parts = trial.parts(&unknowns, &shares);
            for limb in 0..LIMBS {
                trial.data.coordinates[limb] = trial.prediction(&unknowns, &parts, limb);
            }
            trial.data.coordinates[LIMBS] = trial.standard_prediction(&unknowns);
            let arrow = trial.arrow(&unknowns, &shares);
            // Entries in the unknowns' own sizes, against the largest of their block: what is next to nothing drowns in rounding.
            let of_unknown: Vec<f64> = (0..arrow.descent.len()).map(size_of_unknown).collect();
            let largest = |block: &DMatrix<f64>, sizes: &[f64]| {
                block
                    .column_iter()
                    .zip(sizes)
                    .map(|(column, size)| column.amax() * size)
                    .fold(0.0, f64::max)
            };
            let of_motion = alloc::vec![trial.latent.amax(); trial.latent.len()];
            let blocks = [
                largest(&arrow.coupling, &of_unknown),
                largest(&arrow.information, &of_unknown),
                largest(&arrow.own, &of_motion),
            ];
            let compare =
                |block: usize, size: f64, differences: &DVector<f64>, column: DVector<f64>| {
                    let off = (differences + column).amax() * size;
                    assert!(
                        off <= BLOCKS * blocks[block],
                        "{drive:?} {turns} {amplifier}: block {block}: {off:e} of {:e}",
                        blocks[block]
                    );
                };
            let size = unknowns.len();
            for u in 0..size {
                let h = 1e-5 * size_of_unknown(u);
                let moved = |by: f64| {
                    let mut moved = unknowns.clone();
                    moved.values[u] += by;
                    trial.arrow(&moved, &shares)
                };
                let (up, down) = (moved(h), moved(-h));
                let by = |a: &DVector<f64>, b: &DVector<f64>| (a - b) / (2.0 * h);
                let size = size_of_unknown(u);
                let own = by(&up.own_descent, &down.own_descent);
                compare(0, size, &own, arrow.coupling.column(u).clone_owned());
                let common = by(&up.descent, &down.descent);
                compare(1, size, &common, arrow.information.column(u).clone_owned());
            }
            for (j, size) in of_motion.iter().enumerate() {
                let h = 1e-5 * trial.latent.amax();
                let moved = |by: f64| {
                    let mut moved = trial.clone();
                    moved.latent[j] += by;
                    moved.arrow(&unknowns, &shares)
                };
                let (up, down) = (moved(h), moved(-h));
                let by = (&up.own_descent - &down.own_descent) / (2.0 * h);
                compare(2, *size, &by, arrow.own.column(j).clone_owned());
            }
        }
    }

    /// A step that solves the whole arrow is what elimination and going back come to.
    #[test]
    fn inv_elimination_solves_the_arrow() {
        let shares = Shares::new(&Geometry::PAPER).expect("the paper's drawing");
        for (drive, turns, amplifier) in CASES {
            let (trial, unknowns) = trial(drive, turns, amplifier);
            let arrow = trial.arrow(&unknowns, &shares);
            let common = unknowns.len();
            let (outer, inner) = (arrow.descent.len(), arrow.own_descent.len());
            // A little of everything beforehand, as certificates give it, makes the whole regular.
            let beforehand = arrow.information.diagonal().rows(0, common).amax();
            let mut whole = DMatrix::zeros(outer + inner, outer + inner);
            whole
                .view_mut((0, 0), (outer, outer))
                .copy_from(&arrow.information);
            for u in 0..common {
                whole[(u, u)] += beforehand;
            }
            whole
                .view_mut((outer, outer), (inner, inner))
                .copy_from(&arrow.own);
            whole
                .view_mut((outer, 0), (inner, outer))
                .copy_from(&arrow.coupling);
            whole
                .view_mut((0, outer), (outer, inner))
                .copy_from(&arrow.coupling.transpose());
            let mut descent = DVector::zeros(outer + inner);
            descent.rows_mut(0, outer).copy_from(&arrow.descent);
            descent.rows_mut(outer, inner).copy_from(&arrow.own_descent);
            let step = Cholesky::new(whole).expect("regular").solve(&descent);
            let part = trial.contribution(&unknowns, &shares).expect("determined");
            let mut information = part.information.clone();
            for u in 0..common {
                information[(u, u)] += beforehand;
            }
            let head = Cholesky::new(information)
                .expect("regular")
                .solve(&part.descent);
            let mut moved = trial.clone();
            moved.follow(&part, &head, 1.0);
            let close = |a: &DVector<f64>, b: &DVector<f64>| (a - b).amax() <= BLOCKS * b.amax();
            assert!(close(&head, &step.rows(0, common).clone_owned()));
            let motion = &moved.latent - &trial.latent;
            assert!(close(&motion, &step.rows(outer, inner).clone_owned()));
            if amplifier {
                let transient = DVector::from_iterator(
                    LIMBS,
                    (0..LIMBS).map(|i| moved.transient[i] - trial.transient[i]),
                );
                assert!(close(&transient, &step.rows(common, LIMBS).clone_owned()));
            }
        }
    }
}
