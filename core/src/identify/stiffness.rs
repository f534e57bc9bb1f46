//! Step 4: k/m from pure linear motion above the threshold, where the true w* is zero: eq. (20), Fig. 10.
//!
//! The search decodes the same trials for each k/m on a grid and takes the one with the smallest mean |w*|. All of
//! the effect comes from the motion of the mass in the shell, some four millionths of the torque balance: scale factors must
//! be right against each other to some hundred-thousandths before the minimum means anything. [`judge`] says when it does not.

use super::{Reason, Verdict};
use crate::decouple::stream::Decoupler;
use crate::error::{Error, Result, require, require_samples};
use crate::geometry::LIMBS;
use crate::model::Parameters;
use crate::model::{Sensor, Settings};

/// The paper's grid: from, to, step, s^-2.
pub const PAPER_GRID_PER_S2: (f64, f64, f64) = (1.0e8, 10.0e8, 0.1e8);

/// The minimum must lie this far below the largest value on the grid to be more than a dent in a floor of other
/// errors. In Fig. 10 as we measure it, noise-free, it is 1e-3 and less.
const FLOOR_OVER_LARGEST: f64 = 0.5;

/// Grid points of the paper's search, s^-2.
pub fn paper_grid() -> impl Iterator<Item = f64> + Clone {
    let (from, to, step) = PAPER_GRID_PER_S2;
    let points = ((to - from) / step + 0.5) as usize + 1;
    (0..points).map(move |i| from + step * i as f64)
}

/// Sum of |w*| over one trial and the number of samples in it, for one candidate k/m.
///
/// # Errors
/// Those of [`Decoupler::new`] and [`Decoupler::push`]; [`Error::Overflow`] if a rate or their sum is not finite.
pub fn rate_norm_sum(
    sensor: &Sensor,
    parameters: &Parameters,
    settings: &Settings,
    voltage_v: &[[f64; LIMBS]],
) -> Result<(f64, usize)> {
    let mut decoupler = Decoupler::new(sensor, parameters, settings)?;
    let (mut sum, mut count) = (0.0, 0);
    for row in voltage_v {
        if let Some(sample) = decoupler.push(row)? {
            sum += sample.rate_shell_rad_s.length();
            count += 1;
            if !sum.is_finite() {
                return Err(Error::overflow(
                    "mean rate (step 4)",
                    sample.sample as usize,
                ));
            }
        }
    }
    Ok((sum, count))
}

/// Result of step 4.
#[derive(Debug, Clone, PartialEq)]
pub struct StiffnessPerMass {
    /// Grid point with the smallest mean |w*|, s^-2: what the paper reads off.
    pub grid_minimum_per_s2: f64,
    /// Minimum of the parabola through that point and its neighbours in 1/(k/m), in which the rate is linear, s^-2.
    pub interpolated_per_s2: f64,
    /// Mean |w*| at the grid minimum, rad/s.
    pub smallest_rad_s: f64,
    /// Largest mean |w*| on the grid, rad/s.
    pub largest_rad_s: f64,
    /// Whether the curve determines k/m.
    pub verdict: Verdict,
}

/// Judges a search curve of (k/m, mean |w*|), ascending in k/m.
///
/// # Errors
/// [`Error::TooFewSamples`] below three points; [`Error::NotFinite`] (channel 0, sample = grid index);
/// [`Error::OutOfRange`] for a k/m that is not positive, finite and larger than the one before, or a negative |w*|.
pub fn judge(curve: &[(f64, f64)]) -> Result<StiffnessPerMass> {
    require_samples("stiffness per mass (step 4)", 3, curve.len())?;
    let mut best = 0;
    let mut largest = 0.0_f64;
    let mut previous = 0.0;
    for (i, &(k, value)) in curve.iter().enumerate() {
        require(
            k > previous && k.is_finite(),
            "stiffness_per_mass_per_s2",
            k,
            "positive, finite and ascending",
        )?;
        previous = k;
        if !value.is_finite() {
            return Err(Error::NotFinite {
                channel: 0,
                sample: i,
                value,
            });
        }
        require(value >= 0.0, "mean |w*|", value, "not negative")?;
        if value < curve[best].1 {
            best = i;
        }
        largest = largest.max(value);
    }
    let (grid_minimum, smallest) = curve[best];
    let inside = best > 0 && best + 1 < curve.len();
    let interpolated = if inside {
        let points = [curve[best - 1], curve[best], curve[best + 1]];
        vertex_in_compliance(points).unwrap_or(grid_minimum)
    } else {
        grid_minimum
    };
    let floor_over_largest = smallest / largest;
    let verdict = if !inside {
        Verdict::Undetermined {
            reason: Reason::EdgeOfGrid,
        }
    } else if floor_over_largest > FLOOR_OVER_LARGEST {
        Verdict::Undetermined {
            reason: Reason::Flat { floor_over_largest },
        }
    } else {
        Verdict::Determined
    };
    Ok(StiffnessPerMass {
        grid_minimum_per_s2: grid_minimum,
        interpolated_per_s2: interpolated,
        smallest_rad_s: smallest,
        largest_rad_s: largest,
        verdict,
    })
}

/// Vertex of the parabola through the squares of three curve points over x = 1/(k/m), as k/m.
///
/// w* is linear in x, so the square of its mean size is close to a parabola in x where the size itself has a kink.
fn vertex_in_compliance(points: [(f64, f64); 3]) -> Option<f64> {
    let [(x0, y0), (x1, y1), (x2, y2)] = points.map(|(k, w)| (1.0 / k, w * w));
    let slope01 = (y1 - y0) / (x1 - x0);
    let slope12 = (y2 - y1) / (x2 - x1);
    let curvature = (slope12 - slope01) / (x2 - x0);
    let vertex = 0.5 * (x0 + x1) - 0.5 * slope01 / curvature;
    // The vertex of points beyond the range of squares is nowhere.
    (curvature > 0.0 && vertex > 0.0)
        .then(|| 1.0 / vertex)
        .filter(|k| k.is_normal())
}
