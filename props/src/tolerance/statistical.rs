//! Truth: chance. Limits on statistics, of which a chosen rate of false alarms or a stated accuracy decides.

use super::{Tolerance, measured, required};
use crate::statistics::ONE_IN_A_MILLION;

const CHANCE: &str = "one false alarm in a million";

/// Chi-square of predicted against seen errors, in half widths of an interval that chance leaves once in a million.
pub const CHI_SQUARE: Tolerance = required(1.0, CHANCE);
/// A normal variable in its standard deviations.
pub const TAP_CHANCE: Tolerance = required(ONE_IN_A_MILLION, CHANCE);
/// k/m of a session over the half width of its 95 % interval.
pub const TAP_INTERVAL: Tolerance = required(ONE_IN_A_MILLION / 1.96, CHANCE);
/// Standard error of ln k/m that a tap states against the Cramér-Rao bound.
pub const TAP_STANDARD_ERROR: Tolerance = measured(
    0.1,
    0.02,
    "noise that is estimated from 12,000 residuals, over eleven taps",
);
/// Half width of k/m's interval by two taps of a 60 dB chain, with standards of class 1 % and ranges good to half a per cent.
pub const TAP_HALF_WIDTH: Tolerance = required(2e-2, "2 % is asked for");
/// Errors in bounds under Huber's loss, which costs 5 % of the variance at its usual limit, and wild values.
pub const ROBUST_Z: Tolerance = required(ONE_IN_A_MILLION, CHANCE);
/// ln k_i/k_j of any two limbs with laboratory errors.
pub const STIFFNESS_RATIO: Tolerance = required(5e-3, "half a per cent is asked for");
/// Attained over asked-for rate of false alarms, less one.
pub const FALSE_ALARMS: Tolerance = required(0.1, "a tenth of the rate that is asked for");
/// Kolmogorov's distance of drawn numbers from their distribution, times the root of their count: 2 exp(-2 x^2) is a millionth.
pub const KOLMOGOROV: Tolerance = required(2.694, CHANCE);
/// Errors of a calibration of the blind trial's healthy corner: standards of class 1 %, wedges of 0.01 degrees, 60 dB.
pub const CORNER: Tolerance = required(
    0.03,
    "a calibration as good as its standards, and a random sensor's weakest limb",
);
/// Share of failures of five standard deviations whose class is not named, as far as it is no chance of one in a million: of the suite's 108
/// of a kind up to nine may be unnamed.
pub const NOT_ISOLATED: Tolerance = required(0.01, "one failure in a hundred");
/// Share of ambiguous pairs of which the wrong limb is named: odds of a thousand to one, and models that do not fit. As far as it is no
/// chance of one in a million.
pub const TWIN_WRONG: Tolerance = required(0.01, "one pair in a hundred");
/// Share of 2,400 recordings with hum in which a sound limb is excluded: 0.025 + 3 sqrt(0.025 * 0.975 / 2400).
pub const HUM_EXCLUDES: Tolerance = required(
    0.0346,
    "one recording in forty, and three standard deviations of the count",
);
/// Share of plays in which limbs die with their noise and a sound one is excluded, as far as it is no chance of one in a million.
pub const SOUND_LIMB_EXCLUDED: Tolerance = required(1e-3, "one play in a thousand");
/// Drawn against theoretical probability of detection, in standard errors.
pub const DETECTION_Z: Tolerance = required(ONE_IN_A_MILLION, CHANCE);
/// Attitude half a second after a limb died that was then excluded, from that of a sensor that never failed, noise 60 dB below
/// full scale, rad.
pub const SURVIVED_RAD: Tolerance = measured(
    3e-2,
    9e-3,
    "over ten seeds: the noise of eight limbs instead of nine, integrated twice",
);
/// Attitude from the truth after 1.2 s of noise 60 dB below full scale, most of it from the rate at the first sample, rad.
pub const NOISY_ATTITUDE_RAD: Tolerance = measured(0.1, 0.023, "without a failure, too");
/// Error of an acceleration in ground axes over its deviation, of all samples whose attitude is known.
pub const OVER_DEVIATION: Tolerance = required(
    6.0,
    "no ground-axis sample is off by more than six of its deviations",
);
/// Error of a with rests over that of the open loop, late in a minute.
pub const RESTS_OF_OPEN_LOOP: Tolerance = required(
    0.1,
    "a second of rest in ten takes nine tenths of the error off",
);
