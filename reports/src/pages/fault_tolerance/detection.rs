//! Detected, isolated, named: how often, how soon.

use super::published::{Class, Counts, Curve, Detection, Kind, MAKE_DETECTION};
use sixaxis_page::number::{count, fixed, scientific, significant};
use sixaxis_page::{Axis, Block, Column, Figure, Row, Series, Table};

/// Text, figures and tables.
pub fn blocks(d: &Detection) -> Vec<Block> {
    let (single, windows): (Vec<_>, Vec<_>) = d.curves.iter().partition(|c| c.window == 1);
    vec![
        Block::Heading("Detection and isolation".to_owned()),
        Block::Text(format!(
            "A sample's rows, and mean, slope and energy of windows of 8 to 4096 samples, are held to chi-square distributions that \
             a healthy sensor's noise has exactly; thresholds come from the rate of false alarms that is asked for. Random sensors \
             in six-axis motion up to 5 Hz at {} kHz, noise 60 dB below full scale, failures injected into the voltages; sizes in \
             standard deviations σ of a sample's noise; {} false alarm an hour; seeds from {}: {MAKE_DETECTION}.",
            fixed(d.sample_rate_hz / 1e3, 0),
            significant(d.false_alarms_per_hour, 1),
            count(d.first_seed),
        )),
        Block::FigureGrid(vec![
            operating(
                "operating-sample",
                "Operating curve of one sample",
                &single,
            ),
            operating(
                "operating-window",
                "Operating curve of a mean of 64 samples",
                &windows,
            ),
        ]),
        Block::Table(false_alarms(d)),
        Block::Table(detected(d)),
        Block::Table(classes(d)),
        Block::Text(
            "Twins, 2 and 4, 3 and 7, 6 and 8, have equal columns in the rows: any course of a failure of one explains all nine \
             channels as well as the same course in the other, under another load. What tells them apart is no force: a course \
             that goes along with one channel's signal, a channel that keeps still, roughness or a step where motion is smooth. \
             A drift has none of these, and the answer is the pair, but for the few that are taken for another kind."
                .to_owned(),
        ),
        Block::Table(twins(d)),
    ]
}

fn operating(id: &str, title: &str, curves: &[&Curve]) -> Figure {
    let mut figure = Figure::new(
        id,
        title,
        Axis::log("probability of a false alarm", ""),
        Axis::linear("probability of detection", "").range(0.0, 1.02),
    );
    for (colour, curve) in curves.iter().enumerate() {
        let pairs = |values: &[f64]| -> Vec<(f64, f64)> {
            curve
                .false_alarm
                .iter()
                .copied()
                .zip(values.iter().copied())
                .collect()
        };
        figure = figure
            .series(Series::points(
                format!("{} σ", significant(curve.sigmas, 1)),
                colour,
                pairs(&curve.detected),
            ))
            .series(Series::dashed("", colour, pairs(&curve.theory)));
    }
    let (limb, draws) = curves.first().map_or((0, 0), |c| (c.limb, c.draws));
    figure.caption(format!(
        "The zero of limb {limb} moved by so much; {} draws each. Dashed: noncentral chi-square with three degrees of freedom.",
        count(draws)
    ))
}

fn false_alarms(d: &Detection) -> Table {
    let rows = d.false_alarms.iter().map(|f| {
        let asked = f.rate_per_sample * f.samples as f64;
        Row::new(
            scientific(f.rate_per_sample, 0),
            [
                format!("{} : 1", fixed(f.unequal, 0)),
                count(f.samples),
                count(f.alarms),
                fixed(f.alarms as f64 / asked, 3),
                fixed(1.0 / asked.sqrt(), 3),
            ],
        )
    });
    Table {
        caption: "False alarms counted".to_owned(),
        stub: "asked for, per sample".to_owned(),
        columns: vec![
            Column::number("noise of the channels", "largest : smallest"),
            Column::number("samples", ""),
            Column::number("alarms", ""),
            Column::number("over those asked for", ""),
            Column::number("scatter of that", "1σ"),
        ],
        rows: rows.collect(),
        footnote: "Wanted: within 10 %.".to_owned(),
        ..Table::default()
    }
}

