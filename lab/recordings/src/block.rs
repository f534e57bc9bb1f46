//! Samples as they go from a file to whoever computes with them.

/// Consecutive samples of the selected channels: one column per channel, all of one length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Block {
    /// Columns in the order of the selection.
    pub columns: Vec<Vec<f64>>,
}

impl Block {
    /// An empty block for so many channels.
    pub fn new(channels: usize) -> Self {
        Self {
            columns: vec![Vec::new(); channels],
        }
    }

    /// Rows in it.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Empties it for so many channels, keeping the memory.
    pub fn clear(&mut self, channels: usize) {
        self.columns.resize_with(channels, Vec::new);
        for column in &mut self.columns {
            column.clear();
        }
    }
}
