//! The accuracy report of `sixaxis report`.
//!
//! | module | holds |
//! |---|---|
//! | [`study`] | plays the paper's campaign on MuJoCo, runs the paper's methods on it, holds the outcome against the truth |
//! | [`sections`] | what a reader is told of it: one text file and one module for each section of the page |
//!
//! `sixaxis_page` turns sections into one offline HTML page and knows nothing of sensors, simulators or campaigns.

pub mod sections;
pub mod study;
