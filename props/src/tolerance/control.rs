//! Negative controls: how wrong a deliberately broken variant is made, and how clearly that must show.

/// A broken ingredient must exceed the limit of the sound one by this factor.
pub const NEGATIVE_CONTROL: f64 = 100.0;

/// Relative change of the squared elongations that shows a free model at work.
pub const STIRRED: f64 = 0.1;
/// Relative difference above which two theoretical values can be told apart a hundred times over.
pub const TOLD_APART: f64 = 1e-2;

/// Relative differences that a decay's derivatives are compared with: phases of a hundred radians move by 1e-4.
pub const TAP_DIFFERENCE: f64 = 1e-6;
/// Assumed over true I/m in the control of a tap with wrong moments of inertia.
pub const TAP_WRONG_INERTIA: f64 = 1.05;
/// Stated over true error of I/m there.
pub const TAP_BELIEVED: f64 = 0.01;
/// Standard errors by which k/m must then be wrong: ten intervals' half widths.
pub const TAP_BEYOND: f64 = 20.0;
/// A rig's resonance in the control of the verdict: frequency, Hz, and amplitude in the first channel, V.
pub const TAP_RIG_HZ: f64 = 1100.0;
/// See [`TAP_RIG_HZ`].
pub const TAP_RIG_V: f64 = 0.1;

/// Share of an inertia's deviation that goes unseen, at least, where step 3 takes the scale factors for exact. Measured 0.45.
pub const CROSS_TERM_LOST: f64 = 0.2;

/// Bias in standard deviations that errors in variables may leave.
pub const JOINT_BIAS: f64 = 0.1;
/// Bias in standard deviations that plain least squares must show where the joint fit shows none.
pub const PLAIN_BIAS: f64 = 1.0;
/// Share of wild samples in a record, and their size over the converter's range.
pub const WILD_SHARE: f64 = 0.01;
/// Errors in bounds that plain squares must show under wild samples.
pub const BENT_Z: f64 = 20.0;

/// Factor by which ratios from MuJoCo must be worse without the second order.
pub const SECOND_ORDER_SEEN: f64 = 3.0;
/// Correlation of neighbouring blocks of slow noise, in deviations, at least.
pub const COLOURED_Z: f64 = 10.0;
/// Share of one channel that is added to another.
pub const CROSSTALK: f64 = 5e-3;
/// What [`CROSSTALK`] must make of the loop's misfit or of the correlation of neighbouring blocks, in deviations: beyond
/// one false alarm in a million.
pub const CROSSTALK_Z: f64 = 5.0;

/// Noise over what the detector assumes in the control: the energy of 64 samples shows it in every window.
pub const FALSE_ALARM_NOISE: f64 = 1.3;
/// Error of the attitude, rad, that a dead limb must leave half a second after it died where it is not excluded.
/// Measured 0.2 to 2.9.
pub const DEAD_LIMB_RAD: f64 = 0.1;