/// A kind in words, with its size.
fn name(kind: &Kind) -> String {
    let words = match kind.kind.as_str() {
        "dead" => "dead",
        "stuck" => "stuck",
        "scale_jump" => "sensitivity jumps",
        "offset" => "zero jumps",
        "drift" => "zero drifts, in 1\u{a0}s",
        "noise_burst" => "noise, for 0.3\u{a0}s",
        "swapped" => "two channels swapped",
        other => other,
    };
    kind.sigmas.map_or(words.to_owned(), |s| {
        format!("{words}, {}\u{a0}σ", fixed(s, 0))
    })
}

fn percent(part: u64, all: u64) -> String {
    if all == 0 {
        return "–".to_owned();
    }
    fixed(100.0 * part as f64 / all as f64, 1)
}

fn detected(d: &Detection) -> Table {
    let rows = d.kinds.iter().map(|k| {
        let mut cells: Vec<String> = k
            .detected_within
            .iter()
            .map(|share| fixed(100.0 * share, 1))
            .collect();
        cells.extend([
            percent(k.isolated.right, k.isolated.all()),
            count(k.isolated.wrong),
            delay(k.isolated_after),
            percent(k.named.right, k.named.all()),
        ]);
        Row::new(name(k), cells)
    });
    let mut columns: Vec<Column> = d
        .within_samples
        .iter()
        .map(|n| Column::number(format!("seen within {}", count(*n)), "%"))
        .collect();
    columns.extend([
        Column::number("class right", "%"),
        Column::number("class wrong", "trials"),
        Column::number("class after", "samples"),
        Column::number("kind right", "%"),
    ]);
    let trials = d.kinds.first().map_or(0, |k| k.trials);
    Table {
        caption: "Failures of each kind".to_owned(),
        stub: "failure".to_owned(),
        columns,
        rows: rows.collect(),
        footnote: format!(
            "{} trials a line, each limb as often. A sensitivity's size is the rms change of the signal; a drift reaches its size \
             at the end; dead, stuck and swapped channels have the size that the motion gives them. Delays: median, and what 99 % \
             stay below.",
            count(trials)
        ),
        ..Table::default()
    }
}

fn delay([median, most]: [u64; 2]) -> String {
    format!("{} ({})", count(median), count(most))
}

fn numbers(class: &Class) -> String {
    let numbers: Vec<String> = class.limbs.iter().map(u64::to_string).collect();
    numbers.join(" or ")
}

fn classes(d: &Detection) -> Table {
    let rows = d.classes.iter().map(|c| {
        Row::new(
            numbers(c),
            [
                count(c.isolated.all()),
                fixed(
                    100.0 * c.isolated.right as f64 / c.isolated.all().max(1) as f64,
                    2,
                ),
                count(c.isolated.wrong),
                count(c.isolated.open),
                delay(c.isolated_after),
            ],
        )
    });
    Table {
        caption: format!(
            "Isolation to the classes that forces tell apart, at {} σ",
            significant(d.class_sigmas, 1)
        ),
        stub: "limb".to_owned(),
        columns: vec![
            Column::number("trials", ""),
            Column::number("right", "%"),
            Column::number("wrong", "trials"),
            Column::number("open", "trials"),
            Column::number("after", "samples"),
        ],
        rows: rows.collect(),
        footnote: "All kinds but swapped pairs. Wanted: 99 %.".to_owned(),
        ..Table::default()
    }
}

fn twins(d: &Detection) -> Table {
    let rows = d.kinds.iter().filter(|k| k.twins.all() > 0).map(|k| {
        let Counts { right, wrong, open } = k.twins;
        let all = k.twins.all();
        Row::new(
            name(k),
            [
                count(all),
                percent(right, all),
                percent(wrong, all),
                percent(open, all),
            ],
        )
    });
    Table {
        caption: "Which of two twins".to_owned(),
        stub: "failure".to_owned(),
        columns: vec![
            Column::number("trials", ""),
            Column::number("right", "%"),
            Column::number("wrong", "%"),
            Column::number("both named, open which", "%"),
        ],
        rows: rows.collect(),
        footnote: "A twin is named at odds of a thousand to one; otherwise the answer is the pair."
            .to_owned(),
        ..Table::default()
    }
}
