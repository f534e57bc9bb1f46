//! The page of a calibration: is it good, and if not, what next? Sections stand in the order in which someone who has just
//! calibrated needs them; each has a file.

mod findings;
mod joint;
mod parameters;
mod preprocessing;
mod provenance;
mod rest;
mod steps;
mod taps;
mod trials;
mod validation;

use crate::verdict::{Grade, Judgement};
use sixaxis_core::Parameter;
use sixaxis_recordings::session::{Limits, SessionFile};

use super::labels::{self, largest, symbol};
pub use findings::{place, split};
use sixaxis_page::number::scientific;
use sixaxis_page::{Page, State, Tile};

/// Palette index of the neutral grey, for standards and what stood before.
const NEUTRAL: usize = 6;

/// Lays out a judged session.
///
/// Nothing is measured here but what a picture needs: the preprocessing of one trial is repeated stage by stage. Sizes of
/// recordings are asked of the file system; one that is gone has none.
#[must_use]
pub fn page(file: &SessionFile, judgement: &Judgement) -> Page {
    let session = &file.session;
    let mut sections = vec![
        findings::section(judgement),
        parameters::section(file, judgement),
        joint::section(judgement),
        trials::section(file, judgement),
        validation::section(file, judgement),
        steps::section(judgement),
        taps::section(judgement),
        preprocessing::section(file, judgement),
        rest::section(judgement),
        provenance::section(file, judgement),
    ];
    sections.retain(|section| !section.blocks.is_empty());
    let serial = match session.sensor.serial.as_str() {
        "" => "a six-axis accelerometer".to_owned(),
        serial => format!("sensor {serial}"),
    };
    Page {
        title: format!("Calibration of {serial}"),
        subtitle: judgement.sentence.clone(),
        facts: provenance::facts(file, judgement),
        tiles: tiles(&session.limits, judgement),
        sections,
    }
}

/// Nothing is green on the page of a calibration that is not good: a bar that is met there proves nothing.
fn state(judgement: &Judgement, met: bool) -> State {
    match (met, judgement.grade) {
        (true, Grade::Bad) => State::Neutral,
        (true, _) => State::Good,
        (false, _) => State::Bad,
    }
}

/// A share held against its bar, with where it was found.
fn share_tile(
    judgement: &Judgement,
    label: &str,
    worst: Option<(f64, String)>,
    limit: f64,
    none: &str,
) -> Tile {
    match worst {
        Some((share, place)) => Tile::new(
            label,
            labels::share(Some(share)),
            format!("{place}; the bar: {}", labels::bar(limit)),
            // Written so that NaN is no pass.
            state(judgement, share <= limit),
        ),
        None => Tile::new(label, "none", none, State::Neutral),
    }
}

fn tiles(limits: &Limits, judgement: &Judgement) -> Vec<Tile> {
    let (word, note, verdict) = match judgement.grade {
        Grade::Good => (
            "Good",
            "the bar: nothing found wrong, nothing missing".to_owned(),
            State::Good,
        ),
        Grade::Reserved => (
            "Good, reserved",
            format!(
                "nothing is wrong; {} left open",
                labels::count(judgement.reservations.len(), "point", "points")
            ),
            State::Warn,
        ),
        Grade::Bad => (
            "Not good",
            match judgement.findings.len() {
                0 => "the four steps could not be done".to_owned(),
                n => format!(
                    "{} found wrong; do not use it",
                    labels::count(n, "thing", "things")
                ),
            },
            State::Bad,
        ),
    };
    let trials = &judgement.trials;
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
        judgement
            .parameters
            .iter()
            .filter(|p| p.parameter.has_size())
            .filter_map(|p| Some((p.half_width_95? / p.estimate.abs(), symbol(p.parameter)))),
    );
    let mut tiles = vec![
        Tile::new("Verdict", word, note, verdict),
        share_tile(
            judgement,
            "Largest validation error",
            validation,
            limits.validation_percent / 100.0,
            "no run was decoupled and held against the standards",
        ),
        share_tile(
            judgement,
            "Largest hold-out error",
            hold_out,
            limits.hold_out_percent / 100.0,
            "no trial could be predicted by the others",
        ),
        share_tile(
            judgement,
            "Widest 95 % interval",
            interval.map(|(share, name)| (share, format!("half width, of {name}"))),
            limits.interval_percent / 100.0,
            "no parameter was identified",
        ),
    ];
    if let Some(stiffness) = judgement
        .parameters
        .iter()
        .find(|p| p.parameter == Parameter::Stiffness)
    {
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
