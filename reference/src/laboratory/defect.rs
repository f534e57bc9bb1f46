//! The defects that a session may have. Their particulars are drawn from ranges in which a defect of that kind does harm.

use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use crate::geometry::LIMBS;
use crate::rig::run::WEDGES;

/// Kind of a defect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A channel shows its zero drift and nothing else.
    DeadLimb,
    /// Two channels are exchanged.
    SwappedChannels,
    /// A channel has the wrong sign.
    InvertedChannel,
    /// A channel is clipped.
    ClippedConverter,
    /// A gain, a unit or a sensitivity is written down wrongly.
    WrongScaling,
    /// Numbers of millivolts are filed as volts, or the other way round.
    MillivoltMixUp,
    /// Gravity turns in the sensor and the session file does not state it, or the reverse.
    GravityNotHandled,
    /// The wedges of a step span a plane only.
    UnderExcitedAxis,
    /// A wedge misses its direction by two degrees.
    LooseWedge,
    /// Sensor and reference instruments do not share a clock, or the sample rate is written down wrongly.
    ClockMismatch,
    /// The session file does not state the gyroscope's bandwidth.
    GyroscopeLag,
    /// A channel's zero drifts during a record.
    DriftDuringRun,
    /// A trial was recorded with another sensor.
    ForeignTrial,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::DeadLimb,
        Self::SwappedChannels,
        Self::InvertedChannel,
        Self::ClippedConverter,
        Self::WrongScaling,
        Self::MillivoltMixUp,
        Self::GravityNotHandled,
        Self::UnderExcitedAxis,
        Self::LooseWedge,
        Self::ClockMismatch,
        Self::GyroscopeLag,
        Self::DriftDuringRun,
        Self::ForeignTrial,
    ];

    /// The word that plans have for it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::DeadLimb => "dead_limb",
            Self::SwappedChannels => "swapped_channels",
            Self::InvertedChannel => "inverted_channel",
            Self::ClippedConverter => "clipped_converter",
            Self::WrongScaling => "wrong_scaling",
            Self::MillivoltMixUp => "millivolt_mix_up",
            Self::GravityNotHandled => "gravity_not_handled",
            Self::UnderExcitedAxis => "under_excited_axis",
            Self::LooseWedge => "loose_wedge",
            Self::ClockMismatch => "clock_mismatch",
            Self::GyroscopeLag => "gyroscope_lag",
            Self::DriftDuringRun => "drift_during_run",
            Self::ForeignTrial => "foreign_trial",
        }
    }
}

/// Where something is wrong: trials are counted from 0 over steps 2, 3, 4 and the compound runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Where {
    /// In all recordings, the static one too.
    Everywhere,
    /// From this trial on.
    From(usize),
    /// In this trial alone.
    Trial(usize),
}

impl Where {
    /// Whether a recording is concerned; the static one has no trial number.
    #[must_use]
    pub fn holds(self, trial: Option<usize>) -> bool {
        match (self, trial) {
            (Self::Everywhere, _) => true,
            (Self::From(first), Some(trial)) => trial >= first,
            (Self::Trial(only), Some(trial)) => trial == only,
            (_, None) => false,
        }
    }
}

