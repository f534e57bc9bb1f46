//! The pen: plotters' elements in page units, on a backend that writes SVG in the theme's colours.
//!
//! plotters knows fixed colours and whole pixels only. Here everything is drawn [`FINE`] times larger, which the view box
//! takes back, and each [`Ink`] travels as a colour of its own, from which the backend writes a CSS variable with a
//! fallback: a figure follows the page's theme and is still readable without one.

use core::cell::RefCell;
use core::convert::Infallible;
use std::rc::Rc;

use super::markup;
use super::trace::Point;
use plotters::coord::Shift;
use plotters::element::{Drawable, PointCollection};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};

/// How many colours the palette has.
///
/// The hues are near those of Okabe and Ito; lightness and chroma were searched so that any two
/// stay at least 0.07 apart in OKLab for normal, deutan, protan and tritan eyes, with a contrast of
/// at least 3:1 against the light paper and 4.5:1 against the dark one.
pub const PALETTE: usize = 8;

/// Drawing units per page unit: what is read back from a drawing is as fine, so that it can be read and enlarged.
pub const FINE: f64 = 16.0;

/// What a stroke or a text means; the theme decides its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// A curve of the palette.
    Series(usize),
    /// The same, broken.
    Dashed(usize),
    /// The area of a band in the curve's colour, which lets through what is behind it.
    Band(usize),
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

/// The theme's variable of each ink that is no curve, the light theme's colour, and further attributes.
const PLAIN: [(Ink, &str, &str, &str); 5] = [
    (Ink::Text, "--ink", "#1c1c1a", ""),
    (Ink::Muted, "--ink-2", "#5c5c58", " class=\"halo\""),
    (Ink::Axis, "--axis", "#8a8a84", ""),
    (Ink::Grid, "--grid", "#e6e6e2", ""),
    (
        Ink::Mark,
        "--mark",
        "#6a6a66",
        " stroke-dasharray=\"32 56\"",
    ),
];

/// Light theme's colours of the curves.
const CURVES: [&str; PALETTE] = [
    "#1e50aa", "#a8471a", "#00a586", "#753369", "#ac8c1a", "#087fb1", "#696865", "#79000c",
];

impl Ink {
    /// The colour that it travels as: kind and index.
    fn colour(self) -> RGBColor {
        let of_curve = |index: usize| (index % PALETTE) as u8;
        match self {
            Self::Series(index) => RGBColor(0, of_curve(index), 0),
            Self::Dashed(index) => RGBColor(1, of_curve(index), 0),
            Self::Band(index) => RGBColor(3, of_curve(index), 0),
            other => {
                let place = PLAIN.iter().position(|(ink, ..)| *ink == other);
                RGBColor(2, place.unwrap_or(0) as u8, 0)
            }
        }
    }

    /// Attributes that draw `property` (stroke or fill) in the ink that travels as a colour.
    fn attributes(colour: BackendColor, property: &str) -> String {
        let (kind, index, _) = colour.rgb;
        let place = usize::from(index);
        if kind == 2 {
            let (_, name, fallback, more) = PLAIN[place];
            return format!(" style=\"{property}:var({name},{fallback})\"{more}");
        }
        let more = match kind {
            1 => " stroke-dasharray=\"104 64\"",
            3 => " fill-opacity=\"0.3\"",
            _ => "",
        };
        format!(
            " style=\"{property}:var(--s{index},{})\"{more}",
            CURVES[place]
        )
    }
}

/// plotters' backend: SVG elements, one a line.
#[derive(Default)]
struct Themed {
    svg: Rc<RefCell<String>>,
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl Themed {
    fn element(&mut self, element: &str) -> Drawn {
        let mut svg = self.svg.borrow_mut();
        svg.push_str(element);
        svg.push('\n');
        Ok(())
    }
}

/// Path data of a stroke: its first point, and from each point to the next, which takes fewer digits.
fn outline(path: impl IntoIterator<Item = BackendCoord>) -> String {
    let mut data = String::new();
    let mut last = None;
    for (x, y) in path {
        let (from, command) = match last {
            None => ((0, 0), "M"),
            Some((from, first)) => (from, if first { "l" } else { "" }),
        };
        data += command;
        for (number, parted) in [(x - from.0, command.is_empty()), (y - from.1, true)] {
            // A minus sign parts by itself.
            if parted && number >= 0 {
                data.push(' ');
            }
            data += &number.to_string();
        }
        last = Some(((x, y), last.is_none()));
    }
    data
}

impl DrawingBackend for Themed {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        // plotters clamps points to the sheet; this one is larger than any figure.
        (1 << 20, 1 << 20)
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, point: BackendCoord, colour: BackendColor) -> Drawn {
        self.draw_circle(point, 1, &colour, true)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        self.element(&format!(
            "<path fill=\"none\"{} stroke-width=\"{}\" d=\"{}\"/>",
            Ink::attributes(style.color(), "stroke"),
            style.stroke_width(),
            outline(path)
        ))
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        (x, y): BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let look = if fill {
            Ink::attributes(style.color(), "fill")
        } else {
            let stroke = Ink::attributes(style.color(), "stroke");
            format!(
                " fill=\"none\"{stroke} stroke-width=\"{}\"",
                style.stroke_width()
            )
        };
        self.element(&format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{look}/>"
        ))
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        self.element(&format!(
            "<path{} d=\"{}z\"/>",
            Ink::attributes(style.color(), "fill"),
            outline(corners)
        ))
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Drawn {
        let anchor = match style.anchor().h_pos {
            HPos::Left => "start",
            HPos::Center => "middle",
            HPos::Right => "end",
        };
        self.element(&format!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.35em\" text-anchor=\"{anchor}\" font-size=\"{:.1}\"{}>{}</text>",
            style.size(),
            Ink::attributes(style.color(), "fill"),
            markup::svg(text)
        ))
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

/// A pen on a sheet measured in page units.
pub struct Pen {
    svg: Rc<RefCell<String>>,
    area: DrawingArea<Themed, Shift>,
}

impl Default for Pen {
    fn default() -> Self {
        let backend = Themed::default();
        Self {
            svg: Rc::clone(&backend.svg),
            area: backend.into_drawing_area(),
        }
    }
}

impl Pen {
    /// The content of the SVG element.
    pub fn into_svg(self) -> String {
        self.svg.take()
    }

