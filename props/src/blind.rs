//! Blind trials of the verdict: sessions written to disk, each healthy or with one defect, judged from their files alone.
//!
//! Which seed has which defect, and with which particulars, only the player knows; the judge gets the folder. One range of
//! seeds was used while thresholds were chosen ([`TUNING_SEEDS`]), what is reported comes from another.

use std::path::Path;

use serde::{Deserialize, Serialize};
use sixaxis_calibration::calibrate::{Options, calibrate};
use sixaxis_calibration::finding::Cause;
use sixaxis_calibration::progress::NoProgress;
use sixaxis_calibration::report::Grade;
use sixaxis_recordings::session::SessionFile;
use sixaxis_reference::laboratory::defect::Kind;
use sixaxis_reference::laboratory::plan::{
    ChainPlan, DefectChoice, Engine, RigPlan, SensorChoice, SessionPlan,
};
use sixaxis_reference::laboratory::session::simulate_session;
use sixaxis_reference::laboratory::write::write;

/// Seeds that thresholds were chosen with.
pub const TUNING_SEEDS: core::ops::Range<u64> = 1..101_000;
/// First of the seeds that are reported.
pub const REPORTED_FROM: u64 = 200_000;
/// Formats that sessions are written in, in turn.
const FORMATS: [&str; 4] = ["npz", "parquet", "tdms", "csv"];

/// Wedges of a healthy laboratory are this good, degrees: half an arc minute, which a workshop grinds. A tenth of a degree
/// spoils the 1 Hz validation run by 15 %, and the verdict says so.
const WEDGE_ERROR_DEG: f64 = 0.01;
/// Its sensor's limbs are this equally stiff, relative.
const STIFFNESS_SPREAD: f64 = 2e-3;

/// The defect of a seed: every third session is healthy, the others have each kind in turn.
#[must_use]
pub fn defect_of(seed: u64) -> Option<Kind> {
    match seed % 3 {
        0 => None,
        r => Some(Kind::ALL[((seed / 3 * 2 + r - 1) % Kind::ALL.len() as u64) as usize]),
    }
}

/// The cause that a verdict on a kind of defect should name.
#[must_use]
pub const fn cause_of(kind: Kind) -> Cause {
    match kind {
        Kind::DeadLimb => Cause::DeadLimb,
        Kind::SwappedChannels => Cause::SwappedChannels,
        Kind::InvertedChannel => Cause::InvertedChannel,
        Kind::ClippedConverter => Cause::ClippedConverter,
        Kind::WrongScaling => Cause::WrongScaling,
        Kind::MillivoltMixUp => Cause::MillivoltMixUp,
        Kind::GravityNotHandled => Cause::GravityNotHandled,
        Kind::UnderExcitedAxis => Cause::UnderExcitedAxis,
        Kind::LooseWedge => Cause::LooseWedge,
        Kind::ClockMismatch => Cause::ClockMismatch,
        Kind::GyroscopeLag => Cause::GyroscopeLag,
        Kind::DriftDuringRun => Cause::DriftDuringRun,
        Kind::ForeignTrial => Cause::ForeignTrial,
    }
}

/// One session and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Its seed.
    pub seed: u64,
    /// What was wrong.
    pub kind: Option<Kind>,
    /// With its particulars.
    pub particulars: String,
    /// The verdict.
    pub grade: Grade,
    /// The cause named first.
    pub cause: Option<Cause>,
    /// What the judge said.
    pub sentence: String,
    /// What it found, in full.
    pub evidence: Vec<String>,
    /// What it would rather have seen.
    pub reservations: Vec<String>,
}

impl Outcome {
    /// Good where nothing is wrong, bad where something is.
    #[must_use]
    pub fn verdict_is_right(&self) -> bool {
        self.grade
            == if self.kind.is_some() {
                Grade::Bad
            } else {
                Grade::Good
            }
    }

    /// The cause is the one.
    #[must_use]
    pub fn cause_is_right(&self) -> bool {
        self.cause == self.kind.map(cause_of)
    }

    /// A defect called good.
    #[must_use]
    pub fn is_broken_promise(&self) -> bool {
        self.kind.is_some() && self.grade == Grade::Good
    }

    /// A healthy session called anything but good.
    #[must_use]
    pub fn is_false_alarm(&self) -> bool {
        self.kind.is_none() && self.grade != Grade::Good
    }
}

/// The plan of a seed.
#[must_use]
pub fn plan(seed: u64, engine: Engine) -> SessionPlan {
    SessionPlan {
        seed,
        sensor: SensorChoice::Random,
        engine,
        rig: RigPlan {
            wedge_error_deg: WEDGE_ERROR_DEG,
            ..RigPlan::default()
        },
        chain: ChainPlan {
            stiffness_spread: STIFFNESS_SPREAD,
            ..ChainPlan::default()
        },
        defect: defect_of(seed).map_or(DefectChoice::None, DefectChoice::Kind),
        ..SessionPlan::default()
    }
}

/// Plays a seed's session, writes it into a folder of its own below `folder`, judges what lies there, and clears it away.
///
/// # Errors
/// What went wrong, in words, with the seed.
pub fn run(seed: u64, engine: Engine, folder: &Path) -> Result<Outcome, String> {
    let own = folder.join(format!("session-{seed}"));
    let format = FORMATS[(seed % FORMATS.len() as u64) as usize];
    let at = |what: &str, e: &dyn core::fmt::Display| format!("seed {seed}: {what}: {e}");
    let played = simulate_session(&plan(seed, engine)).map_err(|e| at("playing", &e))?;
    let session = write(&played, &own, format).map_err(|e| at("writing", &e))?;
    let particulars = played
        .truth
        .defect
        .as_ref()
        .map_or_else(String::new, |defect| format!("{defect:?}"));
    // From here on the files have to speak for themselves.
    drop(played);
    let judged = SessionFile::read(&session)
        .map_err(Into::into)
        .and_then(|file| calibrate(&file, &Options::default(), &NoProgress))
        .map_err(|e| at("judging", &e));
    let cleared = std::fs::remove_dir_all(&own).map_err(|e| at("clearing", &e));
    let judged = judged?;
    cleared?;
    Ok(Outcome {
        seed,
        kind: defect_of(seed),
        particulars,
        grade: judged.grade,
        cause: judged.findings.first().map(|finding| finding.cause),
        sentence: judged.sentence,
        reservations: judged.reservations,
        evidence: judged
            .findings
            .iter()
            .map(|f| {
                format!(
                    "{:?} {:?} {:?}: {}",
                    f.cause, f.recordings, f.channels, f.evidence
                )
            })
            .collect(),
    })
}
