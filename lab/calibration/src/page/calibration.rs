//! The page of a calibration: is it good, and if not, what next? Sections stand in the order in which someone who has just
//! calibrated needs them; each has a file.

mod findings;
mod joint;
mod parameters;
mod pictures;
mod preprocessing;
mod provenance;
mod rest;
mod steps;
mod taps;
mod trials;
mod validation;

use crate::calibrate::CalibratedSession;
use crate::report::Grade;
use sixaxis_recordings::session::{Limits, SessionFile};

use super::labels::{self, largest, symbol};
pub use findings::{place, split};
use sixaxis_page::number::scientific;
use sixaxis_page::{Page, State, Tile};

/// Lays out a judged session.
///
/// Nothing is measured here but what a picture needs: the preprocessing of one trial is repeated stage by stage. Sizes of
/// recordings are asked of the file system; one that is gone has none.
pub fn page(file: &SessionFile, calibrated: &CalibratedSession) -> Page {
    let session = &file.session;
    let mut sections = vec![
        findings::section(file, calibrated),
        parameters::section(file, calibrated),
        joint::section(calibrated),
        trials::section(file, calibrated),
        validation::section(file, calibrated),
        steps::section(calibrated),
        taps::section(calibrated),
        preprocessing::section(file, calibrated),
        rest::section(calibrated),
        provenance::section(file, calibrated),
    ];
    sections.retain(|section| !section.blocks.is_empty());
    let serial = match session.sensor.serial.as_str() {
        "" => "a six-axis accelerometer".to_owned(),
        serial => format!("sensor {serial}"),
    };
    Page {
        title: format!("Calibration of {serial}"),
        subtitle: calibrated.sentence.clone(),
        facts: provenance::facts(file, calibrated),
        tiles: tiles(&session.limits, calibrated),
        sections,
    }
}

/// Nothing is green on the page of a calibration that is not good: an acceptance limit that is met there proves nothing.
fn state(calibrated: &CalibratedSession, met: bool) -> State {
    match (met, calibrated.grade) {
        (true, Grade::Bad) => State::Neutral,
        (true, _) => State::Good,
        (false, _) => State::Bad,
    }
}

/// A share held against its acceptance limit, with where it was found.
fn share_tile(
    calibrated: &CalibratedSession,
    label: &str,
    worst: Option<(f64, String)>,
    limit: f64,
    none: &str,
) -> Tile {
    match worst {
        Some((share, place)) => Tile::new(
            label,
            labels::share(Some(share)),
            format!("{place}; acceptance limit: {}", labels::stated(limit)),
            // Written so that NaN is no pass.
            state(calibrated, share <= limit),
        ),
        None => Tile::new(label, "none", none, State::Neutral),
    }
}

fn tiles(limits: &Limits, calibrated: &CalibratedSession) -> Vec<Tile> {
    let (word, note, verdict) = match calibrated.grade {
        Grade::Good => (
            "Good",
            "acceptance: nothing found wrong, nothing missing".to_owned(),
            State::Good,
        ),
        Grade::Reserved => (
            "Good, reserved",
            format!(
                "nothing wrong was named; {} left open",
                labels::count(calibrated.reservations.len(), "point", "points")
            ),
            State::Warn,
        ),
        Grade::Bad => (
            "Not good",
            match calibrated.findings.len() {
                0 => "the four steps could not be done".to_owned(),
                n => format!(
                    "{} found wrong; do not use it",
                    labels::count(n, "thing", "things")
                ),
            },
            State::Bad,
        ),
    };
    let trials = &calibrated.trials;
    let validation = largest(trials.iter().filter_map(|t| {
        let worst = largest(t.validation?.into_iter().map(|e| (e, ())))?.0;
        Some((worst, labels::file_name(&t.name)))
    }));
    let hold_out = largest(
        trials
            .iter()
            .filter_map(|t| Some((t.hold_out?, labels::file_name(&t.name)))),
    );
    let interval = largest(
        calibrated
            .parameters
            .iter()
            .filter(|p| p.parameter.has_size())
            .filter_map(|p| Some((p.half_width_95? / p.estimate.abs(), symbol(p.parameter)))),
    );
    let mut tiles = vec![
        Tile::new("Verdict", word, note, verdict),
        share_tile(
            calibrated,
            "Largest validation error",
            validation,
            limits.validation_percent / 100.0,
            "no run was decoupled and held against the standards",
        ),
        share_tile(
            calibrated,
            "Largest hold-out error",
            hold_out,
            limits.hold_out_percent / 100.0,
            "no trial could be predicted by the others",
        ),
        share_tile(
            calibrated,
            "Widest 95 % interval",
            interval.map(|(share, name)| (share, format!("half width, of {name}"))),
            limits.interval_percent / 100.0,
            "no parameter was identified",
        ),
    ];
    if let Some(stiffness) = calibrated.stiffness() {
        tiles.push(if stiffness.determined {
            Tile::new(
                "$k/m$",
                format!("{} 1/s²", scientific(stiffness.estimate, 3)),
                match stiffness.half_width_95 {
                    Some(half_width) => format!(
                        "{}; half width of the 95 % interval {}",
                        stiffness.remark,
                        labels::share(Some(half_width / stiffness.estimate))
                    ),
                    None => "determined by step 4".to_owned(),
                },
                State::Neutral,
            )
        } else {
            Tile::new(
                "$k/m$",
                "not determined",
                "its design value is used, which accelerations at the rig's frequencies do not notice; a tap on the shell determines it",
                State::Neutral,
            )
        });
    }
    tiles
}
