//! Recordings of every format: files that other software wrote, our own, and damaged ones; their clocks, and the sessions that name them.

#[path = "../foreign/expected.rs"]
mod expected;

mod clocks;
mod draft;
mod hdf5;
mod jumps;
mod matlab;
mod numpy;
mod parquet;
mod session;
mod tdms;
mod text;
