//! Rows of one or several arrays as blocks.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use super::header::{self, Refusal};
use super::stream::{Body, Shared, Stream};
use super::table::{Table, arrange};
use crate::channel::{Block, Channel, Layout};
use crate::error::{Error, Place, Result};
use crate::numbers::Number;
use crate::source::Source;

/// Bytes read at once from one array.
const PIECE: usize = 1 << 18;
/// Decoders that may run side by side, 80 kB each.
const DECODERS: usize = 1024;

/// Arrays, open for reading.
pub struct NumpySource {
    path: PathBuf,
    layout: Layout,
    tables: Vec<Table>,
    /// Table and field of every channel.
    origins: Vec<(usize, usize)>,
    selected: Vec<usize>,
    /// Tables whose checksum has been verified.
    verified: BTreeSet<usize>,
    state: State,
}

enum State {
    /// Nothing read since the selection.
    Fresh,
    /// At this row, with so many left.
    Reading { runs: Vec<Run>, at: u64, left: u64 },
    /// An array could not be read; the others are out of step.
    Failed,
}

/// Bytes of equal rows that one or several of the selected channels are in.
struct Run {
    table: usize,
    /// Whether the stream ends with the last row.
    whole: bool,
    stream: Stream,
    record: usize,
    /// Column of the block, type, and bytes from the beginning of the row.
    fields: Vec<(usize, Number, usize)>,
}

/// Opens a file for sharing.
///
/// # Errors
/// [`Error::Io`].
pub fn share(path: &Path) -> Result<(Shared, u64)> {
    let file = File::open(path).map_err(|source| Error::io(path, source))?;
    let length = file
        .metadata()
        .map_err(|source| Error::io(path, source))?
        .len();
    Ok((Arc::new(Mutex::new(file)), length))
}

/// An input error, or that the bytes are not what they should be.
pub fn failed(path: &Path, member: Option<&str>, place: Place, source: io::Error) -> Error {
    use io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
    if !matches!(source.kind(), InvalidData | InvalidInput | UnexpectedEof) {
        return Error::io(path, source);
    }
    let cause = match member {
        Some(name) => format!("member {name}: {source}"),
        None => source.to_string(),
    };
    Error::malformed(path, place, cause)
}

impl NumpySource {
    /// Opens an NPY file.
    ///
    /// # Errors
    /// [`Error::Malformed`], [`Error::Unsupported`], [`Error::Io`].
    pub fn open_npy(path: &Path) -> Result<Self> {
        let (file, length) = share(path)?;
        let body = Body {
            file,
            begin: 0,
            packed: length,
            bytes: length,
            deflated: false,
            crc: None,
        };
        let header = header::read(&mut body.open(), length).map_err(|refusal| match refusal {
            Refusal::Io(source) => failed(path, None, Place::Whole, source),
            Refusal::Malformed(cause) => Error::malformed(path, Place::Whole, cause),
            Refusal::Unsupported(feature) => {
                Error::unsupported(path, feature, "save real numbers, as floats or integers")
            }
        })?;
        let table = arrange(&header, body, None)
            .map_err(|(feature, advice)| Error::unsupported(path, feature, advice))?;
        Ok(Self::new(path, "NPY".to_owned(), vec![table]))
    }

    /// From arrays; names and lengths are theirs.
    pub fn new(path: &Path, format: String, tables: Vec<Table>) -> Self {
        let mut layout = Layout {
            format,
            ..Layout::default()
        };
        let mut origins = Vec::new();
        for (at, table) in tables.iter().enumerate() {
            for (field, of) in table.fields.iter().enumerate() {
                let mut channel = Channel::new(of.name.as_str(), None);
                channel.samples = Some(table.rows);
                layout.channels.push(channel);
                origins.push((at, field));
            }
        }
        crate::channel::make_unique(&mut layout.channels);
        layout.time = crate::channel::time_channel(&layout.channels);
        Self {
            path: path.to_owned(),
            selected: (0..origins.len()).collect(),
            layout,
            tables,
            origins,
            verified: BTreeSet::new(),
            state: State::Fresh,
        }
    }

    /// For what the arrays do not say of themselves.
    pub fn layout_mut(&mut self) -> &mut Layout {
        &mut self.layout
    }

    fn origin(&self, channel: usize) -> Option<(usize, &Table, usize)> {
        let &(table, field) = self.origins.get(channel)?;
        Some((table, self.tables.get(table)?, field))
    }

