//! NumPy: one array (`.npy`) or a zip file of named arrays (`.npz`).
//!
//! # What is read
//! Headers of version 1, 2 and 3; floats of 2, 4 and 8 bytes, integers of 1 to 8 bytes, booleans, of either byte order; C
//! and Fortran order. A 64-bit integer that f64 cannot hold exactly is refused with its sample, not rounded.
//!
//! | array | channels |
//! |---|---|
//! | one dimension | one: `column_1`, in an NPZ its own name |
//! | two dimensions | rows are samples, but of 2 to 64 rows with more than eight times as many columns each is a channel: `column_1` ..., in an NPZ `name_1` ...; at most 4096 columns |
//! | structured, one dimension | one per numeric field, of its name, in an NPZ `name/field`; fields of text are left out |
//!
//! In an NPZ a single number or string is a property; `sample_rate_hz` (or `fs`, `fs_hz`) is the rate of all channels, and
//! the string `name.unit` the unit of channel `name`. A member that cannot be a channel (three dimensions, text, objects)
//! is a property that says so. Pickled objects are never loaded.
//!
//! Members are stored or deflated; a deflated one is decoded as it is read, with one decoder per selected member (per
//! selected column in Fortran order). Checksums are verified when the last sample of a member is read, and for Fortran order
//! when it is selected.
//!
//! # What is written
//! `.npy`: two dimensions, f8, C order; names, units and rates have no place in it. `.npz`: a stored array of f8 per
//! channel, with units and properties as above. Because the members follow one another, the samples are first spooled to
//! a file without a name in the same folder (of the same size, gone at the end); the memory used is 4 MiB.

mod dtype;
mod header;
mod literal;
mod npz;
mod sink;
mod source;
mod stream;
mod table;
mod zip;

pub(crate) use npz::open as open_npz;
pub(crate) use sink::create;
pub(crate) use source::open_npy;
