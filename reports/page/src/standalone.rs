//! A figure as a picture of its own, for places that have no page around it: title and legend come along, on paper white.

use super::figure::Figure;
use super::layout::{Layout, Size};
use super::markup::escape;
use super::plot::{legend, to_svg};

/// Size of the legend's text, and the room one entry takes at the most, in units of the picture.
const FONT: f64 = 15.0;
const ROW: f64 = 24.0;
const SAMPLE: f64 = 30.0;
/// Width of a letter over the font's size: an estimate that errs wide.
const LETTER: f64 = 0.56;
const MARGIN: f64 = 12.0;

/// The figure with title and legend as one SVG document.
pub fn standalone(figure: &Figure) -> String {
    let width = Size::STANDARD.width;
    let mut head = String::new();
    head += &format!(
        r##"<text x="{MARGIN}" y="{y}" font-size="17" font-weight="600" fill="#1c1c1a">{}</text>
"##,
        escape(&figure.title),
        y = MARGIN + 17.0,
    );
    let mut y = MARGIN + 30.0;
    let mut x = MARGIN;
    for series in figure.series.iter().filter(|s| !s.label.is_empty()) {
        let length = SAMPLE + 8.0 + series.label.chars().count() as f64 * FONT * LETTER + 22.0;
        if x > MARGIN && x + length > width {
            x = MARGIN;
            y += ROW;
        }
        head += &format!(
            r##"<svg x="{x}" y="{y}" width="{SAMPLE}" height="{ROW}">{}</svg><text x="{tx}" y="{ty}" font-size="{FONT}" fill="#1c1c1a">{}</text>
"##,
            legend(series),
            escape(&series.label),
            tx = x + SAMPLE + 8.0,
            ty = y + 0.5 * ROW + 0.35 * FONT,
        );
        x += length;
    }
    let top = y + ROW + 6.0;
    let height = Layout::of(figure, Size::STANDARD).height() + top;
    let plot = to_svg(figure, Size::STANDARD);
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-family="system-ui, sans-serif">
<rect width="100%" height="100%" fill="#ffffff"/>
{head}<svg x="0" y="{top}" width="{width}" height="{rest}">
{plot}</svg>
</svg>
"##,
        rest = height - top,
    )
}
