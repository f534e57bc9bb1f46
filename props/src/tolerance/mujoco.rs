//! Truth: MuJoCo, whose own error is what halving its step changes.

use super::{Gate, Reason, Tolerance, derived, measured, reference_limited};

/// MuJoCo's elongations at rest, over the largest.
pub const STATIC_ELONGATION: Tolerance =
    reference_limited(1e-9, 2e-10, "rounding of 18 nm in site positions of 40 mm");
/// Commanded against simulated acceleration of the shell, over the peak.
pub const EXACT_DRIVE: Tolerance = measured(1e-12, 1.3e-13, "");
/// Forces per mass of sensors that differ in nothing but their mass, over the largest force.
pub const MASS_RATIO: Tolerance = reference_limited(5e-9, 4e-10, "rounding walks in the modes");
/// Decoupled against true acceleration, over the peak of the vector, at 10 kHz with true parameters.
pub const DECOUPLED: Tolerance = reference_limited(1e-6, 1.4e-7, "most of it is the step of 25 us");
/// The coordination equations on MuJoCo's limb forces, over the largest force.
pub const COORDINATION: Tolerance = measured(5e-5, 1.1e-5, "second order in limb tilt");
/// By how much the reference's order of convergence may fall short of four.
pub const REFERENCE_ORDER: Tolerance = measured(0.2, 0.09, "orders of 3.91 to 4.03");
/// Departure of a scheme's measured order from theory, between 500 Hz and 1 kHz on a 5 Hz run.
pub const ORDER: Tolerance = measured(
    0.2,
    0.14,
    "Adams-Moulton, for which 1 kHz is not yet the limit; at most 0.005 for others",
);
/// Relative acceleration in MuJoCo against linear theory.
pub const LINEAR_THEORY: Tolerance = measured(2e-5, 4e-6, "geometric nonlinearity");
/// Scale factors and inertia from simulated runs with the compliance kept, relative.
pub const COMPLIANT: Tolerance = measured(4e-8, 9e-9, "the reference's own");
/// Rate (rad/s) and rotation (rad) at the end of a run from rest to rest, of which Newton has made all there is to make.
pub const CLOSED: Tolerance = measured(4e-10, 1.5e-11, "");
/// Accelerations decoded with limbs excluded, on the rig in MuJoCo, over full scale.
pub const WITHOUT_LIMBS_RIG: Tolerance = reference_limited(
    2e-8,
    5.0e-9,
    "MuJoCo's strains leave 5.5e-10 of the largest in the parity rows, and that is amplified",
);
/// The same of limbs that are unequal by a tenth, with their ratios told, and without damping.
pub const WITHOUT_UNEQUAL_LIMBS: Tolerance = measured(3e-8, 6.8e-9, "");
/// With the damping of the design.
pub const WITHOUT_UNEQUAL_DAMPED_LIMBS: Tolerance = measured(
    4e-4,
    1.2e-4,
    "limbs are damped alike, whatever their stiffness, and no relation knows of it",
);
/// Error in single precision with limbs excluded over that with all.
pub const WITHOUT_LIMBS_F32: Tolerance = measured(3.0, 1.2, "");
/// Error of random motions, over full scale.
pub const RANDOM_MOTION: Gate = Gate {
    median: 1e-7,
    q99: 1e-6,
    max: 2e-6,
    reason: Reason::Measured {
        value: 7.3e-7,
        margin: 2e-6 / 7.3e-7,
        note: "median 3e-8 and 99 % below 4e-7 over 1,000 motions",
    },
};
/// Error of accelerations and rate over their peaks, over half a limb's mass: a limb's own force is taken off as if no load tilted the limbs.
pub const LIMBS_WITH_MASS: Tolerance = measured(
    0.06,
    0.02,
    "most in slow motion: weight in limbs that it tilts",
);
/// The same over what is allowed, 1e-6 and the reference's own error.
pub const RANDOM_MOTION_SHARE: Gate = Gate {
    median: 1.0,
    q99: 1.0,
    max: 1.0,
    reason: Reason::Derived("every error within what its own row allows"),
};
/// Frequency of a mode from a ring-down against the eigenproblem, relative.
pub const MODE_FREQUENCY: Tolerance = measured(1e-5, 4.4e-7, "");
/// Drift of the energy of the free two-body model over 20 ms, relative.
pub const ENERGY: Tolerance = measured(
    2e-9,
    2e-10,
    "the modes lose energy at the fifth power of the step",
);
/// Drift of its linear momentum, relative.
pub const MOMENTUM: Tolerance = measured(1e-12, 3e-14, "");
/// Drift of its angular momentum, relative.
pub const ANGULAR_MOMENTUM: Tolerance = measured(4e-13, 1.4e-14, "");
/// Departure from two of the order of MuJoCo's own step for a tumbling body.
pub const MUJOCO_ORDER: Tolerance = measured(0.2, 0.09, "");
/// Positions after 100 steps about a fixed axis, ours against MuJoCo's, m and rad.
pub const FIXED_AXIS_STEP: Tolerance = measured(1e-14, 1.1e-15, "");
/// Fourth difference of a limb force per mass at 10 kHz in a slow run, m/s^2.
pub const ROUNDING_NOISE: Tolerance =
    measured(1e-6, 1.4e-7, "sixteen roundings of a length and more");
