//! Blind trials of the verdict: sessions written to disk, healthy ones in several rooms and others with one defect of any size,
//! judged from their files alone and held afterwards against what only the simulator knows.
//!
//! Which seed has which defect, and how large, only the player knows; the judge gets the folder. One range of seeds was used while
//! thresholds were chosen ([`TUNING_SEEDS`]), what is reported comes from another. Whether a verdict was right is not asked of the
//! drawing: [`harm`] measures what became of parameters and decoupled accelerations, [`table`] counts, and
//! [`pairs`] holds the same sessions by two engines side by side.

pub mod harm;
mod one_kind;
pub mod pairs;
pub mod rooms;
pub mod rows;
pub mod share;
pub mod table;
pub mod validation_run;

use std::path::Path;

use serde::{Deserialize, Serialize};
use sixaxis_calibration::calibrate::{CalibratedSession, Options, calibrate};
use sixaxis_calibration::finding::Cause;
use sixaxis_calibration::progress::NoProgress;
use sixaxis_calibration::report::Grade;
use sixaxis_recordings::session::SessionFile;
use sixaxis_reference::laboratory::defect::Kind;
use sixaxis_reference::laboratory::plan::{
    ChainPlan, DefectChoice, Engine, RigPlan, SensorChoice, SessionPlan,
};
use sixaxis_reference::laboratory::recording::SimulatedRecording;
use sixaxis_reference::laboratory::room::Room;
use sixaxis_reference::laboratory::session::{SimulatedSession, simulate_session};
use sixaxis_reference::laboratory::write::write;
use sixaxis_reference::rig::run::Mounting;

use self::harm::Harm;

/// Seeds that thresholds were chosen with.
pub const TUNING_SEEDS: core::ops::Range<u64> = 1..101_000;
/// First of the seeds that are reported. Those from each earlier million on were published or read earlier, and what they said has
/// been read and acted on; seeds that have been read test nothing any more.
pub const REPORTED_FROM: u64 = 21_000_000;
/// Of so many sessions one is written in another format than npz.
const OTHER_FORMAT_EVERY: u64 = 50;
/// Those formats, in turn.
const OTHER_FORMATS: [&str; 3] = ["parquet", "tdms", "csv"];

/// Wedges of the healthy corner, degrees: 0.6 of an arc minute, which a workshop grinds.
pub const WEDGE_ERROR_DEG: f64 = 0.01;
/// Its limbs are this equally stiff, relative.
pub const STIFFNESS_SPREAD: f64 = 2e-3;
/// Samples per second of its trials, and length of its static record, s: half and a fifth of the paper's campaign, for speed.
pub const SAMPLE_RATE_HZ: f64 = 1000.0;
/// See [`SAMPLE_RATE_HZ`].
pub const STATIC_DURATION_S: f64 = 120.0;

/// What a session is drawn from: the healthy corner but for one thing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cell {
    /// The corner itself.
    Corner,
    /// Largest error of a wedge, degrees.
    WedgeDeg(f64),
    /// Standard deviation of the limbs' stiffnesses, relative.
    StiffnessSpread(f64),
    /// The axis is level.
    LevelAxis,
    /// Ratio of signal to noise of limbs and standards, dB.
    SignalToNoiseDb(f64),
    /// Half a limb's mass over the seismic mass.
    RodMass(f64),
    /// An ordinary room.
    Room(Room),
    /// The corner with a defect.
    Defect(Kind),
}

/// Healthy cells of one cycle of sessions; each room three times.
const HEALTHY: [Cell; 20] = [
    Cell::Corner,
    Cell::WedgeDeg(0.02),
    Cell::WedgeDeg(0.05),
    Cell::WedgeDeg(0.1),
    Cell::WedgeDeg(0.2),
    Cell::StiffnessSpread(0.0),
    Cell::StiffnessSpread(0.005),
    Cell::StiffnessSpread(0.01),
    Cell::StiffnessSpread(0.02),
    Cell::LevelAxis,
    Cell::SignalToNoiseDb(50.0),
    Cell::SignalToNoiseDb(66.0),
    Cell::SignalToNoiseDb(72.0),
    Cell::RodMass(0.01),
    Cell::Room(Room::Gentle),
    Cell::Room(Room::Gentle),
    Cell::Room(Room::Gentle),
    Cell::Room(Room::Usual),
    Cell::Room(Room::Usual),
    Cell::Room(Room::Usual),
];
/// Sessions of each kind of defect in a cycle.
const OF_A_KIND: usize = 2;
/// Sessions of a cycle.
pub const CYCLE: u64 = (HEALTHY.len() + OF_A_KIND * Kind::ALL.len()) as u64;

