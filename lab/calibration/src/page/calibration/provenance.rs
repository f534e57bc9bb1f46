//! Where everything comes from.

use crate::calibrate::CalibratedSession;
use crate::trial::Trial;
use sixaxis_recordings::session::{Entry, SessionFile};

use crate::page::labels::{file_name, role, unbroken};
use sixaxis_page::number::{MISSING, count, si, significant};
use sixaxis_page::{Block, Cell, Listing, Section, Table};

/// The section.
pub fn section(file: &SessionFile, calibrated: &CalibratedSession) -> Section {
    Section::new(
        "provenance",
        "Provenance",
        "What was read. The session file stands here whole, so that this page and the recordings are enough to calibrate again.",
    )
    .block(Block::Table(table(file, calibrated)))
    .block(Block::Listing(Listing {
        caption: format!("Session file {}", session_name(file)),
        text: file.text.clone(),
    }))
}

fn table(file: &SessionFile, calibrated: &CalibratedSession) -> Table {
    let name = |entry: &Entry| entry.file.display().to_string();
    let of = |entry: &Entry, get: &dyn Fn(&Trial) -> String| {
        let mut trials = calibrated.recordings.iter().map(|(trial, _)| trial);
        let trial = trials.find(|trial| trial.name == name(entry));
        trial.map_or(MISSING.to_owned(), get)
    };
    Table::of("file", &file.session.recording, |entry| {
        unbroken(&name(entry))
    })
    .text("role", |entry| role(entry.role))
    .col("size", |entry| {
        match std::fs::metadata(file.resolve(&entry.file)) {
            Ok(m) => Cell::from(si(m.len() as f64, 3, "B")).title(format!("{} bytes", m.len())),
            Err(_) => Cell::from(MISSING),
        }
    })
    .col("samples", |entry| {
        of(entry, &|t| count(t.voltage_v.len() as u64))
    })
    .col("sample rate", |entry| {
        of(entry, &|t| si(t.sample_rate_hz, 3, "Hz"))
    })
    .col(("length", "s"), |entry| {
        of(entry, &|t| {
            significant(t.voltage_v.len() as f64 / t.sample_rate_hz, 3)
        })
    })
    .text("gains, N/V", |entry| {
        list(&entry.gain_n_per_v.unwrap_or(file.session.sensor.gain_n_per_v).each())
    })
    .text("down", |entry| match (entry.down, entry.direction) {
        (Some(down), _) => list(&down),
        (None, Some(_)) => "along the rig's axis".to_owned(),
        (None, None) => MISSING.to_owned(),
    })
    .caption("Recordings")
    .footnote(
        "Samples and rate as they were worked with: a long static record is averaged in groups. Gains of limbs 1 to 9, one number \
         where all are the same; down in the sensor's axes at rest, where gravity of 9.80665 m/s² points.",
    )
    .into()
}

/// Numbers as the session states them, one where all are the same.
fn list(numbers: &[f64]) -> String {
    let same = numbers.windows(2).all(|pair| pair[0] == pair[1]);
    let shown = if same { &numbers[..1] } else { numbers };
    let texts: Vec<String> = shown.iter().map(f64::to_string).collect();
    texts.join(", ")
}

fn session_name(file: &SessionFile) -> String {
    file.path
        .file_name()
        .map_or_else(String::new, |name| file_name(&name.to_string_lossy()))
}

/// The footer.
pub fn facts(file: &SessionFile, calibrated: &CalibratedSession) -> Vec<(String, String)> {
    let session = &file.session;
    [
        ("sixaxis", env!("CARGO_PKG_VERSION").to_owned()),
        ("session", session_name(file)),
        ("title", session.title.clone()),
        ("sensor", session.sensor.serial.clone()),
        (
            "recordings",
            format!(
                "{} named, {} used",
                session.recording.len(),
                calibrated.recordings.len()
            ),
        ),
    ]
    .into_iter()
    .filter(|(_, value)| !value.is_empty())
    .map(|(name, value)| (name.to_owned(), value))
    .collect()
}
