//! Rows of one or several arrays as blocks.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use super::header::{self, Refusal};
use super::stream::{Body, Shared, Stream};
use super::table::{Table, arrange};
use crate::channel::Channel;
use crate::error::{Error, Place, Result};
use crate::layout::Layout;
use crate::numbers::Number;
use crate::source::{Decoder, Source, reading};

/// Bytes read at once from one array.
const PIECE: usize = 1 << 18;
/// Decoders that may run side by side, 80 kB each.
const DECODERS: usize = 1024;

/// Arrays, open for reading.
struct Arrays {
    path: PathBuf,
    tables: Vec<Table>,
    /// Table and field of every channel.
    origins: Vec<(usize, usize)>,
    /// Tables whose checksum has been verified.
    verified: BTreeSet<usize>,
}

/// At this row, with so many left.
struct Position {
    runs: Vec<Run>,
    at: u64,
    left: u64,
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

/// Opens an NPY file.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`], [`Error::Io`].
pub(crate) fn open_npy(path: &Path) -> Result<Box<dyn Source>> {
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
    Ok(arrays(path, "NPY", vec![table], None, BTreeMap::new()))
}

/// Arrays as a source, with the rate of all channels; the property `name.unit` is the unit of channel `name`.
pub(super) fn arrays(
    path: &Path,
    format: &str,
    tables: Vec<Table>,
    sample_rate_hz: Option<f64>,
    properties: BTreeMap<String, String>,
) -> Box<dyn Source> {
    let (mut channels, mut origins) = (Vec::new(), Vec::new());
    for (at, table) in tables.iter().enumerate() {
        for (field, of) in table.fields.iter().enumerate() {
            channels.push(Channel {
                samples: Some(table.rows),
                sample_rate_hz,
                ..Channel::new(of.name.as_str(), None)
            });
            origins.push((at, field));
        }
    }
    let mut layout = Layout::new(format, channels, properties);
    for channel in &mut layout.channels {
        channel.unit = layout.properties.remove(&format!("{}.unit", channel.name));
    }
    let arrays = Arrays {
        path: path.to_owned(),
        tables,
        origins,
        verified: BTreeSet::new(),
    };
    reading(path, layout, arrays)
}

impl Arrays {
    /// Checks the sums of arrays that will not be read from end to end, once.
    fn verify(&mut self, selected: &[usize]) -> Result<()> {
        for &channel in selected {
            let (at, _) = self.origins[channel];
            let table = &self.tables[at];
            if !table.fortran || table.body.crc.is_none() || self.verified.contains(&at) {
                continue;
            }
            let mut stream = table.body.open();
            let checked = stream.skip(table.body.bytes).and_then(|()| stream.finish());
            checked.map_err(|source| self.failed(at, Place::Whole, source))?;
            self.verified.insert(at);
        }
        Ok(())
    }

    fn failed(&self, table: usize, place: Place, source: io::Error) -> Error {
        failed(
            &self.path,
            self.tables[table].member.as_deref(),
            place,
            source,
        )
    }

    /// The next `count` rows of a run, of which the first has number `at`.
    fn advance(
        &self,
        run: &mut Run,
        columns: &mut [Vec<f64>],
        at: u64,
        count: usize,
    ) -> Result<()> {
        let rows_at_once = (PIECE / run.record.max(1)).max(1);
        let mut piece = vec![0; rows_at_once.min(count) * run.record];
        let mut done = 0;
        while done < count {
            let rows = rows_at_once.min(count - done);
            let begin = at + done as u64;
            let bytes = piece.get_mut(..rows * run.record).unwrap_or_default();
            run.stream
                .read_exact(bytes)
                .map_err(|source| self.failed(run.table, Place::Sample(begin), source))?;
            for &(column, number, offset) in &run.fields {
                // The layout was checked against the record.
                let bytes = bytes.get(offset..).unwrap_or_default();
                if let Some(row) = number.first_rounded(bytes, run.record, rows) {
                    let place = Place::Sample(begin + row as u64);
                    let cause = "a 64-bit integer that f64 cannot hold exactly; subtract an offset before saving";
                    return Err(Error::malformed(&self.path, place, cause));
                }
                number.append(bytes, run.record, rows, &mut columns[column]);
            }
            done += rows;
        }
        Ok(())
    }
}

impl Decoder for Arrays {
    type Position = Position;

    fn start(&mut self, _layout: &Layout, selected: &[usize], samples: u64) -> Result<Position> {
        self.verify(selected)?;
        let mut runs: Vec<Run> = Vec::new();
        for (column, &channel) in selected.iter().enumerate() {
            let (at, field) = self.origins[channel];
            let table = &self.tables[at];
            let field = &table.fields[field];
            let io = |source| self.failed(at, Place::Whole, source);
            // Rows are read once for all their channels; columns one after the other in the file each for itself.
            let known = runs.iter_mut().find(|run| run.whole && run.table == at);
            if let Some(run) = known {
                run.fields
                    .push((column, field.number, field.offset as usize));
                continue;
            }
            let (stream, offset) = if table.fortran {
                let begin = table.begin.saturating_add(field.offset);
                (table.body.open_at(begin).map_err(io)?, 0)
            } else {
                let mut stream = table.body.open();
                stream.skip(table.begin).map_err(io)?;
                (stream, field.offset as usize)
            };
            runs.push(Run {
                table: at,
                whole: !table.fortran,
                stream,
                record: table.record,
                fields: vec![(column, field.number, offset)],
            });
            let deflated = |run: &&Run| self.tables[run.table].body.deflated;
            if runs.iter().filter(deflated).count() > DECODERS {
                return Err(Error::unsupported(
                    &self.path,
                    format!("reading more than {DECODERS} compressed arrays at once"),
                    "select fewer channels, or save with numpy.savez",
                ));
            }
        }
        Ok(Position {
            runs,
            at: 0,
            left: samples,
        })
    }

    fn next(
        &mut self,
        position: &mut Position,
        _layout: &Layout,
        columns: &mut [Vec<f64>],
        limit: usize,
    ) -> Result<usize> {
        let count = usize::try_from(position.left).map_or(limit, |left| left.min(limit));
        for run in &mut position.runs {
            self.advance(run, columns, position.at, count)?;
        }
        position.at += count as u64;
        position.left -= count as u64;
        if position.left == 0 && count > 0 {
            for run in position.runs.iter_mut().filter(|run| run.whole) {
                let checked = run.stream.finish();
                checked.map_err(|source| self.failed(run.table, Place::Whole, source))?;
            }
        }
        Ok(count)
    }
}
