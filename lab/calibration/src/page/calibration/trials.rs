//! Every trial as it came out.

use crate::calibrate::CalibratedSession;
use crate::diagnosis::odd_trial;
use crate::grade::COORDINATION_LIMIT;
use crate::report::TrialReport;
use sixaxis_recordings::session::{Limits, Role, SessionFile};

use crate::page::labels::{self, bar, direction, file_name, largest, share, unbroken};
use sixaxis_page::number::{MISSING, fixed, percent, significant};
use sixaxis_page::{
    Axis, Block, Cell, Column, Figure, HeadCell, Mark, Row, Section, Series, State, Table,
};

const ROLES: [Role; 4] = [
    Role::Linear,
    Role::Angular,
    Role::HighFrequencyLinear,
    Role::Validation,
];

/// Use of the converter's range below which its steps begin to matter.
const POOR_RANGE: f64 = 0.02;

/// The section.
pub fn section(file: &SessionFile, calibrated: &CalibratedSession) -> Section {
    let section = Section::new(
        "trials",
        "The trials",
        "How well each trial agrees with the others and with the mathematics. A number that is beyond its bar is marked.",
    );
    if calibrated.trials.is_empty() {
        return section;
    }
    section
        .block(Block::Figure(figure(&file.session.limits, calibrated)))
        .block(Block::Table(table(file, calibrated)))
        .block(Block::Text(
            [
                "- **Departure**: how far the nine channels are from what all trials together expect of this motion, over the \
                 trial's own size. Half a degree of a wedge makes about 1\u{a0}%.",
                "- **Residual**: what the motion, an offset, a trend and a lag together do not explain of the voltages: noise and vibration.",
                "- **Lag**: time by which the standard instrument is behind the sensor after its own lag has been undone.",
                "- **Prediction**: of linear and angular trials the hold-out error: the step is fitted without this trial and has to \
                 predict it, which is the honest test of a fit. Of validation runs the largest error of the six decoupled \
                 accelerations over their peaks.",
                "- **Whiteness**: correlation of neighbouring residuals of the step's equation. 0 is noise; near 1 something \
                 systematic is left, such as a wedge's angle, and the noise alone would promise too narrow an interval.",
                "- **Coordination**: the largest residual of the three equations that nine limbs of equal stiffness obey and no step \
                 uses: an independent check.",
            ]
            .join("\n"),
        ))
}

/// What was found about a recording itself.
fn found(calibrated: &CalibratedSession, name: &str) -> Option<&'static str> {
    calibrated
        .findings
        .iter()
        .find(|f| f.recordings.iter().any(|r| r == name))
        .map(|f| f.cause.name())
}

fn table(file: &SessionFile, calibrated: &CalibratedSession) -> Table {
    let limits = &file.session.limits;
    let mut rows = Vec::new();
    for role in ROLES {
        let trials: Vec<&TrialReport> = calibrated
            .trials
            .iter()
            .filter(|t| t.role == role)
            .collect();
        let missing: Vec<String> = file
            .session
            .recording
            .iter()
            .filter(|entry| entry.role == role)
            .map(|entry| entry.file.display().to_string())
            .filter(|name| trials.iter().all(|t| t.name != *name))
            .collect();
        if trials.is_empty() && missing.is_empty() {
            continue;
        }
        rows.push(Row::group(labels::role(role)));
        rows.extend(trials.iter().map(|trial| row(limits, calibrated, trial)));
        rows.extend(missing.iter().map(|name| {
            let mut cells = vec![Cell::from(MISSING); COLUMNS];
            cells[0] = Cell::from(found(calibrated, name).unwrap_or("not used")).state(State::Bad);
            Row::new(unbroken(name), cells)
        }));
    }
    let mut table = Table {
        caption: "All trials".to_owned(),
        stub: "recording".to_owned(),
        head: vec![vec![
            HeadCell::new("", 1),
            HeadCell::new("motion", 2),
            HeadCell::new("recording", 1),
            HeadCell::new("agreement with the others", 4),
            HeadCell::new("independent checks", 2),
        ]],
        columns: vec![
            Column::text("found"),
            Column::number("frequency", "Hz"),
            Column::number("direction", ""),
            Column::number("range used", ""),
            Column::number("departure", ""),
            Column::number("residual", ""),
            Column::number("lag", "ms"),
            Column::number("predic\u{ad}tion", ""),
            Column::number("whiteness", ""),
            Column::number("coordi\u{ad}nation", ""),
        ],
        rows,
        footnote: format!(
            "Bars: departure {}, hold-out {}, coordination {}, validation {}. Range used is the largest voltage over the converter's \
             limit; a small share wastes resolution. Directions are those of travel and axis in the sensor's axes at rest.",
            bar(odd_trial::NOTICED),
            bar(limits.hold_out_percent / 100.0),
            bar(COORDINATION_LIMIT),
            bar(limits.validation_percent / 100.0),
        ),
    };
    // Where nothing was found there is nothing to tell in its column.
    if calibrated.findings.iter().all(|f| f.recordings.is_empty()) {
        table.columns.remove(0);
        for row in table.rows.iter_mut().filter(|row| !row.cells.is_empty()) {
            row.cells.remove(0);
        }
        for head in &mut table.head {
            head.remove(0);
        }
    }
    table
}

