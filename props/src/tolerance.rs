//! Every limit that a test holds something to, with its reason.

use sixaxis_core::Scheme;

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

/// Limits on the distribution of an error over many cases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gate {
    /// On the median.
    pub median: f64,
    /// On what 99 % of the cases stay below.
    pub q99: f64,
    /// On the largest.
    pub max: f64,
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
pub const REFERENCE_ORDER: Tolerance = new(0.2, Reason::Measured("3.91 to 4.03"));
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
/// Manufactured motion, in units of what the scheme's order and the central differences leave.
#[must_use]
pub const fn manufactured(scheme: Scheme) -> Tolerance {
    match scheme {
        Scheme::Euler => new(4.0, Reason::Measured("1.6")),
        Scheme::Heun => new(0.5, Reason::Measured("0.13")),
        Scheme::HeunSubstepped => new(0.15, Reason::Measured("0.04")),
        Scheme::AdamsBashforth2 => new(4.0, Reason::Measured("1.04")),
        Scheme::AdamsMoulton4 => new(
            5.0,
            Reason::Measured("1.4, of which most is the start in mid-motion"),
        ),
        Scheme::RungeKutta4 => new(2.0, Reason::Measured("0.7")),
    }
}
/// Three derivations against each other, over full scale.
pub const FORMULATIONS: Tolerance = new(
    1e-10,
    Reason::Measured("1e-11 with the canonical one, 3e-14 without"),
);
/// Departure of a converging integration's order from theory, in its asymptotic range.
pub const CONVERGENCE: Tolerance = new(0.05, Reason::Measured("0.02"));
/// Departure of a scheme's order over a decade of step from theory, on the full equations.
pub const FULL_ORDER: Tolerance = new(0.05, Reason::Measured("0.02"));
/// Error of Heun in eight sub-steps over that of plain Heun at a coarse step.
pub const SUBSTEPS: Tolerance = new(0.1, Reason::Measured("0.02"));
/// Departure of R R^T from 1 after ten million steps.
pub const ORTHONORMAL: Tolerance = new(1e-14, Reason::Measured("4e-16"));
/// What decoupling without limbs adds to the error, noise-free, over full scale: the bar asked for.
pub const WITHOUT_LIMBS: Tolerance = new(
    1e-9,
    Reason::Measured("1.8e-12 at strains of 3.3e-5, five times the rig's"),
);
/// The same on the rig in MuJoCo.
pub const WITHOUT_LIMBS_RIG: Tolerance = new(
    2e-8,
    Reason::ReferenceLimited(
        "5.0e-9 seen: MuJoCo's strains leave 5.5e-10 of the largest in the parity rows, and that is amplified",
    ),
);
/// Error in single precision without limbs over that with all.
pub const WITHOUT_LIMBS_F32: Tolerance = new(3.0, Reason::Measured("1.2"));
/// The same where the mass is taken to stay in its place: second order in limb tilt.
pub const WITHOUT_LIMBS_TILT: Tolerance = new(5e-4, Reason::Measured("1.5e-4"));
/// What is left of a channel that broke at the last sample received, of the rate's peak and in rad.
pub const SWITCH_OVER: Tolerance = new(2e-9, Reason::Measured("4.1e-10 rad, 4e-13 of the rate"));
/// Error of random motions in MuJoCo, over full scale.
pub const RANDOM_MOTION: Gate = Gate {
    median: 1e-7,
    q99: 1e-6,
    max: 2e-6,
    reason: Reason::Measured("3e-8, 4e-7 and 7.3e-7 over 1,000 motions"),
};
/// The same over what is allowed: 1e-6 and the reference's own error.
pub const RANDOM_MOTION_SHARE: Gate = Gate {
    median: 1.0,
    q99: 1.0,
    max: 1.0,
    reason: Reason::Derived,
};
/// Frequency of a mode from a ring-down against the eigenproblem, relative.
pub const MODE_FREQUENCY: Tolerance = new(1e-5, Reason::Measured("4.4e-7"));
/// Drift of the energy of the free two-body model over 20 ms, relative.
pub const ENERGY: Tolerance = new(
    2e-9,
    Reason::Measured("2e-10: the modes lose energy at the fifth power of the step"),
);
/// Drift of its linear momentum, relative.
pub const MOMENTUM: Tolerance = new(1e-12, Reason::Measured("3e-14"));
/// Drift of its angular momentum, relative.
pub const ANGULAR_MOMENTUM: Tolerance = new(1e-12, Reason::Measured("1.4e-14"));
/// Relative change of the squared elongations that shows a free model at work.
pub const STIRRED: f64 = 0.1;
/// Departure from two of the order of MuJoCo's own step for a tumbling body.
pub const MUJOCO_ORDER: Tolerance = new(0.2, Reason::Measured("0.09"));
/// Positions after 100 steps about a fixed axis, ours against MuJoCo's, m and rad.
pub const FIXED_AXIS_STEP: Tolerance = new(1e-14, Reason::Measured("1.1e-15"));
/// Fourth difference of a limb force per mass at 10 kHz in a slow run, m/s^2: sixteen roundings of a length and more.
pub const ROUNDING_NOISE: Tolerance = new(1e-6, Reason::Measured("1.4e-7"));
/// Tare from one place of rest, in roundings of a limb's length.
pub const TARE_ROUNDINGS: Tolerance = new(4.0, Reason::Derived);
/// Mean tare over 400 places, in the same.
pub const MEAN_TARE_ROUNDINGS: Tolerance = new(
    1.0,
    Reason::Measured("0.55: hinge positions are rounded, too"),
);
/// Threshold frequency against the printed one, Hz: half a unit in the last printed digit.
pub const PRINTED_THRESHOLD_HZ: Tolerance = new(0.05, Reason::Derived);
/// Departure of a power law's exponent from theory.
pub const THRESHOLD_POWER: Tolerance = new(1e-5, Reason::Measured("2e-6"));
/// Relative difference above which two theoretical values can be told apart a hundred times over.
pub const TOLD_APART: f64 = 1e-2;
/// Outputs of one sensor looked at in two ways, over their largest.
pub const SYMMETRY: Tolerance = new(1e-12, Reason::Measured("2.7e-14"));
/// Outputs in reversed time at 150 samples a period: the scheme's error, twice.
pub const TIME_REVERSAL: Tolerance = new(2e-5, Reason::Measured("4e-6"));
/// The four steps as printed, noise-free: drift (V), scale, inertia, stiffness (relative).
pub const FOUR_STEPS: [Tolerance; 4] = [
    new(1e-12, Reason::Derived),
    new(5e-6, Reason::Measured("1.9e-6: relative motion neglected")),
    new(5e-6, Reason::Measured("7e-7")),
    new(1e-2, Reason::Measured("1.8e-3: what step 2 neglects")),
];
/// Steps 2 to 4 repeated with the compliance kept.
pub const REPEATED_STEPS: [Tolerance; 4] = [
    new(1e-12, Reason::Derived),
    new(2e-8, Reason::Measured("3e-9, the reference's own")),
    new(1e-8, Reason::Measured("2e-9")),
    new(
        2e-4,
        Reason::Measured("4e-5: a parabola through three grid points"),
    ),
];
/// Two ways to one least-squares answer, over the largest value and the square of the condition number.
pub const LEAST_SQUARES: Tolerance = new(
    2e-11,
    Reason::Measured("5e-13: the singular value iteration stops at 1e-15 of the largest entry"),
);
/// (14) and (19) against a pseudo-inverse of the tall matrix, over the largest value.
pub const CLOSED_FORM: Tolerance = new(1e-12, Reason::Measured("3e-15"));
/// Chi-square of predicted against seen errors, in half widths of an interval that chance leaves once in a million.
pub const CHI_SQUARE: Tolerance = new(1.0, Reason::Derived);
/// What rounding leaves of a condition number of 1e8, relative.
pub const NEAR_LIMIT: Tolerance = new(1e-6, Reason::Measured("4e-9"));
/// A handful of operations on numbers of one size.
pub const LAST_DIGITS: Tolerance = new(8.0 * f64::EPSILON, Reason::Derived);
/// Central differences of a parabola over 1e-5 s, over the size of the derivative: rounding over the step's square.
pub const DIFFERENCED: Tolerance = new(2e-8, Reason::Measured("3e-9"));
/// A broken ingredient must exceed the limit of the sound one by this factor.
pub const NEGATIVE_CONTROL: f64 = 100.0;

