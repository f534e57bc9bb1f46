//! Decoupling for longer than seconds: how well rate and attitude are still known, and what else keeps them.
//!
//! The decoupler integrates angular acceleration to rate and rate to attitude with nothing to hold either. Specific
//! force in *sensor axes* needs neither, and its errors, those of zeros and sensitivities, are not integrated; what is turned into *ground axes* is as good as the attitude. An
//! error-state Kalman filter runs beside the decoupler, at a lower rate than it, and says how good that is. Where something else is
//! known of the motion, rest, a bounded velocity or an attitude, the filter corrects rate, attitude, zero drifts and scale factors with it.
//!
//! | file | holds |
//! |---|---|
//! | [`block`] | means of consecutive samples, all that the filter sees of a recording |
//! | [`model`] | how errors of parameters, rate, attitude and velocity grow from one block to the next |
//! | `deviations` | what that covariance says of attitude, rate and accelerations |
//! | `bending` | what errors have done to attitude and velocity in second order |
//! | [`correction`] | what a measurement does: errors found, and what they have bent |
//! | [`filter`] | their covariance, and the gain of a measurement |
//! | [`bound`] | what aids leave open just before the next comes, the sensor standing still |
//! | [`aid`] | what a measurement is, and the one of a state at rest |
//! | [`rest`] | whether the sensor is at rest, from its channels |
//! | `unknown` | errors of which nothing is known any longer |
//! | `steady` | whether it may as well turn, or move on, as it did |
//! | `steer` | a decoupler's rate and attitude changed in mid-stream |
//! | [`decoupler`] | decoupler and filter in one stream |
//! | `channels` | zero drifts and scale factors that the filter has corrected |
//! | `history` | what is remembered of a recording that is to be smoothed |
//! | `smoother` | what the whole of it says of each of its times |
//! | `gain` | by how much errors go back over a block of it |
//! | [`second_pass`] | the same recording decoupled with that |
//!
//! # Errors
//! All errors are *decoded less true*, to first order:
//!
//! | places | error | axes, unit |
//! |---|---|---|
//! | 0 to 2 | attitude psi, R_decoded = exp(\[psi\]x) R | ground, rad |
//! | 3 to 5 | rate | shell, rad/s |
//! | 6 to 8 | velocity since the first sample | ground, m/s |
//! | 9 to 17 | zero drifts | V |
//! | 18 to 26 | scale factors | 1/kg |
//! | 27 to 32 | inertias | m^2 |
//!
//! Inertias are considered and never corrected (Schmidt): all else is as uncertain as they make it. So is the heading, where gravity
//! alone is measured against: to first order a turn about it seems to show once other errors are large, and it does not. Velocities,
//! those of rests, too, leave scale factors alone. Stiffness has no part.
//!
//! Where an amplifier's high-pass is undone, zeros wander
//! ([`ZeroWander`](crate::decouple::uncertainty::ZeroWander)): by a walk, whose steps are the channels' own noise, and by a ramp, which the
//! filter takes for a walk that comes as far.
//!
//! Two things are of second order: an error of the attitude has turned itself on, and has bent gravity into the velocity by half its
//! square, which a rest tells to a millimetre a second. Both are taken off with an error that is found, and what is left counts about the
//! corrected ones.

pub mod aid;
mod bending;
pub mod block;
pub mod bound;
mod channels;
pub mod correction;
pub mod decoupler;
mod deviations;
pub mod filter;
#[cfg(feature = "alloc")]
mod gain;
#[cfg(feature = "alloc")]
mod history;
pub mod model;
pub mod rest;
#[cfg(feature = "alloc")]
pub mod second_pass;
#[cfg(feature = "alloc")]
mod smoother;
mod steady;
mod steer;
mod unknown;

pub use aid::{Aid, Taken};
pub use bound::Bound;
pub use decoupler::AidedDecoupler;
pub use deviations::Deviations;
pub use filter::ErrorFilter;
pub use rest::RestFinder;
#[cfg(feature = "alloc")]
pub use second_pass::SmoothedDecoupler;
#[cfg(feature = "alloc")]
pub use smoother::Smoothed;
