//! Runs that were never fitted: decoupled accelerations over those of the standards.

use crate::calibrate::CalibratedSession;
use crate::report::ValidationRun;
use sixaxis_recordings::session::SessionFile;

use crate::page::labels::{self, file_name, stated};
use sixaxis_page::figure::NEUTRAL;
use sixaxis_page::number::{MISSING, significant};
use sixaxis_page::{Axis, Block, Cell, Figure, Section, Table};

const AXES: [&str; 3] = ["x", "y", "z"];
/// Palette indices of x, y and z.
const COLOURS: [usize; 3] = [0, 1, 2];

/// The section.
pub fn section(file: &SessionFile, calibrated: &CalibratedSession) -> Section {
    let section = Section::new(
        "validation",
        "Validation runs",
        "Runs that no step has seen, decoupled with this calibration and held against the standard instruments, from rest to rest, \
         in sensor axes: the change of the specific force since the rest, and the angular acceleration. The error contains the instruments' own, and their class is its share.",
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
    match calibrated.trial(&comparison.name) {
        Some(trial) => format!("{name}, {} Hz", significant(trial.frequency_hz, 3)),
        None => name,
    }
}

fn figure(
    run: usize,
    comparison: &ValidationRun,
    from: usize,
    id: &str,
    title: &str,
    unit: &str,
) -> Figure {
    let curve = |get: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        (0..comparison.decoupled.len())
            .map(|i| {
                let time_s = (comparison.first + i) as f64 / comparison.sample_rate_hz;
                (time_s, get(i))
            })
            .collect()
    };
    let figure = Figure::new(
        format!("validation-{run}-{id}"),
        title,
        Axis::linear("time", "s"),
        Axis::linear("acceleration", unit),
    );
    let (decoupled, standard) = (&comparison.decoupled, &comparison.standard);
    let axes = || (from..from + 3).zip(AXES).zip(COLOURS);
    let figure = axes().fold(figure, |figure, ((column, axis), colour)| {
        let label = format!("decoupled, {axis}");
        figure.line(label, colour, curve(&|i| decoupled[i][column]))
    });
    let labels = ["standard instruments", "", ""];
    let figure = axes()
        .zip(labels)
        .fold(figure, |figure, (((column, axis), _), label)| {
            let curve = curve(&|i| standard[i][column]);
            let name = format!("standard instruments, {axis}");
            figure.dashed(label, NEUTRAL, curve).named(name)
        });
    let figure = figure.below(Axis::linear("error", unit));
    axes().fold(figure, |figure, ((column, axis), colour)| {
        let error = |i: usize| decoupled[i][column] - standard[i][column];
        let name = format!("error, {axis}");
        figure.line("", colour, curve(&error)).named(name)
    })
}

/// Figures of one axis of a run.
struct Errors {
    axis: usize,
    peak: f64,
    worst: f64,
    rms: f64,
    /// Largest error over the peak, as the run was judged by.
    share: Option<f64>,
}

fn table(file: &SessionFile, calibrated: &CalibratedSession) -> Table {
    let limit = file.session.limits.validation_percent / 100.0;
    let mut table = Table::grouped("axis");
    for run in &calibrated.validation_runs {
        let judged = calibrated.trial(&run.name).and_then(|t| t.validation);
        table = table.group(
            heading(calibrated, run),
            (0..6).map(|axis| errors(run, judged, axis)),
            |e| {
                let letter = if e.axis < 3 { "a" } else { "α" };
                format!("${letter}$_{{{}}}", AXES[e.axis % 3])
            },
        );
    }
    let with_unit = |axis: usize, x: f64, digits: usize| {
        let unit = if axis < 3 { "m/s²" } else { "rad/s²" };
        Cell::from(format!("{}\u{a0}{unit}", significant(x, digits))).title(format!("{x} {unit}"))
    };
    table
        .col("peak", |e| with_unit(e.axis, e.peak, 3))
        .col("largest error", |e| with_unit(e.axis, e.worst, 2))
        .col("error, r.m.s.", |e| with_unit(e.axis, e.rms, 2))
        .col("largest error over peak", |e| {
            e.share.map_or(Cell::from(MISSING), |share| {
                let cell = Cell::of(share, |share| labels::share(Some(share)));
                cell.warn_unless(share <= limit)
            })
        })
        .caption("Errors of the decoupled accelerations")
        .footnote(format!(
            "Over the run's peak on that axis, or over a tenth of the largest peak where an axis has less. The acceptance limit is {}.",
            stated(limit)
        ))
        .into()
}

fn errors(run: &ValidationRun, judged: Option<[f64; 6]>, axis: usize) -> Errors {
    let (mut peak, mut worst, mut squares) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (standard, decoupled) in run.standard.iter().zip(&run.decoupled) {
        let error = decoupled[axis] - standard[axis];
        peak = peak.max(standard[axis].abs());
        worst = worst.max(error.abs());
        squares += error * error;
    }
    Errors {
        axis,
        peak,
        worst,
        rms: (squares / run.standard.len().max(1) as f64).sqrt(),
        share: judged.map(|errors| errors[axis]),
    }
}