/// Tare from one place of rest, in roundings of a limb's length.
pub const TARE_ROUNDINGS: Tolerance = measured(4.0, 0.69, "");
/// Mean tare over 400 places, in the same.
pub const MEAN_TARE_ROUNDINGS: Tolerance = measured(1.0, 0.55, "hinge positions are rounded, too");
/// Threshold frequency against the printed one, Hz.
pub const PRINTED_THRESHOLD_HZ: Tolerance =
    derived(0.5 * 0.1, "half a unit in the last printed digit");
/// Departure of a power law's exponent from theory.
pub const THRESHOLD_POWER: Tolerance = measured(1e-5, 2e-6, "");
/// The four steps as printed, noise-free: drift (V), scale, inertia, stiffness (relative).
pub const FOUR_STEPS: [Tolerance; 4] = [
    ZERO_DRIFT,
    measured(5e-6, 1.9e-6, "relative motion neglected"),
    measured(5e-6, 7e-7, ""),
    measured(1e-2, 3.7e-3, "what step 2 neglects"),
];
/// Steps 2 to 4 repeated with the compliance kept.
pub const REPEATED_STEPS: [Tolerance; 4] = [
    ZERO_DRIFT,
    measured(2e-8, 3e-9, "the reference's own"),
    measured(1e-8, 2e-9, ""),
    measured(2e-4, 4e-5, "a parabola through three grid points"),
];
/// Zero drift, V, from a record that is at rest without noise: a mean of equal numbers below 0.1 V.
const ZERO_DRIFT: Tolerance = measured(1e-12, 0.0, "exact but for rounding");
/// Accelerations of the rig at 5 Hz against the printed formulas in the same discretisation, over the peak of the vector,
/// after ten thousand samples.
pub const PRINTED_FORMULAS: Tolerance = measured(1e-12, 6e-14, "");
/// Single precision over a run of the rig at 5 Hz, over the peak.
pub const SINGLE_PRECISION: Tolerance = measured(3e-4, 7e-5, "");
/// Sums of |w*| by interpolation in 1/(k/m), over the largest of the curve.
pub const SEARCH: Tolerance = measured(1e-9, 8e-11, "");
/// Forces of limbs that do not give way against MuJoCo's, over the run's largest: in units of the square of the drive over
/// k/m, the share of the shell's motion by which the mass moves in it.
pub const fn rigid_limbs(frequency_hz: f64, stiffness_per_mass_per_s2: f64) -> Tolerance {
    let rate = core::f64::consts::TAU * frequency_hz;
    let unit = rate * rate / stiffness_per_mass_per_s2;
    measured(
        5.0 * rate * rate / stiffness_per_mass_per_s2,
        3.1 * unit,
        "2.1 to 3.1 times (w^2)/(k/m); 1e-6 at 1.5 Hz, 1.1e-5 at 5 Hz",
    )
}
/// The rig's motion in closed form against MuJoCo's integration, over the peak.
pub const RIGID_MOTION: Tolerance = measured(1e-12, 1.4e-13, "");
/// Nine forces at 500 Hz against MuJoCo's, whose limbs have 2 % of damping, over the largest.
pub const SHAKEN: Tolerance = measured(2e-5, 4.3e-6, "");
/// Scale factors and inertias of the joint fit of a campaign in MuJoCo, whose limbs give way, relative.
pub const JOINT_MUJOCO: Tolerance = measured(
    5e-5,
    1.5e-5,
    "relative motion in angular trials, and limbs that tilt",
);
/// ln ratios of scale factors from a tumble in MuJoCo, in blocks.
pub const RATIOS_MUJOCO: Tolerance = measured(
    2e-7,
    4.6e-8,
    "what the calibration's common factor makes of the second order",
);
