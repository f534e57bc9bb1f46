//! What can be wrong with what the caller hands in, said so that it can be found: channel, sample, cause.

use thiserror::Error;

use crate::limb_set::{LimbSet, NotALimb};
use crate::unobservable::{LostLoad, UnobservableDirections};

/// Every way in which input to this crate can be refused.
///
/// Channels are numbered 1 to 9 as in the paper; samples are counted from 0.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A sample is NaN or infinite.
    #[error("channel {channel}, sample {sample}: value {value} is not a finite number")]
    NotFinite {
        /// Channel, from 1.
        channel: usize,
        /// Sample, from 0.
        sample: usize,
        /// The offending value.
        value: f64,
    },
    /// Finite input, but a result that no f64 holds.
    #[error(
        "{what}: {}sample {sample}: finite input, but of a size whose result is not a finite number", OfChannel(*channel)
    )]
    Overflow {
        /// The operation.
        what: &'static str,
        /// Channel, from 1; 0 where it is not one channel's.
        channel: usize,
        /// Sample, from 0.
        sample: usize,
    },
    /// A parameter or setting lies outside the range in which it has a meaning.
    #[error("{name} = {value}: must be {requirement}")]
    OutOfRange {
        /// Name of the field, with its unit.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// What would be accepted.
        requirement: &'static str,
    },
    /// The inertia per mass is one that no rigid body can have.
    #[error(
        "inertia per mass has principal moments {principal_m2:?} m^2: a body needs all of them positive and none larger than the sum of the other two"
    )]
    ImpossibleInertia {
        /// Principal moments per mass, ascending, m^2.
        principal_m2: [f64; 3],
    },
    /// Time does not advance by the same step from sample to sample.
    #[error(
        "sample {sample}: time stamp {time_s} s follows {previous_s} s, expected a step of {expected_step_s} s"
    )]
    IrregularTime {
        /// Sample, from 0.
        sample: usize,
        /// Its time stamp.
        time_s: f64,
        /// The time stamp before it.
        previous_s: f64,
        /// Step that the sample rate asks for.
        expected_step_s: f64,
    },
    /// The recording is too short for what is asked of it.
    #[error("{what} needs at least {needed} samples, got {got}")]
    TooFewSamples {
        /// The operation.
        what: &'static str,
        /// Its minimum.
        needed: usize,
        /// What it got.
        got: usize,
    },
    /// Two series that belong together differ in length.
    #[error("{what}: expected {expected} samples, got {got}")]
    LengthMismatch {
        /// Which series.
        what: &'static str,
        /// Length of its partner.
        expected: usize,
        /// Its own length.
        got: usize,
    },
    /// A channel does not move at all although the sensor does.
    #[error("channel {channel}: dead, it reads {value_v} V in all {samples} samples")]
    DeadChannel {
        /// Channel, from 1.
        channel: usize,
        /// What it reads.
        value_v: f64,
        /// In how many samples.
        samples: usize,
    },
    /// A channel touches the limit of the converter.
    #[error("channel {channel}, sample {sample}: clipped at {limit_v} V")]
    Clipped {
        /// Channel, from 1.
        channel: usize,
        /// First clipped sample, from 0.
        sample: usize,
        /// Converter limit.
        limit_v: f64,
    },
    /// The motion does not excite every unknown.
    #[error(
        "{what}: the motion leaves {unknowns} unknowns with rank {rank} (condition number {condition:.3e}); nothing is known along {lost_direction:?}"
    )]
    RankDeficient {
        /// The identification step.
        what: &'static str,
        /// Number of unknowns.
        unknowns: usize,
        /// Numerical rank.
        rank: usize,
        /// Condition number of the column-scaled regressor.
        condition: f64,
        /// Unit vector, in the unknowns' order (padded with zeros), along which the data say nothing.
        lost_direction: [f64; 9],
    },
    /// A record that is taken for one period of a motion does not end where it began.
    #[error(
        "{what}: the record does not end where it began: from its last sample back to its first the standard jumps by {jump_over_step:.1} times its largest step; a trial begins and ends at rest or holds whole turns"
    )]
    NotClosed {
        /// The operation.
        what: &'static str,
        /// That jump over the largest difference of neighbouring samples.
        jump_over_step: f64,
    },
    /// The data leave an unknown open.
    #[error("{what}: the trials leave unknown {unknown} open (condition number {condition:.3e})")]
    Indeterminate {
        /// The estimator.
        what: &'static str,
        /// The unknown that is least known, from 1: zero drifts, scale factors, inertias, compliance, then instruments and rig.
        unknown: usize,
        /// Condition number of the scaled normal matrix.
        condition: f64,
    },
    /// A limb that the forces would stretch or compress by half its length or more.
    #[error(
        "channel {channel}, sample {sample}: the limb would change its length by {strain:.3} of it; no limb survives a hundredth"
    )]
    Overstrained {
        /// Channel, from 1.
        channel: usize,
        /// Sample, from 0.
        sample: usize,
        /// Elongation over length.
        strain: f64,
    },
    /// Three limb lengths for which no common end point exists.
    #[error("node {node}: its three limbs, as long as the forces make them, do not meet")]
    LimbsDoNotMeet {
        /// Node of the mass, from 1: limbs 1-3, 4-6, 7-9.
        node: usize,
    },
    /// What follows the largest sample of a recording is not the free decay of the mass in its shell.
    #[error(
        "after its largest sample the recording rings like the sensor's six modes to {:.0} % only: no tap, or a shell that was not held still after it",
        100.0 * explained
    )]
    NoRingDown {
        /// Share of the variance that six decaying modes explain at best.
        explained: f64,
    },
    /// Too few samples for the highest mode of the sensor.
    #[error(
        "sampled at {sample_rate_hz:.0} Hz, the sensor's highest mode at {highest_mode_hz:.0} Hz cannot be followed: at least {needed_hz:.0} Hz"
    )]
    SampledTooSlowly {
        /// Samples per second.
        sample_rate_hz: f64,
        /// Highest mode, Hz.
        highest_mode_hz: f64,
        /// Smallest sample rate that will do.
        needed_hz: f64,
    },
    /// Limbs that cannot be excluded together.
    #[error("limbs {excluded} excluded: the remaining limbs cannot observe {load}")]
    LostLoad {
        /// The limbs.
        excluded: LimbSet,
        /// What loads none but them.
        load: LostLoad,
    },
    /// A motion that does not determine all scale ratios.
    #[error(
        "scale ratios: the motion does not determine {directions}; turn the sensor about more axes, or longer"
    )]
    UnobservableScaleRatios {
        /// What it does not determine.
        directions: UnobservableDirections,
    },
    /// A fit that is far from accounting for what it is given and hardly gets nearer.
    #[error(
        "{what} leaves {over_noise:.1} times what noise does after {iterations} iterations, and was given up: what was recorded is not of this model"
    )]
    Unaccounted {
        /// The fit.
        what: &'static str,
        /// After which it was given up.
        iterations: usize,
        /// Root mean square of what it leaves, over that of noise.
        over_noise: f64,
        /// Residuals less unknowns.
        degrees_of_freedom: usize,
    },
    /// An iteration did not settle within its cap.
    #[error("{what} did not converge in {iterations} iterations")]
    NotConverged {
        /// The iteration.
        what: &'static str,
        /// Its cap.
        iterations: usize,
    },
}

