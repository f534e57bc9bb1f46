//! Library side of the `sixaxis` command.
//!
//! The command itself (`main.rs`) stays thin; everything that can be used from an example or a
//! test lives here. [`study`] measures, [`pages`] decides what a reader is told of it, `sixaxis_page` turns
//! plain data into one self-contained HTML page and knows nothing of sensors, simulators or
//! campaigns.

pub mod pages;
pub mod progress;
pub mod study;
