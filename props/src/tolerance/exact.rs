//! Truth: a closed form, a manufactured motion, another derivation, or another path through the core. What is left is
//! rounding, a scheme's own error, or terms that a series drops.

use sixaxis_core::Scheme;

use super::{Tolerance, derived, measured, required};

/// Rounding of some hundred operations on numbers of one size.
pub const ROUNDING: Tolerance = derived(1024.0 * f64::EPSILON, "a thousand roundings");
/// A handful of operations on numbers of one size.
pub const LAST_DIGITS: Tolerance = derived(8.0 * f64::EPSILON, "eight roundings");
/// Second harmonic of a crank-slider's place by its series in the crank over the rod, to the seventh power.
pub const fn rod_harmonic(crank_over_rod: f64) -> Tolerance {
    let square = crank_over_rod * crank_over_rod;
    let ninth = square * square * square * square * crank_over_rod;
    derived(
        ninth / 64.0 / (1.0 - square),
        "the first term that is left out, 735/65536 of the ninth power, and all after it",
    )
}
/// A slope by central differences, relative, for a phase step of the crank and a rod of three cranks or more.
pub const fn rod_slope(phase_step_rad: f64) -> Tolerance {
    derived(
        4.0 * phase_step_rad * phase_step_rad,
        "the third derivative over six of a sine whose harmonics add up to less than 24 times it",
    )
}
/// Net force of nine limbs from voltages without noise, over the largest of the trial.
pub const WRENCH_SUM: Tolerance = measured(1e-12, 3.2e-14, "");
/// What a defect of size 0 changes of a simulated day, in relative means, summed over 22 recordings.
pub const NO_DEFECT: Tolerance = measured(1e-11, 1e-12, "directions that are normalized once more");
/// What a defect of the largest size that is drawn changes at least, in the same measure.
pub const SEEN: Tolerance = required(1e-3, "far above rounding");
/// Tail of a binomial distribution at an end of an interval, over what it should be, less one.
pub const BETA_QUANTILE: Tolerance =
    measured(1e-9, 1e-10, "iteration of the incomplete beta function");
