//! Writing.

use std::collections::HashSet;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::object::{join_path, split_path};
use super::value::Timestamp;
use crate::began::BEGAN;
use crate::channel::Channel;
use crate::error::{Error, Result};
use crate::layout::Layout;
use crate::sink::{self, Encoder, Sink};

/// Rows in a segment, at most.
const MAX_ROWS: usize = 1 << 16;
/// Numbers in a segment, at most, where there are many channels.
const MAX_NUMBERS: usize = 1 << 20;
/// Numbers that are written at a time.
const PIECE: usize = 1 << 13;
/// Group of channels without one.
const GROUP: &str = "recording";

const VERSION: u32 = 4713;
const HAS_METADATA: u32 = 1 << 1;
const NEW_OBJECTS: u32 = 1 << 2;
const HAS_RAW_DATA: u32 = 1 << 3;
const NO_RAW_INDEX: u32 = 0xFFFF_FFFF;
const RAW_INDEX_LENGTH: u32 = 20;
const I32: u32 = 3;
const F64: u32 = 10;
const TEXT: u32 = 0x20;
const TIME: u32 = 0x44;

/// A TDMS file being written.
struct Writer {
    file: BufWriter<File>,
    layout: Layout,
    /// Group and name of each channel.
    names: Vec<[String; 2]>,
    /// Rows of the segment written last; none before the first.
    last: Option<usize>,
    /// Numbers as bytes, on their way out.
    bytes: Vec<u8>,
}

/// Starts a TDMS file, version 4713: contiguous f64 segments of at most 65,536 rows.
///
/// A channel `group/channel` is written under that group, split at the first slash; one without a group goes into
/// `recording`. Unit, sample rate and start offset become `unit_string`, `wf_increment` and `wf_start_offset`, where there are time stamps
/// the first of them for all that begin at 0 otherwise, a property
/// `wf_start_time` (as this reader gives it) that of every channel with a rate; all other properties become texts of the file.
///
/// # Errors
/// Those of [`sink::create`]; [`Error::Unsupported`] if two channels get the same name.
pub(crate) fn create(path: &Path, layout: &Layout) -> Result<Box<dyn Sink>> {
    let names: Vec<[String; 2]> = layout
        .channels
        .iter()
        .map(|channel| names(&channel.name))
        .collect();
    let mut seen = HashSet::new();
    if let Some([group, name]) = names.iter().find(|names| !seen.insert(*names)) {
        return Err(Error::unsupported(
            path,
            format!("a second channel {name:?} in group {group:?}"),
            "give the channels different names",
        ));
    }
    sink::create(path, layout, |file| {
        Ok(Writer {
            file: BufWriter::new(file),
            layout: layout.clone(),
            names,
            last: None,
            bytes: vec![0; 8 * PIECE],
        })
    })
}

impl Encoder for Writer {
    fn rows(&self) -> usize {
        (MAX_NUMBERS / self.names.len().max(1)).clamp(1, MAX_ROWS)
    }

    fn piece(&mut self, columns: &[Vec<f64>]) -> io::Result<()> {
        self.segment(columns.first().map_or(0, Vec::len), columns)
    }

    fn finish(mut self) -> io::Result<File> {
        if self.last.is_none() {
            self.segment(0, &[])?;
        }
        self.file
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
    }
}

impl Writer {
    fn segment(&mut self, rows: usize, columns: &[Vec<f64>]) -> io::Result<()> {
        let metadata = match self.last {
            // What a segment does not say holds from the one before.
            Some(last) if last == rows => Vec::new(),
            last => {
                let first = self.layout.time.and_then(|time| columns.get(time)?.first());
                self.metadata(rows, last.is_none(), first.copied().unwrap_or(0.0))?
            }
        };
        let data = rows as u64 * columns.len() as u64 * 8;
        let mut flags = 0;
        if !metadata.is_empty() {
            flags |= HAS_METADATA | NEW_OBJECTS;
        }
        if data > 0 {
            flags |= HAS_RAW_DATA;
        }
        self.file.write_all(b"TDSm")?;
        self.file.write_all(&flags.to_le_bytes())?;
        self.file.write_all(&VERSION.to_le_bytes())?;
        self.file
            .write_all(&(metadata.len() as u64 + data).to_le_bytes())?;
        self.file
            .write_all(&(metadata.len() as u64).to_le_bytes())?;
        self.file.write_all(&metadata)?;
        for values in columns.iter().flat_map(|column| column.chunks(PIECE)) {
            let bytes = &mut self.bytes[..8 * values.len()];
            for (bytes, value) in bytes.chunks_exact_mut(8).zip(values) {
                bytes.copy_from_slice(&value.to_le_bytes());
            }
            self.file.write_all(bytes)?;
        }
        self.last = Some(rows);
        Ok(())
    }

