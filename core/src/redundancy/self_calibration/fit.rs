//! The ratios that make the rows vanish, noise in all nine channels taken into account.
//!
//! With theta_i = ln(c_i over the calibration's) and y the calibration's strains less their mean, the rows leave
//! r = W^T C y - s, s their second order. Maximum likelihood with y known but for noise (errors in variables) asks for
//!
//! ```text
//! sum_t D_t^T Q^-1 r_t = 0,   D = (c_i W_i yhat_i),   yhat = y - N C W Q^-1 r,   Q = W^T C N C W,
//! ```
//!
//! N the covariance of y's noise: plain least squares would have y in D and shrink every c_i by noise over signal. Q is what the
//! residuals themselves show. All sums follow from the second moments. The information A is sum D^T Q^-1 D of the true y, noise's
//! share subtracted; the sum as it is, B, is the covariance of the gradient. A^-1 B A^-1 without the common factor is the
//! covariance of the ratios.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::moments::{COLUMNS, Moments};
use super::ratios::{Limits, LoopMisfit, ScaleRatios};
use super::{PerLimbs, RATIOS, contrasts, noise};
use crate::error::{Error, Result, require_samples};
use crate::float::{exp, sqrt};
use crate::geometry::LIMBS;
use crate::identify::least_squares::gauss_newton::{self, Nonlinear, Outcome, iterate};
use crate::redundancy::parity::{ROWS, SIGNATURES};
use crate::unobservable::UnobservableDirections;

/// Blocks below which the noise is not known well enough for anything.
const FEWEST_BLOCKS: usize = 32;
/// Steps with all rows weighted alike, which find the neighbourhood.
const PLAIN_STEPS: usize = 6;
/// Caps.
const LIMITS: gauss_newton::Limits = gauss_newton::Limits {
    steps: 144,
    shares: 1,
};
/// Step, relative, at which the ratios stand.
const SETTLED: f64 = 1e-12;
/// Steps by rounding of the moments: nothing on any interval.
const ROUNDING: f64 = 1e-9;
/// Longest step.
const LONGEST: f64 = 0.5;
/// Length of a step over the one before from which on only a share of each step is taken, and the least share.
const OVERSHOT: f64 = 0.9;
const LEAST_SHARE: f64 = 0.25;
/// Share of a row's own variance that rounding leaves of it, at least.
const ROUNDING_SHARE: f64 = 64.0 * f64::EPSILON;
/// Largest asymmetry that the eigenvalue iteration is asked to resolve, and its cap.
const EIGEN: (f64, usize) = (1e-15, 1000);

/// Coefficients of the rows: nine limbs, and limb 1 in the first row alone.
const COEFFICIENTS: usize = LIMBS + 1;
const LOOP: usize = LIMBS;

/// Limb and signature of a coefficient.
fn coefficient(k: usize) -> (usize, Vector3<f64>) {
    if k == LOOP {
        return (0, Vector3::x());
    }
    (k, Vector3::from(SIGNATURES[k].map(f64::from)))
}

/// Gradient and information at some ratios.
struct Normal {
    gradient: SVector<f64, COEFFICIENTS>,
    information: SMatrix<f64, COEFFICIENTS, COEFFICIENTS>,
    /// Covariance of the gradient by the nine.
    gradients: PerLimbs,
    /// Mean correlation of neighbouring blocks' residuals.
    lag_one: f64,
}

/// Eigenvalues and eigenvectors of the information without the common factor.
type Spectrum = (SVector<f64, RATIOS>, SMatrix<f64, RATIOS, RATIOS>);

pub(super) fn fit(moments: &Moments, limits: &Limits) -> Result<ScaleRatios> {
    let blocks = moments.blocks.saturating_sub(moments.records - 1) as usize;
    require_samples("scale ratios, in blocks,", FEWEST_BLOCKS, blocks)?;
    let rows = Rows { moments, limits };
    let mut at = rows.point(SVector::zeros(), false)?;
    for step in 1..=PLAIN_STEPS {
        at = rows.point(at.after_step(), step == PLAIN_STEPS)?;
    }
    let end = iterate(&rows, at, LIMITS)?;
    // If the motion is too poor, that is the reason to give.
    let found = finish(moments, limits, &end.at.after_step())?;
    if end.outcome == Outcome::Converged {
        return Ok(found);
    }
    Err(Error::NotConverged {
        what: "scale ratios",
        iterations: end.steps,
    })
}

