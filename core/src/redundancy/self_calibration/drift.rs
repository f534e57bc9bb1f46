//! Which limbs have drifted since a calibration.
//!
//! Changes are known except for a common factor, so that the nine numbers alone do not determine which limbs drifted. The result is
//! the smallest set F of limbs whose change explains the data, the others having kept their scale (or changed it together, as a
//! common amplifier or a common stiffness does). With A the information on the changes e,
//!
//! ```text
//! chi^2(F) = e^T A e - (A e)_F^T A_FF^-1 (A e)_F,     8 - |F| degrees of freedom,     e_F = A_FF^-1 (A e)_F.
//! ```

use nalgebra::{SMatrix, SVector};

use super::{PerLimbs, RATIOS, ScaleRatios, information_without_common};
use crate::error::{Error, Result};
use crate::float::sqrt;
use crate::geometry::LIMBS;
use crate::limb_set::LimbSet;
use crate::significance::chi_square_limit;

/// Limbs that may have drifted at most: fewer than half, so that "the others" are a majority.
pub const MOST_DRIFTED: usize = 4;

/// The limbs that drifted, and by how much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drifted {
    /// The smallest set of limbs whose change explains the data. Empty where all kept their ratios, and where not even
    /// [`MOST_DRIFTED`] limbs explain them: see `explained`.
    pub limbs: LimbSet,
    /// Whether `limbs` explain the data at the asked rate of false alarms.
    pub explained: bool,
    /// The next best set of the same size, if it explains the data, too: the result is then ambiguous.
    pub rival: Option<LimbSet>,
    /// ln of each limb's change against those that kept their scale.
    pub ln_change: [f64; LIMBS],
    /// Standard deviations of these.
    pub deviation: [f64; LIMBS],
    /// Sum of squares, over its covariance, that the changes of `limbs` leave.
    pub chi_square: f64,
    /// Sum of squares if no limb had drifted, with eight degrees of freedom.
    pub chi_square_of_none: f64,
    /// Limit of that.
    pub limit_of_none: f64,
}

/// Names the limbs that have drifted; `calibration` is the covariance of the calibration's ln scale factors, whose common error
/// drops out, or zeros to take the calibration for exact.
///
/// A set is accepted where chance leaves as much in `false_alarm` of cases: so often a sensor without drift is said to have one, where the covariance holds.
/// That of short records is a little narrow: of 2 s, 1.2 to 1.4 times as often (2,997 simulated records).
///
/// # Errors
/// [`Error::OutOfRange`] for a rate that is none or a covariance that is none.
pub fn drifted(ratios: &ScaleRatios, calibration: &PerLimbs, false_alarm: f64) -> Result<Drifted> {
    let information = information_without_common(&(ratios.covariance + calibration)).ok_or(
        Error::out_of_range(
            "covariance of the calibration's scale factors",
            calibration.amax(),
            "positive and finite",
        ),
    )?;
    let e = SVector::from(ratios.ln_ratio);
    let weighted = information * e;
    let of_none = e.dot(&weighted);
    let mut found = (LimbSet::EMPTY, of_none, false, None);
    for size in 0..=MOST_DRIFTED {
        let limit = chi_square_limit(false_alarm, RATIOS - size)?;
        let mut best = [(LimbSet::EMPTY, f64::INFINITY); 2];
        for set in LimbSet::of_size(size) {
            let left = of_none - change(&information, &weighted, set).map_or(0.0, |c| c.explained);
            if left < best[0].1 {
                best = [(set, left), best[0]];
            } else if left < best[1].1 {
                best[1] = (set, left);
            }
        }
        if best[0].1 <= limit {
            let rival = (best[1].1 <= limit).then_some(best[1].0);
            found = (best[0].0, best[0].1, true, rival);
            break;
        }
    }
    let (limbs, left, explained, rival) = found;
    let mut ln_change = [f64::NAN; LIMBS];
    let mut deviation = [f64::NAN; LIMBS];
    for i in 0..LIMBS {
        if let Some(c) = change(&information, &weighted, limbs.with(i))
            && let Some(place) = limbs.with(i).indices().position(|limb| limb == i)
        {
            ln_change[i] = c.value[place];
            deviation[i] = sqrt(c.covariance[(place, place)]);
        }
    }
    Ok(Drifted {
        limbs,
        explained,
        rival,
        ln_change,
        deviation,
        chi_square: left,
        chi_square_of_none: of_none,
        limit_of_none: chi_square_limit(false_alarm, RATIOS)?,
    })
}

/// One limb more than may have drifted: any limb is asked for its change beside those.
const PLACES: usize = MOST_DRIFTED + 1;

struct Change {
    value: SVector<f64, PLACES>,
    covariance: SMatrix<f64, PLACES, PLACES>,
    explained: f64,
}

/// Change of the limbs of a set, in ascending order, the others having none.
fn change(information: &PerLimbs, weighted: &SVector<f64, LIMBS>, set: LimbSet) -> Option<Change> {
    let mut limbs = [None; PLACES];
    for (place, limb) in limbs.iter_mut().zip(set.indices()) {
        *place = Some(limb);
    }
    let block = SMatrix::<f64, PLACES, PLACES>::from_fn(|a, b| match (limbs[a], limbs[b]) {
        (Some(i), Some(j)) => information[(i, j)],
        _ => f64::from(i8::from(a == b)),
    });
    let own = SVector::<f64, PLACES>::from_fn(|a, _| limbs[a].map_or(0.0, |i| weighted[i]));
    let covariance = block.cholesky()?.inverse();
    let value = covariance * own;
    Some(Change {
        value,
        covariance,
        explained: own.dot(&value),
    })
}
