//! The judges: generators, tolerances and comparisons with which `sixaxis-core` is tested against `sixaxis-reference`.
//!
//! The suites themselves are in `tests/`: four programs, of which each module is a suite. A test's name begins with the class
//! of its evidence: `ref_` another implementation, `paper_` a printed number, `prop_` input that is drawn, `law_` a statement about
//! given input, `stat_` a statistic over seeded draws, `inv_` an invariant, `order_` a rate of convergence, `neg_` something broken that
//! fails, `regress_` a defect that stays mended.
//!
//! Without the feature `strategies` nothing here needs proptest, so that a report can be made without it.

pub mod aided;
pub mod blind;
pub mod campaign;
pub mod compare;
pub mod evidence;
pub mod faults;
pub mod joint;
pub mod manufactured;
pub mod motions;
pub mod problem;
pub mod propagation;
pub mod provenance;
pub mod publication;
pub mod results;
pub mod rigid;
pub mod seed;
pub mod self_calibration;
pub mod statistics;
#[cfg(feature = "strategies")]
pub mod strategy;
pub mod taps;
pub mod tolerance;
pub mod truth;
pub mod undone;
