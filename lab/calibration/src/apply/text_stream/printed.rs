//! Rows of answers as comma-separated text on standard output.

use std::io::{self, Write};

use anyhow::Result;
use sixaxis_recordings::{Block, Channel, Layout, Sink};

/// Writes the headings of a table and flushes.
///
/// # Errors
/// Those of the output.
pub(super) fn write_headings(output: &mut dyn Write, layout: &Layout) -> io::Result<()> {
    let headings: Vec<String> = layout.channels.iter().map(Channel::heading).collect();
    writeln!(output, "{}", headings.join(","))?;
    output.flush()
}

/// Writes the rows of a block, each flushed by itself where there is one only.
///
/// # Errors
/// Those of the output.
pub(super) fn write_rows(output: &mut dyn Write, block: &Block) -> io::Result<()> {
    use std::fmt::Write as _;
    let rows = block.rows();
    let mut text = String::new();
    for row in 0..rows {
        for (index, column) in block.columns.iter().enumerate() {
            if index > 0 {
                text.push(',');
            }
            // The shortest digits that read back the same, with a power of ten where zeros would be many.
            let _ = write!(text, "{:?}", column[row]);
        }
        text.push('\n');
    }
    if rows > 0 {
        output.write_all(text.as_bytes())?;
        output.flush()?;
    }
    Ok(())
}

/// Standard output as a sink: rows of comma-separated values.
pub struct Printed<W: Write + Send> {
    output: W,
}

impl<W: Write + Send> Printed<W> {
    /// Writes the headings.
    ///
    /// # Errors
    /// Those of the output.
    pub fn create(mut output: W, layout: &Layout) -> Result<Self> {
        write_headings(&mut output, layout)?;
        Ok(Self { output })
    }
}

impl<W: Write + Send> Sink for Printed<W> {
    fn write(&mut self, block: &Block) -> sixaxis_recordings::Result<()> {
        write_rows(&mut self.output, block)
            .map_err(|source| sixaxis_recordings::Error::io("standard output".as_ref(), source))
    }

    fn finish(mut self: Box<Self>) -> sixaxis_recordings::Result<()> {
        self.output
            .flush()
            .map_err(|source| sixaxis_recordings::Error::io("standard output".as_ref(), source))
    }
}

/// Whether an error says that nobody reads the output any more.
pub fn is_closed_pipe(error: &anyhow::Error) -> bool {
    let broken = |e: &io::Error| e.kind() == io::ErrorKind::BrokenPipe;
    match error.downcast_ref::<sixaxis_recordings::Error>() {
        Some(sixaxis_recordings::Error::Io { source, .. }) => broken(source),
        _ => error.downcast_ref::<io::Error>().is_some_and(broken),
    }
}
