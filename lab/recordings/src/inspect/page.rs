//! Recordings as a page: each channel's history and spectrum, and what is noticed.

use sixaxis_page::number::{MISSING, count, significant, with_unit};
use sixaxis_page::{Axis, Block, Cell, Figure, Page, Section, State, Table, Tile};

use super::allan::Coefficient;
use super::facts::{ChannelFacts, Group, Inspection, NUMBERS, Severity};
use super::listing;
use crate::printable::line;

/// Channels drawn of a file; the others are in the table.
const DRAWN: usize = 64;
/// Gaps marked in a history.
const GAPS: usize = 5;
/// Characters of a name in a title.
const NAME: usize = 48;

/// Lays out the page.
pub fn page(inspections: &[&Inspection]) -> Page {
    let facts = vec![("sixaxis".to_owned(), env!("CARGO_PKG_VERSION").to_owned())];
    if let [one] = inspections {
        let mut section = Section::new("file-1", "What is noticed", "");
        section.blocks = blocks(one, 1);
        return Page {
            title: format!("Recording {}", text(name_of(&one.file), NAME)),
            subtitle: text(&one.format, 256),
            facts,
            tiles: tiles(one),
            sections: vec![section],
        };
    }
    let sections = inspections.iter().enumerate().map(|(k, inspection)| {
        let title = text(name_of(&inspection.file), NAME);
        let lead = format!("{}.", text(&inspection.format, 256));
        let mut section = Section::new(format!("file-{}", k + 1), title, lead);
        section.blocks = blocks(inspection, k + 1);
        section
    });
    Page {
        title: format!("{} recordings", inspections.len()),
        subtitle: "What is in each: channels, clock, noise, spectrum, and what is noticed."
            .to_owned(),
        facts,
        tiles: Vec::new(),
        sections: sections.collect(),
    }
}

