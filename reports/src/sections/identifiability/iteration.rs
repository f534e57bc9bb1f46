//! Steps 2 to 4 repeated: how k/m approaches the truth, and where it ends.

use sixaxis_calibration::iteration::End;
use sixaxis_page::number::scientific;
use sixaxis_page::{Axis, Figure, Table, Text};

use super::RECORDS;
use crate::sections::stiffness_text;
use crate::study::results::identifiability::{Identifiability, IterationRun, Records};

/// Ends of the ordinate of the trace.
const DISTANCES: (f64, f64) = (1e-7, 10.0);
/// Ends of its abscissa.
const PASSES: (f64, f64) = (0.0, 5.0);

/// Figures and table.
pub fn fill(text: Text, study: &Identifiability) -> Text {
    RECORDS
        .into_iter()
        .fold(text, |text, (records, id, _)| {
            text.figure(figure(&format!("trace-{id}"), runs(study, records)))
        })
        .table("iterations", table(study))
}

fn runs(study: &Identifiability, records: Records) -> impl Iterator<Item = &IterationRun> {
    let all = study.iterations.iter();
    all.filter(move |run| run.records == records)
}

fn start(run: &IterationRun) -> String {
    let from = run.start_per_s2.map_or("step 4's own k/m".to_owned(), |k| {
        format!("{} × 10⁸", stiffness_text(k, 1))
    });
    match run.with_errors {
        true => format!("from {from}, laboratory errors"),
        false => format!("from {from}"),
    }
}

fn figure<'a>(id: &str, runs: impl Iterator<Item = &'a IterationRun>) -> Figure {
    let figure = Figure::new(
        id,
        "",
        Axis::linear("pass", "").range(PASSES.0, PASSES.1),
        Axis::log("|k/m / truth − 1|", "").range(DISTANCES.0, DISTANCES.1),
    );
    runs.zip([0, 1, 2, 3, 7, 4])
        .fold(figure, |figure, (run, colour)| {
            let points = run.passes.iter().enumerate().map(|(number, pass)| {
                // A start of one's own takes the place of the four steps.
                let own = run.start_per_s2.filter(|_| number == 0);
                let k = own.unwrap_or(pass.found_per_s2);
                (number as f64, (k / run.truth_per_s2 - 1.0).abs())
            });
            figure.line_points(start(run), colour, points)
        })
}

fn table(study: &Identifiability) -> Table {
    let ended = |records| {
        runs(study, records).filter_map(|run| Some((run, run.passes.last()?.found_per_s2)))
    };
    Table::grouped("start")
        .group(
            "Step 4 on whole runs",
            ended(Records::WholeRuns),
            |(run, _)| start(run),
        )
        .group(
            "Step 4 on the turns at full speed",
            ended(Records::EvenTurns),
            |(run, _)| start(run),
        )
        .col("repetitions", |(run, _)| (run.passes.len() - 1).to_string())
        .col(("k/m", "10⁸ s⁻²"), |(_, k)| stiffness_text(*k, 4))
        .col("over truth, less one", |(run, k)| {
            scientific(k / run.truth_per_s2 - 1.0, 1)
        })
        .text("verdict", |(run, _)| match run.end {
            End::Converged => "stands still".to_owned(),
            _ => run.sentence.clone(),
        })
        .into()
}
