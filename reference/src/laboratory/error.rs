//! Sessions that cannot be simulated.

use thiserror::Error;

#[cfg(feature = "mujoco")]
use crate::mujoco::simulation::SimulationError;

/// A session that cannot be simulated.
#[derive(Debug, Error)]
pub enum SessionError {
    /// MuJoCo refuses.
    #[cfg(feature = "mujoco")]
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The plan says something that cannot be.
    #[error("simulation plan: {key}: {cause}")]
    Plan {
        /// The key, as in `rig.rest_s`.
        key: String,
        /// What is wrong, and what would be right.
        cause: String,
    },
}

impl SessionError {
    /// A plan that is refused at a key.
    pub(super) fn plan(key: &str, cause: impl Into<String>) -> Self {
        Self::Plan {
            key: key.to_owned(),
            cause: cause.into(),
        }
    }

    /// A plan that wants MuJoCo at a key, in a build that has none.
    #[cfg(not(feature = "mujoco"))]
    pub(super) fn without_mujoco(key: &str) -> Self {
        Self::plan(
            key,
            "this build has no MuJoCo; set engine = \"rigid\" and rig.taps = 0",
        )
    }
}
