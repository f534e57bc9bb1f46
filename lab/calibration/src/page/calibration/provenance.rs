//! Where everything comes from.

use crate::calibrate::CalibratedSession;
use sixaxis_recordings::session::SessionFile;

use crate::page::labels::{file_name, role, unbroken};
use sixaxis_page::number::{MISSING, count, si, significant};
use sixaxis_page::{Block, Cell, Column, Listing, Row, Section, Table};

/// The section.
pub fn section(file: &SessionFile, calibrated: &CalibratedSession) -> Section {
    let rows = file.session.recording.iter().map(|entry| {
        let name = entry.file.display().to_string();
        let trial = calibrated
            .recordings
            .iter()
            .map(|(trial, _)| trial)
            .find(|trial| trial.name == name);
        let bytes = std::fs::metadata(file.resolve(&entry.file)).ok();
        Row::new(
            unbroken(&name),
            [
                Cell::from(role(entry.role)),
                Cell::from(
                    bytes
                        .as_ref()
                        .map_or(MISSING.to_owned(), |m| si(m.len() as f64, 3, "B")),
                )
                .title(bytes.map_or(String::new(), |m| format!("{} bytes", m.len()))),
                Cell::from(trial.map_or(MISSING.to_owned(), |t| count(t.voltage_v.len() as u64))),
                Cell::from(trial.map_or(MISSING.to_owned(), |t| si(t.sample_rate_hz, 3, "Hz"))),
                Cell::from(trial.map_or(MISSING.to_owned(), |t| {
                    significant(t.voltage_v.len() as f64 / t.sample_rate_hz, 3)
                })),
            ],
        )
    });
    Section::new(
        "provenance",
        "Provenance",
        "What was read. The session file stands here whole, so that this page and the recordings are enough to calibrate again.",
    )
    .block(Block::Table(Table {
        caption: "Recordings".to_owned(),
        stub: "file".to_owned(),
        columns: vec![
            Column::text("role"),
            Column::number("size", ""),
            Column::number("samples", ""),
            Column::number("sample rate", ""),
            Column::number("length", "s"),
        ],
        rows: rows.collect(),
        footnote: "Samples and rate as they were worked with: a long static record is averaged in groups.".to_owned(),
        ..Table::default()
    }))
    .block(Block::Listing(Listing {
        caption: format!("Session file {}", session_name(file)),
        text: file.text.clone(),
    }))
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
