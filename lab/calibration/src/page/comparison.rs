//! Decoupled motions as a page: by themselves, or beside the truth.

use crate::apply::curves::{Band, Curves};
use crate::compare::measure::{Axis as Measured, Comparison, Quantity, to_a_millionth};
use sixaxis_page::figure::NEUTRAL;
use sixaxis_page::number::{MISSING, count, significant};
use sixaxis_page::{Axis, Block, Cell, Figure, Page, Section, State, Table, Tile};
use sixaxis_recordings::envelope::Envelope;

/// Palette indices of the result and of its error.
const RESULT: usize = 0;
const ERROR: usize = 3;

const SYMBOLS: [&str; 9] = [
    "$a$_{x}", "$a$_{y}", "$a$_{z}", "$α$_{x}", "$α$_{y}", "$α$_{z}", "$ω$_{x}", "$ω$_{y}",
    "$ω$_{z}",
];

/// How a quantity is written.
struct Words {
    title: &'static str,
    /// On an axis.
    short: &'static str,
    unit: &'static str,
}

const fn words(quantity: Quantity) -> Words {
    let (title, short, unit) = match quantity {
        Quantity::Linear => ("Linear acceleration", "acceleration", "m/s²"),
        Quantity::Angular => ("Angular acceleration", "angular acceleration", "rad/s²"),
        Quantity::Rate => ("Angular rate", "rate", "rad/s"),
    };
    Words { title, short, unit }
}

/// A figure of one axis, without its curves.
fn figure(index: usize, quantity: Quantity) -> Figure {
    let words = words(quantity);
    Figure::new(
        format!("axis-{index}"),
        format!("{}, {}", words.title, ["x", "y", "z"][index % 3]),
        Axis::linear("time", "s"),
        Axis::linear(words.short, words.unit),
    )
}

