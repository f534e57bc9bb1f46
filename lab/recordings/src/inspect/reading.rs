//! Which channels are read side by side, and their blocks from the file to the accumulators.

use std::path::Path;

use rayon::prelude::*;
use sixaxis_core::dsp::spectrum::Welch;

use super::facts::{ChannelFacts, Group, Inspection, RateOrigin, Twins, Unreadable};
use super::notices;
use super::pairs::{Pairs, twins};
use super::sensor::{Expected, find};
use super::series::Series;
use super::spectrum::segment;
use crate::error::{Error, Result};
use crate::ingest::clock::Stamps;
use crate::ingest::columns::{BLOCK, Columns};
use crate::ingest::find::Column;
use crate::layout::Layout;
use crate::open;
use crate::session::Role;

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

/// Reads a recording once and states what is in it. Session and options, if there are any, say what its file leaves open.
///
/// `advance` is told the rows of each block and the rows of all groups together.
///
/// # Errors
/// Those of a file that cannot be opened or of which no channel can be read.
pub fn inspect(
    path: &Path,
    expected: Option<Expected>,
    advance: &mut dyn FnMut(u64, u64),
) -> Result<Inspection> {
    let source = open(path)?;
    let mut layout = source.layout().clone();
    if let Some(expected) = &expected {
        expected.complete(&mut layout);
    }
    let selections = selections(&layout);
    let length = |selection: &Vec<usize>| layout.channels[*selection.first()?].samples;
    let total = selections.iter().filter_map(length).sum();
    let mut reader = Reader {
        columns: Columns::new(path, source, Vec::new(), None, None)?,
        layout: &layout,
        expected: expected.as_ref(),
        advance: &mut |rows| advance(rows, total),
        groups: Vec::new(),
        twins: Vec::new(),
        unreadable: Vec::new(),
        failure: None,
    };
    for selection in &selections {
        reader.try_group(selection);
    }
    let groups = reader.groups;
    if let Some(failure) = reader.failure
        && groups
            .iter()
            .all(|g| g.channels.is_empty() && g.time_stamps.is_none())
    {
        return Err(failure);
    }
    let channels: Vec<_> = groups.iter().flat_map(|g| &g.channels).collect();
    // Channels of different groups are compared by their prints alone.
    let mut one_signal = reader.twins;
    for pair in twins(&channels, None) {
        if !one_signal.iter().any(|t| t.channels == pair.channels) {
            one_signal.push(pair);
        }
    }
    let sensor = find(&channels, expected.as_ref());
    let mut inspection = Inspection {
        file: path.display().to_string(),
        format: layout.format.clone(),
        properties: layout.properties.clone(),
        cut: layout.cut.clone(),
        groups,
        unreadable: reader.unreadable,
        twins: one_signal,
        sensor,
        axis_noise: Vec::new(),
        facts: Vec::new(),
    };
    inspection.facts = notices::of(&inspection, expected.as_ref());
    Ok(inspection)
}

/// Channels of one length, one rate and one start, in the file's order. The time stamps go with all groups of their length.
fn selections(layout: &Layout) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let alike = |a: usize, b: usize| {
        let (a, b) = (&layout.channels[a], &layout.channels[b]);
        a.samples == b.samples
            && a.start_offset_s == b.start_offset_s
            && a.sample_rate_hz.map(f64::to_bits) == b.sample_rate_hz.map(f64::to_bits)
    };
    for index in (0..layout.channels.len()).filter(|index| Some(*index) != layout.time) {
        match groups.iter_mut().find(|group| alike(group[0], index)) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    if groups.is_empty() && layout.time.is_some() {
        return vec![Vec::new()];
    }
    groups
        .iter()
        .flat_map(|group| group.chunks(CHANNELS).map(<[usize]>::to_vec))
        .collect()
}

struct Reader<'a> {
    columns: Columns,
    layout: &'a Layout,
    expected: Option<&'a Expected>,
    advance: &'a mut dyn FnMut(u64),
    groups: Vec<Group>,
    twins: Vec<Twins>,
    unreadable: Vec<Unreadable>,
    failure: Option<Error>,
}

