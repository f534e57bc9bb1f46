//! What is remembered of a recording that is to be smoothed: far less than its samples, and few covariances.

use alloc::vec::Vec;

use super::aid::Measurement;
use super::block::Block;
use super::filter::ErrorFilter;
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
}

/// A block that has gone by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passed {
    pub(super) block: Block,
    /// Its last sample, with the corrections that were made there.
    pub(super) corrected: SixAxis,
}

/// Blocks, what happened after each, and the filter from time to time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct History {
    /// Before the first block of each segment.
    pub(super) filters: Vec<ErrorFilter>,
    pub(super) blocks: Vec<Passed>,
    /// With the number of the block, in order.
    pub(super) events: Vec<(usize, Event)>,
}

impl History {
    pub(super) fn new(filter: &ErrorFilter) -> Self {
        Self {
            filters: [filter.clone()].into(),
            blocks: Vec::new(),
            events: Vec::new(),
        }
    }

    pub(super) fn happened(&mut self, event: Event) {
        self.events.push((self.blocks.len(), event));
    }

    /// Nothing more happens after this block; the filter is carried over the next one from here.
    pub(super) fn pass(&mut self, block: Block, corrected: SixAxis, filter: &ErrorFilter) {
        self.blocks.push(Passed { block, corrected });
        if self.blocks.len().is_multiple_of(SEGMENT) {
            self.filters.push(filter.clone());
        }
    }
}
