//! Recordings as a page: each channel's history and spectrum, and what is noticed.

use sixaxis_page::number::{count, significant, with_unit};
use sixaxis_page::{
    Axis, Block, Cell, Column, Figure, Mark, Page, Row, Section, Series, State, Table, Tile,
};

use super::facts::{ChannelFacts, Group, Inspection, NUMBERS, Severity};
use super::listing::{self, printable};

/// Channels drawn of a file; the others are in the table.
const DRAWN: usize = 64;
/// Gaps marked in a history.
const GAPS: usize = 5;
/// Characters of a name in a title.
const NAME: usize = 48;

/// Lays out the page.
#[must_use]
pub fn page(inspections: &[&Inspection]) -> Page {
    let one = match inspections {
        [one] => Some(*one),
        _ => None,
    };
    let mut sections = Vec::new();
    for (k, inspection) in inspections.iter().enumerate() {
        sections.push(of_file(inspection, k + 1, one.is_some()));
    }
    Page {
        title: match one {
            Some(one) => format!("Recording {}", text(name_of(&one.file), NAME)),
            None => format!("{} recordings", inspections.len()),
        },
        subtitle: match one {
            Some(one) => text(&one.format, 256),
            None => {
                "What is in each: channels, clock, noise, spectrum, and what is noticed.".to_owned()
            }
        },
        facts: vec![("sixaxis".to_owned(), env!("CARGO_PKG_VERSION").to_owned())],
        tiles: one.map_or_else(Vec::new, tiles),
        sections,
    }
}

/// A text from a file: no control characters, and no marks of this page's.
fn text(words: &str, most: usize) -> String {
    printable(words, most)
        .chars()
        .map(|c| match c {
            '`' => '\'',
            '$' => '＄',
            '*' => '∗',
            other => other,
        })
        .collect::<String>()
        .replace("_{", "_ {")
        .replace("^{", "^ {")
}

fn name_of(file: &str) -> &str {
    file.rsplit(['/', '\\']).next().unwrap_or(file)
}

fn tiles(one: &Inspection) -> Vec<Tile> {
    let channels: usize = one.groups.iter().map(|g| g.channels.len()).sum();
    let mut tiles = vec![Tile::new(
        "channels",
        count(channels as u64),
        "without time stamps",
        State::Neutral,
    )];
    if let [group] = one.groups.as_slice() {
        tiles.push(Tile::new(
            "samples of each",
            count(group.samples),
            "",
            State::Neutral,
        ));
        tiles.push(match group.sample_rate_hz {
            Some(rate) => Tile::new(
                "sample rate",
                with_unit(rate, 5, "Hz"),
                group.sample_rate_origin.words(),
                State::Neutral,
            ),
            None => Tile::new("sample rate", "unknown", "nothing tells it", State::Warn),
        });
        if let Some(duration) = group.duration_s {
            tiles.push(Tile::new(
                "duration",
                with_unit(duration, 4, "s"),
                "",
                State::Neutral,
            ));
        }
    }
    tiles.push(match one.told(Severity::Noticed).count() {
        0 => Tile::new("noticed", "nothing", "", State::Good),
        some => Tile::new("noticed", count(some as u64), "see below", State::Neutral),
    });
    tiles
}

fn of_file(inspection: &Inspection, k: usize, alone: bool) -> Section {
    let mut first = Section::new(
        format!("file-{k}"),
        if alone {
            "What is noticed".to_owned()
        } else {
            text(name_of(&inspection.file), NAME)
        },
        // Alone, it stands under the headline.
        if alone {
            String::new()
        } else {
            format!("{}.", text(&inspection.format, 256))
        },
    );
    let list = |severity| {
        let facts = inspection.told(severity);
        facts.fold(String::new(), |all, fact| {
            format!("{all}- {}\n", text(&fact.text, 1024))
        })
    };
    let (noticed, remarks) = (list(Severity::Noticed), list(Severity::Remark));
    first = first.block(Block::Text(if noticed.is_empty() {
        "Nothing noticed.".to_owned()
    } else {
        noticed
    }));
    if !remarks.is_empty() {
        first = first
            .block(Block::Heading("To be known".to_owned()))
            .block(Block::Text(remarks));
    }
    let mut left = DRAWN;
    for (g, group) in inspection.groups.iter().enumerate() {
        first = first.block(Block::Table(numbers(inspection, group)));
        let drawn = &group.channels[..group.channels.len().min(left)];
        left -= drawn.len();
        if drawn.is_empty() {
            continue;
        }
        let id = format!("{k}-{}", g + 1);
        let histories: Vec<Figure> = drawn
            .iter()
            .enumerate()
            .filter(|(_, c)| c.finite() > 0)
            .map(|(n, c)| history(&format!("history-{id}-{}", n + 1), c, group))
            .collect();
        if !histories.is_empty() {
            first = first
                .block(Block::Heading("Time histories".to_owned()))
                .block(Block::FigureGrid(histories));
        }
        let spectra: Vec<Figure> = drawn
            .iter()
            .enumerate()
            .filter_map(|(n, c)| spectrum(&format!("spectrum-{id}-{}", n + 1), c, group))
            .collect();
        if !spectra.is_empty() {
            first = first
                .block(Block::Heading("Spectra".to_owned()))
                .block(Block::FigureGrid(spectra));
        }
    }
    let all: usize = inspection.groups.iter().map(|g| g.channels.len()).sum();
    if all > DRAWN {
        first = first.block(Block::Note(format!(
            "{DRAWN} of {all} channels are drawn; the table has all."
        )));
    }
    first
}

