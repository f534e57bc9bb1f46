//! The laboratory's pages: a calibration and a comparison as [`sixaxis_page::Page`]s. Nothing is measured in here but what a
//! picture needs.

pub mod calibration;
pub mod comparison;
pub mod labels;
