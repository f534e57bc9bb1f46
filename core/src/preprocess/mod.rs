//! Cleaning of recordings before identification and decoupling.

pub mod lag;
