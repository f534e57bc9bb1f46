//! Runs that were never fitted: decoupled accelerations over those of the standards.

use crate::calibrate::CalibratedSession;
use crate::report::ValidationRun;
use sixaxis_recordings::session::SessionFile;

use super::NEUTRAL;
use crate::page::labels::{self, bar, file_name};
use sixaxis_page::number::{MISSING, significant};
use sixaxis_page::{Axis, Block, Cell, Column, Figure, Panel, Row, Section, Series, State, Table};

const AXES: [&str; 3] = ["x", "y", "z"];
/// Palette indices of x, y and z.
const COLOURS: [usize; 3] = [0, 1, 2];

/// Points that a curve is drawn with at most. The drawing keeps peaks; this keeps the page small.
const DRAWN: usize = 4000;

/// The section.
pub fn section(file: &SessionFile, calibrated: &CalibratedSession) -> Section {
    let section = Section::new(
        "validation",
        "Validation runs",
        "Runs that no step has seen, decoupled with this calibration and held against the standard instruments, from rest to rest, \
         in ground axes at the sensor's rest. The error contains the instruments' own, and their class is its share.",
    );
    if calibrated.validation_runs.is_empty() {
        // Without parameters there is nothing to say that the parameters' own section does not.
        if calibrated.steps.is_none() {
            return section;
        }
        return section.block(Block::Note(
            "None could be decoupled. A recording of role `validation`, a compound motion at best, is the only proof that decoupled \
             accelerations are right."
                .to_owned(),
        ));
    }
    let mut section = section.block(Block::Table(table(file, calibrated)));
    for (run, comparison) in calibrated.validation_runs.iter().enumerate() {
        section = section
            .block(Block::Heading(heading(calibrated, comparison)))
            .block(Block::FigureGrid(vec![
                figure(run, comparison, 0, "linear", "Linear acceleration", "m/s²"),
                figure(
                    run,
                    comparison,
                    3,
                    "angular",
                    "Angular acceleration",
                    "rad/s²",
                ),
            ]));
    }
    section
}

fn heading(calibrated: &CalibratedSession, comparison: &ValidationRun) -> String {
    let name = file_name(&comparison.name);
    calibrated
        .trials
        .iter()
        .find(|t| t.name == comparison.name)
        .map_or(name.clone(), |t| {
            format!("{name}, {} Hz", significant(t.frequency_hz, 3))
        })
}

fn figure(
    run: usize,
    comparison: &ValidationRun,
    from: usize,
    id: &str,
    title: &str,
    unit: &str,
) -> Figure {
    let stride = comparison.decoupled.len().div_ceil(DRAWN).max(1);
    let curve = |get: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        (0..comparison.decoupled.len())
            .step_by(stride)
            .map(|i| {
                let time_s = (comparison.first + i) as f64 / comparison.sample_rate_hz;
                (time_s, get(i))
            })
            .collect()
    };
    let mut figure = Figure::new(
        format!("validation-{run}-{id}"),
        title,
        Axis::linear("time", "s"),
        Axis::linear("acceleration", unit),
    );
    let mut errors = Vec::new();
    for axis in 0..3 {
        let column = from + axis;
        figure = figure.series(Series::line(
            format!("decoupled, {}", AXES[axis]),
            COLOURS[axis],
            curve(&|i| comparison.decoupled[i][column]),
        ));
        errors.push(Series::line(
            "",
            COLOURS[axis],
            curve(&|i| comparison.decoupled[i][column] - comparison.standard[i][column]),
        ));
    }
    for axis in 0..3 {
        let column = from + axis;
        let label = if axis == 0 {
            "standard instruments"
        } else {
            ""
        };
        figure = figure.series(Series::dashed(
            label,
            NEUTRAL,
            curve(&|i| comparison.standard[i][column]),
        ));
    }
    figure.below(Panel {
        y: Axis::linear("error", unit),
        series: errors,
        marks: Vec::new(),
    })
}

fn table(file: &SessionFile, calibrated: &CalibratedSession) -> Table {
    let limit = file.session.limits.validation_percent / 100.0;
    let mut rows = Vec::new();
    for comparison in &calibrated.validation_runs {
        rows.push(Row::group(heading(calibrated, comparison)));
        let judged = calibrated
            .trials
            .iter()
            .find(|t| t.name == comparison.name)
            .and_then(|t| t.validation);
        for axis in 0..6 {
            rows.push(row(comparison, judged, axis, limit));
        }
    }
    Table {
        caption: "Errors of the decoupled accelerations".to_owned(),
        stub: "axis".to_owned(),
        columns: vec![
            Column::number("peak", ""),
            Column::number("largest error", ""),
            Column::number("error, r.m.s.", ""),
            Column::number("largest error over peak", ""),
        ],
        rows,
        footnote: format!(
            "Over the run's peak on that axis, or over a tenth of the largest peak where an axis has less. The bar is {}.",
            bar(limit)
        ),
        ..Table::default()
    }
}

fn row(comparison: &ValidationRun, judged: Option<[f64; 6]>, axis: usize, limit: f64) -> Row {
    let unit = if axis < 3 { "m/s²" } else { "rad/s²" };
    let letter = if axis < 3 { "a" } else { "α" };
    let (mut peak, mut worst, mut squares) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (standard, decoupled) in comparison.standard.iter().zip(&comparison.decoupled) {
        let error = decoupled[axis] - standard[axis];
        peak = peak.max(standard[axis].abs());
        worst = worst.max(error.abs());
        squares += error * error;
    }
    let rms = (squares / comparison.standard.len().max(1) as f64).sqrt();
    let with_unit = |x: f64, digits: usize| {
        Cell::from(format!("{}\u{a0}{unit}", significant(x, digits))).title(format!("{x} {unit}"))
    };
    let share = judged.map_or(Cell::from(MISSING), |errors| {
        let cell = Cell::from(labels::share(Some(errors[axis]))).title(errors[axis].to_string());
        if errors[axis] <= limit {
            cell
        } else {
            cell.state(State::Warn)
        }
    });
    Row::new(
        format!("${letter}$_{{{}}}", AXES[axis % 3]),
        [
            with_unit(peak, 3),
            with_unit(worst, 2),
            with_unit(rms, 2),
            share,
        ],
    )
}
