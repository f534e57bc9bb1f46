//! Whether repeating the steps helps.

use sixaxis_calibration::iteration::End;

use crate::study::results::identifiability::{Identifiability, IterationRun, Records};
use sixaxis_page::number::{fixed, scientific};
use sixaxis_page::{Axis, Block, Column, Figure, Row, Series, Table};

/// Unit of the table, s^-2.
const UNIT_PER_S2: f64 = 1e8;
/// Ends of the ordinate of the trace.
const DISTANCES: (f64, f64) = (1e-7, 10.0);
/// Ends of its abscissa.
const PASSES: (f64, f64) = (0.0, 5.0);

/// Figures and table.
pub fn blocks(study: &Identifiability) -> Vec<Block> {
    vec![
        Block::Heading("Steps 2 to 4 repeated until k/m stands still".to_owned()),
        Block::Text(
            "Each pass keeps the compliance that the pass before found. Without errors it stands still after two to four passes, \
             wherever it starts; what is left is the parabola through three grid points and the reference's own step. With the \
             laboratory's errors step 4 has no minimum to go on from, and the iteration ends there, with a verdict. On a session \
             of one's own: `sixaxis calibrate --iterate 10`."
                .to_owned(),
        ),
        Block::FigureGrid(vec![
            figure(study, Records::WholeRuns, "Whole runs, rest to rest", "trace-whole-runs"),
            figure(study, Records::EvenTurns, "Turns at full speed only", "trace-even-turns"),
        ]),
        Block::Table(table(study)),
    ]
}

fn start(run: &IterationRun) -> String {
    let from = run.start_per_s2.map_or("step 4's own k/m".to_owned(), |k| {
        format!("{} × 10⁸", fixed(k / UNIT_PER_S2, 1))
    });
    if run.with_errors {
        format!("{from}, laboratory errors")
    } else {
        from
    }
}

fn figure(study: &Identifiability, records: Records, title: &str, id: &str) -> Figure {
    let mut figure = Figure::new(
        id,
        title,
        Axis::linear("pass", "").range(PASSES.0, PASSES.1),
        Axis::log("|k/m / truth − 1|", "").range(DISTANCES.0, DISTANCES.1),
    );
    let runs = study.iterations.iter().filter(|run| run.records == records);
    for (run, colour) in runs.zip([0, 1, 2, 3, 7, 4]) {
        let distance = |k: f64| (k / run.truth_per_s2 - 1.0).abs();
        let points = run.passes.iter().enumerate().map(|(number, pass)| {
            // A start of one's own takes the place of the four steps.
            let k = if number == 0 {
                run.start_per_s2.unwrap_or(pass.found_per_s2)
            } else {
                pass.found_per_s2
            };
            (number as f64, distance(k))
        });
        figure = figure.series(Series::line_points(
            format!("from {}", start(run)),
            colour,
            points,
        ));
    }
    figure
}

fn table(study: &Identifiability) -> Table {
    let mut rows = Vec::new();
    for (records, name) in [
        (Records::WholeRuns, "Step 4 on whole runs"),
        (Records::EvenTurns, "Step 4 on the turns at full speed"),
    ] {
        rows.push(Row::group(name));
        for run in study.iterations.iter().filter(|run| run.records == records) {
            let Some(last) = run.passes.last() else {
                continue;
            };
            rows.push(Row::new(
                format!("from {}", start(run)),
                [
                    (run.passes.len() - 1).to_string(),
                    fixed(last.found_per_s2 / UNIT_PER_S2, 4),
                    scientific(last.found_per_s2 / run.truth_per_s2 - 1.0, 1),
                    match run.end {
                        End::Converged => "stands still".to_owned(),
                        _ => run.sentence.clone(),
                    },
                ],
            ));
        }
    }
    Table {
        caption: "Where the passes end".to_owned(),
        stub: "start".to_owned(),
        columns: vec![
            Column::number("repetitions", ""),
            Column::number("k/m", "10⁸ s⁻²"),
            Column::number("over truth, less one", ""),
            Column::text("verdict"),
        ],
        rows,
        ..Table::default()
    }
}
