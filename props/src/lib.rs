//! The judges: generators, tolerances and comparisons with which `sixaxis-core` is tested against `sixaxis-reference`.
//!
//! The suites themselves are in `tests/`, one file a subject; a test's name begins with the class of its evidence:
//! `ref_` MuJoCo, `paper_` a printed number, `prop_` any input, `inv_` an invariant, `order_` a rate of convergence.

pub mod blind;
pub mod compare;
pub mod evidence;
pub mod faults;
pub mod hostile;
pub mod joint;
pub mod manufactured;
pub mod motions;
pub mod propagation;
pub mod publication;
pub mod results;
pub mod rig_runs;
pub mod rigid;
pub mod self_calibration;
pub mod statistics;
pub mod strategy;
pub mod taps;
pub mod tolerance;
pub mod truth;