    /// All objects; their properties too, if they are new. The first row is of this time.
    fn metadata(&self, rows: usize, new: bool, first_s: f64) -> io::Result<Vec<u8>> {
        let mut objects = 0_u32;
        let mut bytes = Vec::new();
        if new {
            let texts = self.layout.properties.iter();
            let properties: Vec<Property> = texts
                .map(|(name, text)| Property::text(name, text))
                .collect::<io::Result<_>>()?;
            object(&mut bytes, &[], None, &properties)?;
            objects += 1;
            let mut groups = HashSet::new();
            for [group, _] in &self.names {
                if groups.insert(group) {
                    object(&mut bytes, &[group], None, &[])?;
                    objects += 1;
                }
            }
        }
        let start = self
            .layout
            .properties
            .get(BEGAN)
            .and_then(|text| Timestamp::parse(text));
        for ([group, name], channel) in self.names.iter().zip(&self.layout.channels) {
            let properties = if new {
                self.properties(channel, rows, start, first_s)?
            } else {
                Vec::new()
            };
            object(&mut bytes, &[group, name], Some(rows), &properties)?;
            objects += 1;
        }
        let mut metadata = objects.to_le_bytes().to_vec();
        metadata.append(&mut bytes);
        Ok(metadata)
    }

    fn properties(
        &self,
        channel: &Channel,
        rows: usize,
        start: Option<Timestamp>,
        first_s: f64,
    ) -> io::Result<Vec<Property>> {
        let mut properties = Vec::new();
        let offset_s = match channel.start_offset_s {
            0.0 if channel.sample_rate_hz.is_some() => first_s,
            own_s => own_s,
        };
        if let Some(unit) = &channel.unit {
            properties.push(Property::text("unit_string", unit)?);
        }
        if let Some(rate) = channel.sample_rate_hz {
            if let Some(start) = start {
                properties.push(Property::new(BEGAN, TIME, &start.0.to_le_bytes()));
            }
            properties.push(Property::new(
                "wf_increment",
                F64,
                &(1.0 / rate).to_le_bytes(),
            ));
            properties.push(Property::new(
                "wf_samples",
                I32,
                &(rows as u32).to_le_bytes(),
            ));
        }
        if channel.sample_rate_hz.is_some() || offset_s != 0.0 {
            properties.push(Property::new(
                "wf_start_offset",
                F64,
                &offset_s.to_le_bytes(),
            ));
        }
        Ok(properties)
    }
}

/// A property as the file has it.
struct Property(Vec<u8>);

impl Property {
    fn new(name: &str, kind: u32, value: &[u8]) -> Self {
        let mut bytes = Vec::new();
        bytes.extend((name.len() as u32).to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(value);
        Self(bytes)
    }

    fn text(name: &str, value: &str) -> io::Result<Self> {
        let mut bytes = Vec::new();
        text(&mut bytes, value)?;
        Ok(Self::new(name, TEXT, &bytes))
    }
}

fn text(bytes: &mut Vec<u8>, value: &str) -> io::Result<()> {
    let length = u32::try_from(value.len()).map_err(|_| io::ErrorKind::InvalidInput)?;
    bytes.extend(length.to_le_bytes());
    bytes.extend(value.as_bytes());
    Ok(())
}

fn object(
    bytes: &mut Vec<u8>,
    names: &[&String],
    rows: Option<usize>,
    properties: &[Property],
) -> io::Result<()> {
    text(bytes, &join_path(names.iter().map(|name| name.as_str())))?;
    match rows {
        None => bytes.extend(NO_RAW_INDEX.to_le_bytes()),
        Some(rows) => {
            bytes.extend(RAW_INDEX_LENGTH.to_le_bytes());
            bytes.extend(F64.to_le_bytes());
            bytes.extend(1_u32.to_le_bytes());
            bytes.extend((rows as u64).to_le_bytes());
        }
    }
    bytes.extend((properties.len() as u32).to_le_bytes());
    for Property(property) in properties {
        bytes.extend(property);
    }
    Ok(())
}

/// Group and name of a channel.
fn names(name: &str) -> [String; 2] {
    if name.starts_with("/'")
        && let Some(names) = split_path(name)
        && let Ok(names) = names.try_into()
    {
        return names;
    }
    let (group, name) = name.split_once('/').unwrap_or((GROUP, name));
    [group.to_owned(), name.to_owned()]
}