/// Accelerations of the rig at 5 Hz against the printed formulas in the same discretisation, over the peak of the vector,
/// after ten thousand samples.
pub const PRINTED_FORMULAS: Tolerance = new(1e-12, Reason::Measured("6e-14"));
/// Accelerations by another way through the kernel, any sensor and motion, over the peak of the vector.
pub const PATHS: Tolerance = new(1e-12, Reason::Measured("1e-13"));
/// Dropped terms of the strain series, in units of the fourth power of the strains' root sum of squares.
pub const STRAIN_SERIES: Tolerance = new(1.0, Reason::Measured("0.4"));
/// Single precision over a run of the rig at 5 Hz, over the peak.
pub const SINGLE_PRECISION: Tolerance = new(3e-4, Reason::Measured("7e-5"));
/// Sums of |w*| by interpolation in 1/(k/m), over the largest of the curve.
pub const SEARCH: Tolerance = new(1e-9, Reason::Measured("8e-11"));
/// Forces of limbs that do not give way against MuJoCo's, over the run's largest: in units of the square of the drive over
/// k/m, the share of the shell's motion by which the mass moves in it.
#[must_use]
pub const fn rigid_limbs(frequency_hz: f64, stiffness_per_mass_per_s2: f64) -> Tolerance {
    let rate = core::f64::consts::TAU * frequency_hz;
    new(
        5.0 * rate * rate / stiffness_per_mass_per_s2,
        Reason::Measured("2.1 to 3.1; 1e-6 at 1.5 Hz, 1.1e-5 at 5 Hz"),
    )
}
/// The rig's motion in closed form against MuJoCo's integration, over the peak.
pub const RIGID_MOTION: Tolerance = new(1e-12, Reason::Measured("1.4e-13"));

