//! The verdict, tried blind: healthy laboratories in several corners, and defects by their size.

use anyhow::Result;
use sixaxis_page::number::{count, fixed, significant};
use sixaxis_page::{Axis, Cell, Figure, Section, Table, Text};
use sixaxis_props::blind::share::Share;
use sixaxis_props::blind::{Cell as Corner, cause_of};
use sixaxis_props::results::{Blind, BlindBin, BlindKind, BlindPairs, BlindTally, Published};
use sixaxis_reference::laboratory::room::Room;

/// Shares that one mark stands for: from, its words, its place in the palette.
const SHARES: [(f64, &str, usize); 4] = [
    (0.9, "90 to 100 %", 2),
    (0.5, "50 to 90 %", 0),
    (0.1, "10 to 50 %", 1),
    (0.0, "below 10 %", 3),
];

/// The section.
///
/// # Errors
/// If the published result cannot be read or the text does not fit it.
pub fn section() -> Result<Section> {
    let p = &Blind::embedded()?;
    let pairs = &BlindPairs::embedded()?;
    let good = by_size(p, "blind-good", |tally| tally.good, 0.0);
    let false_good = by_size(
        p,
        "blind-false-good",
        |tally| tally.false_good,
        f64::MIN_POSITIVE,
    );
    // A magnitude decides between words, not whether there is one.
    let unnamed = p.kinds.iter().filter(|k| cause_of(k.kind, 1.0).is_none());
    Text::new(include_str!("blind.md"))
        .value("p", p)
        .value("pairs", pairs)
        .value("alike", pairs.same_cause_of_named())
        .value("could_show", p.false_good_of_good_that_could_show())
        .value("kinds", p.kinds.len())
        .value("unnamed", unnamed.count())
        .value("false_good_of_good", p.false_good_of_good.value())
        .figure(good)
        .figure(false_good)
        .table("blind-healthy", healthy(p))
        .table("blind-kinds", kinds(p))
        .section("blind")
}

/// A mark for each kind and size whose share is at least this, in the colour of its share.
fn by_size(p: &Blind, id: &str, share: fn(&BlindTally) -> Share, least: f64) -> Figure {
    let names = p.kinds.iter().map(words);
    let figure = Figure::new(
        id,
        "",
        Axis::linear("size: seventh of the range", "").range(0.5, 7.5),
        Axis::names("", names),
    );
    let mut above = f64::INFINITY;
    SHARES
        .into_iter()
        .fold(figure, |figure, (from, label, colour)| {
            let below = core::mem::replace(&mut above, from);
            let points = p.kinds.iter().enumerate().flat_map(|(row, kind)| {
                kind.bins.iter().enumerate().filter_map(move |(bin, b)| {
                    let value = share(&b.tally).value();
                    let here = value >= from.max(least) && value < below;
                    here.then_some(((bin + 1) as f64, row as f64))
                })
            });
            figure.points(label, colour, points.collect::<Vec<_>>())
        })
}

fn words(kind: &BlindKind) -> String {
    kind.kind.name().replace('_', " ")
}

fn cell_words(cell: Corner) -> String {
    match cell {
        Corner::Corner => "the corner".to_owned(),
        Corner::WedgeDeg(deg) => format!("wedges {deg}°"),
        Corner::StiffnessSpread(spread) => {
            format!("stiffness {} %", significant(100.0 * spread, 1))
        }
        Corner::LevelAxis => "axis level".to_owned(),
        Corner::SignalToNoiseDb(db) => format!("{db} dB"),
        Corner::RodMass(share) => format!("limbs' mass {} %", significant(200.0 * share, 1)),
        Corner::Room(Room::Gentle) => "gentle room".to_owned(),
        Corner::Room(Room::Usual) => "usual room".to_owned(),
        Corner::Defect(kind) => kind.name().replace('_', " "),
    }
}

fn healthy(p: &Blind) -> Table {
    // A kind and its size stay in one line.
    Table::of("laboratory", &p.healthy, |row| {
        cell_words(row.cell).replace(' ', "\u{a0}")
    })
    .col("sessions", |row| count(row.tally.sessions))
    .col(("good", "%, 95 %"), |row| range(row.tally.good))
    .col(("with reservations", "%, 95 %"), |row| {
        range(row.tally.reserved)
    })
    .col(("not good or refused", "%, 95 %"), |row| {
        let [bad, refused] = [row.tally.not_good, row.tally.refused];
        range(Share::new(bad.count + refused.count, bad.of))
    })
    .col(("wrong cause", "%, 95 %"), |row| {
        range(row.tally.wrong_cause)
    })
    .col(("false good", "%, 95 %"), |row| range(row.tally.false_good))
    .col(("s/m, I/m off by", "%"), |row| {
        percent(row.tally.median_parameter_error)
    })
    .col(("decoupled to", "%, of 95 %"), |row| {
        Cell::or_dash(row.tally.beyond_gain_95.map(|errors| {
            let [linear, angular] = errors.map(|error| significant(100.0 * error, 2));
            format!("{linear}, {angular}")
        }))
    })
    .into()
}

fn kinds(p: &Blind) -> Table {
    let sum = |kind: &BlindKind, of: fn(&BlindTally) -> Share| {
        let counts = kind.bins.iter().map(|bin| of(&bin.tally).count);
        count(counts.sum::<usize>())
    };
    let half_good = |kind: &BlindKind| {
        let mut good = kind.bins.iter().filter(|bin| bin.tally.good.value() >= 0.5);
        good.next_back()
            .map(|bin: &BlindBin| significant(bin.to, 2))
    };
    Table::of("defect", &p.kinds, |kind| words(kind))
        .text("unit", |kind| kind.unit.clone())
        .col(("range", "from"), |kind| {
            significant(kind.bins.first().map_or(f64::NAN, |bin| bin.from), 2)
        })
        .col(("range", "to"), |kind| {
            significant(kind.bins.last().map_or(f64::NAN, |bin| bin.to), 2)
        })
        .col("sessions", |kind| {
            count(
                kind.bins
                    .iter()
                    .map(|bin| bin.tally.sessions)
                    .sum::<usize>(),
            )
        })
        .col("good up to", move |kind| Cell::or_dash(half_good(kind)))
        .col("false good", move |kind| {
            sum(kind, |tally| tally.false_good)
        })
        .col(("cause", "right"), move |kind| {
            sum(kind, |tally| tally.right_cause)
        })
        .col(("cause", "none"), move |kind| {
            sum(kind, |tally| tally.no_cause)
        })
        .col(("cause", "wrong"), move |kind| {
            sum(kind, |tally| tally.wrong_cause)
        })
        .into()
}

/// A share with its interval, per cent.
fn range(share: Share) -> String {
    format!(
        "{} ({}–{})",
        fixed(100.0 * share.value(), 0),
        fixed(100.0 * share.low_95, 0),
        fixed(100.0 * share.high_95, 0)
    )
}

fn percent(share: Option<f64>) -> Cell {
    Cell::or_dash(share.map(|share| significant(100.0 * share, 2)))
}
