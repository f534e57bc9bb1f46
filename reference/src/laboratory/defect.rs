//! The defects that a session may have: a kind, one magnitude, a place. [`KINDS`](Kind::ALL) is the one table of kinds.
//!
//! A magnitude is drawn log-uniformly over its kind's range, which for most runs from where nothing could notice it to where a careless
//! laboratory ends up, whatever a judge makes of it. A magnitude of 0 is no defect. What a defect does to parameters and to
//! decoupled accelerations is measured afterwards and never asked beforehand. How each kind acts is in `spoil`.

use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use super::plan::SessionPlan;
use super::schedule::trial_count;
use crate::geometry::LIMBS;

/// Where something is wrong: trials are counted from 0 over steps 2, 3, 4 and the compound runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Where {
    /// In all recordings, the static one too.
    #[default]
    Everywhere,
    /// From this trial on.
    From(usize),
    /// In this trial alone.
    Trial(usize),
}

impl Where {
    /// Whether a recording is concerned; the static one has no trial number.
    pub fn holds(self, trial: Option<usize>) -> bool {
        match (self, trial) {
            (Self::Everywhere, _) => true,
            (Self::From(first), Some(trial)) => trial >= first,
            (Self::Trial(only), Some(trial)) => trial == only,
            (_, None) => false,
        }
    }
}

/// Where a kind's place is drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spread {
    /// In all recordings.
    Everywhere,
    /// In any one trial.
    OneTrial,
    /// In one trial of steps 2 and 3.
    OneIdentifying,
    /// In the last of the day's recordings: the magnitude says in how many.
    EndOfDay,
}

/// What the table says of a kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    /// The word that plans have for it.
    pub name: &'static str,
    /// Unit of its magnitude; `share`, `ln` and `log10` are pure numbers.
    pub unit: &'static str,
    /// Range of its magnitude.
    pub range: (f64, f64),
    /// Whether it is as likely negative.
    pub signed: bool,
    /// Where it is.
    pub spread: Spread,
    /// What the magnitude is, and why the range is what it is.
    pub reason: &'static str,
}

macro_rules! kinds {
    ($($kind:ident $name:literal $unit:literal $low:literal..$high:literal $signed:literal $spread:ident $reason:literal)*) => {
        /// Kind of a defect.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Kind {
            $(#[doc = $reason] $kind,)*
        }

        impl Kind {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$kind),*];

            /// What the table says of it.
            pub const fn facts(self) -> Facts {
                match self {
                    $(Self::$kind => Facts {
                        name: $name,
                        unit: $unit,
                        range: ($low, $high),
                        signed: $signed,
                        spread: Spread::$spread,
                        reason: $reason,
                    },)*
                }
            }
        }
    };
}

