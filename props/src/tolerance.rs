//! Every limit that a test holds something to, with its reason.

/// Why a limit is what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// It follows from the arithmetic; the expression is the limit's own.
    Derived,
    /// It was measured; the text gives the value seen, and the limit leaves room for other machines.
    Measured(&'static str),
    /// The reference can say no more; the text gives its own error.
    ReferenceLimited(&'static str),
}

/// A limit on an error, in the unit of the comparison (mostly relative).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Largest error that passes.
    pub limit: f64,
    /// Why.
    pub reason: Reason,
}

const fn new(limit: f64, reason: Reason) -> Tolerance {
    Tolerance { limit, reason }
}

/// Rounding of some hundred operations on numbers of one size.
pub const ROUNDING: Tolerance = new(1024.0 * f64::EPSILON, Reason::Derived);
/// MuJoCo's elongations at rest, over the largest.
pub const STATIC_ELONGATION: Tolerance = new(
    1e-9,
    Reason::ReferenceLimited("2e-10 seen: rounding of 18 nm in site positions of 40 mm"),
);
/// Commanded against simulated acceleration of the shell, over the peak.
pub const EXACT_DRIVE: Tolerance = new(1e-12, Reason::Measured("1.3e-13"));
/// Forces per mass of sensors that differ in nothing but their mass, over the largest force.
pub const MASS_RATIO: Tolerance = new(
    5e-9,
    Reason::ReferenceLimited("4e-10 seen: rounding walks in the modes"),
);
/// Decoupled against true acceleration, over the peak of the vector, at 10 kHz with true parameters.
pub const DECOUPLED: Tolerance = new(
    1e-6,
    Reason::ReferenceLimited("1.4e-7 seen, of which most is the step of 25 us"),
);
/// The coordination equations on MuJoCo's limb forces, over the largest force: second order in limb tilt.
pub const COORDINATION: Tolerance = new(5e-5, Reason::Measured("1.1e-5"));
/// By how much the reference's order of convergence may fall short of four.
pub const REFERENCE_ORDER: Tolerance = new(
    0.2,
    Reason::Measured("3.90 to 3.91: quaternions are advanced as MuJoCo does"),
);
/// Departure of a scheme's measured order from theory, between 500 Hz and 1 kHz on a 5 Hz run.
pub const ORDER: Tolerance = new(
    0.2,
    Reason::Measured("0.001 to 0.14: 1 kHz is not yet the limit of Adams-Moulton"),
);
/// Pose from elongations and back, over the size of the displacement.
pub const POSE_ROUND_TRIP: Tolerance = new(1e-12, Reason::Measured("1e-15"));
/// Relative rate against a differenced rotation matrix, rad/s, at 0.02 rad and 1.7 rad/s: the square of the step
/// times the cube of the rate, and the dropped terms phi^3/24.
pub const RELATIVE_RATE: Tolerance = new(1.7 * 0.02 * 0.02 * 0.02 / 24.0 + 5e-9, Reason::Derived);
/// Elongations against differences of distances, m: rounding of 25 mm.
pub const DISTANCE: Tolerance = new(16.0 * 0.0255 * f64::EPSILON, Reason::Derived);
/// Static preload against J (J^T J)^-1, relative: the sag over the limb length, twice over.
pub const PRELOAD_LINEAR: Tolerance = new(1e-5, Reason::Derived);
/// Relative acceleration in MuJoCo against linear theory.
pub const LINEAR_THEORY: Tolerance = new(2e-5, Reason::Measured("4e-6: geometric nonlinearity"));
/// Identification from exact rows.
pub const EXACT_ROWS: Tolerance = new(
    1e-9,
    Reason::Measured("2e-10 over the condition number at the worst"),
);
/// Scale factors and inertia from simulated runs with the compliance kept, relative.
pub const COMPLIANT: Tolerance = new(4e-8, Reason::Measured("9e-9, the reference's own"));
/// Rate (rad/s) and rotation (rad) at the end of a closed run: three Newton steps.
pub const CLOSED: Tolerance = new(1e-8, Reason::Measured("1.5e-11"));
/// The gyroscope's gain from exact rows: the minimum of a parabola is flat over the root of rounding.
pub const GAIN: Tolerance = new(1e-6, Reason::Derived);
/// A broken ingredient must exceed the limit of the sound one by this factor.
pub const NEGATIVE_CONTROL: f64 = 100.0;
