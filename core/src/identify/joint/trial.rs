//! One trial's part in the normal equations, its latent motion eliminated.
//!
//! With X_s the series as the amplifier passes them on and H the amplifier's response, channel i is
//!
//! ```text
//! z_i = d_i sqrt(N) e_0 + (m/s_i)/c_i sum_m C_im H phi_m(q) + b_i E + noise,
//! ```
//!
//! b_i E being what is left of the amplifier's own transient, and the standard is (1 + gamma) A q + noise, A its lag. The
//! coefficients C depend on inertia, compliance and wedge. Gauss-Newton's normal matrix is an arrow: the motion of this trial
//! and its transients touch no other trial, so they are eliminated here (Schur complement) and what remains is a matrix in the
//! common unknowns alone. Its inverse is the Cramer-Rao bound of the common unknowns with the motion unknown.

use alloc::vec;
use alloc::vec::Vec;

use glam::DVec3;
use nalgebra::{Cholesky, Complex, DMatrix, DVector, Dyn};

use super::harmonics::{Grid, Projection};
use super::motion::{self, Operator, Series};
use super::shares::Shares;
use super::unknowns::{
    ACCELEROMETER_GAIN, AMPLIFIER_CORNER, COMPLIANCE, DRIFT, GYROSCOPE_GAIN, GYROSCOPE_LAG,
    INERTIA, MASS_PER_SCALE, Unknowns, inertia_entry,
};
use crate::geometry::LIMBS;
use crate::scalar::{exp, sin_cos, sqrt};
use crate::signal::Gains;

/// What the rig does in a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    /// Moves the sensor along the wedge's direction; the standard is the accelerometer.
    Linear,
    /// Turns it about that direction; the standard is the gyroscope.
    Angular,
}

/// A trial, projected on its harmonics.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Trial {
    pub drive: Drive,
    pub grid: Grid,
    pub gains: Gains,
    /// Nine channels, then the standard.
    pub data: Projection<{ LIMBS + 1 }>,
    pub wedge: usize,
    /// Gravity with the wedge as it is meant to be, m/s^2.
    pub gravity_m_s2: DVec3,
    pub gravity_turns: bool,
    /// Whether the amplifiers are high-passes.
    pub amplifier: bool,
    /// First-order lag of the standard accelerometer, s: known.
    pub accelerometer_lag_s: f64,
    /// Harmonics of the motion, the unknowns of this trial alone.
    pub latent: DVector<f64>,
    /// Transients b_i of the amplifiers.
    pub transient: [f64; LIMBS],
}

/// What a trial adds to the normal equations, and what it takes to go back to its own unknowns.
pub(super) struct Contribution {
    pub information: DMatrix<f64>,
    /// Minus half the gradient of the sum of squares.
    pub descent: DVector<f64>,
    pub squares: f64,
    back: Back,
}

struct Back {
    latent: Cholesky<f64, Dyn>,
    coupling: DMatrix<f64>,
    descent: DVector<f64>,
    transient: Option<(Cholesky<f64, Dyn>, DMatrix<f64>, DVector<f64>)>,
}

/// A share of a series in a channel and how it depends on the common unknowns.
struct Share {
    /// C_im for each limb.
    value: [f64; LIMBS],
    /// Derivatives by common unknowns.
    slopes: Vec<(usize, [f64; LIMBS])>,
}