impl Cell {
    /// The cell of a seed: all of a cycle in turn.
    pub fn of(seed: u64) -> Self {
        let place = (seed % CYCLE) as usize;
        HEALTHY
            .get(place)
            .copied()
            .unwrap_or_else(|| Self::Defect(Kind::ALL[(place - HEALTHY.len()) % Kind::ALL.len()]))
    }

    /// The defect.
    pub const fn kind(self) -> Option<Kind> {
        match self {
            Self::Defect(kind) => Some(kind),
            _ => None,
        }
    }
}

/// The plan of a session of a cell.
pub fn plan(cell: Cell, seed: u64, engine: Engine) -> SessionPlan {
    let mut plan = SessionPlan {
        seed,
        sensor: SensorChoice::Random,
        engine,
        sample_rate_hz: SAMPLE_RATE_HZ,
        static_duration_s: STATIC_DURATION_S,
        rig: RigPlan {
            wedge_error_deg: WEDGE_ERROR_DEG,
            ..RigPlan::default()
        },
        chain: ChainPlan {
            stiffness_spread: STIFFNESS_SPREAD,
            ..ChainPlan::default()
        },
        ..SessionPlan::default()
    };
    match cell {
        Cell::Corner => {}
        Cell::WedgeDeg(largest) => plan.rig.wedge_error_deg = largest,
        Cell::StiffnessSpread(spread) => plan.chain.stiffness_spread = spread,
        Cell::LevelAxis => plan.rig.mounting = Mounting::AxisLevel,
        Cell::SignalToNoiseDb(db) => {
            plan.chain.signal_to_noise_db = db;
            plan.instruments.signal_to_noise_db = db;
        }
        Cell::RodMass(share) => plan.rod_mass = share,
        Cell::Room(room) => plan = room.holding(plan),
        Cell::Defect(kind) => plan.defect = DefectChoice::Kind(kind),
    }
    plan
}

/// Decades from which a factor is millivolts for volts and not just wrong.
const NEAR_A_THOUSAND: f64 = 2.5;

/// The cause that a verdict on a defect should name; none where the judge has no word for it.
pub fn cause_of(kind: Kind, magnitude: f64) -> Option<Cause> {
    Some(match kind {
        Kind::MillivoltMixUp if magnitude < NEAR_A_THOUSAND => Cause::WrongScaling,
        Kind::DeadLimb | Kind::DeadStatic => Cause::DeadLimb,
        Kind::SwappedChannels => Cause::SwappedChannels,
        Kind::InvertedChannel | Kind::InvertedSmall => Cause::InvertedChannel,
        Kind::ClippedConverter => Cause::ClippedConverter,
        Kind::WrongGain
        | Kind::WrongGainInTrial
        | Kind::AccelerometerGain
        | Kind::GyroscopeGain
        | Kind::WrongScaling => Cause::WrongScaling,
        Kind::MillivoltMixUp => Cause::MillivoltMixUp,
        Kind::GravityNotHandled | Kind::TiltedAxis => Cause::GravityNotHandled,
        Kind::UnderExcitedAxis => Cause::UnderExcitedAxis,
        Kind::LooseWedge | Kind::TurnedFlange => Cause::LooseWedge,
        Kind::FadingSensitivity => Cause::FadingSensitivity,
        Kind::ReferenceLate
        | Kind::ReferenceRate
        | Kind::SampleRate
        | Kind::LateCard
        | Kind::DroppedSamples => Cause::ClockMismatch,
        Kind::GyroscopeLag => Cause::GyroscopeLag,
        Kind::AmplifierHighPass => Cause::HighPassMisstated,
        Kind::DriftDuringRun | Kind::DriftAtRest | Kind::ZeroMoved => Cause::DriftDuringRun,
        Kind::ForeignTrial => Cause::ForeignTrial,
        Kind::CentreOffset
        | Kind::ConnectingRod
        | Kind::WrongLimbLength
        | Kind::WrongHalfEdge
        | Kind::CrossTalk
        | Kind::CubicNonlinearity
        | Kind::Hysteresis
        | Kind::MainsHum => return None,
    })
}

/// What the cause named first is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Naming {
    /// It is the defect.
    Right,
    /// No cause is named, or "cause unknown".
    None,
    /// It is something else.
    Wrong,
}

/// One session and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Its seed.
    pub seed: u64,
    /// What it was drawn from.
    pub cell: Cell,
    /// Size of the defect in its kind's unit, without sign.
    pub magnitude: Option<f64>,
    /// The verdict; none if the session is refused, which leaves no calibration.
    pub grade: Option<Grade>,
    /// The cause named first.
    pub cause: Option<Cause>,
    /// What the calibration is worth in truth; none without one.
    pub harm: Option<Harm>,
    /// Whether a converter stood at its limit: where a defect drives it there, that is a cause, too.
    pub clips: bool,
}

