//! Which channels go side by side, and their blocks from the file to the accumulators.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use sixaxis_recordings::unit::{self, Unit};
use sixaxis_recordings::{Block, Layout, Source, open};

use super::clock::{Clock, Stamps};
use super::findings::{Group, Inspection, RateOrigin, Unreadable};
use super::notices;
use super::pairs::{Pairs, Prints, twins};
use super::sensor::{Expectations, Expected, find};
use super::series::Series;
use super::spectrum::{Plan, segment};
use crate::progress::Progress;

/// Rows of a block.
const ROWS: usize = 1 << 16;
/// Values of a block at most.
const VALUES: usize = 1 << 21;
/// Channels read side by side.
const CHANNELS: usize = 128;
/// Channels that may have the longest segments.
const FEW: usize = 32;
/// Longest segment of more channels.
const SHORT_SEGMENT: usize = 1 << 14;
/// Channels up to which a group that cannot be read is tried channel by channel.
const RETRIED: usize = 64;

/// Looks at a recording.
///
/// # Errors
/// [`sixaxis_recordings::Error`] for a file that cannot be opened or of which no channel can be read.
pub fn inspect(
    path: &Path,
    expectations: Option<&Expectations>,
    progress: &Progress,
) -> Result<Inspection> {
    let mut source = open(path)?;
    let mut layout = source.layout().clone();
    let expected = expectations.map(|e| e.of(path));
    if let Some(expected) = &expected {
        expected.complete(&mut layout);
    }
    let mut reader = Reader {
        source: source.as_mut(),
        layout: &layout,
        expected: expected.as_ref(),
        progress,
        prints: Vec::new(),
        unreadable: Vec::new(),
        failure: None,
    };
    let mut groups = Vec::new();
    let mut found_twins = Vec::new();
    for selection in selections(&layout) {
        reader.try_group(&selection, &mut groups, &mut found_twins);
    }
    let Reader {
        prints,
        unreadable,
        failure,
        ..
    } = reader;
    if let Some(failure) = failure
        && groups
            .iter()
            .all(|g| g.channels.is_empty() && g.time_stamps.is_none())
    {
        return Err(failure);
    }
    // What other groups hold can only be told by its prints.
    let names: Vec<&str> = prints.iter().map(|p| p.1.as_str()).collect();
    let all: Vec<Prints> = prints.iter().map(|p| p.2).collect();
    for pair in twins(&names, &all, None) {
        if !found_twins
            .iter()
            .any(|t: &super::pairs::Twins| t.channels == pair.channels)
        {
            found_twins.push(pair);
        }
    }
    let channels: Vec<&super::findings::ChannelFacts> =
        groups.iter().flat_map(|g| &g.channels).collect();
    let sensor = find(&channels, expected.as_ref());
    let mut inspection = Inspection {
        file: path.display().to_string(),
        format: layout.format.clone(),
        properties: layout.properties.clone(),
        groups,
        unreadable,
        twins: found_twins,
        sensor,
        noticed: Vec::new(),
        remarks: Vec::new(),
    };
    notices::add(&mut inspection, expected.as_ref());
    Ok(inspection)
}

/// Channels that go side by side, in the file's order, without the time stamps, which go with all of their length.
fn selections(layout: &Layout) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let alike = |a: usize, b: usize| {
        let (a, b) = (&layout.channels[a], &layout.channels[b]);
        a.samples == b.samples
            && a.sample_rate_hz.map(f64::to_bits) == b.sample_rate_hz.map(f64::to_bits)
    };
    for index in (0..layout.channels.len()).filter(|index| Some(*index) != layout.time) {
        match groups.iter_mut().find(|group| alike(group[0], index)) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    if groups.is_empty() && layout.time.is_some() {
        groups.push(Vec::new());
    }
    groups
        .iter()
        .flat_map(|group| {
            if group.is_empty() {
                vec![Vec::new()]
            } else {
                group.chunks(CHANNELS).map(<[usize]>::to_vec).collect()
            }
        })
        .collect()
}