impl Trial {
    /// Common unknowns that this trial depends on.
    fn shares(&self, unknowns: &Unknowns, shares: &Shares) -> Vec<Share> {
        let tensor = unknowns.inertia().matrix_mass_m2();
        let (n, sideways) = unknowns.direction(self.wedge);
        let angles = unknowns.angles(self.wedge);
        let linear = |d: DVec3| core::array::from_fn(|i| shares.of_acceleration(i).dot(d));
        let torque = |m: DVec3| core::array::from_fn(|i| shares.of_torque_per_m(i).dot(m));
        match self.drive {
            Drive::Linear => {
                let compliance = unknowns.values[COMPLIANCE];
                let given_way = shares.of_compliance(tensor, n);
                let mut slopes = vec![(COMPLIANCE, given_way)];
                slopes.extend((0..6).map(|j| {
                    let by = shares.of_compliance_by_inertia(inertia_entry(j), n);
                    (INERTIA + j, by.map(|g| compliance * g))
                }));
                slopes.extend((0..2).map(|side| {
                    let by = shares.of_compliance(tensor, sideways[side]);
                    (angles + side, by.map(|g| compliance * g))
                }));
                vec![
                    Share {
                        value: linear(n),
                        slopes: (0..2)
                            .map(|side| (angles + side, linear(sideways[side])))
                            .collect(),
                    },
                    Share {
                        value: given_way.map(|g| compliance * g),
                        slopes,
                    },
                ]
            }
            Drive::Angular => {
                let mut slopes: Vec<(usize, [f64; LIMBS])> = (0..6)
                    .map(|j| (INERTIA + j, torque(inertia_entry(j) * n)))
                    .collect();
                slopes.extend((0..2).map(|side| (angles + side, torque(tensor * sideways[side]))));
                let whirl = |d: DVec3, i: DVec3| d.cross(i);
                let mut quadratic: Vec<(usize, [f64; LIMBS])> = (0..6)
                    .map(|j| (INERTIA + j, torque(whirl(n, inertia_entry(j) * n))))
                    .collect();
                quadratic.extend((0..2).map(|side| {
                    let b = sideways[side];
                    (
                        angles + side,
                        torque(whirl(b, tensor * n) + whirl(n, tensor * b)),
                    )
                }));
                let mut all = vec![
                    Share {
                        value: torque(tensor * n),
                        slopes,
                    },
                    Share {
                        value: torque(whirl(n, tensor * n)),
                        slopes: quadratic,
                    },
                ];
                if self.gravity_turns {
                    let (g, by) = unknowns.gravity(self.wedge, self.gravity_m_s2);
                    // About the third angle the direction stays.
                    let turned = [sideways[0], sideways[1], DVec3::ZERO];
                    let slopes = |of: &dyn Fn(DVec3, DVec3) -> DVec3| {
                        turned
                            .iter()
                            .zip(by)
                            .enumerate()
                            .map(|(angle, (b, dg))| (angles + angle, linear(of(*b, dg))))
                            .collect()
                    };
                    all.push(Share {
                        value: linear(n.cross(g)),
                        slopes: slopes(&|b, dg| b.cross(g) + n.cross(dg)),
                    });
                    all.push(Share {
                        value: linear(g - n * n.dot(g)),
                        slopes: slopes(&|b, dg| dg - b * n.dot(g) - n * (b.dot(g) + n.dot(dg))),
                    });
                }
                all
            }
        }
    }

    /// H and dH by the corner: at the mean and at each harmonic.
    fn amplifier(&self, corner_rad_s: f64) -> (f64, Vec<Complex<f64>>, Vec<Complex<f64>>) {
        let one = Complex::new(1.0, 0.0);
        if !self.amplifier {
            let count = self.grid.harmonics;
            return (1.0, vec![one; count], vec![one * 0.0; count]);
        }
        let (h, dh) = (1..=self.grid.harmonics)
            .map(|k| {
                let iw = Complex::new(0.0, self.grid.rate_rad_s(k));
                let through = iw / (iw + corner_rad_s);
                (through, -through / (iw + corner_rad_s))
            })
            .unzip();
        (0.0, h, dh)
    }

