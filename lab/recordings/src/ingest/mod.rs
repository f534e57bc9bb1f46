//! From a file to columns of numbers that can be computed with: the one way in for every command.
//!
//! `inspect`, `calibrate`, `decouple`, `compare` and `self-calibrate` read recordings through these files and therefore agree
//! about which channel is which, what its unit is worth, how fast it was sampled and what a gap is.
//!
//! | file | holds |
//! |---|---|
//! | [`find`] | names to channels: limbs, standards, time stamps, columns of a motion |
//! | [`units`] | the size of a channel's unit in SI |
//! | [`clock`] | time stamps: rate, jitter, gaps; the sample rate that file and session state |
//! | [`columns`] | blocks of columns in SI units, with their time stamps |
//! | [`readings`] | one recording of a session, whole, on the clock of the limbs |
//! | [`averaged`] | a static record of any length in bounded memory |

pub mod averaged;
pub mod clock;
pub mod columns;
mod even;
pub mod find;
pub mod readings;
mod units;
