//! The drawing room: plain data in, one self-contained HTML file out.
//!
//! Nothing in here measures, simulates or decides. A caller fills a [`Page`], [`render`] turns it
//! into a page without network access, foreign fonts or required scripts. Writing it to disk is the caller's.
//!
//! Read the files in this order:
//!
//! | file | holds |
//! |---|---|
//! | [`page`] | what a page consists of: tiles, sections, ledgers |
//! | [`table`] | tables: heading, alignment and cell of a column in one place |
//! | [`text`] | the text of a section in a file of its own |
//! | [`figure`] | what a figure consists of: axes, series, marks |
//! | [`number`] | how a number is printed |
//! | [`markup`] | the few inline marks a text may contain |
//! | [`scale`] | where ticks go and how they are labelled |
//! | [`trace`] | how samples become strokes: gaps, clipping, decimation |
//! | [`layout`] | where everything of a figure stands |
//! | [`guide`] | guide lines and a free place for their labels |
//! | [`ink`] | the pen: strokes, texts and markers as SVG in the theme's colours |
//! | [`reading`] | what a drawing says of itself, so that it can be read by a pointer |
//! | [`plot`] | a figure as SVG |
//! | [`render()`] | the page as HTML |
//!
//! Units, frames and tolerances belong to the caller: labels arrive here as finished text.

pub mod figure;
pub mod guide;
pub mod ink;
pub mod layout;
pub mod markup;
pub mod number;
pub mod page;
pub mod plot;
pub mod reading;
mod render;
pub mod scale;
pub mod standalone;
pub mod table;
pub mod text;
pub mod trace;

pub use figure::{Axis, Figure, Kind, Mark, Panel, Scale, Series};
pub use page::{Basis, Block, Claim, Listing, Page, Section, State, Tile, Verdict};
pub use render::{AXIS_SCRIPT, render, theme};
pub use table::{Cell, Table, TableBuilder};
pub use text::Text;
