//! Failures detected, isolated to a class, and named by kind: how often, how soon.

use sixaxis_page::figure::paired;
use sixaxis_page::number::{count, fixed, scientific, significant};
use sixaxis_page::{Axis, Figure, Table, Text};
use sixaxis_props::faults::Name;
use sixaxis_props::results::{Curve, Detection, FaultTally, OfClass};

/// Values, figures and tables.
pub fn fill(text: Text, d: &Detection) -> Text {
    let (single, windows): (Vec<_>, Vec<_>) = d.curves.iter().partition(|c| c.window == 1);
    let (limb, draws) = single.first().map_or((0, 0), |c| (c.limb, c.draws));
    let caption = format!(
        "The zero of limb {limb} moved by so much; {} draws each. Dashed: noncentral chi-square with three degrees of freedom.",
        count(draws)
    );
    text.value("detection", d)
        .value("operating_caption", caption)
        .figure(operating("operating-sample", &single))
        .figure(operating("operating-window", &windows))
        .table("false-alarms", false_alarms(d))
        .table("detected", detected(d))
        .table("classes", classes(d))
        .table("ambiguous-pairs", ambiguous_pairs(d))
}

fn operating(id: &str, curves: &[&Curve]) -> Figure {
    let figure = Figure::new(
        id,
        "",
        Axis::log("probability of a false alarm", ""),
        Axis::linear("probability of detection", "").range(0.0, 1.02),
    );
    curves
        .iter()
        .enumerate()
        .fold(figure, |figure, (colour, curve)| {
            let label = format!("{} σ", significant(curve.sigmas, 1));
            let over = |values: &[f64]| paired(&curve.false_alarm, values);
            figure.points(label, colour, over(&curve.detected)).dashed(
                "",
                colour,
                over(&curve.theory),
            )
        })
}

fn false_alarms(d: &Detection) -> Table {
    Table::of("asked for, per sample", &d.false_alarms, |f| {
        scientific(f.rate_per_sample, 0)
    })
    .col(("noise of the channels", "largest : smallest"), |f| {
        format!("{} : 1", fixed(f.unequal, 0))
    })
    .col("samples", |f| count(f.samples))
    .col("alarms", |f| count(f.alarms))
    .col("over those asked for", |f| {
        fixed(f.alarms as f64 / (f.rate_per_sample * f.samples as f64), 3)
    })
    .col(("scatter of that", "1σ"), |f| {
        fixed(1.0 / (f.rate_per_sample * f.samples as f64).sqrt(), 3)
    })
    .into()
}

/// A kind in words, with its size.
fn name(kind: &FaultTally) -> String {
    let words = match kind.kind {
        Name::Dead => "dead",
        Name::Stuck => "stuck",
        Name::ScaleJump => "sensitivity jumps",
        Name::Offset => "zero jumps",
        Name::Drift => "zero drifts, in 1\u{a0}s",
        Name::NoiseBurst => "noise, for 0.3\u{a0}s",
        Name::Swapped => "two channels swapped",
    };
    kind.sigmas.map_or(words.to_owned(), |s| {
        format!("{words}, {}\u{a0}σ", fixed(s, 0))
    })
}

fn percent(part: usize, all: usize, decimals: usize) -> String {
    match all {
        0 => "–".to_owned(),
        _ => fixed(100.0 * part as f64 / all as f64, decimals),
    }
}

/// Median, and what 99 % stay below.
fn delay([median, most]: [u64; 2]) -> String {
    format!("{} ({})", count(median), count(most))
}

fn detected(d: &Detection) -> Table {
    let table = Table::of("failure", &d.kinds, |k| name(k));
    let within = d.within_samples.iter().enumerate();
    within
        .fold(table, |table, (i, samples)| {
            let head = format!("seen within {}", count(*samples));
            table.col((head, "%"), |k| fixed(100.0 * k.detected_within[i], 1))
        })
        .col(("class right", "%"), |k| {
            percent(k.isolated.right, k.isolated.all(), 1)
        })
        .col(("class wrong", "trials"), |k| count(k.isolated.wrong))
        .col(("class after", "samples"), |k| delay(k.isolated_after))
        .col(("kind right", "%"), |k| {
            percent(k.named.right, k.named.all(), 1)
        })
        .into()
}

fn classes(d: &Detection) -> Table {
    let name = |c: &&OfClass| {
        let numbers: Vec<String> = c.limbs.iter().map(usize::to_string).collect();
        numbers.join(" or ")
    };
    Table::of("limb", &d.classes, name)
        .col("trials", |c| count(c.isolated.all()))
        .col(("right", "%"), |c| {
            percent(c.isolated.right, c.isolated.all(), 2)
        })
        .col(("wrong", "trials"), |c| count(c.isolated.wrong))
        .col(("open", "trials"), |c| count(c.isolated.open))
        .col(("after", "samples"), |c| delay(c.isolated_after))
        .into()
}

fn ambiguous_pairs(d: &Detection) -> Table {
    let kinds = d.kinds.iter().filter(|k| k.twins.all() > 0);
    let share = |k: &FaultTally, part: usize| percent(part, k.twins.all(), 1);
    Table::of("failure", kinds, |k| name(k))
        .col("trials", |k| count(k.twins.all()))
        .col(("right", "%"), |k| share(k, k.twins.right))
        .col(("wrong", "%"), |k| share(k, k.twins.wrong))
        .col(("both named, open which", "%"), |k| share(k, k.twins.open))
        .into()
}
