//! What the benches time, and the proof that it is worth timing.
//!
//! Every bench gets its input from a [`sixaxis_props::problem`], which MuJoCo played and whose truth MuJoCo knows. The code that is
//! about to be timed first answers the problem once; [`validate`] holds the answer against the truth, to a limit from
//! [`sixaxis_props::tolerance`], and panics if it fails: a fast wrong answer gets no time. The other side of every ratio is the same
//! mathematics written down plainly, held to the same truth: the paper's decoder ([`sixaxis_core::paper`]), the pose by
//! Gauss-Newton ([`gauss_newton`]), identification by a pseudo-inverse ([`pseudo_inverse`]).
//!
//! Names are `quantity/problem/implementation`; implementations of one problem share a group and so a run. Only ratios
//! within a run mean anything: the nanoseconds are the machine's. Nothing here is tested for its own sake; tests of
//! this package show that a wrong answer is refused.

pub mod free_sensor;
pub mod gauss_newton;
pub mod machine;
pub mod pseudo_inverse;
pub mod spread;
pub mod validate;

use std::time::Duration;

/// Measurement time of each bench unless `--measurement-time` says otherwise.
pub const MEASUREMENT_TIME: Duration = Duration::from_secs(2);
/// Warm-up time of each bench unless `--warm-up-time` says otherwise.
pub const WARM_UP_TIME: Duration = Duration::from_millis(500);
/// Samples that the median of each bench is taken over: the slowest takes 6 ms an iteration.
pub const SAMPLE_SIZE: usize = 50;
