//! What is told of a recording that was inspected.

pub mod inspection;