/// Relative differences that a decay's derivatives are compared with: phases of a hundred radians move by 1e-4.
pub const TAP_DIFFERENCE: f64 = 1e-6;
/// A decay's derivatives against those differences, over their size, beyond what the modes themselves explain.
pub const TAP_DERIVATIVES: Tolerance = new(1e-5, Reason::Derived);
/// A normal variable in its standard deviations: one false alarm in a million.
pub const TAP_CHANCE: Tolerance = new(crate::statistics::ONE_IN_A_MILLION, Reason::Derived);
/// Standard error of ln k/m that a tap states against the Cramér-Rao bound: noise that is estimated from 12,000 residuals.
pub const TAP_STANDARD_ERROR: Tolerance = new(0.1, Reason::Measured("0.02 over eleven taps"));
/// I/m that a tap is told over the true one, for the control.
pub const TAP_WRONG_INERTIA: f64 = 1.05;
/// Its stated over its true error there.
pub const TAP_BELIEVED: f64 = 0.01;
/// Standard errors by which k/m must then be wrong: ten intervals' half widths.
pub const TAP_BEYOND: f64 = 20.0;
/// A rig's resonance in the control of the verdict: frequency, Hz, and amplitude in the first channel, V.
pub const TAP_RIG_HZ: f64 = 1100.0;
/// See [`TAP_RIG_HZ`].
pub const TAP_RIG_V: f64 = 0.1;
/// k/m of a session over the half width of its 95 % interval: 2.5 of those are one false alarm in a million.
pub const TAP_INTERVAL: Tolerance =
    new(crate::statistics::ONE_IN_A_MILLION / 1.96, Reason::Derived);
/// Half width of k/m's interval by two taps of a 60 dB chain, with standards of class 1 % and ranges good to half a per cent.
pub const TAP_HALF_WIDTH: Tolerance = new(2e-2, Reason::Derived);
/// Derivatives of the frequency response against differences by 1e-5, over the largest: rounding over step and share of the
/// motion that is relative, and the step's square.
pub const RESPONSE_DIFFERENCED: Tolerance = new(1e-7, Reason::Measured("1.6e-8"));
/// Nine forces at 500 Hz against MuJoCo's, whose limbs have 2 % of damping, over the largest.
pub const SHAKEN: Tolerance = new(2e-5, Reason::Measured("4.3e-6"));
/// Tilt of limbs to first order against an equilibrium, over load squared and limb length: rounding of tilts of 1e-7.
pub const TILT: Tolerance = new(1e-6, Reason::Measured("1e-7"));
/// Errors of step 2 by first-order theory, over the largest.
pub const FIRST_ORDER: Tolerance = new(2e-3, Reason::Measured("4e-4"));
/// Cramer-Rao bound from analytic derivatives against one from differences by 1e-5, relative.
pub const BOUND: Tolerance = new(1e-5, Reason::Derived);
/// Closed-form change of a parameter against central differences of the whole pipeline, relative.
pub const PIPELINE_DERIVATIVE: Tolerance = new(
    3e-3,
    Reason::Measured(
        "1e-3 by the gyroscope, 4e-8 by all else: what the low-pass leaves of (15) as a residual",
    ),
);
/// The same of m/k by step 2's errors, of which the closed form neglects that strains are as wrong as the scale factors: x ds/s,
/// a share that counts where the torques' own share, a hundred times m/k for a percent of s/m, cancels between limbs.
pub const COMPLIANCE_DERIVATIVE: Tolerance = new(0.2, Reason::Measured("6.5e-2"));
/// Share of an inertia's deviation that goes unseen, at least, where step 3 takes the scale factors for exact. Measured 0.45.
pub const CROSS_TERM_LOST: f64 = 0.2;
/// m/k by least squares from a run without errors, relative.
pub const COMPLIANCE_FIT: Tolerance = new(1e-4, Reason::Measured("6e-6"));

