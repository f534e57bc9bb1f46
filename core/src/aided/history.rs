//! What is remembered of a recording that is to be smoothed: a block's means and corrections, about half as many bytes as its samples
//! have, and few covariances.

use alloc::vec::Vec;

use super::aid::Measurement;
use super::block::Block;
use super::channels::Channels;
use super::filter::ErrorFilter;
use super::model::ErrorModel;
use crate::six_axis::SixAxis;

/// Blocks from one filter that is kept to the next: those between are carried over again.
pub(super) const SEGMENT: usize = 256;

/// What happened after a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// A measurement was offered to the filter.
    Measured(Measurement),
    /// The filter was doubted.
    Doubted,
    /// Velocities, m/s, are counted from here, with this deviation.
    Tared(f64),
}

/// A block that has gone by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passed {
    pub(super) block: Block,
    /// Its last sample, with the corrections that were made there.
    pub(super) corrected: SixAxis,
}

/// Blocks, what happened after each, and filter and channels from time to time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct History {
    /// Before the first block of each segment.
    before: Vec<(ErrorFilter, Channels)>,
    blocks: Vec<Passed>,
    /// With the number of the block, in order.
    events: Vec<(usize, Event)>,
}

/// Consecutive blocks, from filter and channels before the first of them on.
pub(super) struct Segment<'a> {
    pub(super) before: &'a (ErrorFilter, Channels),
    pub(super) first: usize,
    pub(super) blocks: &'a [Passed],
    pub(super) events: &'a [(usize, Event)],
}

impl History {
    pub(super) fn new(filter: &ErrorFilter, channels: &Channels) -> Self {
        Self {
            before: [(filter.clone(), *channels)].into(),
            blocks: Vec::new(),
            events: Vec::new(),
        }
    }

    pub(super) fn happened(&mut self, event: Event) {
        self.events.push((self.blocks.len(), event));
    }

    /// Nothing more happens after this block; filter and channels go on from here.
    pub(super) fn pass(
        &mut self,
        block: Block,
        corrected: SixAxis,
        filter: &ErrorFilter,
        channels: &Channels,
    ) {
        self.blocks.push(Passed { block, corrected });
        if self.blocks.len().is_multiple_of(SEGMENT) {
            self.before.push((filter.clone(), *channels));
        }
    }

    /// Segments with at least one block.
    pub(super) fn segments(&self) -> usize {
        self.blocks.len().div_ceil(SEGMENT)
    }

    /// One of them.
    pub(super) fn segment(&self, number: usize) -> Option<Segment<'_>> {
        let (first, end) = (number * SEGMENT, (number + 1) * SEGMENT);
        let blocks = self.blocks.get(first..end.min(self.blocks.len()))?;
        let event = |block: usize| self.events.partition_point(|(of, _)| *of < block);
        Some(Segment {
            before: self.before.get(number)?,
            first,
            blocks,
            events: self.events.get(event(first)..event(end))?,
        })
    }

    /// The model of the errors.
    pub(super) fn model(&self) -> Option<&ErrorModel> {
        self.begin().map(|(filter, _)| filter.model())
    }

    /// Filter and channels before the first block.
    pub(super) fn begin(&self) -> Option<&(ErrorFilter, Channels)> {
        self.before.first()
    }
}