/// A number, in full as its tooltip.
fn number(value: Option<f64>, digits: usize) -> Cell {
    match value {
        Some(x) => Cell::from(significant(x, digits)).title(x.to_string()),
        None => Cell::from("—"),
    }
}

/// The numbers of a group's channels, and the highest line of each spectrum.
fn numbers(inspection: &Inspection, group: &Group) -> Table {
    let hertz = match group.sample_rate_hz {
        Some(_) => "Hz",
        None => "1/sample",
    };
    let mut columns = vec![Column::text("unit")];
    columns.extend(NUMBERS.map(|(label, ..)| Column::number(label, "")));
    columns.extend([
        Column::number("flat", "samples"),
        Column::number("not finite", "samples"),
        Column::number("peak at", hertz),
        Column::number("its amplitude", ""),
        Column::text("noticed"),
    ]);
    let rows = group.channels.iter().map(|channel| {
        let mut concerned = inspection.told(Severity::Noticed);
        let noticed = if concerned.any(|fact| fact.channels.contains(&channel.name)) {
            Cell::from("see above").state(State::Warn)
        } else {
            Cell::from("—")
        };
        let flat = [&channel.flat_bottom, &channel.flat_top];
        let flat: u64 = flat.into_iter().flatten().map(|top| top.samples).sum();
        let mut cells = vec![match listing::unit(channel).as_str() {
            "-" => Cell::from("—"),
            unit => Cell::from(text(unit, NAME)),
        }];
        cells.extend(NUMBERS.map(|(_, digits, value)| number(value(channel), digits)));
        cells.extend([
            Cell::from(count(flat)),
            Cell::from(count(channel.not_a_number + channel.infinite)),
            number(channel.dominant.map(|line| line.frequency), 4),
            number(channel.dominant.map(|line| line.amplitude), 3),
            noticed,
        ]);
        Row::new(text(&channel.name, NAME), cells)
    });
    Table {
        caption: listing::heading(group),
        stub: "channel".to_owned(),
        columns,
        rows: rows.collect(),
        footnote: "Each row in the channel's own unit; one with a question mark is not understood by the other commands. Noise: \
                   standard deviation of the white noise, from third differences. Step: smallest difference of two samples. \
                   Bits: what the range needs in such steps, where all samples stand on a grid of them. Drift: mean of the last \
                   tenth less mean of the first. Peak: highest line of the spectrum, if one stands out."
            .to_owned(),
        ..Table::default()
    }
}

/// Smallest and largest sample of each bin: a long record shows as a band that no peak is missing from.
fn history(id: &str, channel: &ChannelFacts, group: &Group) -> Figure {
    let (step, label, unit) = match group.step_s() {
        Some(step) => (step, "time", "s"),
        None => (1.0, "sample", ""),
    };
    let points = channel.history.points().into_iter();
    let points = points.map(|(row, value)| (channel.start_offset_s + row * step, value));
    let mut figure = Figure::new(
        id,
        text(&channel.name, NAME),
        Axis::linear(label, unit),
        Axis::linear("value", text(channel.unit_name(), NAME)),
    )
    .series(Series::line("", 0, points.collect::<Vec<_>>()));
    for top in [&channel.flat_bottom, &channel.flat_top]
        .into_iter()
        .flatten()
    {
        figure = figure.mark(Mark::horizontal(top.value, "flat"));
    }
    // Samples after a gap stand where the count of samples puts them, not where the clock does.
    if let Some(stamps) = &group.time_stamps {
        for gap in stamps.first_gaps.iter().take(GAPS) {
            figure = figure.mark(Mark::vertical(gap.sample as f64 * step, "gap"));
        }
    }
    figure
}

/// Root of the density, so that the ordinate is in the channel's unit.
fn spectrum(id: &str, channel: &ChannelFacts, group: &Group) -> Option<Figure> {
    let spectrum = channel.spectrum.as_ref()?;
    if channel.constant || spectrum.densities.is_empty() {
        return None;
    }
    let points: Vec<(f64, f64)> = spectrum
        .densities
        .iter()
        .enumerate()
        .skip(1)
        .map(|(k, density)| (k as f64 * spectrum.line_distance, density.sqrt()))
        .collect();
    let hertz = group.sample_rate_hz.is_some();
    let unit = match (channel.unit_name(), hertz) {
        ("", true) => "1/√Hz".to_owned(),
        ("", false) => String::new(),
        (unit, true) if unit.contains(['/', '*', ' ']) => format!("({})/√Hz", text(unit, NAME)),
        (unit, true) => format!("{}/√Hz", text(unit, NAME)),
        (unit, false) => format!("{}·√sample", text(unit, NAME)),
    };
    let mut figure = Figure::new(
        id,
        text(&channel.name, NAME),
        if hertz {
            Axis::log("frequency", "Hz")
        } else {
            Axis::log("frequency", "1/sample")
        },
        Axis::log("root density", unit),
    )
    .series(Series::line("", 0, points));
    for line in &channel.mains {
        figure = figure.mark(Mark::vertical(
            line.frequency,
            format!("{:.0} Hz", line.frequency),
        ));
    }
    Some(figure)
}