/// Scale factors and inertias of the joint fit of a campaign without noise on rigid limbs, relative: what lies above the last
/// harmonic.
pub const JOINT_NOISE_FREE: Tolerance = new(
    5e-6,
    Reason::Measured("1.5e-6, the reference's gyroscope between samples"),
);
/// The same in MuJoCo, whose limbs give way: relative motion in angular trials, and limbs that tilt.
pub const JOINT_MUJOCO: Tolerance = new(5e-5, Reason::Measured("1.5e-5"));
/// Bias in standard deviations that errors in variables may leave.
pub const JOINT_BIAS: f64 = 0.1;
/// Bias in standard deviations that plain least squares must show where the joint fit is said to have none.
pub const PLAIN_BIAS: f64 = 1.0;
/// Share of wild samples in a record, and their size over the converter's range.
pub const WILD_SHARE: f64 = 0.01;
/// Huber's loss costs 5 % of the variance at its usual limit; wild values cost what they make of the samples near them.
pub const ROBUST_Z: Tolerance = new(crate::statistics::ONE_IN_A_MILLION, Reason::Derived);
/// Errors in bounds that plain squares must show under wild samples.
pub const BENT_Z: f64 = 20.0;

/// ln ratios of scale factors from a tumble in closed form, sample by sample, after one repetition: the third order of the
/// strains, and rounding.
pub const RATIOS_CLOSED_FORM: Tolerance = new(1e-11, Reason::Measured("8e-13"));
/// The same from MuJoCo, in blocks: what the calibration's common factor makes of the second order.
pub const RATIOS_MUJOCO: Tolerance = new(2e-7, Reason::Measured("4.6e-8"));
/// Factor by which ratios must be worse without the second order there.
pub const SECOND_ORDER_SEEN: f64 = 3.0;
/// Correlation of neighbouring blocks of slow noise, in deviations, at least.
pub const COLOURED_Z: f64 = 10.0;
/// Share of one channel that another shows, too, and what this must make of the loop's misfit or of the correlation of
/// neighbouring blocks, in deviations: beyond one false alarm in a million.
pub const CROSSTALK: f64 = 5e-3;
/// See [`CROSSTALK`].
pub const CROSSTALK_Z: f64 = 5.0;
/// ln k_i/k_j of any two limbs with laboratory errors: half a per cent is asked for.
pub const STIFFNESS_RATIO: Tolerance = new(5e-3, Reason::Derived);
/// Attained over asked-for rate of false alarms, less one.
pub const FALSE_ALARMS: Tolerance = new(0.1, Reason::Derived);
/// Noise over what the detector is told in the control: the energy of 64 samples sees it in every window.
pub const FALSE_ALARM_NOISE: f64 = 1.3;
/// Share of failures of five standard deviations whose class is not named.
pub const NOT_ISOLATED: Tolerance = new(0.01, Reason::Derived);
/// Share of twins that are named wrongly: odds of a thousand to one, and models that are none.
pub const TWIN_WRONG: Tolerance = new(0.01, Reason::Derived);
/// Drawn against theoretical probability of detection, in standard errors.
pub const DETECTION_Z: Tolerance = new(crate::statistics::ONE_IN_A_MILLION, Reason::Derived);
/// What the rows keep of a failure that is taken off the wrong twin, over the failure: curvature of strains of 1e-5.
pub const TWIN_TRACE: Tolerance = new(1e-4, Reason::Derived);
/// Attitude half a second after a limb died that was then done without, from that of a sensor that never failed, noise 60 dB below
/// full scale, rad.
pub const SURVIVED_RAD: Tolerance = new(
    3e-2,
    Reason::Measured(
        "9e-3 over ten seeds: the noise of eight limbs instead of nine, integrated twice",
    ),
);
/// What it is, at least, with the dead limb. Measured 0.2 to 2.9.
pub const DEAD_LIMB_RAD: f64 = 0.1;
/// Attitude from the truth after 1.2 s of noise 60 dB below full scale, most of it from the rate at the first sample, rad.
pub const NOISY_ATTITUDE_RAD: Tolerance =
    new(0.1, Reason::Measured("0.023 without a failure, too"));