/// One thing wrong. Channels are counted from 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Defect {
    /// The channel shows its zero drift and noise.
    DeadLimb {
        /// Which.
        channel: usize,
        /// Where.
        place: Where,
    },
    /// The plugs of two limbs are exchanged; the amplifiers' gains stay.
    SwappedChannels {
        /// Which.
        channels: [usize; 2],
        /// Where.
        place: Where,
    },
    /// The channel's polarity is turned.
    InvertedChannel {
        /// Which.
        channel: usize,
        /// Where.
        place: Where,
    },
    /// The channel stops at this share of its own peak.
    ClippedConverter {
        /// Which.
        channel: usize,
        /// In which trial.
        trial: usize,
        /// Share of the peak.
        share: f64,
    },
    /// The session's gain of a channel is so many times the true one.
    WrongGain {
        /// Which.
        channel: usize,
        /// Where.
        place: Where,
        /// Factor.
        factor: f64,
    },
    /// The accelerometer's readings are so many times what its unit and sensitivity say.
    WrongAccelerometer {
        /// Factor.
        factor: f64,
    },
    /// The gyroscope's readings are so many times what its unit and sensitivity say.
    WrongGyroscope {
        /// Factor.
        factor: f64,
    },
    /// The limbs' voltages are numbers of millivolts (or volts) said to be volts (or millivolts).
    MillivoltMixUp {
        /// Channel, or all.
        channel: Option<usize>,
        /// Where.
        place: Where,
        /// 1000 or 1/1000.
        factor: f64,
    },
    /// The rig's axis is level, and the session says nothing of it; or it is vertical and the session says level.
    GravityNotHandled {
        /// Whether the axis is level in truth.
        level: bool,
    },
    /// Wedges of a step lie in one plane, square to this axis.
    UnderExcitedAxis {
        /// 0 to 2.
        axis: usize,
        /// In the linear trials.
        linear: bool,
        /// In the angular trials.
        angular: bool,
    },
    /// One wedge's direction is off.
    LooseWedge {
        /// Which of the wedges.
        wedge: usize,
        /// Angle, degrees.
        angle_deg: f64,
        /// Where the tilt goes to, rad about the wedge's direction.
        azimuth_rad: f64,
    },
    /// The reference instruments' clock starts late and runs at another speed.
    ReferenceClock {
        /// Where.
        place: Where,
        /// How late their samples are, s.
        late_s: f64,
        /// Their true sample rate over what is written down, less 1.
        rate_error: f64,
    },
    /// The sample rate is written down wrongly.
    WrongSampleRate {
        /// Where.
        place: Where,
        /// Written over true.
        factor: f64,
    },
    /// The session does not state the gyroscope's bandwidth.
    GyroscopeLag {
        /// Its true bandwidth, Hz.
        bandwidth_hz: f64,
    },
    /// A channel's zero moves steadily during one trial.
    DriftDuringRun {
        /// Which.
        channel: usize,
        /// In which trial; the static record if none.
        trial: Option<usize>,
        /// From beginning to end, as a share of the trial's largest signal; of the converter's range for the static record.
        share: f64,
    },
    /// A trial is another sensor's.
    ForeignTrial {
        /// Which.
        trial: usize,
        /// Seed of the other sensor.
        seed: u64,
    },
}

/// Steps of an amplifier's range that are mistaken for one another.
const RANGE_STEPS: [f64; 6] = [2.0, 2.5, 5.0, 0.5, 0.4, 0.2];

