//! The core against MuJoCo: motions, campaigns and modes that take seconds to simulate, and the rig against its own laws.
//!
//! One module is one suite of evidence; see [`sixaxis_props::evidence`].

mod campaign;
mod limbs;
mod literals;
mod motions;
mod reference;
mod rig_departures;
mod rig_motion;
mod threshold;
