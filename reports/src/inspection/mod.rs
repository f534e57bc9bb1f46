//! What is in a recording, whoever made it: read once, in blocks, whatever its length.
//!
//! Nothing in here draws or needs a sensor. [`inspect`] opens a file, takes every channel through one [`series::Series`] and the
//! time stamps through one [`clock::Clock`], and puts the numbers and what is to be noticed about them into a
//! [`findings::Inspection`].
//!
//! | file | holds |
//! |---|---|
//! | [`findings`] | the answer: plain data, serialisable |
//! | [`reading`] | which channels go side by side, blocks from the file to the accumulators |
//! | [`clock`] | time stamps: rate, jitter, gaps |
//! | [`series`] | one channel's numbers, all in one pass |
//! | [`extreme`] | flat tops |
//! | [`envelope`] | minimum, maximum and mean over time in bounded memory; drift |
//! | [`resolution`] | smallest step, bits |
//! | [`spectrum`] | Welch's spectrum as the samples come; dominant line, mains |
//! | [`pairs`] | correlation; channels that are one signal |
//! | [`sensor`] | the nine limbs and the standards, where they can be told |
//! | [`notices`] | what is noticed, in sentences |
//! | [`listing`] | the answer as text for a terminal |
//!
//! Memory: a block of at most 2,097,152 values (65,536 rows up to 32 channels), and for each channel a segment of at most 65,536
//! samples with its spectrum, 2,048 bins and 4,096 samples for the resolution. At most 128 channels are read side by side; more
//! take several passes.

pub mod clock;
pub mod envelope;
pub mod extreme;
pub mod findings;
pub mod listing;
pub mod notices;
pub mod pairs;
pub mod reading;
pub mod resolution;
pub mod sensor;
pub mod series;
pub mod spectrum;

pub use findings::Inspection;
pub use reading::inspect;
pub use sensor::Expectations;