/// Rate after a minute of a vehicle's motion, decoded at 1 kHz from forces in equilibrium, rad/s.
pub const COMPLIANT_RATE: Tolerance = measured(
    1e-5,
    3.5e-7,
    "over 100 seeds: the mass's own motion, which the truth leaves out, and the scheme",
);
/// Pose from elongations and back, over the size of the displacement.
pub const POSE_ROUND_TRIP: Tolerance = measured(3e-14, 1.2e-15, "");
/// Relative rate against a differenced rotation matrix, rad/s, at 0.02 rad and 1.7 rad/s.
pub const RELATIVE_RATE: Tolerance = derived(
    1.7 * 0.02 * 0.02 * 0.02 / 24.0 + 5e-9,
    "the dropped terms phi^3/24, and the square of the step times the cube of the rate",
);
/// Elongations against differences of distances, m.
pub const DISTANCE: Tolerance = derived(16.0 * 0.0255 * f64::EPSILON, "rounding of 25 mm");
/// Static preload against J (J^T J)^-1, relative.
pub const PRELOAD_LINEAR: Tolerance = measured(1e-5, 9.2e-7, "twice the sag over the limb length");
/// Identification from exact rows, over the condition number.
pub const EXACT_ROWS: Tolerance = measured(3e-14, 1.1e-15, "over 100 seeds");
/// The gyroscope's gain from exact rows, and the inertias found with it.
pub const GAIN: Tolerance = measured(2e-12, 5.7e-14, "over 100 seeds");
/// Manufactured motion, in units of what the scheme's order and the central differences leave.
pub const fn manufactured(scheme: Scheme) -> Tolerance {
    match scheme {
        Scheme::Euler => measured(4.0, 1.6, ""),
        Scheme::Heun => measured(0.5, 0.13, ""),
        Scheme::HeunSubstepped => measured(0.15, 0.04, ""),
        Scheme::AdamsBashforth2 => measured(4.0, 1.04, ""),
        Scheme::AdamsMoulton4 => measured(5.0, 1.4, "most of it is the start in mid-motion"),
        Scheme::RungeKutta4 => measured(2.0, 0.7, ""),
    }
}
/// Newton's and Euler's equations for the shell's rate against those for the mass's, over full scale.
pub const FORMULATIONS: Tolerance = measured(1.3e-11, 4.4e-13, "over 100 seeds");
/// Either against Hamilton's equations.
pub const CANONICAL: Tolerance = measured(1e-10, 1.9e-11, "over 100 seeds");
/// Departure of a converging integration's order from theory, in its asymptotic range.
pub const CONVERGENCE: Tolerance = measured(0.05, 0.02, "");
/// Departure of a scheme's order over a decade of step from theory, on the full equations.
pub const FULL_ORDER: Tolerance = measured(0.05, 0.02, "");
/// Error of Heun in eight sub-steps over that of plain Heun at a coarse step.
pub const SUBSTEPS: Tolerance = measured(0.1, 0.02, "");
/// Departure of R R^T from 1 after ten million steps.
pub const ORTHONORMAL: Tolerance = measured(1e-14, 4e-16, "");
/// What excluded limbs add to the error, noise-free, over full scale.
pub const WITHOUT_LIMBS: Tolerance = required(
    1e-9,
    "1e-9 of full scale; 1.8e-12 seen at strains of 3.3e-5, five times the rig's",
);
/// What is left in the attitude of a channel that broke at the last sample received, rad.
pub const SWITCH_OVER: Tolerance = measured(2e-9, 4.1e-10, "in rad");
/// The same of the rate.
pub const SWITCH_OVER_RATE: Tolerance = measured(1.2e-11, 3.9e-13, "over 100 seeds");
/// Outputs of one sensor looked at in two ways, over their largest.
pub const SYMMETRY: Tolerance = measured(1e-12, 2.7e-14, "");
/// Outputs in reversed time at 150 samples a period.
pub const TIME_REVERSAL: Tolerance = measured(2e-5, 4e-6, "the scheme's error, twice");
/// Two ways to one least-squares answer, over the largest value and the square of the condition number.
pub const LEAST_SQUARES: Tolerance = measured(
    2e-11,
    5e-13,
    "the singular value iteration stops at 1e-15 of the largest entry",
);
/// The same rows in another order, in other units, under other names or twice, over the same.
pub const SAME_ROWS: Tolerance = measured(6e-14, 1.9e-15, "over 100 seeds");
/// Unknowns tied together after the fact against rows that were tied before, over the same.
pub const TIED: Tolerance = measured(4e-13, 1.3e-14, "over 100 seeds");
/// (14) and (19) against a pseudo-inverse of the tall matrix, over the largest value.
pub const CLOSED_FORM: Tolerance = measured(1e-12, 7.5e-14, "");
/// Forces of a static load against the pseudo-inverse of the geometry, over the largest.
pub const STATIC_SHARE: Tolerance = measured(3e-14, 1.2e-15, "");
/// What rounding leaves of a condition number of 1e8, relative.
pub const NEAR_LIMIT: Tolerance = measured(1e-7, 4.4e-9, "");
/// Velocity of a parabola by central differences over 1e-5 s, relative.
pub const DIFFERENCED_ONCE: Tolerance = measured(2.5e-12, 8.4e-14, "rounding over the step");
/// Its acceleration.
pub const DIFFERENCED_TWICE: Tolerance =
    measured(5e-10, 1.7e-11, "rounding over the step's square");