    /// E, the coordinates of exp(-corner t), and its derivative by the corner: sums of geometric series.
    fn decay(&self, corner_rad_s: f64) -> [DVector<f64>; 2] {
        let grid = &self.grid;
        let samples = grid.samples as f64;
        let per_sample = corner_rad_s * grid.step_s;
        let end = exp(-per_sample * samples);
        let one = Complex::new(1.0, 0.0);
        let sums = |k: usize| {
            let (sin, cos) = sin_cos(grid.rate_rad_s(k) * grid.step_s);
            let ratio = Complex::new(cos, -sin) * exp(-per_sample);
            let rest = one / (one - ratio);
            let sum = rest * (1.0 - end);
            let slope = (rest * (samples * end) - sum * ratio * rest) * grid.step_s;
            [sum, slope]
        };
        [0, 1].map(|which| {
            let z: Vec<Complex<f64>> = (1..=grid.harmonics)
                .map(|k| sums(k)[which] * sqrt(2.0 / samples))
                .collect();
            grid.vector(sums(0)[which].re / sqrt(samples), &z)
        })
    }

    fn series(&self) -> Vec<Series> {
        match self.drive {
            Drive::Linear => motion::linear(&self.grid, &self.latent).into(),
            Drive::Angular => motion::angular(&self.grid, &self.latent, self.gravity_turns),
        }
    }

    /// Response of the standard to the motion, its derivative by the gyroscope's lag, and its gain's place.
    fn standard(&self, unknowns: &Unknowns) -> (Vec<Complex<f64>>, Vec<Complex<f64>>, usize) {
        let (lag, gain) = match self.drive {
            Drive::Linear => (self.accelerometer_lag_s, ACCELEROMETER_GAIN),
            Drive::Angular => (unknowns.values[GYROSCOPE_LAG], GYROSCOPE_GAIN),
        };
        let (response, slope) = (1..=self.grid.harmonics)
            .map(|k| {
                let iw = Complex::new(0.0, self.grid.rate_rad_s(k));
                let follows = Complex::new(1.0, 0.0) / (Complex::new(1.0, 0.0) + iw * lag);
                (follows, -iw * follows * follows)
            })
            .unzip();
        (response, slope, gain)
    }

    /// Motion as the standard alone shows it.
    pub fn start(&mut self, unknowns: &Unknowns) {
        let (response, _, gain) = self.standard(unknowns);
        let shown = &self.data.coordinates[LIMBS];
        for (k, r) in response.iter().enumerate() {
            let z = Complex::new(shown[2 * k + 1], shown[2 * k + 2])
                / (r * (1.0 + unknowns.values[gain]));
            self.latent[2 * k] = z.re;
            self.latent[2 * k + 1] = z.im;
        }
    }

