//! The index of raw data from DAQmx.

use super::cursor::Cursor;
use super::kind::Kind;
use super::object::RawIndex;
use crate::error::{Error, Result};

/// Header of an index with format changing scalers.
pub const FORMAT_CHANGING: u32 = 0x1269;
/// Header of an index with digital line scalers.
pub const DIGITAL_LINE: u32 = 0x126A;
/// Data type of a channel that only its scalers describe.
const RAW: u32 = 0xFFFF_FFFF;

/// How a channel's raw values lie in the buffers of the acquisition devices, one buffer after the other, each interleaved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Daqmx {
    /// More than one only in formats that are not read.
    pub scalers: Vec<Scaler>,
    /// Bytes per row of each buffer.
    pub widths: Vec<u32>,
    /// The scales count from the scaler, not from the raw value.
    pub scaled_by_id: bool,
}

/// Where the raw values are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Scaler {
    pub kind: Kind,
    pub buffer: u32,
    /// Byte in the row.
    pub offset: u32,
    /// Number of the scale that stands for these values.
    pub id: u32,
}

impl Daqmx {
    /// Reads the index after its header.
    pub fn read(cursor: &mut Cursor, header: u32) -> Result<RawIndex> {
        let code = cursor.u32()?;
        if cursor.u32()? != 1 {
            return Err(cursor.malformed("samples of more than one dimension"));
        }
        let values = cursor.u64()?;
        let line = header == DIGITAL_LINE;
        let count = cursor.u32()?;
        if u64::from(count) * if line { 17 } else { 20 } > cursor.left() {
            return Err(cursor.malformed(format!("{count} scalers are announced, more than fit")));
        }
        let mut scalers = Vec::new();
        for _ in 0..count {
            scalers.push(Scaler::read(cursor, line)?);
        }
        let count = cursor.u32()?;
        if u64::from(count) * 4 > cursor.left() {
            return Err(cursor.malformed(format!("{count} buffers are announced, more than fit")));
        }
        let mut widths = Vec::new();
        for _ in 0..count {
            widths.push(cursor.u32()?);
        }
        for scaler in &scalers {
            let width = usize::try_from(scaler.buffer)
                .ok()
                .and_then(|buffer| widths.get(buffer));
            let end = u64::from(scaler.offset) + scaler.kind.size().unwrap_or(0);
            if width.is_none_or(|width| u64::from(*width) < end) {
                return Err(cursor.malformed("a DAQmx scaler outside the row of its buffer"));
            }
        }
        let Some(first) = scalers.first() else {
            return Err(cursor.malformed("DAQmx raw data without a scaler"));
        };
        let kind = first.kind;
        if code != RAW && !line && (scalers.len() != 1 || Kind::from_code(code) != Some(kind)) {
            return Err(cursor.malformed("data types of a DAQmx channel and its scaler differ"));
        }
        Ok(RawIndex {
            kind,
            values,
            bytes: 0,
            daqmx: Some(Self {
                scalers,
                widths,
                scaled_by_id: code == RAW,
            }),
        })
    }
}

impl Scaler {
    fn read(cursor: &mut Cursor, line: bool) -> Result<Self> {
        let code = cursor.u32()?;
        let Some(kind) = Kind::from_daqmx_code(code) else {
            return Err(Error::unsupported(
                cursor.path(),
                format!("DAQmx raw data of type {code}"),
                "log scaled values instead of raw ones, or convert the file with LabVIEW or DIAdem",
            ));
        };
        let buffer = cursor.u32()?;
        let offset = cursor.u32()?;
        let (kind, offset) = if line {
            cursor.u8()?;
            // The offset counts bits, from the lowest of the first byte; higher bytes follow.
            if cursor.big_endian {
                return Err(Error::unsupported(
                    cursor.path(),
                    "big-endian DAQmx digital lines",
                    "convert the file with LabVIEW or DIAdem",
                ));
            }
            (Kind::Line((offset % 8) as u8), offset / 8)
        } else {
            cursor.u32()?;
            (kind, offset)
        };
        Ok(Self {
            kind,
            buffer,
            offset,
            id: cursor.u32()?,
        })
    }
}