/// The page of a comparison.
pub fn page(comparison: &Comparison) -> Page {
    let instants = comparison.instants + comparison.unknown_instants;
    let duration_s = (instants.saturating_sub(1)) as f64 / comparison.rate_hz;
    Page {
        title: "Decoupled motion against the truth".to_owned(),
        subtitle: format!(
            "{} held against {}: {} common instants{} over {} s.",
            name_of(&comparison.result),
            name_of(&comparison.truth),
            count(comparison.instants),
            comparison.left_out(count),
            significant(duration_s, 4)
        ),
        facts: vec![
            ("sixaxis".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("result".to_owned(), comparison.result.clone()),
            ("truth".to_owned(), comparison.truth.clone()),
            (
                "common instants per second".to_owned(),
                to_a_millionth(comparison.rate_hz).to_string(),
            ),
            (
                "first common instant".to_owned(),
                format!("{} s", to_a_millionth(comparison.start_s)),
            ),
        ],
        tiles: tiles(comparison),
        sections: vec![errors(comparison), curves(comparison)],
    }
}

/// File name without its folders, marks of inline text taken out.
fn name_of(path: &str) -> String {
    let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
    name.to_owned()
}

fn tiles(comparison: &Comparison) -> Vec<Tile> {
    let worst = |quantity: Quantity| {
        comparison
            .axes
            .iter()
            .zip(SYMBOLS)
            .filter(|(axis, _)| axis.quantity == quantity)
            .filter_map(|(axis, symbol)| Some((axis, symbol, axis.largest_error_percent?)))
            .max_by(|a, b| a.2.total_cmp(&b.2))
    };
    let mut tiles: Vec<Tile> = Quantity::ALL
        .into_iter()
        .filter_map(|quantity| {
            let (axis, symbol, percent) = worst(quantity)?;
            Some(Tile::new(
                words(quantity).title,
                format!("{} %", significant(percent, 3)),
                format!(
                    "largest error over that axis' peak: {symbol} is {}\u{a0}{} off at {}\u{a0}s",
                    significant(axis.largest_error, 3),
                    words(quantity).unit,
                    significant(axis.largest_error_time_s, 3)
                ),
                State::Neutral,
            ))
        })
        .collect();
    if let Some(angle) = comparison.largest_attitude_error_deg {
        tiles.push(Tile::new(
            "Attitude",
            format!("{}°", significant(angle, 3)),
            "largest angle between the two",
            State::Neutral,
        ));
    }
    tiles
}

fn errors(comparison: &Comparison) -> Section {
    let share = |axis: &Measured, figure: f64| {
        axis.percent(figure).map_or(Cell::from(MISSING), |percent| {
            Cell::from(significant(percent, 3)).title(format!("{figure} {}", axis.unit))
        })
    };
    let in_unit = |figure: f64| Cell::from(significant(figure, 3)).title(figure.to_string());
    let table = Table::of("axis", comparison.axes.iter().zip(SYMBOLS), |(axis, symbol)| {
        format!("{symbol},\u{a0}{}", words(axis.quantity).unit)
    })
    .under("truth")
    .col(("peak", "axis' unit"), |(axis, _)| {
        Cell::from(significant(axis.peak, 5)).title(axis.peak.to_string())
    })
    .under("largest error")
    .col(("over the peak", "%"), |(a, _)| share(a, a.largest_error))
    .col(("", "axis' unit"), |(a, _)| in_unit(a.largest_error))
    .under("mean")
    .col(("", "axis' unit"), |(a, _)| in_unit(a.mean_error))
    .under("root mean square")
    .col(("", "axis' unit"), |(a, _)| in_unit(a.rms_error))
    .col(("over the peak", "%"), |(a, _)| share(a, a.rms_error))
    .under("quantiles, over the peak")
    .col(("50 %", "%"), |(a, _)| share(a, a.error_quantiles[0]))
    .col(("90 %", "%"), |(a, _)| share(a, a.error_quantiles[1]))
    .col(("99 %", "%"), |(a, _)| share(a, a.error_quantiles[2]))
    .caption("Largest, root mean square, quantiles")
    .footnote(
        "A dash stands where an axis has less than a thousandth of the peak of the largest of its three: an error over such a \
         peak says nothing.",
    );
    Section::new(
        "errors",
        "Errors, axis by axis",
        "As in the paper's Tables 4 to 6, an error is the largest difference over the whole run over that axis' peak. \
         Differences are result less truth; a quantile of 99 % is what 99 of 100 instants do not exceed.",
    )
    .block(Block::Table(table.into()))
}

fn curves(comparison: &Comparison) -> Section {
    let figures = comparison
        .axes
        .iter()
        .zip(&comparison.pictures)
        .enumerate()
        .map(|(index, (axis, picture))| {
            figure(index, axis.quantity)
                .line("truth", NEUTRAL, picture.truth.points())
                .dashed("result", RESULT, picture.result.points())
                .below(Axis::linear("error", words(axis.quantity).unit))
                .line("result less truth", ERROR, picture.error.points())
        });
    Section::new(
        "curves",
        "Curves",
        "Accelerations in ground axes, rates in the sensor's. Long runs are drawn by the smallest and the largest sample of each \
         stretch; no peak is lost.",
    )
    .block(Block::FigureGrid(figures.collect()))
}

/// The page of one decoupled recording: six accelerations over time, with one standard deviation on either side where deviations
/// were asked for, and in words how they came about.
pub fn picture(recording: &str, curves: &Curves, facts: Vec<(String, String)>) -> Page {
    let figures = curves
        .accelerations
        .iter()
        .enumerate()
        .map(|(index, curve)| {
            let quantity = Quantity::ALL[index / 3];
            let (figure, unit) = (figure(index, quantity), words(quantity).unit);
            let points = curve.points();
            let Some(bands) = &curves.bands else {
                return figure.line("", RESULT, points);
            };
            let Band { edges, deviation } = &bands[index];
            figure
                .band(
                    "± one standard deviation",
                    RESULT,
                    edges.each_ref().map(Envelope::points),
                )
                .line("acceleration", RESULT, points)
                .below(Axis::linear("one standard deviation", unit))
                .line("one standard deviation", ERROR, deviation.points())
        });
    let known = if curves.bands.is_some() {
        " The band is one standard deviation on either side, to first order: noise of the calibration and of this recording, gains of the \
         standards. Where it is narrower than the line, the deviation stands below."
    } else {
        ""
    };
    Page {
        title: "Decoupled accelerations".to_owned(),
        subtitle: format!("{}, in the axes of the ground.", name_of(recording)),
        facts,
        tiles: Vec::new(),
        sections: vec![
            Section::new(
                "curves",
                "Six accelerations",
                format!(
                    "Long recordings are drawn by the smallest and the largest sample of each stretch; no peak is lost.{known}"
                ),
            )
            .block(Block::FigureGrid(figures.collect())),
        ],
    }
}
