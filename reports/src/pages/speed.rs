//! Speed: what the core takes beside what else one could run, and how that grows.
//!
//! The numbers are a published [`snapshot`]'s, not this machine's: a report that timed would never be the same twice.
//! Ratios lead and nanoseconds stand behind, small: ratios are more nearly the same elsewhere.

mod figures;
mod snapshot;
#[cfg(test)]
mod tests;

use sixaxis_core::Scheme;

use self::snapshot::{Instructions, Peer, Peers, Snapshot, Speed, Spread};
use sixaxis_page::number::{count, fixed, scientific, significant};
use sixaxis_page::{Block, Cell, Column, HeadCell, Row, Section, Table};

const ID: &str = "speed";
const TITLE: &str = "Speed: the core beside what else one could run";
/// What ratios are taken to, by its name among the peers and among the instruction counts.
const PUSH: &str = "push";
const EIGEN: &str = "eigen";
/// Where one finds what is no peer but the core itself.
const OURS: &str = "this project";
const COUNTED_BASE: &str = "push/full/heun";
/// Sample rate of the lead's example, Hz: the one most of this report is at.
const EXAMPLE_RATE_HZ: f64 = 10_000.0;
/// Digits of a commit that tell it from others.
const COMMIT_DIGITS: usize = 9;

/// The section.
#[must_use]
pub fn section() -> Section {
    match Snapshot::embedded() {
        Ok(snapshot) => of(&snapshot),
        Err(e) => Section::new(ID, TITLE, "").block(Block::Note(format!(
            "The measurements cannot be read: {e}. {PUBLISH}"
        ))),
    }
}

const PUBLISH: &str = "`benches/peers/run`, then `cargo run --release -p sixaxis-benches --example speed -- --publish` \
                       measures and publishes anew.";

fn of(snapshot: &Snapshot) -> Section {
    let Snapshot {
        speed,
        peers,
        instructions,
    } = snapshot;
    let mut section = Section::new(ID, TITLE, lead(speed))
        .block(Block::Note(watermark(speed)))
        .block(Block::Heading("What else one could run".to_owned()))
        .block(Block::Table(peers_table(peers)))
        .block(Block::Text(differences(peers)));
    if let Some(instructions) = instructions {
        section = section
            .block(Block::Heading("Instructions".to_owned()))
            .block(Block::Table(instructions_table(instructions)));
    }
    section
        .block(Block::Heading("Work and precision".to_owned()))
        .block(Block::Text(figures::work_precision_text(
            &speed.work_precision,
        )))
        .block(figures::work_precision(&speed.work_precision))
        .block(Block::Heading("Longer records, more streams".to_owned()))
        .block(Block::Text(figures::scaling_text(
            &speed.length,
            &speed.streams,
        )))
        .block(figures::scaling(&speed.length, &speed.streams))
}

/// What the default scheme takes at the rate most of this report is at.
fn lead(speed: &Speed) -> String {
    let curves = speed.work_precision.curves.iter();
    let mut points = curves
        .filter(|curve| curve.scheme == Scheme::default())
        .flat_map(|curve| &curve.points);
    let Some(p) = points.find(|p| p.sample_rate_hz == EXAMPLE_RATE_HZ) else {
        return String::new();
    };
    let ms = |spread: Spread| significant(1e3 * spread.median, 2);
    format!(
        "A second of signal at 10 kHz takes one core {} ms sample by sample and {} ms as a record: it could follow about {} such \
         sensors, or play back about {} recordings. Nothing is timed before its answer has been checked. All times are medians \
         of interleaved rounds; ratios are more nearly the same on another machine than nanoseconds, which stand small.",
        ms(p.push_s_per_s),
        ms(p.record_s_per_s),
        significant(1.0 / p.push_s_per_s.median, 2),
        significant(1.0 / p.record_s_per_s.median, 2),
    )
}