/// A text from a file: no control characters, and no marks of this page's.
fn text(words: &str, most: usize) -> String {
    line(words, most)
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

/// A unit from a file, as pages write it.
fn unit_text(unit: &str) -> String {
    text(unit, NAME).replace("^2", "²")
}

fn name_of(file: &str) -> &str {
    file.rsplit(['/', '\\']).next().unwrap_or(file)
}

fn tiles(one: &Inspection) -> Vec<Tile> {
    let tile =
        |label: &str, value: String, note: &str| Tile::new(label, value, note, State::Neutral);
    let channels: usize = one.groups.iter().map(|g| g.channels.len()).sum();
    let channels = count(channels as u64);
    let mut tiles = vec![tile("channels", channels, "without time stamps")];
    if let [group] = one.groups.as_slice() {
        tiles.push(tile("samples of each", count(group.samples), ""));
        tiles.push(match group.sample_rate_hz {
            Some(rate) => {
                let origin = group.sample_rate_origin.words();
                tile("sample rate", with_unit(rate, 5, "Hz"), origin)
            }
            None => Tile::new("sample rate", "unknown", "nothing tells it", State::Warn),
        });
        if let Some(duration) = group.duration_s {
            tiles.push(tile("duration", with_unit(duration, 4, "s"), ""));
        }
    }
    tiles.push(match one.told(Severity::Noticed).count() {
        0 => Tile::new("noticed", "nothing", "", State::Good),
        some => tile("noticed", count(some as u64), "see below"),
    });
    tiles
}

/// The blocks of the `k`-th file.
fn blocks(inspection: &Inspection, k: usize) -> Vec<Block> {
    let list = |severity| {
        let facts = inspection.told(severity);
        facts.fold(String::new(), |all, fact| {
            format!("{all}- {}\n", text(&fact.text, 1024))
        })
    };
    let (noticed, remarks) = (list(Severity::Noticed), list(Severity::Remark));
    let mut blocks = vec![Block::Text(if noticed.is_empty() {
        "Nothing noticed.".to_owned()
    } else {
        noticed
    })];
    if !remarks.is_empty() {
        let heading = Block::Heading("To be known".to_owned());
        blocks.extend([heading, Block::Text(remarks)]);
    }
    let mut left = DRAWN;
    for (g, group) in inspection.groups.iter().enumerate() {
        blocks.push(Block::Table(numbers(inspection, group)));
        blocks.extend(at_rest(group).map(Block::Table));
        let drawn = &group.channels[..group.channels.len().min(left)];
        left -= drawn.len();
        let id = |kind: &str, n: usize| format!("{kind}-{k}-{}-{}", g + 1, n + 1);
        let (mut histories, mut spectra) = (Vec::new(), Vec::new());
        for (n, channel) in drawn.iter().enumerate() {
            if channel.finite() > 0 {
                histories.push(history(&id("history", n), channel, group));
            }
            spectra.extend(spectrum(&id("spectrum", n), channel, group));
        }
        let stabilities = drawn.iter().enumerate();
        let stabilities: Vec<Figure> = stabilities
            .filter_map(|(n, channel)| stability(&id("allan", n), channel))
            .collect();
        for (heading, figures) in [
            ("Time histories", histories),
            ("Spectra", spectra),
            ("Allan deviation", stabilities),
        ] {
            if !figures.is_empty() {
                let heading = Block::Heading(heading.to_owned());
                blocks.extend([heading, Block::FigureGrid(figures)]);
            }
        }
    }
    if !inspection.axis_noise.is_empty() {
        blocks.push(Block::Table(
            Table::of("axis", &inspection.axis_noise, |noise| {
                noise.axis.to_owned()
            })
            .col("root density", |noise| significant(noise.noise_density, 4))
            .text("unit", |noise| noise.unit)
            .caption("Noise of the accelerations at rest, one-sided")
            .into(),
        ));
    }
    let all: usize = inspection.groups.iter().map(|g| g.channels.len()).sum();
    if all > DRAWN {
        blocks.push(Block::Note(format!(
            "{DRAWN} of {all} channels are drawn; the table has all."
        )));
    }
    blocks
}

/// The numbers of a group's channels, and the highest line of each spectrum.
fn numbers(inspection: &Inspection, group: &Group) -> Table {
    let number = |value: Option<f64>, digits| {
        Cell::or_dash(value.map(|x| Cell::of(x, |x| significant(x, digits))))
    };
    let noticed = |channel: &&ChannelFacts| {
        let mut facts = inspection.told(Severity::Noticed);
        match facts.any(|fact| fact.channels.contains(&channel.name)) {
            true => Cell::from("see above").state(State::Warn),
            false => Cell::from(MISSING),
        }
    };
    let mut table =
        Table::of("channel", &group.channels, |c| text(&c.name, NAME)).text("unit", |c| {
            match listing::unit(c).as_str() {
                "-" => Cell::from(MISSING),
                unit => Cell::from(unit_text(unit)),
            }
        });
    for (label, digits, value) in NUMBERS {
        table = table.col(label, |c| number(value(c), digits));
    }
    let peak = match group.sample_rate_hz {
        Some(_) => ("peak at", "Hz"),
        None => ("peak at", "1/sample"),
    };
    table
        .col(("flat", "samples"), |c| {
            let ends = [&c.flat_bottom, &c.flat_top].into_iter().flatten();
            count(ends.map(|top| top.samples).sum::<u64>())
        })
        .col(("not finite", "samples"), |c| {
            count(c.not_a_number + c.infinite)
        })
        .col(peak, |c| number(c.dominant.map(|line| line.frequency), 4))
        .col("its amplitude", |c| {
            number(c.dominant.map(|line| line.amplitude), 3)
        })
        .text("noticed", noticed)
        .caption(listing::heading(group))
        .footnote(
            "Each row in the channel's own unit; one with a question mark is not understood by the other commands. Noise: \
             standard deviation of the white noise, from third differences. Density: the same as a one-sided root density, per \
             root hertz. Step: smallest difference of two samples. Bits: \
             what the range needs in such steps, where all samples stand on a grid of them. Drift: mean of the last tenth \
             less mean of the first. Peak: highest line of the spectrum, if one stands out.",
        )
        .into()
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
        Axis::linear("value", unit_text(channel.unit_name())),
    )
    .line("", 0, points.collect::<Vec<_>>());
    for top in [&channel.flat_bottom, &channel.flat_top]
        .into_iter()
        .flatten()
    {
        let first_s = channel.start_offset_s + top.first_sample as f64 * step;
        figure = figure
            .horizontal(top.value, "flat")
            .vertical(first_s, "first flat");
    }
    if let Some(first) = channel.first_not_finite {
        let first_s = channel.start_offset_s + first as f64 * step;
        figure = figure.vertical(first_s, "first not finite");
    }
    // Samples after a gap stand where the count of samples puts them, not where the clock does.
    if let Some(stamps) = &group.time_stamps {
        for gap in stamps.first_gaps.iter().take(GAPS) {
            figure = figure.vertical(gap.sample as f64 * step, "gap");
        }
    }
    figure
}