impl Reader<'_> {
    /// Reads a group; if that fails, those of its channels that can be read.
    fn try_group(&mut self, selection: &[usize]) {
        let failure = match self.read(selection) {
            Ok((group, pairs)) => return self.keep(group, pairs),
            Err(failure) => failure,
        };
        let mut good = Vec::new();
        let retried = (2..=RETRIED).contains(&selection.len());
        for &index in selection {
            let cause = if retried {
                match self.read(&[index]) {
                    Ok(_) => {
                        good.push(index);
                        continue;
                    }
                    Err(cause) => cause.to_string(),
                }
            } else {
                failure.to_string()
            };
            let channel = self.layout.channels[index].name.clone();
            self.unreadable.push(Unreadable { channel, cause });
        }
        self.failure.get_or_insert(failure);
        if !good.is_empty()
            && let Ok((group, pairs)) = self.read(&good)
        {
            self.keep(group, pairs);
        }
    }

    fn keep(&mut self, group: Group, pairs: Option<Pairs>) {
        let channels: Vec<&ChannelFacts> = group.channels.iter().collect();
        self.twins.extend(twins(&channels, pairs.as_ref()));
        self.groups.push(group);
    }

    /// The time stamps, if they go with these channels.
    fn time_of(&self, selection: &[usize]) -> Option<Column> {
        let time = self.layout.time?;
        let fits = selection.first().is_none_or(|first| {
            self.layout.channels[*first].samples == self.layout.channels[time].samples
        });
        let seconds = self.layout.channels[time].seconds().filter(|_| fits)?;
        Some(Column::new(self.layout, time, seconds))
    }

    /// A group with what tells how its channels go together.
    fn read(&mut self, selection: &[usize]) -> Result<(Group, Option<Pairs>)> {
        let channels = &self.layout.channels;
        let time = self.time_of(selection);
        let rows = BLOCK.min(VALUES / (selection.len() + usize::from(time.is_some())));
        // As they are: the facts about a channel are in its own unit.
        let own = |index: &usize| Column::new(self.layout, *index, 1.0);
        self.columns
            .select(selection.iter().map(own).collect(), time, None)?;
        let mut read = self.columns.read_as_it_is(rows)?;
        let first = selection.first().map(|index| &channels[*index]);
        let by_file = first.and_then(|channel| channel.sample_rate_hz);
        let by_session = self.expected.and_then(|e| e.sample_rate_hz);
        let early = by_file
            .or(by_session)
            .or_else(|| self.columns.usual_step_s().map(|step| 1.0 / step));
        let length = first.and_then(|channel| channel.samples);
        let most = if selection.len() > FEW {
            SHORT_SEGMENT
        } else {
            usize::MAX
        };
        let welch = segment(read as u64, read < rows, length, early)
            .and_then(|segment| Welch::new(segment.min(most)).ok());
        let at_rest = self.expected.is_some_and(|e| e.role == Some(Role::Static));
        let mut series: Vec<Series> = selection
            .iter()
            .map(|&index| {
                let full_scale = self
                    .expected
                    .map_or(f64::INFINITY, |e| e.full_scale(self.layout, index));
                Series::new(welch.clone(), full_scale, at_rest)
            })
            .collect();
        let mut pairs = Pairs::new(selection.len());
        let mut samples = 0;
        while read > 0 {
            samples += read as u64;
            let columns = self.columns.columns();
            series
                .par_iter_mut()
                .zip(columns)
                .for_each(|(series, column)| series.extend(column));
            if let Some(pairs) = &mut pairs {
                pairs.add(columns);
            }
            (self.advance)(read as u64);
            read = if read < rows {
                0
            } else {
                self.columns.read_as_it_is(rows)?
            };
        }
        let mut stamps = self.columns.stamps();
        if let Some(gap) = stamps.as_mut().and_then(|s| s.first_gaps.first_mut()) {
            gap.line = self.columns.line(gap.sample);
        }
        let (rate, origin) = rate(by_file, by_session, stamps.as_ref());
        let group = Group {
            samples,
            sample_rate_hz: rate,
            sample_rate_origin: origin,
            duration_s: duration(samples, rate, stamps.as_ref()),
            time_stamps: stamps,
            channels: series
                .into_par_iter()
                .zip(selection)
                .map(|(series, &index)| series.finish(&channels[index], rate))
                .collect(),
            correlations: pairs.as_ref().map(Pairs::correlations),
        };
        Ok((group, pairs))
    }
}

/// The first usable rate: that of the file, of the session, of the time stamps.
fn rate(
    by_file: Option<f64>,
    by_session: Option<f64>,
    stamps: Option<&Stamps>,
) -> (Option<f64>, RateOrigin) {
    let stated = match by_file {
        Some(_) => (by_file, RateOrigin::File),
        None => (by_session, RateOrigin::Session),
    };
    let counted = stamps.and_then(|s| s.mean_rate_hz);
    [stated, (counted, RateOrigin::TimeStamps)]
        .into_iter()
        .find(|(rate, _)| rate.is_some_and(|rate| rate.is_finite() && rate > 0.0))
        .unwrap_or((None, RateOrigin::Unknown))
}

fn duration(samples: u64, rate: Option<f64>, stamps: Option<&Stamps>) -> Option<f64> {
    let spanned = stamps.and_then(|s| Some(s.last_s? - s.first_s? + s.mean_step_s?));
    spanned.or_else(|| rate.map(|rate| samples as f64 / rate))
}