/// Rate and angular acceleration of a rotation on a parabola, by the same.
pub const DIFFERENCED: Tolerance = measured(2e-8, 1.1e-8, "the fourth order in the rotation");
/// Accelerations by another way through the kernel, any sensor and motion, over the peak of the vector: the largest of 43 seeds, where a
/// motion of 1,200 samples lets rounding grow.
pub const PATHS: Tolerance = measured(1e-11, 1.5e-12, "");
/// Dropped terms of the strain series, in units of the fourth power of the strains' root sum of squares.
pub const STRAIN_SERIES: Tolerance = measured(1.0, 0.4, "");
/// A decay's derivatives against differences, over their size, beyond what the modes themselves explain.
pub const TAP_DERIVATIVES: Tolerance = measured(1e-6, 6.3e-8, "");
/// Derivatives of the frequency response against differences by 1e-5, over the largest.
pub const RESPONSE_DIFFERENCED: Tolerance = measured(
    1e-7,
    1.6e-8,
    "rounding over step and share of the motion that is relative, and the step's square",
);
/// Tilt of limbs to first order against an equilibrium, over load squared and limb length.
pub const TILT: Tolerance = measured(1e-6, 1e-7, "rounding of tilts of 1e-7");
/// Errors of step 2 by first-order theory, over the largest.
pub const FIRST_ORDER: Tolerance = measured(2e-3, 4e-4, "");
/// Cramér-Rao bound from analytic derivatives against one from differences by 1e-5, relative.
pub const BOUND: Tolerance = measured(1e-9, 3.4e-11, "");
/// Closed-form deviation of a parameter by one series of one trial against central differences of the whole pipeline, relative:
/// by a series that the parameter is linear in, the accelerometer in step 2 or a channel in step 3.
pub const BY_LINEAR_SERIES: Tolerance = measured(2e-9, 6.2e-11, "rounding over the step");
/// By a channel in step 2, whose scale factor it is.
pub const BY_CHANNEL: Tolerance = measured(1.2e-6, 4.1e-8, "the step's square");
/// By a channel in step 4.
pub const BY_CHANNEL_OF_STEP_4: Tolerance = measured(4e-5, 1.3e-6, "the step's square");
/// By the gyroscope.
pub const BY_GYROSCOPE: Tolerance = measured(
    3e-3,
    1.8e-4,
    "what the low-pass leaves of (15) as a residual",
);
/// What the closed form says is not reached, over what is.
pub const NOT_REACHED: Tolerance = measured(6e-5, 2.1e-6, "second order");
/// Closed-form change of a parameter by a standard's gain against central differences by 1e-4: the accelerometer's, which scales
/// everything.
pub const BY_ACCELEROMETER_GAIN: Tolerance = measured(2.6e-10, 8.7e-12, "rounding over the step");
/// The gyroscope's.
pub const BY_GYROSCOPE_GAIN: Tolerance = measured(4e-5, 1.5e-6, "the low-pass, again");
/// The same of m/k by step 2's errors, of which the closed form neglects that strains are as wrong as the scale factors: x ds/s,
/// a share that counts where the torques' own share, a hundred times m/k for a percent of s/m, cancels between limbs.
pub const COMPLIANCE_DERIVATIVE: Tolerance = measured(0.2, 6.5e-2, "");
/// m/k by least squares from a run without errors, relative.
pub const COMPLIANCE_FIT: Tolerance = measured(1e-4, 6e-6, "");
/// Scale factors and inertias of the joint fit of a campaign without noise on rigid limbs, relative: what lies above the last
/// harmonic.
pub const JOINT_NOISE_FREE: Tolerance =
    measured(5e-6, 1.5e-6, "the reference's gyroscope between samples");
/// ln ratios of scale factors from a tumble in closed form, sample by sample, after one repetition.
pub const RATIOS_CLOSED_FORM: Tolerance =
    measured(1e-11, 8e-13, "the third order of the strains, and rounding");
