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
//! `incomplete_last_segment` is `true`. Channels that start at different times (`wf_start_time`, `wf_start_offset`) are read from
//! the last start on.

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

pub(crate) use sink::create;
pub(crate) use source::open;
