//! What to do next, and what was found.

use crate::calibrate::CalibratedSession;
use crate::finding::Finding;
use crate::report::Grade;

use super::pictures;
use crate::page::labels::{count, file_name};
use sixaxis_page::{Block, Cell, Listing, Section, State, Table};
use sixaxis_recordings::session::SessionFile;

/// Recordings named in full in a cell; of more, the first and a number.
const NAMED: usize = 4;

/// The section.
pub fn section(file: &SessionFile, calibrated: &CalibratedSession) -> Section {
    let lead = match calibrated.grade {
        Grade::Good => {
            "Nothing: the calibration can be used. Keep the session file and the recordings with it, and repeat one trial now and \
             then to see whether the sensor is still the same."
        }
        Grade::Reserved => {
            "Nothing was found wrong, but not everything that would prove the calibration is there. Work off this list, or decide \
             for each point whether your measurement can do without it."
        }
        Grade::Bad => {
            "The calibration should not be used. Work off this list from the top, then calibrate again: the first point often \
             causes the others."
        }
    };
    let mut section = Section::new("next", "What to do next", lead);
    let (actions, consequences) = split(calibrated);
    if !actions.is_empty() {
        let list: Vec<String> = actions
            .iter()
            .map(|next| format!("- {}", capital(&next.replace('\n', " "))))
            .collect();
        section = section.block(Block::Text(list.join("\n")));
    }
    if !consequences.is_empty() {
        section = section.block(Block::Listing(Listing {
            caption: format!(
                "{} that may be consequences of the above: look again after it is mended",
                count(consequences.len(), "more finding", "more findings")
            ),
            text: consequences.join("\n"),
        }));
    }
    let table = if calibrated.findings.is_empty() {
        Block::Note(
            "Looked for and not found: recordings that cannot be read, clipping, silent, exchanged or inverted channels, \
             directions left out, gravity that turns in the sensor, wrong units and gains, clocks that disagree, lags, drift, loose \
             wedges, trials of another sensor. What no recording of the day can show: one channel's gain that is stated wrongly in all of them, but for a \
             scale factor that stands out of the others by more than 3.5 times, a limb that was weaker all day, likewise, a wrong limb length or half \
             edge, but for inertias that are off the design's by more than 35 %, and without the rig's stroke the accelerometer's scale."
                .to_owned(),
        )
    } else {
        Block::Table(table(&calibrated.findings))
    };
    let remarks = calibrated.remarks.iter();
    let remarks = remarks.map(|remark| Block::Note(format!("{}.", capital(remark))));
    section.blocks.extend(remarks);
    section.blocks.push(table);
    section.blocks.extend(pictures::blocks(file, calibrated));
    section
}

fn table(findings: &[Finding]) -> Table {
    Table::of("what", findings, |f| format!("**{}**", f.cause.name()))
        .text("where", |f| {
            Cell::from(place(f))
                .title(f.recordings.join(", "))
                .state(State::Bad)
        })
        .text("evidence", |f| f.evidence.as_str())
        .text("advice", |f| f.advice.as_str())
        .caption("What was found")
        .footnote(
            "Channels are limbs, counted from 1. A cause that explains others is looked for first, and what it explains is not \
             listed again.",
        )
        .into()
}

/// What to do next, parted into what to do at once and what may be a consequence of what was found: where something is wrong,
/// nothing that it spoils can be judged.
pub fn split(calibrated: &CalibratedSession) -> (&[String], &[String]) {
    let at_once = if calibrated.findings.is_empty() {
        calibrated.next.len()
    } else {
        calibrated
            .next
            .len()
            .saturating_sub(calibrated.reservations.len())
    };
    calibrated.next.split_at(at_once)
}

/// Recordings and channels of a finding.
pub fn place(finding: &Finding) -> String {
    let recordings = match finding.recordings.as_slice() {
        [] => "all recordings".to_owned(),
        few if few.len() <= NAMED => {
            let names: Vec<String> = few.iter().map(|name| file_name(name)).collect();
            names.join(", ")
        }
        [first, rest @ ..] => format!("{} and {} more", file_name(first), rest.len()),
    };
    let numbers: Vec<String> = finding.channels.iter().map(ToString::to_string).collect();
    match numbers.as_slice() {
        [] => recordings,
        [one] => format!("{recordings}; channel {one}"),
        [rest @ .., last] => format!("{recordings}; channels {} and {last}", rest.join(", ")),
    }
}

/// The first letter of a sentence; a file's name keeps its own.
pub(super) fn capital(text: &str) -> String {
    let first_word = text.split([' ', ':']).next().unwrap_or_default();
    if first_word.contains('.') || first_word.contains('/') {
        return text.to_owned();
    }
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
