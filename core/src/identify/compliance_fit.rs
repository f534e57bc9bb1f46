//! Step 4 without a grid: the compliance m/k that makes the mean *square* of w* smallest, in closed form.
//!
//! The paper looks for the smallest mean |w*| over a grid of k/m: a norm that has a kink at its minimum, over candidates that
//! end where the grid does. But w* is linear in the compliance x = m/k, to a ten-thousandth and less (see
//! [`super::stiffness_search`]): w* = p + (x - x_0) q, of which two decodes tell p and q. The mean square is then a parabola,
//! its vertex at
//!
//! ```text
//! x = x_0 - sum p . q / sum |q|^2,
//! ```
//!
//! and that is linear in whatever disturbs p. Where errors drown the effect, x lies anywhere, negative too, and
//! with it comes how far ([`crate::decouple::uncertainty::influence::ComplianceInfluence`]): no edge of a grid hides it.
//! Without errors both find the truth (test `ref_compliance_fit_finds_what_the_grid_finds`).

use glam::DVec3;

use crate::decouple::stream::Decoupler;
use crate::error::{Error, Result, require};
use crate::geometry::LIMBS;
use crate::model::Parameters;
use crate::model::{Sensor, Settings};

/// k/m of the two decodes, s^-2: the ends of the paper's grid.
const NODES_PER_S2: [f64; 2] = [10.0e8, 1.0e8];

/// Collects trials of pure linear motion above the threshold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ComplianceFit {
    stiff_squares: f64,
    products: f64,
    slope_squares: f64,
    samples: usize,
}

impl ComplianceFit {
    /// Decodes one trial twice and adds it; `each` sees by how much w* changes with m/k, shell axes, (rad/s)/s^2, sample by
    /// sample in order.
    ///
    /// # Errors
    /// Those of [`Decoupler::new`] and [`Decoupler::push`].
    pub fn push_trial(
        &mut self,
        sensor: &Sensor,
        parameters: &Parameters,
        settings: &Settings,
        voltage_v: &[[f64; LIMBS]],
        mut each: impl FnMut(DVec3),
    ) -> Result<()> {
        let decoupler = |stiffness_per_mass_per_s2: f64| {
            let parameters = Parameters {
                stiffness_per_mass_per_s2,
                ..*parameters
            };
            Decoupler::new(sensor, &parameters, settings)
        };
        let [stiff, soft] = NODES_PER_S2.map(|k| 1.0 / k);
        let (mut stiffer, mut softer) = (decoupler(NODES_PER_S2[0])?, decoupler(NODES_PER_S2[1])?);
        for row in voltage_v {
            let (Some(a), Some(b)) = (stiffer.push(row)?, softer.push(row)?) else {
                continue;
            };
            let slope = (b.rate_shell_rad_s - a.rate_shell_rad_s) / (soft - stiff);
            // With limbs that do not give way: m/k = 0.
            let stiff_rad_s = a.rate_shell_rad_s - slope * stiff;
            self.stiff_squares += stiff_rad_s.length_squared();
            self.products += stiff_rad_s.dot(slope);
            self.slope_squares += slope.length_squared();
            self.samples += 1;
            each(slope);
        }
        Ok(())
    }

    /// Sum of the squares of the slopes, (rad/s)^2/s^4.
    #[must_use]
    pub fn slope_squares(&self) -> f64 {
        self.slope_squares
    }

    /// The vertex: m/k, s^2. Errors of the scale factors may make it negative.
    ///
    /// # Errors
    /// [`Error::TooFewSamples`] without a sample; [`Error::OutOfRange`] if w* does not change with the compliance, or by
    /// numbers whose squares no f64 holds.
    pub fn solve(&self) -> Result<f64> {
        const WHAT: &str = "compliance per mass (step 4)";
        if self.samples == 0 {
            return Err(Error::TooFewSamples {
                what: WHAT,
                needed: 3,
                got: 0,
            });
        }
        let vertex = -self.products / self.slope_squares;
        let left = self.stiff_squares + self.products * vertex;
        require(
            self.slope_squares > 0.0 && vertex.is_finite() && left.is_finite(),
            WHAT,
            self.slope_squares,
            "found from motion in which the rate changes with it, by numbers whose squares are finite",
        )?;
        Ok(vertex)
    }
}
