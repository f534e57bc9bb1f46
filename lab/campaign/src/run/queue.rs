//! Which case comes next, and which parts are being filled.

use core::ops::Range;
use std::collections::BTreeMap;

use crate::row::Row;

/// One case to be done.
#[derive(Debug, Clone, Copy)]
pub(super) struct Task {
    /// The case.
    pub seed: u64,
    /// First seed of its part.
    part: u64,
}

/// A part that is not full yet.
#[derive(Debug)]
struct Filling {
    rows: Vec<Option<Row>>,
    missing: usize,
}

/// Cases in the order of their seeds.
#[derive(Debug)]
pub(super) struct Queue {
    parts: std::vec::IntoIter<Range<u64>>,
    current: Range<u64>,
    first_of_current: u64,
    filling: BTreeMap<u64, Filling>,
    failed: u64,
    closed: bool,
}

impl Queue {
    pub fn new(parts: Vec<Range<u64>>) -> Self {
        Self {
            parts: parts.into_iter(),
            current: 0..0,
            first_of_current: 0,
            filling: BTreeMap::new(),
            failed: 0,
            closed: false,
        }
    }

    /// The next case; none if there is none, or after [`Self::close`].
    pub fn take(&mut self) -> Option<Task> {
        if self.closed {
            return None;
        }
        if self.current.is_empty() {
            self.current = self.parts.next()?;
            self.first_of_current = self.current.start;
            let cases = (self.current.end - self.current.start) as usize;
            self.filling.insert(
                self.first_of_current,
                Filling {
                    rows: vec![None; cases],
                    missing: cases,
                },
            );
        }
        let seed = self.current.next()?;
        Some(Task {
            seed,
            part: self.first_of_current,
        })
    }

    /// Enters a case that is done; returns its part's rows once they are all there.
    pub fn done(&mut self, task: Task, row: Row, failed: bool) -> Option<Vec<Row>> {
        self.failed += u64::from(failed);
        let filling = self.filling.get_mut(&task.part)?;
        let place = filling.rows.get_mut((task.seed - task.part) as usize)?;
        if place.replace(row).is_none() {
            filling.missing -= 1;
        }
        if filling.missing > 0 {
            return None;
        }
        self.filling
            .remove(&task.part)
            .map(|filling| filling.rows.into_iter().flatten().collect())
    }

    /// Cases without parameters so far.
    pub const fn failed(&self) -> u64 {
        self.failed
    }

    /// Gives out no more.
    pub const fn close(&mut self) {
        self.closed = true;
    }
}