fn watermark(speed: &Speed) -> String {
    let m = &speed.machine;
    let vectors = m.processor_has.last();
    let vectors = vectors.map_or(String::new(), |name| format!(" with {name}"));
    format!(
        "Measured on {}{vectors}, {} logical cores, {}, {} for {}, commit {}{}, {}{}; not on this machine. {PUBLISH}",
        m.cpu,
        m.logical_cores,
        m.system,
        m.rustc.split(" (").next().unwrap_or_default(),
        if m.compiled_for.is_empty() {
            "any processor of that kind".to_owned()
        } else {
            m.compiled_for.join(", ")
        },
        short(&speed.commit),
        if speed.core_changed_since_commit {
            " with changes to the core"
        } else {
            ""
        },
        day(&speed.date_utc),
        if speed.quick { ", in a hurry" } else { "" },
    )
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
        "rigid" => ("push, rigid limbs", OURS),
        "nalgebra" => ("nalgebra", "Rust"),
        EIGEN => ("Eigen", "C++"),
        "numba_plain" => ("numba", "Python"),
        "numpy_loop" => ("NumPy in a loop", "Python"),
        "numpy_vectorised" => ("NumPy vectorised", "Python"),
        "solve_ivp" => ("SciPy solve_ivp", "Python"),
        "ode_solvers_rk4" => ("ode_solvers Rk4", "Rust"),
        "ode_solvers_dopri5" => ("ode_solvers Dopri5", "Rust"),
        "mujoco_inverse" => ("MuJoCo mj_inverse", "C"),
        "mujoco_step" => ("MuJoCo mj_step", "C"),
        "pinocchio_rnea" => ("Pinocchio rnea", "C++"),
        "pinocchio_aba" => ("Pinocchio aba", "C++"),
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
        (peers.peers.iter()).partition(|p| known(&p.name).1 == OURS);
    (ours.into_iter().chain(others)).partition(|p| p.computes == whole)
}

fn peers_table(peers: &Peers) -> Table {
    let ratio = |peer: &Peer, base: &str| match peer.ratio_to.get(base) {
        None => Cell::from(""),
        Some(_) if peer.name == base => Cell::from("1"),
        Some(r) => Cell::from(factor(r.median)).title(format!(
            "quartiles {} and {}",
            significant(r.q1, 3),
            significant(r.q3, 3)
        )),
    };
    let error = |e: Option<f64>| {
        e.map_or(Cell::from(""), |e| {
            Cell::from(scientific(e, 1)).title(e.to_string())
        })
    };
    let row = |peer: &&Peer| {
        let cells = [
            ratio(peer, PUSH),
            ratio(peer, EIGEN),
            Cell::from(factor(peer.ns_per_sample.median)),
            error(peer.error.linear_truth),
            error(peer.error.angular_truth),
        ];
        Row::new(title(&peer.name), cells)
    };
    let (whole, part) = by_work(peers);
    let mut rows = vec![Row::group("Nine voltages to six accelerations")];
    rows.extend(whole.iter().map(row));
    rows.push(Row::group("A part of that work, the state given"));
    rows.extend(part.iter().map(row));
    Table {
        caption: "Time for the same record, answers checked".to_owned(),
        stub: "implementation".to_owned(),
        head: vec![vec![
            HeadCell::new("time over that of", 2),
            HeadCell::new("", 1),
            HeadCell::new("largest error / peak", 2),
        ]],
        columns: vec![
            Column::number("push", ""),
            Column::number("Eigen", ""),
            Column::number("per sample", "ns").quiet(),
            Column::number("linear", ""),
            Column::number("angular", ""),
        ],
        rows,
        footnote: peers_footnote(peers),
    }
}

/// A ratio or a time with the digits that are not noise.
fn factor(value: f64) -> String {
    significant(value, 2)
}

fn peers_footnote(peers: &Peers) -> String {
    let versions = peers.versions.iter().filter_map(|(name, version)| {
        // Compilers say their own name as well, and who built them, in brackets.
        let mut words = version.as_deref()?.split(' ');
        let number = words
            .find(|word| word.starts_with(|c: char| c.is_ascii_digit()) && !word.ends_with(')'))?;
        Some(format!("{name} {number}"))
    });
    let versions: Vec<String> = versions.collect();
    let commit = peers.commit.as_deref().map_or("unknown", short);
    format!(
        "One core for each; {} rounds{}, {}, commit {commit}{}. Errors are against MuJoCo's truth; a half that is not computed \
         has none. {}.",
        peers.rounds,
        if peers.quick { " in a hurry" } else { "" },
        day(&peers.date_utc),
        match peers.versions.get("rustflags") {
            Some(Some(flags)) if !flags.is_empty() => format!(", Rust with `{flags}`"),
            _ => String::new(),
        },
        versions.join(", "),
    )
}

