//! Recordings on disk: named channels in, blocks of numbers out, and the way back; and the session that they belong to.
//!
//! A file is opened as a [`Source`], says in its [`Layout`] what is in it, and is read in
//! [`Block`]s of bounded size, so that a recording larger than the memory works. Numbers arrive as f64 in the channel's own
//! unit, with the scaling that the file prescribes applied; where a scaling is not understood the file is refused, raw
//! counts are never handed out. What is written goes to a neighbour first ([`draft`]) and replaces the old file whole.
//!
//! | file | holds |
//! |---|---|
//! | [`channel`] | one channel: its name and unit |
//! | `layout` | what a file says before its samples are read |
//! | `block` | samples of some channels |
//! | `source`, `sink` | the traits [`Source`] and [`Sink`], and what all formats have in common of them |
//! | [`kind`] | what a file is that was named where another was expected |
//! | `open` | [`open()`] and [`create`]: which format a file has |
//! | [`motion`] | columns of a motion: accelerations, rate, attitude |
//! | [`draft`] | a file that appears whole or not at all |
//! | [`text`] | CSV and its national variants, gzip |
//! | [`tdms`] | what LabVIEW writes |
//! | [`parquet`] | columnar files of pandas, Polars, DuckDB |
//! | [`numpy`] | NPY and NPZ |
//! | [`hdf5`] | HDF5, of which MAT files of version 7.3 are a kind |
//! | [`matlab`] | MAT files |
//! | `variables` | what the files of MATLAB and HDF5 have in common |
//! | `numbers` | stored numbers as f64 |
//! | [`mod@unit`] | units that channels come in |
//! | [`ingest`] | names, units, clock: from a file to columns that can be computed with |
//! | [`inspect`] | what is in a recording, whoever made it |
//! | [`printable`] | text from files, fit for a terminal |
//! | [`envelope`] | a series of any length, kept for drawing |
//! | [`unwinding`] | libraries that panic on hostile files |
//! | [`whole`] | files that are read whole, up to a limit |
//! | [`session`] | the session file: which recordings belong together, and what they do not say themselves |

mod began;
mod block;
pub mod channel;
pub mod draft;
pub mod envelope;
pub mod error;
pub mod hdf5;
pub mod ingest;
pub mod inspect;
pub mod kind;
mod layout;
pub mod matlab;
pub mod motion;
mod numbers;
pub mod numpy;
mod open;
pub mod parquet;
pub mod printable;
pub mod runs;
pub mod session;
mod sink;
mod source;
pub mod tdms;
pub mod text;
pub mod unit;
pub mod unwinding;
mod variables;
pub mod whole;

pub use began::BEGAN;
pub use block::Block;
pub use channel::Channel;
pub use error::{Error, Result};
pub use layout::Layout;
pub use open::{create, open};
pub use sink::Sink;
pub use source::Source;
pub use text::calendar_ns;
