//! Laws: equations, symmetries, orders of convergence and statistics that hold for any sensor. Fast: every mutant of core runs
//! against them (`.ci/mutants`).
//!
//! One module is one suite of evidence; see [`sixaxis_props::evidence`].

mod aided;
mod analogue;
mod attitude;
mod covariance;
mod deaths;
mod detection;
mod failed_limbs;
mod fast_ways;
mod fifty_digits;
mod formulations;
mod identification;
mod integrators;
mod iteration;
mod least_squares;
mod paths;
mod pose;
mod propagation;
mod rank;
mod round_trip;
mod runs;
mod search;
mod steady;
mod stiffness_bias;
mod stiffness_bound;
mod symmetry;
mod tap;
mod truth;
mod zero_wander;
