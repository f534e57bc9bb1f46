//! What is in a recording, whoever made it: read once, in blocks, whatever its length. What `sixaxis inspect` prints.
//!
//! No sensor is needed. [`inspect`] opens a file, takes every channel through one accumulator and the time stamps through
//! the [`Clock`](crate::ingest::clock::Clock) that the other commands read them with, and puts the numbers, and what a person
//! should know of them, into an [`Inspection`].
//!
//! | file | holds |
//! |---|---|
//! | [`facts`] | numbers and sentences: plain data, serialisable |
//! | `reading` | which channels are read side by side; blocks from the file to the accumulators |
//! | `series` | one channel's numbers, all in one pass |
//! | `extreme` | flat tops |
//! | `jumps` | spikes, steps, missing samples |
//! | `resolution` | smallest step, bits |
//! | `spectrum` | highest line, mains |
//! | [`allan`] | at rest: Allan deviation, noise density, bias instability, random walk |
//! | `pairs` | correlation; channels that are one signal |
//! | `sensor` | the nine limbs and the standards, where they can be told |
//! | `notices` | the facts in sentences |
//! | [`listing`] | the facts as text for a terminal |
//! | [`page`] | the facts as a page, with every channel's history and spectrum |
//!
//! Memory: a block of at most 2,097,152 values (65,536 rows up to 32 channels), and for each channel a segment of at most 65,536
//! samples with its window and spectrum, 2,048 bins and 4,096 samples for the resolution. At most 128 channels are read side by
//! side; more take several passes.

pub mod allan;
mod extreme;
pub mod facts;
mod jumps;
pub mod listing;
mod notices;
pub mod page;
mod pairs;
mod reading;
mod resolution;
mod sensor;
mod series;
mod spectrum;

pub use facts::{Inspection, Severity};
pub use reading::inspect;
pub use sensor::Expected;
