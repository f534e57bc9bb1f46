//! Limbs with mass, which a fit without it takes for cross-talk, or finds no way through.
//!
//! A limb's element shows, beside the force on the mass, what accelerates half of its own rod. Along the travel that is the load of a point mass
//! at each of the three nodes: other scale factors and another centre of the mass. So both are free where limbs have mass, and what tells them
//! apart is the square of the rate. Rods of 0.01 % contradict the trials of a fit that has none, or channels that are apart show something of each
//! other there.

use sixaxis_core::identify::joint::estimate::JointEstimate;
use sixaxis_core::identify::joint::unknowns::ROD_MASS;

use super::account::SIGNIFICANT;

/// How heavy limbs may be, half of one over the seismic mass, a standard deviation.
pub(super) const DEVIATION: f64 = 2e-2;
/// What limbs weigh that weigh anything, half of one over the seismic mass.
const LEAST: f64 = 2e-5;
/// Spread of what channels apart show of each other from which on it is worth another fit.
const WORTH_A_FIT: f64 = 3e-5;
/// Whether a fit's cross-talk may be limbs with mass.
pub(super) fn may_be(held: &JointEstimate) -> bool {
    held.spreads.cross_talk_apart > WORTH_A_FIT
}

/// Whether a fit with the mass free says that the limbs have some.
pub(super) fn is_told(free: &JointEstimate) -> bool {
    let deviation = free.covariance[(ROD_MASS, ROD_MASS)].sqrt();
    free.unknowns.values[ROD_MASS] > LEAST.max(SIGNIFICANT * deviation)
}