    /// Checks the sums of arrays that will not be read from end to end, once.
    fn verify(&mut self) -> Result<()> {
        for channel in self.selected.clone() {
            let Some((at, table, _)) = self.origin(channel) else {
                continue;
            };
            if !table.fortran || table.body.crc.is_none() || self.verified.contains(&at) {
                continue;
            }
            let mut stream = table.body.open();
            let checked = stream.skip(table.body.bytes).and_then(|()| stream.finish());
            let member = table.member.as_deref();
            checked.map_err(|source| failed(&self.path, member, Place::Whole, source))?;
            self.verified.insert(at);
        }
        Ok(())
    }

    fn start(&mut self) -> Result<(Vec<Run>, u64)> {
        let rows = self.layout.common_length(&self.path, &self.selected)?;
        self.verify()?;
        let mut runs: Vec<Run> = Vec::new();
        for (column, &channel) in self.selected.iter().enumerate() {
            let Some((at, table, field)) = self.origin(channel) else {
                continue;
            };
            let Some(field) = table.fields.get(field) else {
                continue;
            };
            let io = |source| failed(&self.path, table.member.as_deref(), Place::Whole, source);
            if table.fortran {
                let begin = table.begin.saturating_add(field.offset);
                runs.push(Run {
                    table: at,
                    whole: false,
                    stream: table.body.open_at(begin).map_err(io)?,
                    record: table.record,
                    fields: vec![(column, field.number, 0)],
                });
                continue;
            }
            let part = (column, field.number, field.offset as usize);
            if let Some(run) = runs.iter_mut().find(|run| run.table == at) {
                run.fields.push(part);
            } else {
                let mut stream = table.body.open();
                stream.skip(table.begin).map_err(io)?;
                runs.push(Run {
                    table: at,
                    whole: true,
                    stream,
                    record: table.record,
                    fields: vec![part],
                });
            }
            let deflated = |run: &&Run| self.tables.get(run.table).is_some_and(|t| t.body.deflated);
            if runs.iter().filter(deflated).count() > DECODERS {
                return Err(Error::unsupported(
                    &self.path,
                    format!("reading more than {DECODERS} compressed arrays at once"),
                    "select fewer channels, or save with numpy.savez",
                ));
            }
        }
        Ok((runs, rows))
    }

    fn advance(&self, run: &mut Run, block: &mut Block, at: u64, count: usize) -> Result<()> {
        let member = self.tables.get(run.table).and_then(|t| t.member.as_deref());
        let rows_at_once = (PIECE / run.record.max(1)).max(1);
        let mut piece = vec![0; rows_at_once.min(count) * run.record];
        let mut done = 0;
        while done < count {
            let rows = rows_at_once.min(count - done);
            let begin = at + done as u64;
            let bytes = piece.get_mut(..rows * run.record).unwrap_or_default();
            run.stream
                .read_exact(bytes)
                .map_err(|source| failed(&self.path, member, Place::Sample(begin), source))?;
            for (column, number, offset) in &run.fields {
                let Some(column) = block.columns.get_mut(*column) else {
                    continue;
                };
                // The layout was checked against the record.
                let bytes = bytes.get(*offset..).unwrap_or_default();
                if let Some(row) = number.first_rounded(bytes, run.record, rows) {
                    let place = Place::Sample(begin + row as u64);
                    let cause = "a 64-bit integer that f64 cannot hold exactly; subtract an offset before saving";
                    return Err(Error::malformed(&self.path, place, cause));
                }
                number.append(bytes, run.record, rows, column);
            }
            done += rows;
        }
        Ok(())
    }
}

impl Source for NumpySource {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn select(&mut self, channels: &[usize]) -> Result<()> {
        self.layout.common_length(&self.path, channels)?;
        self.selected = channels.to_vec();
        self.state = State::Fresh;
        Ok(())
    }

    fn read(&mut self, block: &mut Block, limit: usize) -> Result<usize> {
        block.clear(self.selected.len());
        let (mut runs, at, left) = match std::mem::replace(&mut self.state, State::Failed) {
            State::Fresh => {
                let (runs, rows) = self.start()?;
                (runs, 0, rows)
            }
            State::Reading { runs, at, left } => (runs, at, left),
            State::Failed => {
                let cause =
                    "an earlier sample could not be read; select the channels again to start anew";
                return Err(Error::malformed(&self.path, Place::Whole, cause));
            }
        };
        let count = usize::try_from(left).unwrap_or(usize::MAX).min(limit);
        for run in &mut runs {
            self.advance(run, block, at, count)?;
        }
        let (at, left) = (at + count as u64, left - count as u64);
        if left == 0 && count > 0 {
            for run in runs.iter_mut().filter(|run| run.whole) {
                let member = self.tables.get(run.table).and_then(|t| t.member.as_deref());
                run.stream
                    .finish()
                    .map_err(|source| failed(&self.path, member, Place::Whole, source))?;
            }
        }
        self.state = State::Reading { runs, at, left };
        Ok(count)
    }
}