/// The estimating equation of the three rows. Its weights follow the ratios, so that there is no sum of squares that every step
/// lowers: instead of halving a step until it does, an overshoot shortens all later steps.
struct Rows<'a> {
    moments: &'a Moments,
    limits: &'a Limits,
}

/// ln ratios, the step that the equation asks for there, and what is taken of it.
struct Point {
    theta: SVector<f64, LIMBS>,
    step: SVector<f64, LIMBS>,
    length: f64,
    share: f64,
    stands: bool,
}

impl Point {
    fn after_step(&self) -> SVector<f64, LIMBS> {
        self.theta + self.step * (LONGEST / self.length).min(self.share)
    }
}

impl Rows<'_> {
    fn point(&self, theta: SVector<f64, LIMBS>, weighted: bool) -> Result<Point> {
        let Self { moments, limits } = self;
        let basis = contrasts();
        let normal = normal(moments, &theta, weighted)?;
        let (values, vectors) = spectrum(&basis, &normal)?;
        let least = if weighted {
            limits.least_information(values.max())
        } else {
            limits.least_excitation * limits.least_excitation * values.max()
        };
        let gradient = basis.transpose() * normal.gradient.fixed_rows::<LIMBS>(0);
        let along = vectors.transpose() * gradient;
        // An unobservable combination stays where it is: it would wander.
        let step = SVector::<f64, RATIOS>::from_fn(|k, _| {
            if values[k] >= least {
                -along[k] / values[k]
            } else {
                0.0
            }
        });
        let step = basis * vectors * step;
        Ok(Point {
            theta,
            step,
            length: step.amax(),
            share: 1.0,
            stands: false,
        })
    }
}

impl Nonlinear for Rows<'_> {
    type Point = Point;
    /// Whether it is negligible.
    type Step = bool;

    fn step(&self, from: &Point) -> Result<bool> {
        Ok(from.stands)
    }

    fn is_negligible(&self, stands: &bool) -> bool {
        *stands
    }

    fn moved(&self, from: &Point, _step: &bool, _share: f64) -> Result<Point> {
        let next = self.point(from.after_step(), true)?;
        let overshot = next.length > OVERSHOT * from.length && next.length > ROUNDING;
        Ok(Point {
            share: if overshot {
                LEAST_SHARE.max(0.5 * from.share)
            } else {
                from.share
            },
            // Rounding may keep a step from getting any shorter.
            stands: next.length < SETTLED || (next.length < ROUNDING && next.length >= from.length),
            ..next
        })
    }

    fn is_better(&self, next: &Point, _than: &Point) -> bool {
        next.length.is_finite()
    }
}

fn spectrum(basis: &SMatrix<f64, LIMBS, RATIOS>, normal: &Normal) -> Result<Spectrum> {
    let inner = basis.transpose() * normal.information.fixed_view::<LIMBS, LIMBS>(0, 0) * basis;
    let inner = (inner + inner.transpose()) * 0.5;
    let size = inner.amax();
    let undone = Error::NotConverged {
        what: "scale ratios' information",
        iterations: EIGEN.1,
    };
    if !(size.is_normal() && size > 0.0) {
        return Err(undone);
    }
    let eigen = (inner / size)
        .try_symmetric_eigen(EIGEN.0, EIGEN.1)
        .ok_or(undone)?;
    Ok((eigen.eigenvalues * size, eigen.eigenvectors))
}

