//! What the metadata of all segments come to.

use std::fs::File;
use std::path::Path;

use indexmap::IndexSet;

use super::chunk::Chunk;
use super::cursor::Cursor;
use super::object::Object;
use super::walk::Walk;
use crate::error::{Error, Result};

/// Chunks of one layout that follow each other.
#[derive(Debug, Clone, Copy)]
pub struct Run {
    /// Byte of the first chunk.
    pub at: u64,
    pub chunks: u64,
    /// Index of the layout.
    pub layout: u32,
}

/// Objects, and where their samples are.
#[derive(Debug, Default)]
pub struct Index {
    pub objects: Vec<Object>,
    /// All different ones.
    pub layouts: IndexSet<Chunk>,
    /// In the file's order.
    pub runs: Vec<Run>,
    /// The last segment was cut off.
    pub incomplete: bool,
}

impl Index {
    /// Walks all segments, and hands back the file with its length.
    pub fn read(path: &Path) -> Result<(Self, File, u64)> {
        let io = |source| Error::io(path, source);
        let file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let (index, file) = Walk::new(Cursor::new(path, file), length).all()?;
        Ok((index, file, length))
    }

    /// The layout of a run.
    pub fn layout(&self, run: Run) -> Option<&Chunk> {
        self.layouts.get_index(run.layout as usize)
    }

    /// The first run from number `from` on in which an object has samples, and its number.
    pub fn next_run(&self, object: u32, from: usize) -> Option<(usize, Run)> {
        let runs = self.runs.iter().copied().enumerate().skip(from);
        runs.into_iter().find(|(_, run)| {
            self.layout(*run)
                .is_some_and(|layout| layout.column(object).is_some())
        })
    }
}