    fn draw<E>(&self, element: &E)
    where
        for<'e> &'e E: PointCollection<'e, BackendCoord>,
        E: Drawable<Themed>,
    {
        self.area
            .draw(element)
            .expect("writing to a String cannot fail");
    }

    /// Begins a group of elements with these attributes.
    pub fn begin(&mut self, attributes: &str) {
        *self.svg.borrow_mut() += &format!("<g{attributes}>\n");
    }

    /// Ends the group that was begun last.
    pub fn end(&mut self) {
        self.svg.borrow_mut().push_str("</g>\n");
    }

    /// An area, from its corners.
    pub fn area(&mut self, corners: &[Point], ink: Ink) {
        let fine: Vec<_> = corners.iter().map(|p| fine(*p)).collect();
        self.draw(&Polygon::new(fine, ink.colour().filled()));
    }

    /// Markers of one series: the shape once, under an anchor, and its places.
    pub fn markers(&mut self, id: &str, places: &[Point], colour: usize, radius: f64) {
        // plotters draws on the sheet only: the shape is drawn there and moved to the origin.
        let middle = 2.0 * radius;
        let back = -fine((middle, middle)).0;
        *self.svg.borrow_mut() +=
            &format!("<defs><g id=\"{id}\" transform=\"translate({back} {back})\">\n");
        self.marker((middle, middle), colour, radius);
        let mut svg = self.svg.borrow_mut();
        svg.push_str("</g></defs>\n");
        for (x, y) in places.iter().map(|place| fine(*place)) {
            *svg += &format!("<use href=\"#{id}\" x=\"{x}\" y=\"{y}\"/>\n");
        }
    }

    /// A stroke.
    pub fn stroke(&mut self, points: &[Point], ink: Ink, width: f64) {
        let fine: Vec<_> = points.iter().map(|p| fine(*p)).collect();
        self.draw(&PathElement::new(fine, stroke_of(ink, width)));
    }

    /// A text, vertically centred on its anchor.
    pub fn text(&mut self, text: &str, at: Point, anchor: Anchor, size: f64, ink: Ink) {
        let h_pos = match anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let colour = ink.colour();
        let style = ("sans-serif", size * FINE)
            .into_text_style(&self.area)
            .color(&colour)
            .pos(Pos::new(h_pos, VPos::Center));
        self.draw(&Text::new(text.to_owned(), fine(at), style));
    }

    /// The marker that belongs to a palette index.
    pub fn marker(&mut self, at: Point, colour: usize, radius: f64) {
        let ink = Ink::Series(colour);
        let (full, thin) = (ink.colour().filled(), stroke_of(ink, 1.6));
        let corners = |shape: &[(f64, f64)]| -> Vec<BackendCoord> {
            let corner = |(x, y): &(f64, f64)| fine((at.0 + x * radius, at.1 + y * radius));
            shape.iter().map(corner).collect()
        };
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
            self.draw(&Polygon::new(corners(filled), full));
        } else if crossed.is_empty() {
            let style = if colour.is_multiple_of(PALETTE) {
                full
            } else {
                thin
            };
            let radius = (radius * FINE).round() as i32;
            self.draw(&Circle::new(fine(at), radius, style));
        }
        for stroke in crossed {
            self.draw(&PathElement::new(corners(stroke), thin));
        }
    }
}

/// A line of a width in page units.
fn stroke_of(ink: Ink, width: f64) -> ShapeStyle {
    ShapeStyle {
        color: ink.colour().to_rgba(),
        filled: false,
        stroke_width: (width * FINE).round() as u32,
    }
}

fn fine((x, y): Point) -> BackendCoord {
    ((x * FINE).round() as i32, (y * FINE).round() as i32)
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
        assert!(svg.contains("d=\"M0 0l16 2\""), "{svg}");
        assert!(svg.contains(">a &lt; 10<tspan"), "{svg}");
    }
}