struct Reader<'a> {
    source: &'a mut dyn Source,
    layout: &'a Layout,
    expected: Option<&'a Expected>,
    progress: &'a Progress,
    /// Index, name and prints of every channel.
    prints: Vec<(usize, String, Prints)>,
    unreadable: Vec<Unreadable>,
    failure: Option<anyhow::Error>,
}

/// A group that has been read, and how it can be told from others.
struct Read {
    group: Group,
    prints: Vec<(usize, String, Prints)>,
    pairs: Option<Pairs>,
}

impl Reader<'_> {
    /// Reads a group; if that fails, those of its channels that can be read.
    fn try_group(
        &mut self,
        selection: &[usize],
        groups: &mut Vec<Group>,
        found: &mut Vec<super::pairs::Twins>,
    ) {
        let failure = match self.read(selection) {
            Ok(read) => return self.keep(read, groups, found),
            Err(failure) => failure,
        };
        let mut good = Vec::new();
        if (2..=RETRIED).contains(&selection.len()) {
            for &index in selection {
                match self.read(&[index]) {
                    Ok(_) => good.push(index),
                    Err(cause) => self.refuse(index, &cause),
                }
            }
        } else {
            for &index in selection {
                self.refuse(index, &failure);
            }
        }
        self.failure.get_or_insert(failure);
        if !good.is_empty()
            && let Ok(read) = self.read(&good)
        {
            self.keep(read, groups, found);
        }
    }

    fn refuse(&mut self, index: usize, cause: &anyhow::Error) {
        self.unreadable.push(Unreadable {
            channel: self.layout.channels[index].name.clone(),
            cause: format!("{cause:#}"),
        });
    }

    fn keep(&mut self, read: Read, groups: &mut Vec<Group>, found: &mut Vec<super::pairs::Twins>) {
        let names: Vec<&str> = read.prints.iter().map(|p| p.1.as_str()).collect();
        let prints: Vec<Prints> = read.prints.iter().map(|p| p.2).collect();
        found.extend(twins(&names, &prints, read.pairs.as_ref()));
        self.prints.extend(read.prints);
        groups.push(read.group);
    }

    /// The time stamps, if they go with these channels.
    fn time_of(&self, selection: &[usize]) -> Option<usize> {
        let time = self.layout.time?;
        let fits = selection.first().is_none_or(|first| {
            self.layout.channels[*first].samples == self.layout.channels[time].samples
        });
        fits.then_some(time)
    }

    fn read(&mut self, selection: &[usize]) -> Result<Read> {
        let time = self.time_of(selection);
        let mut all = selection.to_vec();
        all.extend(time);
        if all.is_empty() {
            bail!("there is no channel");
        }
        self.source.select(&all)?;
        let rows = ROWS.min(VALUES / all.len());
        let mut gathered = Block::new(all.len());
        let mut piece = Block::new(all.len());
        let mut complete = fill(self.source, &mut gathered, &mut piece, rows)?;
        let mut clock = time.map(|index| Clock::new(seconds(self.layout, index)));
        if let (Some(clock), Some(stamps)) = (&mut clock, gathered.columns.last()) {
            clock.extend(stamps);
        }
        let first = selection.first().map(|index| &self.layout.channels[*index]);
        let stated = first.and_then(|channel| channel.sample_rate_hz);
        let (stated, origin) = match (stated, self.expected.and_then(|e| e.sample_rate_hz)) {
            (Some(rate), _) => (Some(rate), RateOrigin::File),
            (None, Some(rate)) => (Some(rate), RateOrigin::Session),
            (None, None) => (None, RateOrigin::Unknown),
        };
        let early = stated.or_else(|| {
            clock
                .as_mut()
                .and_then(Clock::usual_step_s)
                .map(|step| 1.0 / step)
        });
        let length = first.and_then(|channel| channel.samples);
        let most = if selection.len() > FEW {
            SHORT_SEGMENT
        } else {
            usize::MAX
        };
        let plan = segment(gathered.rows() as u64, complete, length, early)
            .map(|segment| Plan::new(segment.min(most)).map(Arc::new))
            .transpose()
            .context("cannot plan the spectrum")?;
        let mut series: Vec<Series> = selection
            .iter()
            .map(|&index| {
                let full_scale = self.expected.map_or(f64::INFINITY, |e| {
                    e.full_scale(&self.layout.channels, index)
                });
                Series::new(plan.as_ref(), full_scale)
            })
            .collect();
        let mut pairs = Pairs::new(selection.len());
        let stage = length
            .filter(|length| *length > rows as u64)
            .map(|length| self.progress.stage("inspect", length));
        let mut samples = 0u64;
        loop {
            samples += gathered.rows() as u64;
            let columns = &gathered.columns[..selection.len()];
            series
                .par_iter_mut()
                .zip(columns)
                .try_for_each(|(series, column)| series.extend(column))?;
            if let Some(pairs) = &mut pairs
                && gathered.rows() > 0
            {
                pairs.add(columns);
            }
            if let Some(stage) = &stage {
                stage.advance(gathered.rows() as u64);
            }
            if complete {
                break;
            }
            complete = fill(self.source, &mut gathered, &mut piece, rows)?;
            if let (Some(clock), Some(stamps)) = (&mut clock, gathered.columns.last()) {
                clock.extend(stamps);
            }
        }
        let stamps = clock
            .zip(time)
            .map(|(clock, index)| clock.finish(&self.layout.channels[index].name));
        let (rate, origin) = rate(stated, origin, stamps.as_ref());
        let prints = selection
            .iter()
            .zip(&series)
            .map(|(&index, series)| {
                (
                    index,
                    self.layout.channels[index].name.clone(),
                    series.prints(),
                )
            })
            .collect();
        let channels = series
            .into_par_iter()
            .zip(selection)
            .map(|(series, &index)| series.finish(&self.layout.channels[index], rate))
            .collect();
        Ok(Read {
            group: Group {
                samples,
                sample_rate_hz: rate,
                sample_rate_origin: origin,
                duration_s: duration(samples, rate, stamps.as_ref()),
                time_stamps: stamps,
                channels,
                correlations: pairs.as_ref().map(Pairs::correlations),
            },
            prints,
            pairs,
        })
    }
}

