//! Blind trials of the verdict, by the thousand: `cargo run --release -p sixaxis-props --example blind -- --publish`.
//!
//! `--first` and `--count` say which seeds. In shards: `--shard 2/8 --rows FILE` plays every eighth of them from the second on and
//! writes a row a session; `--merge FILE,FILE,...` plays nothing and counts the rows of all. The published file is the same bytes
//! either way.

use std::process::ExitCode;

use sixaxis_props::blind::{CYCLE, REPORTED_FROM, rows, table};
use sixaxis_props::publication::{self, Arguments, Seeds};
use sixaxis_props::results::{Blind, BlindTally};
use sixaxis_reference::laboratory::plan::Engine;

/// Sessions that are played unless told otherwise: whole cycles, and so many that a share of one in a thousand can be told from one of
/// three.
const COUNT: u64 = 45 * CYCLE;

fn main() -> ExitCode {
    publication::end(asked())
}

fn asked() -> Result<(), String> {
    let arguments = Arguments::given(&rows::OPTIONS)?;
    let (first, count) = (REPORTED_FROM, COUNT);
    if let Some(path) = arguments.text("--rows") {
        return rows::write_shard(&arguments, (first, count), Engine::Rigid, path);
    }
    let seeds = Seeds {
        first,
        count,
        sample: 3,
    };
    arguments.obey(seeds, |first, count| study(first, count, &arguments))
}

/// All sessions, or samples of them: from the rows that shards left where these are all of them, played where not.
fn study(first: u64, count: u64, arguments: &Arguments) -> Result<Blind, String> {
    let outcomes = match arguments.text("--merge") {
        Some(files) if count >= CYCLE => rows::gathered(files, first, count)?,
        _ => rows::play(&(first..first + count).collect::<Vec<_>>(), Engine::Rigid)?,
    };
    let table = table::of(outcomes, Engine::Rigid);
    print(&table);
    Ok(table)
}

fn print(published: &Blind) {
    let row = |name: &str, t: &BlindTally| {
        let percent =
            |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{:.3}", 100.0 * x));
        println!(
            "{name:<34} {:>5} | {:>4} {:>4} {:>4} {:>4} | {:>4} {:>4} {:>4} | {:>4} | {:>9} {:>9}",
            t.sessions,
            t.good.count,
            t.reserved.count,
            t.not_good.count,
            t.refused.count,
            t.right_cause.count,
            t.no_cause.count,
            t.wrong_cause.count,
            t.false_good.count,
            percent(t.median_parameter_error),
            percent(t.median_decoupling_error),
        );
    };
    println!(
        "{:<34} {:>5} | {:>4} {:>4} {:>4} {:>4} | {:>4} {:>4} {:>4} | {:>4} | {:>9} {:>9}",
        "", "n", "good", "res.", "bad", "ref.", "cau.", "none", "wrg.", "f.g.", "par. %", "dec. %"
    );
    for cell in &published.healthy {
        row(&format!("{:?}", cell.cell), &cell.tally);
    }
    for kind in &published.kinds {
        for bin in &kind.bins {
            let name = format!("{} {:.1e}..{:.1e}", kind.kind.name(), bin.from, bin.to);
            row(&name, &bin.tally);
        }
    }
    for (what, share) in [
        ("good, and should not be, of all", published.false_good),
        (
            "of those that a recording could show",
            published.false_good_that_could_show,
        ),
        ("a zero drift, among them", published.false_good_at_rest),
        ("of those called good", published.false_good_of_good),
        (
            "wrong cause, of all that name one",
            published.wrong_cause_of_named,
        ),
    ] {
        println!(
            "{what}: {} of {}, {:.2} % ({:.2} to {:.2} %)",
            share.count,
            share.of,
            100.0 * share.value(),
            100.0 * share.low_95,
            100.0 * share.high_95
        );
    }
}