/// Columns after the recording's name.
const COLUMNS: usize = 10;

fn row(limits: &Limits, calibrated: &CalibratedSession, trial: &TrialReport) -> Row {
    let held = |value: Option<f64>, limit: f64| {
        let cell = Cell::from(share(value));
        match value {
            Some(value) if value <= limit => cell,
            Some(_) => cell.state(State::Warn),
            None => cell,
        }
    };
    let worst =
        |values: Option<&[f64]>| largest(values?.iter().map(|x| (*x, ()))).map(|(worst, ())| worst);
    let name = found(calibrated, &trial.name);
    let range = Cell::from(percent(trial.largest_over_full_scale, 2));
    let cells: [Cell; COLUMNS] = [
        name.map_or(Cell::from(""), |words| Cell::from(words).state(State::Bad)),
        Cell::from(significant(trial.frequency_hz, 3)),
        Cell::from(direction(trial.direction)),
        if trial.largest_over_full_scale < POOR_RANGE {
            range.state(State::Warn)
        } else {
            range
        },
        held(trial.departure, odd_trial::NOTICED),
        Cell::from(share(trial.residual)),
        Cell::from(
            trial
                .lag_s
                .map_or(MISSING.to_owned(), |s| fixed(1e3 * s, 2)),
        ),
        match worst(trial.validation.as_ref().map(|v| &v[..])) {
            None => held(trial.hold_out, limits.hold_out_percent / 100.0),
            validation => held(validation, limits.validation_percent / 100.0),
        },
        Cell::from(
            trial
                .residual_correlation
                .map_or(MISSING.to_owned(), |r| fixed(r, 2)),
        ),
        held(
            worst(trial.coordination.as_ref().map(|c| &c[..])),
            COORDINATION_LIMIT,
        ),
    ];
    Row::new(unbroken(&trial.name), cells)
}

fn figure(limits: &Limits, calibrated: &CalibratedSession) -> Figure {
    let trials = &calibrated.trials;
    let series = |get: &dyn Fn(&TrialReport) -> Option<f64>| -> Vec<(f64, f64)> {
        trials
            .iter()
            .enumerate()
            .filter_map(|(row, trial)| Some((100.0 * get(trial)?, row as f64)))
            .collect()
    };
    Figure::new(
        "trial-errors",
        "Departure, hold-out error and validation error by trial",
        Axis::log("share of the trial's own size", "%"),
        Axis::names("trial", trials.iter().map(|t| file_name(&t.name))),
    )
    .series(Series::points("departure from the others", 0, series(&|t| t.departure)))
    .series(Series::points("hold-out error", 1, series(&|t| t.hold_out)))
    .series(Series::points(
        "validation error, largest of six",
        2,
        series(&|t| largest(t.validation?.into_iter().map(|e| (e, ()))).map(|(e, ())| e)),
    ))
    .mark(Mark::vertical(100.0 * odd_trial::NOTICED, "departure noticed"))
    .mark(Mark::vertical(limits.hold_out_percent, "hold-out bar"))
    .mark(Mark::vertical(limits.validation_percent, "validation bar"))
    .caption("A trial that stands apart to the right does not fit in with the others. Its neighbours usually suffer with it: a fit that contains a bad trial predicts the good ones worse.")
}