/// What the Allan deviation tells of the channels at rest.
fn at_rest(group: &Group) -> Option<Table> {
    let at_rest: Vec<_> = group
        .channels
        .iter()
        .filter_map(|channel| Some((channel, channel.stability.as_ref()?)))
        .collect();
    let coefficient = |found: Option<Coefficient>, why: Option<&String>| match found {
        Some(c) => Cell::from(format!(
            "{} ± {}",
            significant(c.value, 4),
            significant(c.standard_error, 2)
        )),
        None => Cell::from(MISSING).title(why.cloned().unwrap_or_default()),
    };
    if at_rest.is_empty() {
        return None;
    }
    let table = Table::of("channel", at_rest, |(c, _)| text(&c.name, NAME))
        .text("unit", |(c, _)| unit_text(&listing::unit(c)))
        .col(("noise density", "per √Hz"), |(_, s)| {
            coefficient(s.noise_density, s.absent.get("noise_density"))
        })
        .col("bias instability", |(_, s)| {
            let value = s.bias_instability.map(|(value, _)| value);
            coefficient(value, s.absent.get("bias_instability"))
        })
        .col(("at", "s"), |(_, s)| {
            Cell::or_dash(s.bias_instability.map(|(_, at_s)| significant(at_s, 4)))
        })
        .col(("random walk", "per √s"), |(_, s)| {
            coefficient(s.random_walk, s.absent.get("random_walk"))
        })
        .caption("At rest")
        .footnote(
            "From the Allan deviation, ± one standard deviation. Bias instability: lowest deviation over 0.664, at this averaging time. \
             A dash: the record does not tell it; why stands behind the pointer, and in the listing.",
        );
    Some(table.into())
}

/// Allan deviation over averaging time, with the share of white noise where it is known.
fn stability(id: &str, channel: &ChannelFacts) -> Option<Figure> {
    let found = channel.stability.as_ref()?;
    let points = found.deviations.iter();
    let points: Vec<_> = points.map(|d| (d.averaging_s, d.deviation)).collect();
    if points.iter().all(|(_, deviation)| *deviation <= 0.0) {
        return None;
    }
    let mut figure = Figure::new(
        id,
        text(&channel.name, NAME),
        Axis::log("averaging time", "s"),
        Axis::log("Allan deviation", unit_text(channel.unit_name())),
    );
    if let Some(density) = found.noise_density {
        let white = points
            .iter()
            .map(|(tau, _)| (*tau, density.value / (2.0 * tau).sqrt()));
        figure = figure.dashed("white noise", 1, white.collect::<Vec<_>>());
    }
    Some(figure.line_points("record", 0, points))
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
        (unit, true) if unit.contains(['/', '*', ' ']) => format!("({})/√Hz", unit_text(unit)),
        (unit, true) => format!("{}/√Hz", unit_text(unit)),
        (unit, false) => format!("{}·√sample", unit_text(unit)),
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
    .line("", 0, points);
    for line in &channel.mains {
        figure = figure.vertical(line.frequency, format!("{:.0} Hz", line.frequency));
    }
    Some(figure)
}