kinds! {
    DeadLimb "dead_limb" "share" 1e-3..1.0 false Everywhere
        "Share of its signal that a channel loses in all trials: from the temperature of the rod to a torn wire."
    DeadStatic "dead_static" "share" 1e-2..1.0 false Everywhere
        "Share of the static record for which a channel reads exactly nothing: a plug that was seated late, or never."
    SwappedChannels "swapped_channels" "share" 1e-2..1.0 false EndOfDay
        "Share of the day's recordings after two plugs were exchanged: the last one, or all of them."
    InvertedChannel "inverted_channel" "share" 1e-2..1.0 false EndOfDay
        "Share of the day's recordings after a channel's polarity was turned: the last one, or all of them."
    InvertedSmall "inverted_small" "share" 1e-3..1.0 false OneTrial
        "In one trial the channel is inverted whose signal is nearest to this share of the strongest one's."
    ClippedConverter "clipped_converter" "share" 1e-3..0.9 false OneTrial
        "Share of its own peak that a channel is cut short by in one trial: a sample or two, up to a range ten times too small."
    WrongGain "wrong_gain" "ln" 1e-3..3.0 true Everywhere
        "Logarithm of a channel's written gain over the true one on the whole day: an amplifier's tolerance, up to a slip of a decade and more."
    WrongGainInTrial "wrong_gain_in_trial" "ln" 1e-3..3.0 true OneIdentifying
        "The same in one trial: an amplifier that settles, up to a range switch that nobody wrote down."
    AccelerometerGain "accelerometer_gain" "ln" 1e-3..0.223 true Everywhere
        "Logarithm of the accelerometer's reading over the truth: 0.8 to 1.25, from a good certificate to a wrong one."
    GyroscopeGain "gyroscope_gain" "ln" 1e-3..0.223 true Everywhere
        "Logarithm of the gyroscope's reading over the truth: 0.8 to 1.25, from a good certificate to a wrong one."
    WrongScaling "wrong_scaling" "ln" 1e-2..4.1 true Everywhere
        "Logarithm of one standard's reading over the truth: up to the 57.3 of degrees for radians."
    MillivoltMixUp "millivolt_mix_up" "log10" 1e-3..3.0 true OneIdentifying
        "Decades by which all voltages of one trial are off: 3 is millivolts for volts."
    GravityNotHandled "gravity_not_handled" "deg" 1e-2..90.0 false Everywhere
        "Angle by which the session's direction of gravity is wrong: a bubble level's, up to level for vertical."
    TiltedAxis "tilted_axis" "deg" 1e-3..30.0 false Everywhere
        "Angle of the pinion's axis off the plumb line, which the session does not know: an engineer's level, up to a rig on its side."
    UnderExcitedAxis "under_excited_axis" "times" 0.1..1000.0 false Everywhere
        "The wedges of steps 2 and 3 are flatter about a plane by one and this many times: skewed, up to the plane itself."
    LooseWedge "loose_wedge" "deg" 1e-3..20.0 false Everywhere
        "Angle by which one wedge misses its direction in steps 2 to 4: ground, up to another wedge."
    TurnedFlange "turned_flange" "deg" 1e-3..90.0 true Everywhere
        "Angle by which the sensor is turned on its flange on all wedges: dowel pins, up to the next bolt hole but one."
    CentreOffset "centre_offset" "mm" 1e-3..10.0 false Everywhere
        "From a point of the pinion's axis to the sensor's centre, in a direction drawn at random: a dial gauge's error, up to one that nobody looked for."
    ConnectingRod "connecting_rod" "crank/rod" 1e-3..0.5 false Everywhere
        "Crank over connecting rod: far longer than any rig's, up to a rod of two cranks."
    WrongLimbLength "wrong_limb_length" "ln" 1e-4..0.3 true Everywhere
        "Logarithm of the written limb length over the true one: a drawing's tolerance, up to a misread drawing."
    WrongHalfEdge "wrong_half_edge" "ln" 1e-4..0.3 true Everywhere
        "Logarithm of the written half edge over the true one: a drawing's tolerance, up to a misread drawing."
    ReferenceLate "reference_late" "s" 1e-5..0.05 true Everywhere
        "Time by which the standards' samples are late: a fiftieth of a sample, up to a tenth of a period."
    ReferenceRate "reference_rate" "ratio" 1e-6..0.1 true Everywhere
        "The standards' true rate over the written one, less 1: a quartz, up to a wrong divider."
    SampleRate "sample_rate" "ln" 1e-4..0.05 true Everywhere
        "Logarithm of the written sample rate over the true one: an RC oscillator at its best, up to a rounded rate."
    LateCard "late_card" "s" 1e-6..0.01 false Everywhere
        "Time by which three of the nine channels, one card, are late: a multiplexer's skew, up to a card that was started by hand."
    DroppedSamples "dropped_samples" "share" 1e-4..0.3 false OneTrial
        "Share of one trial that is missing at one place, all channels alike: a buffer, up to a torn transfer."
    GyroscopeLag "gyroscope_lag" "s" 1e-5..0.05 false Everywhere
        "Time constant of the gyroscope, which the session does not state: 16 kHz, down to 3 Hz."
    AmplifierHighPass "amplifier_high_pass" "Hz" 1e-4..1.0 false Everywhere
        "Corner of the charge amplifiers, which the session does not state: a time constant of half an hour, down to a sixth of a second."
    DriftDuringRun "drift_during_run" "share" 1e-4..0.3 true OneTrial
        "Drift of a channel along one trial over the strongest signal: thermal, up to a leaking cable."
    DriftAtRest "drift_at_rest" "share" 1e-6..0.01 true Everywhere
        "Drift of a channel along the static record over the converter's range: thermal, up to a leaking cable."
    ZeroMoved "zero_moved" "V" 1e-5..0.5 true Everywhere
        "Shift of a channel's zero between the static record and the trials: microvolts of an amplifier, up to a touched potentiometer."
    FadingSensitivity "fading_sensitivity" "share" 1e-5..0.2 true Everywhere
        "Change of a channel's sensitivity from the day's first trial to its last: temperature, up to depolarisation."
    ForeignTrial "foreign_trial" "share" 1e-3..1.0 false OneTrial
        "How far, of the way to a sensor drawn afresh, the sensor of one trial is from this one: 1 is the other sensor."
    CrossTalk "cross_talk" "share" 1e-5..0.1 false Everywhere
        "Share of its neighbour's charge that each channel shows: shielded cables, up to a wet connector."
    CubicNonlinearity "cubic_nonlinearity" "share" 1e-5..0.2 true Everywhere
        "Departure of every channel from a straight line at each trial's largest force, as the cube: quartz, up to an overdriven ceramic."
    Hysteresis "hysteresis" "share" 1e-5..0.2 false Everywhere
        "Share of every channel that lags as friction does, with a play of half the trial's largest force: quartz, up to soft ceramics."
    MainsHum "mains_hum" "V" 1e-5..1.0 false Everywhere
        "Amplitude of 50 Hz on all channels: a thirtieth of a 16-bit converter's step, up to a tenth of its range."
}