/// What makes the comparison less than fair, peer by peer.
fn differences(peers: &Peers) -> String {
    // Peers that are like another one name it as its file is named.
    let words = |text: &str| {
        let names = peers.peers.iter().map(|peer| &peer.name[..]);
        let long = names.filter(|name| name.contains('_') && text.contains(name));
        long.fold(text.replace(" us ", " µs "), |text, name| {
            text.replace(name, known(name).0)
        })
    };
    let (whole, part) = by_work(peers);
    let mut text =
        "What differs, and so bears on the ratios; equation (8) is the one that is integrated:\n\n"
            .to_owned();
    for peer in whole {
        text += &format!("- **{}**: {}.\n", known(&peer.name).0, words(&peer.differs));
    }
    for peer in part {
        let (computes, differs) = (&peer.computes, words(&peer.differs));
        text += &format!("- **{}**: {computes}; {differs}.\n", known(&peer.name).0);
    }
    for (name, reason) in &peers.not_run {
        text += &format!("- **{}**: not run, {reason}.\n", known(name).0);
    }
    text + "\nOf the others, what is faster than push does less. `benches/peers/README.md` has more of what should be known."
}

/// Names of the counted ways that are no scheme of push, in the order in which they are shown.
const OTHER_COUNTS: [(&str, &str); 9] = [
    ("", "Heun otherwise"),
    ("push/full/heun/f32", "single precision"),
    ("record", "a record"),
    ("record/portable", "a record, portable"),
    ("lanes", "eight streams in lanes, each"),
    ("", "What else is done per sample"),
    ("pose", "pose of the mass from limb lengths"),
    ("identify/scale", "identification, step 2"),
    ("identify/inertia", "identification, step 3"),
];

/// Instructions per sample of everything that is held to them.
fn instructions_table(instructions: &Instructions) -> Table {
    let counts = &instructions.per_sample;
    let number = |n: Option<&f64>| n.map_or(Cell::from(""), |n| count(n.round() as u64).into());
    let base = counts.get(COUNTED_BASE);
    let over_base = |n: Option<&f64>| match (n, base) {
        (Some(n), Some(base)) => Cell::from(fixed(n / base, 2)),
        _ => Cell::from(""),
    };
    let mut rows = vec![Row::group("Sample by sample")];
    for scheme in Scheme::ALL {
        let of = |limbs: &str| counts.get(&format!("push/{limbs}/{}", counted_name(scheme)));
        let cells = [
            number(of("full")),
            over_base(of("full")),
            number(of("rigid")),
            over_base(of("rigid")),
        ];
        rows.push(Row::new(scheme.name(), cells));
    }
    for (name, words) in OTHER_COUNTS {
        let one = counts.get(name);
        if name.is_empty() {
            rows.push(Row::group(words));
        } else if one.is_some() {
            let none = || Cell::from("");
            rows.push(Row::new(
                words,
                [number(one), over_base(one), none(), none()],
            ));
        }
    }
    Table {
        caption: "Counted by callgrind, per sample".to_owned(),
        stub: "what is done".to_owned(),
        head: vec![vec![
            HeadCell::new("elastic limbs", 2),
            HeadCell::new("rigid limbs", 2),
        ]],
        columns: vec![
            Column::number("count", ""),
            Column::number("over Heun", ""),
            Column::number("count", ""),
            Column::number("over Heun", ""),
        ],
        rows,
        footnote: format!(
            "Compiled by rustc {}. Counts do not depend on what else the machine does, so every change to the core is held to \
             them. Rigid limbs neglect the motion of the mass in the shell.",
            instructions.rustc
        ),
    }
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
