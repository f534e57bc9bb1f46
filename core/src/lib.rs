#![no_std]
//! placeholder

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod error;

pub use error::{Error, Result};
