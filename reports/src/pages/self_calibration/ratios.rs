//! How far ratios are off, by length of the recording, and whether the intervals hold it.

use super::published::{Length, Pace, Published};
use sixaxis_page::number::{count, fixed, scientific};
use sixaxis_page::{Axis, Block, Column, Figure, Mark, Row, Series, Table};

/// What 95 % intervals are wanted to hold, %.
const BAND: (f64, f64) = (94.0, 96.0);

/// Text, figures and table.
pub fn blocks(p: &Published) -> Vec<Block> {
    vec![
        Block::Heading("How well, and does it know?".to_owned()),
        Block::FigureGrid(vec![errors(p), coverage(p)]),
        Block::Table(table(p)),
    ]
}

fn errors(p: &Published) -> Figure {
    let series = |pace: Pace, of: fn(&Length) -> f64| {
        p.lengths
            .iter()
            .filter(move |l| l.pace == pace)
            .map(move |l| (l.duration_s, 100.0 * of(l)))
            .collect::<Vec<_>>()
    };
    let figure = Figure::new(
        "self-calibration-errors",
        "Error of a scale ratio",
        Axis::log("length of the recording", "s"),
        Axis::log("error", "%"),
    )
    .series(Series::line_points(
        "largest, brisk",
        3,
        series(Pace::Brisk, |l| l.largest_error),
    ))
    .series(Series::line_points(
        "rms, brisk",
        0,
        series(Pace::Brisk, |l| l.rms_error),
    ))
    .series(Series::dashed(
        "median of the stated deviation, brisk",
        1,
        series(Pace::Brisk, |l| l.median_deviation),
    ))
    .series(Series::points(
        "rms, calm",
        2,
        series(Pace::Calm, |l| l.rms_error),
    ))
    .mark(Mark::horizontal(100.0 * p.bar, "bar"))
    .caption(
        "Each ratio to the mean of the nine. Brisk: three sines of 2 to 6 rad/s at 0.3 to 3 Hz about each axis; calm: 0.7 to \
         2 rad/s; shaken: 6 to 18 rad/s. Longer records have fewer draws, see below: the largest error is one of fewer.",
    );
    let shaken = series(Pace::Shaken, |l| l.rms_error);
    if shaken.is_empty() {
        figure
    } else {
        figure.series(Series::points("rms, shaken", 4, shaken))
    }
}

fn coverage(p: &Published) -> Figure {
    let longest = p.lengths.iter().max_by_key(|l| l.draws);
    let points = longest.map(|l| {
        l.coverage_95_by_limb
            .iter()
            .enumerate()
            .map(|(i, share)| (100.0 * share, i as f64))
            .collect::<Vec<_>>()
    });
    let (draws, duration_s) = longest.map_or((0, 0.0), |l| (l.draws, l.duration_s));
    Figure::new(
        "self-calibration-coverage",
        "Truths within the stated 95 % intervals",
        Axis::linear("share of records", "%"),
        Axis::names("limb", (1..=9).map(|limb| limb.to_string())),
    )
    .series(Series::points("ratio", 0, points.unwrap_or_default()))
    .mark(Mark::vertical(BAND.0, "94"))
    .mark(Mark::vertical(BAND.1, "96"))
    .caption(format!(
        "{} records of {duration_s} s. A share scatters by {} %.",
        count(draws),
        fixed(100.0 * (0.95 * 0.05 / draws.max(1) as f64).sqrt(), 1),
    ))
}

fn table(p: &Published) -> Table {
    let rows = p.lengths.iter().map(|l| {
        Row::new(
            format!("{}, {} s", l.pace.word(), l.duration_s),
            [
                count(l.draws),
                count(l.refused),
                scientific(l.rms_error, 2),
                scientific(l.largest_error, 2),
                fixed(100.0 * l.share_within_bar, 1),
                fixed(100.0 * l.draws_within_bar, 1),
                fixed(100.0 * l.coverage_95, 1),
            ],
        )
    });
    Table {
        caption: "ln of scale factors over the calibration's".to_owned(),
        stub: "tumble".to_owned(),
        columns: vec![
            Column::number("records", ""),
            Column::number("refused", "too poor"),
            Column::number("rms error", ""),
            Column::number("largest", "error"),
            Column::number("limbs in bar", "%"),
            Column::number("records in bar", "%"),
            Column::number("coverage of 95 %", "%"),
        ],
        rows: rows.collect(),
        footnote: format!(
            "Bar: {} % from 60 s. A record is in the bar if all nine limbs are. Twins (2 and 4, 3 and 7, 6 and 8) differ by \
             torques alone, a tenth and less of a force by hand: they make the error, and angular acceleration the motion that \
             mends it.",
            100.0 * p.bar
        ),
        ..Table::default()
    }
}
