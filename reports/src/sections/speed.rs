//! Speed: what the core takes beside what else one could run, and how that grows.
//!
//! The numbers are a published measurement's, not this machine's: a report that timed would never be the same twice.
//! Ratios lead and nanoseconds stand behind, small: ratios are more nearly the same elsewhere.

mod figures;
mod growth;

use anyhow::{Context, Result};
use serde::Serialize;
use sixaxis_core::Scheme;
use sixaxis_page::number::{count, fixed, scientific, significant};
use sixaxis_page::{Cell, Section, Table, Text};
use sixaxis_props::results::{Growth, Instructions, Peer, Peers, Published, Speed};

/// What ratios are taken to, by its name among the peers and among the instruction counts.
pub const PUSH: &str = "push";
/// The same formulas in another language: the peer that is hardest to beat.
const CLOSED_FORM: &str = "closed_form";
/// Where one finds what is no peer but the core itself.
const OURS: &str = "this project";
pub const COUNTED_BASE: &str = "push/full/heun";
/// Sample rate of the lead's example, Hz: the one most of this report is at.
const EXAMPLE_RATE_HZ: f64 = 10_000.0;
/// Digits of a commit that tell it from others.
const COMMIT_DIGITS: usize = 9;

/// What makes the comparison with a peer less than fair.
#[derive(Serialize)]
struct Difference<'a> {
    name: &'a str,
    words: String,
}

/// The section.
///
/// # Errors
/// If the measurements cannot be read or the text does not fit them.
pub fn section() -> Result<Section> {
    let snapshot = &Speed::embedded()?;
    let growth = &Growth::embedded()?;
    let Speed {
        speed,
        peers,
        instructions,
    } = snapshot;
    let instructions = instructions.as_ref().context("nothing was counted")?;
    let curves = speed.work_precision.curves.iter();
    let example = curves
        .filter(|curve| curve.scheme == Scheme::default())
        .flat_map(|curve| &curve.points)
        .find(|p| p.sample_rate_hz == EXAMPLE_RATE_HZ);
    let commit = peers.commit.as_deref().map_or("unknown", short);
    let text = Text::new(include_str!("speed.md"))
        .value("speed", speed)
        .value("example", example)
        .value("rustc", speed.machine.rustc.split(" (").next())
        .value("speed_commit", short(&speed.commit))
        .value("speed_day", day(&speed.date_utc))
        .value("peers", peers)
        .value("peers_day", day(&peers.date_utc))
        .value("peers_commit", commit)
        .value("versions", versions(peers))
        .value("differences", differences(peers))
        .value("instructions", instructions)
        .table("peers", peers_table(peers))
        .table("instructions", instructions_table(instructions));
    let text = text
        .value("growth_commit", short(&growth.commit))
        .value("growth_day", day(&growth.date_utc));
    growth::fill(figures::fill(text, speed), growth).section("speed")
}

fn short(commit: &str) -> &str {
    commit.get(..COMMIT_DIGITS).unwrap_or(commit)
}

/// The day of a time stamp.
fn day(date_utc: &str) -> &str {
    date_utc.split('T').next().unwrap_or_default()
}

/// A peer as people know it and the language one would use it from; one that is added later keeps its own name.
fn known(name: &str) -> (&str, &str) {
    match name {
        PUSH => ("push", OURS),
        "record" => ("push_record", OURS),
        "record_portable" => ("push_record_portable", OURS),
        "lanes" => ("push_lanes", OURS),
        "paper" => ("the paper's equations", OURS),
        CLOSED_FORM => ("the closed form", "C++"),
        "closed_form_fast_math" => ("the closed form, -ffast-math", "C++"),
        "numba_lean" => ("numba", "Python"),
        "jax_scan" => ("JAX", "Python"),
        "numpy_vectorised" => ("NumPy", "Python"),
        "eigen" => ("Eigen", "C++"),
        "mujoco_inverse" => ("MuJoCo mj_inverse", "C"),
        "pinocchio_rnea" => ("Pinocchio rnea", "C++"),
        other => (other, ""),
    }
}

fn title(name: &str) -> String {
    match known(name) {
        (title, "") => title.to_owned(),
        (title, language) => format!("{title} ({language})"),
    }
}

/// The peers that do the whole of push's work, and those that do a part of it.
fn by_work(peers: &Peers) -> (Vec<&Peer>, Vec<&Peer>) {
    let push = peers.peers.iter().find(|p| p.name == PUSH);
    let whole = push.map_or("", |p| &p.computes);
    // This project's own ways side by side.
    let (ours, others): (Vec<_>, Vec<_>) =
        peers.peers.iter().partition(|p| known(&p.name).1 == OURS);
    (ours.into_iter().chain(others)).partition(|p| p.computes == whole)
}