/// What the parity rows keep of a failure that is taken off the wrong limb of an ambiguous pair, over the failure.
pub const TWIN_TRACE: Tolerance = measured(1e-4, 3.9e-5, "curvature of strains of 1e-5");
/// Two harmonics of a simulated lag against the filter's differential equation, over the peak of what it shows.
pub const fn simulated_lag(drive_hz: f64, rate_hz: f64) -> Tolerance {
    let radians = 2.0 * core::f64::consts::PI * drive_hz / rate_hz;
    derived(
        2.0 * 9.0 * 3.0 / 128.0 * radians * radians * radians * radians,
        "twice the cubic's 3/128 (2 pi f h)^4, over both harmonics",
    )
}
/// The same of a high-pass, over the signal's peak.
pub const fn simulated_high_pass(corner_hz: f64, drive_hz: f64, rate_hz: f64) -> Tolerance {
    let radians = 2.0 * core::f64::consts::PI * drive_hz / rate_hz;
    derived(
        2.0 * 5.0 * 3.0 / 128.0 * radians * radians * radians * radians * corner_hz / drive_hz,
        "twice the cubic's 3/128 (2 pi f h)^4 times corner over f, over both harmonics",
    )
}
/// A high-pass undone by the core, over the signal's peak: two harmonics that are taken for straight between samples.
pub const fn undone_high_pass(corner_hz: f64, drive_hz: f64, rate_hz: f64) -> Tolerance {
    let radians = 2.0 * core::f64::consts::PI / rate_hz;
    derived(
        corner_hz * 2.0 * drive_hz * radians * radians / 6.0,
        "twice corner over f times (2 pi f h)^2/12, over both harmonics",
    )
}
/// A lag of 10 Hz undone at 1 kHz by the core's differentiator, over the signal's peak, away from the ends of the record: harmonics
/// of 1 and 2 Hz, of 5 and 10 Hz.
pub const UNDONE_LAG: [Tolerance; 2] = [
    measured(2e-6, 4.7e-7, "the differentiator's window of 21 samples"),
    measured(5e-4, 1.1e-4, "the differentiator's window of 21 samples"),
];
/// Rounding of 10,000 decoded samples against fifty digits, units of the last place of the vector's peak: linear and angular
/// acceleration, rate, attitude.
pub const DECODED_ULP: [Tolerance; 4] = [
    measured(2000.0, 478.0, "condition number 35"),
    measured(2500.0, 630.0, "condition number 47"),
    measured(240.0, 59.0, "condition number 14"),
    measured(1500.0, 368.0, "of the whole of it, one"),
];
/// Rounding of the four steps against fifty digits, units of the last place of each parameter.
pub const IDENTIFIED_ULP: [Tolerance; 4] = [
    measured(2.0, 0.41, ""),
    measured(40.0, 10.3, ""),
    measured(
        1200.0,
        297.0,
        "products of inertia, a thousandth of the moments",
    ),
    measured(
        4e5,
        1.08e5,
        "condition number 5e3, and twenty times that: all of k/m is in a millionth of the signals",
    ),
];
/// k/m of step 4 with limbs that point where their own nodes put them, as in core's kernel, against limbs that point to the nodes of
/// the pose, as printed: scale factors are 1e-6 off there.
pub const LIMBS_TO_NODES: Tolerance = measured(
    1e-6,
    2.6e-7,
    "what nine forces miss a pose by, times the strain",
);
/// d(f/m) / d ln(k/m) with tilted limbs at 5 Hz against MuJoCo, over the largest.
pub const TILTED_BY_STIFFNESS: Tolerance = measured(
    1.2e-3,
    2.9e-4,
    "harmonics that a cosine of twice the phase is not",
);
/// Bound of ln(k/m) with tilted limbs against differences of an exact equilibrium, relative.
pub const TILTED_BOUND: Tolerance = measured(
    2.5e-5,
    6.3e-6,
    "differences over a hundredth of m/k, and its second order",
);
/// By how many limits linear theory misses those forces.
pub const NO_TILT: f64 = 100.0;
