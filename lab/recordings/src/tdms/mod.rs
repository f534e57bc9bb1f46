//! TDMS files, as LabVIEW, DAQmx logging and FlexLogger write them.
//!
//! A TDMS file is a string of segments. Each may change the list of objects (file, groups, channels), their properties and
//! the way in which raw samples follow each other; what a segment does not mention holds from before. So the file is walked
//! once when it is opened, metadata only, and what remains is an index of runs whose size grows with the number of segments,
//! not with the samples.
//!
//! | file | holds |
//! |---|---|
//! | `cursor` | bounded reading of metadata, either byte order |
//! | `value` | properties and time stamps |
//! | `object` | object paths and what is known of an object |
//! | `kind` | data types, and samples as f64 |
//! | `daqmx` | the index of raw data from DAQmx |
//! | `chunk` | where the samples of each channel are in a chunk |
//! | `walk` | lead-ins and object lists of all segments |
//! | `index` | what they come to |
//! | `scaling` | scales from raw to physical values |
//! | `describe` | names, units, rates and properties |
//! | `window` | buffered reading |
//! | `source`, `sink` | reading, writing |
//!
//! Read are versions 4712 and 4713, little and big endian, interleaved and contiguous raw data, any number of chunks in a
//! segment, every integer and float type up to 8 bytes, booleans (0 and 1), time stamps (seconds since the channel's first,
//! whose absolute value is in the properties) and DAQmx raw data with one scaler per channel. Integers beyond 2^53 are rounded to the
//! nearest f64. Text channels are left out of the layout, and named in the property `channels_left_out`.
//!
//! Scales (`NI_Scale[n]_...`) are applied in f64, unless `NI_Scaling_Status` says that they already were. A channel whose
//! scale or type is not known stays in the layout, is named in the property `channels_not_readable`, and is refused with
//! [`Error::Unsupported`](crate::Error::Unsupported) when it is selected, or read because nothing was selected; its raw counts are never handed out.
//!
//! A last segment that was cut off (power loss, crash) is read as far as all its channels reach, and the property
//! `incomplete_last_segment` is `true`.

mod chunk;
mod cursor;
mod daqmx;
mod describe;
mod index;
mod kind;
mod object;
mod scaling;
mod sink;
mod source;
mod value;
mod walk;
mod window;

use std::path::Path;

use crate::channel::Layout;
use crate::error::Result;
use crate::sink::Sink;
use crate::source::Source;

/// Opens a TDMS file and indexes it. Its `.tdms_index` neighbour is neither needed nor looked at.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io); [`Error::Malformed`](crate::Error::Malformed) where the file breaks the format's rules;
/// [`Error::Unsupported`](crate::Error::Unsupported) for a version or a data type whose size is not known.
pub(crate) fn open(path: &Path) -> Result<Box<dyn Source>> {
    Ok(Box::new(source::Reader::open(path)?))
}

/// Starts a TDMS file, version 4713: contiguous f64 segments of at most 65,536 rows.
///
/// A channel `group/channel` is written under that group, split at the first slash; one without a group goes into
/// `recording`. Unit, sample rate and start offset become `unit_string`, `wf_increment` and `wf_start_offset`, a property
/// `wf_start_time` (as this reader gives it) that of every channel with a rate; all other properties become texts of the file.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io); [`Error::Unsupported`](crate::Error::Unsupported) if two channels get the same name.
pub(crate) fn create(path: &Path, layout: &Layout) -> Result<Box<dyn Sink>> {
    Ok(Box::new(sink::Writer::create(path, layout)?))
}