fn normal(moments: &Moments, theta: &SVector<f64, LIMBS>, weighted: bool) -> Result<Normal> {
    let c: [f64; LIMBS] = core::array::from_fn(|i| exp(theta[i]));
    let rows = SMatrix::<f64, ROWS, COLUMNS>::from_fn(|row, j| match j.checked_sub(LIMBS) {
        None => c[j] * f64::from(SIGNATURES[j][row]),
        Some(other) => -f64::from(i8::from(other == row)),
    });
    let mixed = rows * moments.scatter;
    let left = mixed * rows.transpose();
    let degrees = degrees_of_freedom(moments);
    let size = core::array::from_fn(|i| c[i] * c[i] * moments.roughness[i]);
    let rounding: f64 = (0..LIMBS)
        .map(|i| c[i] * c[i] * moments.scatter[(i, i)])
        .sum::<f64>()
        * ROUNDING_SHARE;
    let shown = (left + Matrix3::identity() * rounding) / degrees;
    // Before the ratios are known residuals are signal: neither weights nor noise can be read from them.
    let v = if weighted {
        noise::variances(&shown, &size)
    } else {
        [0.0; LIMBS]
    };
    let q = if weighted {
        noise::of_rows(&v)
    } else {
        Matrix3::identity() * shown.trace().max(f64::MIN_POSITIVE)
    };
    let inverse = q.try_inverse().ok_or(Error::NotConverged {
        what: "scale ratios' weights",
        iterations: 0,
    })?;
    // yhat_i = y_i - back_i . r
    let back: [Vector3<f64>; LIMBS] = core::array::from_fn(|i| {
        let (_, w) = coefficient(i);
        inverse * w * (v[i] / c[i])
    });
    let gradient = SVector::from_fn(|k, _| {
        let (i, w) = coefficient(k);
        c[i] * w.dot(&(inverse * (mixed.column(i) - left * back[i])))
    });
    // sum yhat_i yhat_j, and the noise's share of it.
    let product = PerLimbs::from_fn(|i, j| {
        moments.scatter[(i, j)] - back[i].dot(&mixed.column(j)) - back[j].dot(&mixed.column(i))
            + back[i].dot(&(left * back[j]))
    });
    let of_noise = PerLimbs::from_fn(|i, j| {
        let own = if i == j { v[i] / (c[i] * c[i]) } else { 0.0 };
        degrees * (own - back[i].dot(&(q * back[j])))
    });
    let weight = |k: usize, l: usize| {
        let ((i, w), (j, u)) = (coefficient(k), coefficient(l));
        (i, j, c[i] * c[j] * w.dot(&(inverse * u)))
    };
    let information = SMatrix::from_fn(|k, l| {
        let (i, j, weight) = weight(k, l);
        weight * (product[(i, j)] - of_noise[(i, j)])
    });
    let gradients = PerLimbs::from_fn(|k, l| {
        let (i, j, weight) = weight(k, l);
        weight * product[(i, j)]
    });
    let lagged = rows * moments.lagged * rows.transpose();
    Ok(Normal {
        gradient,
        information,
        gradients,
        lag_one: (inverse * lagged).trace() / (ROWS as f64 * degrees),
    })
}

/// Blocks less the means and the ratios, of each row.
fn degrees_of_freedom(moments: &Moments) -> f64 {
    (moments.blocks - moments.records) as f64 - RATIOS as f64 / ROWS as f64
}

fn finish(moments: &Moments, limits: &Limits, theta: &SVector<f64, LIMBS>) -> Result<ScaleRatios> {
    let basis = contrasts();
    let normal = normal(moments, theta, true)?;
    let (values, vectors) = spectrum(&basis, &normal)?;
    let most = values.max();
    let least = limits.least_information(most);
    // Also true of a comparison with what is not a number.
    let told = |value: f64| value >= least;
    if !values.iter().all(|&value| told(value)) {
        let directions = basis * vectors;
        let open = directions.column_iter().zip(values.iter());
        let open = open.filter(|(_, value)| !told(**value));
        return Err(Error::UnobservableScaleRatios {
            directions: UnobservableDirections::of(open.map(|(direction, _)| direction.into())),
        });
    }
    let inner =
        vectors * SMatrix::from_diagonal(&values.map(|value| 1.0 / value)) * vectors.transpose();
    let inverse = basis * inner * basis.transpose();
    let covariance = inverse * normal.gradients * inverse;
    // One step of the tenth coefficient, the nine others free to follow.
    let by_loop = normal.information.fixed_view::<LIMBS, 1>(0, LOOP);
    let followed = inverse * by_loop;
    let information = normal.information[(LOOP, LOOP)] - (by_loop.transpose() * followed)[(0, 0)];
    let slope = normal.gradient[LOOP]
        - (followed.transpose() * normal.gradient.fixed_rows::<LIMBS>(0))[(0, 0)];
    Ok(ScaleRatios {
        ln_ratio: (*theta).into(),
        covariance: (covariance + covariance.transpose()) * 0.5,
        blocks: moments.blocks,
        lag_one_correlation: normal.lag_one,
        misfit: LoopMisfit {
            ln_ratio: -slope / information,
            deviation: sqrt(1.0 / information),
        },
        excitation: sqrt(values.min() / most),
    })
}