/// Whether the recordings of a day could contradict one another: a limb that was always weaker is another scale factor, a gain or a drawing
/// that is written wrongly all day stands in for another sensor, and what is decoupled with the same numbers is right. Only a design
/// value can show these, if one scale factor stands out of the others.
pub const fn could_show(kind: Kind) -> bool {
    !matches!(kind, Kind::DeadLimb | Kind::WrongGain | Kind::WrongHalfEdge)
}

impl Outcome {
    /// What the cause named first is worth.
    pub fn naming(&self) -> Naming {
        match self.cause {
            None | Some(Cause::Unexplained | Cause::JointFitRefused | Cause::Unreadable) => {
                Naming::None
            }
            named if named == self.right_cause() => Naming::Right,
            Some(Cause::ClippedConverter) if self.clips => Naming::Right,
            Some(_) => Naming::Wrong,
        }
    }

    fn right_cause(&self) -> Option<Cause> {
        cause_of(self.cell.kind()?, self.magnitude?)
    }

    /// Whether the recordings of the day could have contradicted one another.
    pub fn could_show(&self) -> bool {
        self.cell.kind().is_none_or(could_show)
    }

    /// Called good although it does not keep what good states.
    pub fn is_false_good(&self) -> bool {
        self.grade == Some(Grade::Good) && self.harm.as_ref().is_none_or(Harm::breaks_the_promise)
    }
}

/// Plays a seed's session, writes it into a folder of its own below `folder`, judges what lies there, and clears it away.
///
/// # Errors
/// What went wrong, in words, with the seed.
pub fn run(seed: u64, engine: Engine, folder: &Path) -> Result<Outcome, String> {
    let cell = Cell::of(seed);
    let own = folder.join(format!("session-{seed}"));
    let other = seed / OTHER_FORMAT_EVERY;
    let format = if seed.is_multiple_of(OTHER_FORMAT_EVERY) {
        OTHER_FORMATS[(other % OTHER_FORMATS.len() as u64) as usize]
    } else {
        "npz"
    };
    try_out(cell, &plan(cell, seed, engine), format, &own)
        .map_err(|error| format!("seed {seed}: {error}"))
}

/// The same for any plan, in a folder that is not there yet.
///
/// # Errors
/// What went wrong, in words.
pub fn try_out(
    cell: Cell,
    plan: &SessionPlan,
    format: &str,
    own: &Path,
) -> Result<Outcome, String> {
    let (played, judged) = judged(plan, format, own)?;
    let judged = judged.as_ref();
    let calibrated = judged.filter(|j| j.calibration.is_some());
    Ok(Outcome {
        seed: plan.seed,
        cell,
        magnitude: played.truth.defect.map(|defect| defect.magnitude.abs()),
        grade: calibrated.map(|j| j.grade),
        cause: judged
            .and_then(|j| j.findings.first())
            .map(|finding| finding.cause),
        harm: calibrated.and_then(|j| Harm::of(j, &played)),
        clips: played.recordings.iter().any(at_the_limit),
    })
}

/// A session, and what becomes of it by its files alone, written to a folder that is not there yet and is cleared away; none if it is
/// refused.
///
/// # Errors
/// What went wrong, in words.
pub fn judged(
    plan: &SessionPlan,
    format: &str,
    own: &Path,
) -> Result<(SimulatedSession, Option<CalibratedSession>), String> {
    let played = simulate_session(plan).map_err(|e| format!("playing: {e}"))?;
    let judged = judged_by_files(&played, format, own)?;
    Ok((played, judged))
}

/// What becomes of a session that was played, as [`judged`].
///
/// # Errors
/// What went wrong, in words.
pub fn judged_by_files(
    played: &SimulatedSession,
    format: &str,
    own: &Path,
) -> Result<Option<CalibratedSession>, String> {
    let session = write(played, own, format).map_err(|e| format!("writing: {e}"))?;
    // The judge has the folder and nothing else.
    let judged = judge(&session).ok();
    std::fs::remove_dir_all(own).map_err(|e| format!("clearing: {e}"))?;
    Ok(judged)
}

fn at_the_limit(recording: &SimulatedRecording) -> bool {
    let limit = recording.full_scale_v;
    let mut voltages = recording.voltage_v.iter().flatten();
    voltages.any(|u| u.abs().total_cmp(&limit).is_eq())
}

fn judge(session: &Path) -> sixaxis_calibration::Result<CalibratedSession> {
    let file = SessionFile::read(session)?;
    calibrate(&file, &Options::default(), &NoProgress)
}