/// Fills a block as far as the source goes, whatever the size of its own pieces. Returns whether it has come to its end.
fn fill(
    source: &mut dyn Source,
    gathered: &mut Block,
    piece: &mut Block,
    rows: usize,
) -> Result<bool> {
    gathered.clear(gathered.columns.len());
    while gathered.rows() < rows {
        if source.read(piece, rows - gathered.rows())? == 0 {
            return Ok(true);
        }
        for (all, some) in gathered.columns.iter_mut().zip(&piece.columns) {
            all.extend_from_slice(some);
        }
    }
    Ok(false)
}

/// Seconds per unit of the time stamps; what is not understood is taken for seconds.
fn seconds(layout: &Layout, index: usize) -> f64 {
    match layout.channels[index].unit.as_deref().and_then(unit::named) {
        Some(Unit::Time(seconds)) => seconds,
        _ => 1.0,
    }
}

fn rate(
    stated: Option<f64>,
    origin: RateOrigin,
    stamps: Option<&Stamps>,
) -> (Option<f64>, RateOrigin) {
    let usable = |rate: &f64| rate.is_finite() && *rate > 0.0;
    if let Some(rate) = stated.filter(usable) {
        return (Some(rate), origin);
    }
    let counted = stamps
        .and_then(|s| s.mean_step_s)
        .map(|step| 1.0 / step)
        .filter(usable);
    match counted {
        Some(rate) => (Some(rate), RateOrigin::TimeStamps),
        None => (None, RateOrigin::Unknown),
    }
}

fn duration(samples: u64, rate: Option<f64>, stamps: Option<&Stamps>) -> Option<f64> {
    let spanned = stamps.and_then(|s| Some(s.last_s? - s.first_s? + s.mean_step_s?));
    spanned.or_else(|| rate.map(|rate| samples as f64 / rate))
}