impl Defect {
    /// One of a kind, for a campaign with so many trials for each of steps 2 to 4 and three compound ones.
    pub fn draw(kind: Kind, per_step: usize, rng: &mut impl Rng) -> Self {
        let channel = rng.random_range(0..LIMBS);
        let trials = 3 * per_step + 3;
        let trial = rng.random_range(0..trials);
        let identifying = rng.random_range(0..2 * per_step);
        let mostly_everywhere = if rng.random_bool(0.7) {
            Where::Everywhere
        } else {
            Where::Trial(identifying)
        };
        let log_uniform = |rng: &mut dyn rand::Rng, from: f64, to: f64| -> f64 {
            (from.ln() + (to / from).ln() * rng.random::<f64>()).exp()
        };
        let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        match kind {
            Kind::DeadLimb => Self::DeadLimb {
                channel,
                place: if rng.random_bool(0.6) {
                    Where::Everywhere
                } else {
                    // Early enough that trials of steps 2 and 3 are among the rest.
                    Where::From(rng.random_range(1..per_step))
                },
            },
            Kind::SwappedChannels => Self::SwappedChannels {
                channels: [channel, (channel + rng.random_range(1..LIMBS)) % LIMBS],
                place: Where::Everywhere,
            },
            Kind::InvertedChannel => Self::InvertedChannel {
                channel,
                place: mostly_everywhere,
            },
            Kind::ClippedConverter => Self::ClippedConverter {
                channel,
                trial,
                share: rng.random_range(0.5..0.97),
            },
            Kind::WrongScaling => match rng.random_range(0..4) {
                0 => Self::WrongGain {
                    channel,
                    place: Where::Trial(identifying),
                    factor: *RANGE_STEPS.choose(rng).unwrap_or(&2.0),
                },
                1 => Self::WrongGain {
                    channel,
                    place: Where::Everywhere,
                    factor: if rng.random_bool(0.5) { 10.0 } else { 0.1 },
                },
                2 => Self::WrongAccelerometer {
                    factor: *[9.80665, 1.0 / 9.80665, 2.0, 0.5, 10.0]
                        .choose(rng)
                        .unwrap_or(&2.0),
                },
                _ => Self::WrongGyroscope {
                    factor: *[57.29578, 1.0 / 57.29578, 2.0, 0.5, 10.0]
                        .choose(rng)
                        .unwrap_or(&2.0),
                },
            },
            Kind::MillivoltMixUp => Self::MillivoltMixUp {
                channel: rng.random_bool(0.3).then_some(channel),
                place: mostly_everywhere,
                factor: if rng.random_bool(0.7) { 1e3 } else { 1e-3 },
            },
            Kind::GravityNotHandled => Self::GravityNotHandled {
                level: rng.random_bool(0.8),
            },
            Kind::UnderExcitedAxis => {
                let linear = rng.random_bool(0.6);
                Self::UnderExcitedAxis {
                    axis: rng.random_range(0..3),
                    linear,
                    angular: !linear || rng.random_bool(0.3),
                }
            }
            Kind::LooseWedge => Self::LooseWedge {
                wedge: rng.random_range(0..WEDGES.len()),
                angle_deg: 2.0,
                azimuth_rad: rng.random_range(0.0..core::f64::consts::TAU),
            },
            Kind::ClockMismatch => match rng.random_range(0..3) {
                0 => Self::ReferenceClock {
                    place: if rng.random_bool(0.6) {
                        Where::Everywhere
                    } else {
                        Where::Trial(trial)
                    },
                    late_s: sign * log_uniform(rng, 2e-3, 30e-3),
                    rate_error: 0.0,
                },
                1 => Self::ReferenceClock {
                    place: Where::Everywhere,
                    late_s: 0.0,
                    rate_error: sign * log_uniform(rng, 1e-3, 1e-2),
                },
                _ => Self::WrongSampleRate {
                    place: if rng.random_bool(0.6) {
                        Where::Everywhere
                    } else {
                        Where::Trial(identifying)
                    },
                    factor: (sign * log_uniform(rng, 0.03, 0.2)).exp(),
                },
            },
            Kind::GyroscopeLag => Self::GyroscopeLag {
                bandwidth_hz: rng.random_range(6.0..30.0),
            },
            Kind::DriftDuringRun => {
                let at_rest = rng.random_bool(0.2);
                Self::DriftDuringRun {
                    channel,
                    trial: (!at_rest).then_some(trial),
                    share: sign
                        * if at_rest {
                            log_uniform(rng, 5e-4, 5e-3)
                        } else {
                            log_uniform(rng, 0.01, 0.1)
                        },
                }
            }
            Kind::ForeignTrial => Self::ForeignTrial {
                trial,
                seed: rng.random(),
            },
        }
    }

    /// Its kind.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::DeadLimb { .. } => Kind::DeadLimb,
            Self::SwappedChannels { .. } => Kind::SwappedChannels,
            Self::InvertedChannel { .. } => Kind::InvertedChannel,
            Self::ClippedConverter { .. } => Kind::ClippedConverter,
            Self::WrongGain { .. }
            | Self::WrongAccelerometer { .. }
            | Self::WrongGyroscope { .. } => Kind::WrongScaling,
            Self::MillivoltMixUp { .. } => Kind::MillivoltMixUp,
            Self::GravityNotHandled { .. } => Kind::GravityNotHandled,
            Self::UnderExcitedAxis { .. } => Kind::UnderExcitedAxis,
            Self::LooseWedge { .. } => Kind::LooseWedge,
            Self::ReferenceClock { .. } | Self::WrongSampleRate { .. } => Kind::ClockMismatch,
            Self::GyroscopeLag { .. } => Kind::GyroscopeLag,
            Self::DriftDuringRun { .. } => Kind::DriftDuringRun,
            Self::ForeignTrial { .. } => Kind::ForeignTrial,
        }
    }
}