impl Kind {
    /// The word that plans have for it.
    pub const fn name(self) -> &'static str {
        self.facts().name
    }
}

/// One thing wrong.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Defect {
    /// Its kind.
    pub kind: Kind,
    /// How large it is, in its kind's unit.
    pub magnitude: f64,
    /// Where it is; without effect where its kind is everywhere or the magnitude says where.
    #[serde(default)]
    pub place: Where,
    /// Its channel, from 0, where it has one.
    #[serde(default)]
    pub channel: usize,
    /// Seed of what else there is to it: an azimuth, a second channel, another sensor.
    #[serde(default)]
    pub seed: u32,
}

impl Defect {
    /// One of a kind for a plan: magnitude log-uniform over the kind's range, everything else even.
    pub fn draw(kind: Kind, plan: &SessionPlan, rng: &mut impl Rng) -> Self {
        let Facts {
            range: (low, high),
            signed,
            spread,
            ..
        } = kind.facts();
        let size = low * (high / low).powf(rng.random::<f64>());
        let negative = rng.random_bool(0.5) && signed;
        let any = rng.random_range(0..trial_count(plan.trials_per_step));
        let identifying = rng.random_range(0..2 * plan.trials_per_step);
        Self {
            kind,
            magnitude: if negative { -size } else { size },
            place: match spread {
                Spread::OneTrial => Where::Trial(any),
                Spread::OneIdentifying => Where::Trial(identifying),
                Spread::Everywhere | Spread::EndOfDay => Where::Everywhere,
            },
            channel: rng.random_range(0..LIMBS),
            seed: rng.random(),
        }
    }

    /// Where it is on a day of so many trials.
    pub fn place(&self, trials: usize) -> Where {
        match self.kind.facts().spread {
            Spread::OneTrial | Spread::OneIdentifying => self.place,
            Spread::Everywhere => Where::Everywhere,
            Spread::EndOfDay => {
                let concerned = (self.magnitude * trials as f64).round() as usize;
                if concerned < trials {
                    Where::From(trials - concerned)
                } else {
                    Where::Everywhere
                }
            }
        }
    }
}