    /// The trial's part at the present unknowns, common and own.
    ///
    /// None if the motion is not determined by the data, which no data with noise leave open.
    pub fn contribution(&self, unknowns: &Unknowns, shares: &Shares) -> Option<Contribution> {
        let values = &unknowns.values;
        let common = values.len();
        let coordinates = self.grid.coordinates();
        let count = 2 * self.grid.harmonics;
        let table = self.shares(unknowns, shares);
        let (h_mean, h, dh) = self.amplifier(values[AMPLIFIER_CORNER]);
        let series = self.series();

        // Everything that a channel is a combination of.
        let filter = |v: &DVector<f64>, mean: f64, factors: &[Complex<f64>]| {
            let mut out = v.clone();
            out[0] *= mean;
            for (k, f) in factors.iter().enumerate() {
                let z = Complex::new(v[2 * k + 1], v[2 * k + 2]) * f;
                out[2 * k + 1] = z.re;
                out[2 * k + 2] = z.im;
            }
            out
        };
        let mut parts: Vec<DVector<f64>> = Vec::new();
        let mut offset = DVector::zeros(coordinates);
        offset[0] = sqrt(self.grid.samples as f64);
        parts.push(offset);
        for s in &series {
            parts.push(filter(&s.value, h_mean, &h));
        }
        let by_corner = parts.len();
        let transients = if self.amplifier { LIMBS } else { 0 };
        if self.amplifier {
            for s in &series {
                parts.push(filter(&s.value, 0.0, &dh));
            }
            parts.extend(self.decay(values[AMPLIFIER_CORNER]));
        }
        // Of the last two, the second is the first one's derivative by the corner.
        let decay = parts.len().saturating_sub(2);
        let operators: Vec<Operator> = series
            .into_iter()
            .map(|s| s.by_latent.filtered(h_mean, &h))
            .collect();
        let all = parts.len();
        let gram = DMatrix::from_fn(all, all, |a, b| parts[a].dot(&parts[b]));
        let seen: Vec<Vec<DVector<f64>>> = operators
            .iter()
            .map(|o| parts.iter().map(|p| o.transposed_times(p)).collect())
            .collect();

        let mut information = DMatrix::zeros(common + transients, common + transients);
        let mut descent = DVector::zeros(common + transients);
        let mut own = DMatrix::zeros(count, count);
        let mut own_descent = DVector::zeros(count);
        let mut coupling = DMatrix::zeros(count, common + transients);
        let mut squares = 0.0;

        let mut pairs = DMatrix::<f64>::zeros(operators.len(), operators.len());
        for limb in 0..LIMBS {
            let weight = 1.0 / self.data.variance[limb];
            let per_gain = 1.0 / self.gains.gain_n_per_v[limb];
            let mass_per_scale = values[MASS_PER_SCALE + limb];
            let gain = mass_per_scale * per_gain;
            // Columns: unknown and its combination of parts.
            let mut columns: Vec<(usize, Vec<(usize, f64)>)> = Vec::new();
            columns.push((DRIFT + limb, vec![(0, 1.0)]));
            let shape: Vec<(usize, f64)> = table
                .iter()
                .enumerate()
                .map(|(m, share)| (1 + m, share.value[limb]))
                .collect();
            columns.push((
                MASS_PER_SCALE + limb,
                shape.iter().map(|(s, c)| (*s, c * per_gain)).collect(),
            ));
            for (m, share) in table.iter().enumerate() {
                for (unknown, slope) in &share.slopes {
                    let entry = (1 + m, gain * slope[limb]);
                    match columns.iter_mut().find(|c| c.0 == *unknown) {
                        Some(column) => column.1.push(entry),
                        None => columns.push((*unknown, vec![entry])),
                    }
                }
            }
            if self.amplifier {
                let mut by = shape
                    .iter()
                    .map(|(s, c)| (by_corner + s - 1, c * gain))
                    .collect::<Vec<_>>();
                by.push((decay + 1, self.transient[limb]));
                columns.push((AMPLIFIER_CORNER, by));
                columns.push((common + limb, vec![(decay, 1.0)]));
            }
            let mut prediction: Vec<(usize, f64)> =
                shape.iter().map(|(s, c)| (*s, c * gain)).collect();
            prediction.push((0, values[DRIFT + limb]));
            if self.amplifier {
                prediction.push((decay, self.transient[limb]));
            }
            let mut residual = self.data.coordinates[limb].clone();
            for (s, c) in &prediction {
                residual.axpy(-c, &parts[*s], 1.0);
            }
            squares += weight * residual.norm_squared();
            let toward: Vec<f64> = parts.iter().map(|p| p.dot(&residual)).collect();
            for (a, from_a) in &columns {
                descent[*a] += weight * from_a.iter().map(|(s, c)| c * toward[*s]).sum::<f64>();
                for (b, from_b) in &columns {
                    information[(*a, *b)] += weight
                        * from_a
                            .iter()
                            .flat_map(|(s, c)| from_b.iter().map(move |(t, d)| (*s, *t, c * d)))
                            .map(|(s, t, product)| product * gram[(s, t)])
                            .sum::<f64>();
                }
            }
            for (m, share) in table.iter().enumerate() {
                let by_latent = gain * share.value[limb];
                own_descent += operators[m].transposed_times(&residual) * (weight * by_latent);
                for (a, from_a) in &columns {
                    let mut column = coupling.column_mut(*a);
                    for (s, c) in from_a {
                        column.axpy(weight * by_latent * c, &seen[m][*s], 1.0);
                    }
                }
                for (l, other) in table.iter().enumerate() {
                    pairs[(m, l)] += weight * by_latent * gain * other.value[limb];
                }
            }
        }
        for m in 0..operators.len() {
            for l in m..operators.len() {
                Operator::add_gram(
                    &operators[m],
                    &operators[l],
                    m == l,
                    pairs[(m, l)],
                    &mut own,
                );
            }
        }

        // The standard; its mean is its own offset and says nothing.
        let (response, lag_slope, gain_place) = self.standard(unknowns);
        let reading = 1.0 + values[gain_place];
        let weight = 1.0 / self.data.variance[LIMBS];
        let shown = &self.data.coordinates[LIMBS];
        for k in 0..self.grid.harmonics {
            let q = Complex::new(self.latent[2 * k], self.latent[2 * k + 1]);
            let residual =
                Complex::new(shown[2 * k + 1], shown[2 * k + 2]) - response[k] * q * reading;
            let by_latent = response[k] * reading;
            squares += weight * residual.norm_sqr();
            let own_part = weight * by_latent.norm_sqr();
            let toward = by_latent.conj() * residual * weight;
            let mut columns = vec![(gain_place, response[k] * q)];
            if self.drive == Drive::Angular {
                columns.push((GYROSCOPE_LAG, lag_slope[k] * q * reading));
            }
            for part in 0..2 {
                own[(2 * k + part, 2 * k + part)] += own_part;
            }
            own_descent[2 * k] += toward.re;
            own_descent[2 * k + 1] += toward.im;
            for (a, slope_a) in &columns {
                descent[*a] += weight * (slope_a.conj() * residual).re;
                let coupled = by_latent.conj() * slope_a * weight;
                coupling[(2 * k, *a)] += coupled.re;
                coupling[(2 * k + 1, *a)] += coupled.im;
                for (b, slope_b) in &columns {
                    information[(*a, *b)] += weight * (slope_a.conj() * slope_b).re;
                }
            }
        }

        let latent = Cholesky::new(own)?;
        let solved = latent.solve(&coupling);
        information.gemm_tr(-1.0, &coupling, &solved, 1.0);
        descent.gemv_tr(-1.0, &solved, &own_descent, 1.0);
        let transient = if transients == 0 {
            None
        } else {
            let block = information
                .view((common, common), (transients, transients))
                .clone_owned();
            let across = information
                .view((common, 0), (transients, common))
                .clone_owned();
            let down = descent.rows(common, transients).clone_owned();
            let factor = Cholesky::new(block)?;
            let solved = factor.solve(&across);
            let mut head = information.view((0, 0), (common, common)).clone_owned();
            head.gemm_tr(-1.0, &across, &solved, 1.0);
            let mut head_descent = descent.rows(0, common).clone_owned();
            head_descent.gemv_tr(-1.0, &solved, &down, 1.0);
            information = head;
            descent = head_descent;
            Some((factor, across, down))
        };
        Some(Contribution {
            information,
            descent,
            squares,
            back: Back {
                latent,
                coupling,
                descent: own_descent,
                transient,
            },
        })
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

#[cfg(test)]
mod tests {
    use super::super::harmonics::project;
    use super::super::unknowns::{ANGLES, WEDGES, Wedge};
    use super::*;
    use crate::geometry::Geometry;

    /// Central differences over 1e-6 of an unknown's size leave this of the largest derivative.
    const FINITE_DIFFERENCES: f64 = 1e-5;
    /// Rounds of the motion's own Gauss-Newton: it settles in three.
    const ROUNDS: usize = 8;

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
        for (drive, turns, amplifier) in [
            (Drive::Linear, false, false),
            (Drive::Linear, false, true),
            (Drive::Angular, false, false),
            (Drive::Angular, true, false),
            (Drive::Angular, true, true),
        ] {
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
                let size = match u {
                    u if u < MASS_PER_SCALE => 1.0,
                    u if u < INERTIA => 0.2,
                    u if u < COMPLIANCE => 2e-4,
                    COMPLIANCE => 1e-5,
                    _ => 0.1,
                };
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
}