fn peers_table(peers: &Peers) -> Table {
    let ratio = |peer: &Peer, base: &str| match peer.ratio_to.get(base) {
        None => Cell::from(""),
        Some(_) if peer.name == base => Cell::from("1"),
        Some(r) => {
            let [q1, q3] = [r.q1, r.q3].map(|q| significant(q, 3));
            Cell::from(factor(r.median)).title(format!("quartiles {q1} and {q3}"))
        }
    };
    let error = |e: Option<f64>| e.map_or(Cell::from(""), |e| Cell::of(e, |e| scientific(e, 1)));
    let name = |peer: &&Peer| title(&peer.name);
    let (whole, part) = by_work(peers);
    Table::grouped("implementation")
        .group("Nine voltages to six accelerations", whole, name)
        .group("A part of that work, the state given", part, name)
        .under("time over that of")
        .col("push", |peer| ratio(peer, PUSH))
        .col("the closed form in C++", |peer| ratio(peer, CLOSED_FORM))
        .under("")
        .quiet(("per sample", "ns"), |peer| {
            factor(peer.ns_per_sample.median)
        })
        .under("largest error / peak")
        .col("linear", |peer| error(peer.error.linear_truth))
        .col("angular", |peer| error(peer.error.angular_truth))
        .into()
}

/// A ratio or a time with the digits that are not noise.
fn factor(value: f64) -> String {
    significant(value, 2)
}

/// Tools with the number of their version.
fn versions(peers: &Peers) -> Vec<String> {
    let all = peers.versions.iter().filter_map(|(name, version)| {
        // Compilers say their own name as well, and who built them, in brackets.
        let mut words = version.as_deref()?.split(' ');
        let number = words
            .find(|word| word.starts_with(|c: char| c.is_ascii_digit()) && !word.ends_with(')'))?;
        Some(format!("{name} {number}"))
    });
    all.collect()
}

fn differences(peers: &Peers) -> Vec<Difference<'_>> {
    // Peers that are like another one name it as its file is named.
    let words = |text: &str| {
        let names = peers.peers.iter().map(|peer| &peer.name[..]);
        let long = names.filter(|name| name.contains('_') && text.contains(name));
        long.fold(text.to_owned(), |text, name| {
            text.replace(name, known(name).0)
        })
    };
    let of = |name, words| Difference {
        name: known(name).0,
        words,
    };
    let (whole, part) = by_work(peers);
    let mut all: Vec<_> = whole
        .iter()
        .map(|peer| of(&peer.name, words(&peer.differs)))
        .collect();
    all.extend(part.iter().map(|peer| {
        let (computes, differs) = (&peer.computes, words(&peer.differs));
        of(&peer.name, format!("{computes}; {differs}"))
    }));
    let not_run = peers.not_run.iter();
    all.extend(not_run.map(|(name, reason)| of(name, format!("not run, {reason}"))));
    all
}

/// Counted ways that are no scheme of push, by heading, in the order in which they are shown.
const OTHER_COUNTS: [(&str, &[(&str, &str)]); 2] = [
    (
        "Heun otherwise",
        &[
            ("push/full/heun/f32", "single precision"),
            ("record", "a record"),
            ("record/portable", "a record, portable"),
            ("lanes", "eight streams in lanes, each"),
        ],
    ),
    (
        "What else is done per sample",
        &[
            ("pose", "pose of the mass from limb lengths"),
            ("identify/scale", "identification, step 2"),
            ("identify/inertia", "identification, step 3"),
        ],
    ),
];

/// Instructions per sample of everything that is held to them.
fn instructions_table(instructions: &Instructions) -> Table {
    let of = |name: &str| instructions.per_sample.get(name).copied();
    let schemes = Scheme::ALL.into_iter().filter_map(|scheme| {
        let count = of(&format!("push/full/{}", counted_name(scheme)))?;
        Some((scheme.name(), count))
    });
    let name = |(words, _): &(&str, f64)| (*words).to_owned();
    let table = Table::grouped("what is done").group("Sample by sample", schemes, name);
    let table = OTHER_COUNTS
        .into_iter()
        .fold(table, |table, (heading, ways)| {
            let ways = ways
                .iter()
                .filter_map(|(way, words)| Some((*words, of(way)?)));
            table.group(heading, ways, name)
        });
    let base = of(COUNTED_BASE).unwrap_or(f64::NAN);
    table
        .col("count", |(_, n)| count(n.round()))
        .col("over Heun", |(_, n)| fixed(n / base, 2))
        .into()
}

/// A scheme's name among the counts.
fn counted_name(scheme: Scheme) -> &'static str {
    match scheme {
        Scheme::Euler => "euler",
        Scheme::Heun => "heun",
        Scheme::HeunSubstepped => "heun_substepped",
        Scheme::AdamsBashforth2 => "ab2",
        Scheme::AdamsMoulton4 => "am4",
        Scheme::RungeKutta4 => "rk4",
    }
}
