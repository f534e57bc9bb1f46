//! The pen: strokes, texts and markers in page units, written as SVG in the theme's colours.
//!
//! Coordinates are whole numbers of a unit [`FINE`] times as fine as the page's, which the view box takes back: files stay
//! small. Each [`Ink`] becomes a CSS variable with a fallback: a figure follows the page's theme and is still readable
//! without one.

use super::markup;
use super::trace::Point;

/// How many colours the palette has.
///
/// The hues are near those of Okabe and Ito; lightness and chroma were searched so that any two
/// stay at least 0.07 apart in OKLab for normal, deutan, protan and tritan eyes, with a contrast of
/// at least 3:1 against the light paper and 4.5:1 against the dark one.
pub const PALETTE: usize = 8;

/// Drawing units per page unit.
pub const FINE: f64 = 4.0;

/// What a stroke or a text means; the theme decides its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// A curve of the palette.
    Series(usize),
    /// The same, broken.
    Dashed(usize),
    /// Axis labels.
    Text,
    /// Tick labels and labels of guides.
    Muted,
    /// Axis lines and ticks.
    Axis,
    /// Grid lines.
    Grid,
    /// Guides.
    Mark,
}

/// Light theme's colours of the curves.
const CURVES: [&str; PALETTE] = [
    "#1e50aa", "#a8471a", "#00a586", "#753369", "#ac8c1a", "#087fb1", "#696865", "#79000c",
];

impl Ink {
    /// Attributes that draw `property` (stroke or fill) in this ink.
    fn attributes(self, property: &str) -> String {
        let curve = |index: usize| {
            let place = index % PALETTE;
            format!(" style=\"{property}:var(--s{place},{})\"", CURVES[place])
        };
        let plain =
            |name: &str, fallback: &str| format!(" style=\"{property}:var({name},{fallback})\"");
        match self {
            Self::Series(index) => curve(index),
            Self::Dashed(index) => curve(index) + " stroke-dasharray=\"26 16\"",
            Self::Text => plain("--ink", "#1c1c1a"),
            Self::Muted => plain("--ink-2", "#5c5c58") + " class=\"halo\"",
            Self::Axis => plain("--axis", "#8a8a84"),
            Self::Grid => plain("--grid", "#e6e6e2"),
            Self::Mark => plain("--mark", "#6a6a66") + " stroke-dasharray=\"8 14\"",
        }
    }
}

/// Where a text stands against its anchor point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Begins there.
    Start,
    /// Centred there.
    Middle,
    /// Ends there.
    End,
}

/// A pen on a sheet measured in page units, and the elements that it has drawn, one a line.
#[derive(Debug, Default)]
pub struct Pen {
    svg: String,
}

impl Pen {
    /// The content of the SVG element.
    #[must_use]
    pub fn into_svg(self) -> String {
        self.svg
    }

    fn element(&mut self, element: &str) {
        self.svg.push_str(element);
        self.svg.push('\n');
    }

    /// A stroke.
    pub fn stroke(&mut self, points: &[Point], ink: Ink, width: f64) {
        self.element(&format!(
            "<polyline fill=\"none\"{} points=\"{}\"/>",
            stroke(ink, width),
            list(points.iter().copied())
        ));
    }

    /// A text, vertically centred on its anchor.
    pub fn text(&mut self, text: &str, at: Point, anchor: Anchor, size: f64, ink: Ink) {
        let (x, y) = fine(at);
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.element(&format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.35em\" text-anchor=\"{anchor}\" font-size=\"{:.1}\"{}>{}</text>",
            (size * FINE).trunc(),
            ink.attributes("fill"),
            markup::svg(text)
        ));
    }

    /// The marker that belongs to a palette index.
    pub fn marker(&mut self, at: Point, colour: usize, radius: f64) {
        let ink = Ink::Series(colour);
        let placed = |(x, y): &Point| (at.0 + x * radius, at.1 + y * radius);
        let filled: &[(f64, f64)] = match colour % PALETTE {
            1 => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            2 => &[(0.0, -1.25), (1.2, 0.85), (-1.2, 0.85)],
            3 => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
            4 => &[(0.0, 1.25), (1.2, -0.85), (-1.2, -0.85)],
            _ => &[],
        };
        let crossed: &[[(f64, f64); 2]] = match colour % PALETTE {
            5 => &[[(-1.0, -1.0), (1.0, 1.0)], [(-1.0, 1.0), (1.0, -1.0)]],
            6 => &[[(-1.2, 0.0), (1.2, 0.0)], [(0.0, -1.2), (0.0, 1.2)]],
            _ => &[],
        };
        if !filled.is_empty() {
            self.element(&format!(
                "<polygon{} points=\"{}\"/>",
                ink.attributes("fill"),
                list(filled.iter().map(placed))
            ));
        } else if crossed.is_empty() {
            let look = match colour.is_multiple_of(PALETTE) {
                true => ink.attributes("fill"),
                false => format!(" fill=\"none\"{}", stroke(ink, MARKER_STROKE)),
            };
            let ((x, y), radius) = (fine(at), whole(radius));
            self.element(&format!(
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{look}/>"
            ));
        }
        for line in crossed {
            self.stroke(&line.each_ref().map(placed), ink, MARKER_STROKE);
        }
    }
}

/// Width of a marker's strokes, page units.
const MARKER_STROKE: f64 = 1.6;

/// Attributes of a line of a width in page units.
fn stroke(ink: Ink, width: f64) -> String {
    let ink = ink.attributes("stroke");
    format!("{ink} stroke-width=\"{}\"", whole(width))
}

/// A length in drawing units.
fn whole(length: f64) -> i32 {
    (length * FINE).round() as i32
}

fn fine((x, y): Point) -> (i32, i32) {
    (whole(x), whole(y))
}

fn list(path: impl Iterator<Item = Point>) -> String {
    let points: Vec<String> = path.map(fine).map(|(x, y)| format!("{x},{y}")).collect();
    points.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_fixed_colour_is_left() {
        let mut pen = Pen::default();
        for i in 0..2 * PALETTE {
            pen.marker((5.0, 5.0), i, 3.0);
        }
        pen.stroke(&[(0.0, 0.0), (1.0, 0.13)], Ink::Dashed(1), 1.5);
        pen.text("a < 10⁻³", (1.0, 1.0), Anchor::End, 10.0, Ink::Muted);
        let svg = pen.into_svg();
        assert!(!svg.contains("\"#"), "{svg}");
        assert!(svg.contains("var(--s7,") && svg.contains("var(--ink-2,"));
        assert!(svg.contains("stroke-dasharray"));
        assert!(svg.contains("points=\"0,0 4,1\""), "{svg}");
        assert!(svg.contains(">a &lt; 10<tspan"), "{svg}");
    }
}
