//! Truth: closed forms of limbs that are not ideal, and a MuJoCo model written from the paper's own literals.

use super::{Tolerance, measured};

/// Forces at rest of limbs whose flexures bend, MuJoCo's against the hinges' energy, over the largest.
pub const BENT_AT_REST: Tolerance = measured(5e-6, 6.4e-7, "second order in the tilt");
/// Frequencies of modes with flexures that bend or limbs with mass, MuJoCo's ring-downs against closed forms, relative.
pub const LIMB_MODES: Tolerance = measured(2e-6, 2.7e-7, "");
/// What lateral damping does to forces at 5 Hz, over the largest effect: the closed form is of first order in the damping.
pub const LATERAL_DAMPING: Tolerance = measured(1e-2, 1.6e-3, "first order in the damping");
/// Limb forces of the reference against those of a model from the paper's literals, over the largest.
pub const LITERAL_FORCES: Tolerance = measured(5e-6, 5.7e-7, "a force that is held for a step");
/// Accelerations decoupled from that model's voltages against its motion law, over the peak.
pub const LITERAL_DECOUPLED: Tolerance = measured(1e-5, 1.1e-6, "a force that is held for a step");