impl Error {
    /// [`Self::Unaccounted`].
    #[cfg(feature = "alloc")]
    pub(crate) const fn unaccounted(
        what: &'static str,
        iterations: usize,
        over_noise: f64,
        degrees_of_freedom: usize,
    ) -> Self {
        Self::Unaccounted {
            what,
            iterations,
            over_noise,
            degrees_of_freedom,
        }
    }

    /// [`Self::OutOfRange`].
    pub(crate) const fn out_of_range(
        name: &'static str,
        value: f64,
        requirement: &'static str,
    ) -> Self {
        Self::OutOfRange {
            name,
            value,
            requirement,
        }
    }

    /// [`Self::Overflow`] of no single channel.
    pub(crate) const fn overflow(what: &'static str, sample: usize) -> Self {
        Self::Overflow {
            what,
            channel: 0,
            sample,
        }
    }
}

/// A channel's number before what is said of it; nothing where it is no single channel's.
struct OfChannel(usize);

impl core::fmt::Display for OfChannel {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self.0 {
            0 => Ok(()),
            channel => write!(f, "channel {channel}, "),
        }
    }
}

/// Refuses a value unless it meets its requirement. Conditions are written so that NaN does not meet them.
pub(crate) fn require(
    met: bool,
    name: &'static str,
    value: f64,
    requirement: &'static str,
) -> Result<()> {
    if met {
        return Ok(());
    }
    Err(Error::out_of_range(name, value, requirement))
}

/// Refuses a value that is not positive and finite.
pub(crate) fn require_positive(name: &'static str, value: f64) -> Result<()> {
    require(
        value > 0.0 && value.is_finite(),
        name,
        value,
        "positive and finite",
    )
}

/// Refuses a value that is negative or not finite.
pub(crate) fn require_not_negative(name: &'static str, value: f64) -> Result<()> {
    require(
        value >= 0.0 && value.is_finite(),
        name,
        value,
        "finite and not negative",
    )
}

/// Refuses a value that is not finite.
pub(crate) fn require_finite(name: &'static str, value: f64) -> Result<()> {
    require(value.is_finite(), name, value, "finite")
}

/// Refuses a sample's values unless all are finite, and names the first channel whose value is not.
#[inline]
pub(crate) fn require_finite_row<'a>(
    row: impl IntoIterator<Item = &'a f64>,
    sample: usize,
) -> Result<()> {
    for (channel, &value) in row.into_iter().enumerate() {
        if !value.is_finite() {
            return Err(Error::NotFinite {
                channel: channel + 1,
                sample,
                value,
            });
        }
    }
    Ok(())
}

/// Refuses a series that is shorter than what is done with it needs.
pub(crate) fn require_samples(what: &'static str, needed: usize, got: usize) -> Result<()> {
    if got < needed {
        return Err(Error::TooFewSamples { what, needed, got });
    }
    Ok(())
}

impl From<NotALimb> for Error {
    fn from(NotALimb(number): NotALimb) -> Self {
        Self::OutOfRange {
            name: "limb",
            value: number as f64,
            requirement: "a number from 1 to 9",
        }
    }
}

/// Result of every fallible function of this crate.
pub type Result<T> = core::result::Result<T, Error>;
