//! The pen: plotters' SVG backend in page units, and its fixed colours turned into theme colours.
//!
//! Two habits of that backend are undone here. Its coordinates are integers, so everything is
//! drawn [`FINE`] times larger and the view box says so. Its colours are fixed, so each [`Ink`]
//! travels as a reserved colour and leaves as a CSS variable with a fallback: the figure follows
//! the page's theme and is still readable without one.

use super::markup;
use super::trace::Point;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// How many colours the palette has.
///
/// The hues are near those of Okabe and Ito; lightness and chroma were searched so that any two
/// stay at least 0.07 apart in OKLab for normal, deutan, protan and tritan eyes, with a contrast of
/// at least 3:1 against the light paper and 4.5:1 against the dark one.
pub const PALETTE: usize = 8;

/// Drawing units per page unit.
pub const FINE: f64 = 4.0;

/// First byte of the reserved colours.
const RESERVED: u8 = 0x5A;

/// Light theme's colours, for a figure taken out of its page.
const FALLBACK: [&str; PALETTE] = [
    "#1e50aa", "#a8471a", "#00a586", "#753369", "#ac8c1a", "#087fb1", "#696865", "#79000c",
];

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

impl Ink {
    fn colour(self) -> RGBColor {
        let (kind, index) = match self {
            Self::Series(i) => (0, i % PALETTE),
            Self::Dashed(i) => (1, i % PALETTE),
            Self::Text => (2, 0),
            Self::Muted => (3, 0),
            Self::Axis => (4, 0),
            Self::Grid => (5, 0),
            Self::Mark => (6, 0),
        };
        RGBColor(RESERVED, kind, index as u8)
    }

    /// The theme's variable and its fallback for a reserved colour.
    fn variable(kind: u8, index: u8) -> (String, &'static str) {
        match kind {
            0 | 1 => (
                format!("--s{index}"),
                FALLBACK[usize::from(index) % PALETTE],
            ),
            2 => ("--ink".to_owned(), "#1c1c1a"),
            3 => ("--ink-2".to_owned(), "#5c5c58"),
            4 => ("--axis".to_owned(), "#8a8a84"),
            5 => ("--grid".to_owned(), "#e6e6e2"),
            _ => ("--mark".to_owned(), "#6a6a66"),
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

/// A pen on a sheet measured in page units.
pub struct Pen<'a> {
    area: DrawingArea<SVGBackend<'a>, plotters::coord::Shift>,
}

impl Pen<'_> {
    /// Draws on a fresh sheet and hands back the themed content of the SVG element.
    ///
    /// # Errors
    /// If the backend fails.
    pub fn sheet(
        width: f64,
        height: f64,
        draw: impl FnOnce(&Pen<'_>) -> anyhow::Result<()>,
    ) -> anyhow::Result<String> {
        let mut raw = String::new();
        {
            let size = (
                (width * FINE).round() as u32,
                (height * FINE).round() as u32,
            );
            let pen = Pen {
                area: SVGBackend::with_string(&mut raw, size).into_drawing_area(),
            };
            draw(&pen)?;
            pen.area.present()?;
        }
        Ok(themed(&raw))
    }

    /// A stroke.
    ///
    /// # Errors
    /// If the backend fails.
    pub fn stroke(&self, points: &[Point], ink: Ink, width: f64) -> anyhow::Result<()> {
        let style = ink.colour().stroke_width((width * FINE).round() as u32);
        let fine: Vec<_> = points.iter().map(|p| fine(*p)).collect();
        Ok(self.area.draw(&PathElement::new(fine, style))?)
    }

    /// A text, vertically centred on its anchor.
    ///
    /// # Errors
    /// If the backend fails.
    pub fn text(
        &self,
        text: &str,
        at: Point,
        anchor: Anchor,
        size: f64,
        ink: Ink,
    ) -> anyhow::Result<()> {
        let h_pos = match anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        // The backend divides sizes by this number.
        let colour = ink.colour();
        let style = ("sans-serif", size * FINE * 1.24)
            .into_text_style(&self.area)
            .color(&colour)
            .pos(Pos::new(h_pos, VPos::Center));
        Ok(self
            .area
            .draw(&Text::new(text.to_owned(), fine(at), style))?)
    }

    /// The marker that belongs to a palette index.
    ///
    /// # Errors
    /// If the backend fails.
    pub fn marker(&self, at: Point, colour: usize, radius: f64) -> anyhow::Result<()> {
        let ink = Ink::Series(colour).colour();
        let corners = |shape: &[(f64, f64)]| -> Vec<(i32, i32)> {
            shape
                .iter()
                .map(|(x, y)| fine((at.0 + x * radius, at.1 + y * radius)))
                .collect()
        };
        let shape: &[(f64, f64)] = match colour % PALETTE {
            1 => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            2 => &[(0.0, -1.25), (1.2, 0.85), (-1.2, 0.85)],
            3 => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
            4 => &[(0.0, 1.25), (1.2, -0.85), (-1.2, -0.85)],
            _ => &[],
        };
        if !shape.is_empty() {
            return Ok(self
                .area
                .draw(&Polygon::new(corners(shape), ink.filled()))?);
        }
        let bars: [[(f64, f64); 2]; 2] = match colour % PALETTE {
            5 => [[(-1.0, -1.0), (1.0, 1.0)], [(-1.0, 1.0), (1.0, -1.0)]],
            6 => [[(-1.2, 0.0), (1.2, 0.0)], [(0.0, -1.2), (0.0, 1.2)]],
            filled => {
                let r = (radius * FINE).round() as i32;
                let style = if filled == 0 {
                    ink.filled()
                } else {
                    ink.stroke_width((1.6 * FINE) as u32)
                };
                return Ok(self.area.draw(&Circle::new(fine(at), r, style))?);
            }
        };
        for bar in bars {
            let style = ink.stroke_width((1.6 * FINE) as u32);
            self.area.draw(&PathElement::new(corners(&bar), style))?;
        }
        Ok(())
    }
}

fn fine((x, y): Point) -> (i32, i32) {
    ((x * FINE).round() as i32, (y * FINE).round() as i32)
}

/// Reserved colours to theme colours, texts to marked-up texts; the outer element is left out.
fn themed(raw: &str) -> String {
    let inner = raw.split_once(">\n").map_or(raw, |(_, rest)| rest);
    let inner = inner.trim_end().strip_suffix("</svg>").unwrap_or(inner);
    let mut out = String::with_capacity(raw.len());
    let mut lines = inner.lines();
    while let Some(line) = lines.next() {
        let is_text = line.starts_with("<text ");
        let line = line
            .replace(" opacity=\"1\"", "")
            .replace(" font-family=\"sans-serif\"", "")
            .replace(" stroke=\"none\"", "")
            .replace(" \"/>", "\"/>")
            .replace("dy=\"0.5ex\"", "dy=\"0.35em\"");
        out += &recoloured(&line);
        if is_text {
            // The backend puts the words on a line of their own.
            out += &markup::svg(&unescape(lines.next().unwrap_or_default()));
            out += lines.next().unwrap_or_default();
        }
        out.push('\n');
    }
    out
}

fn recoloured(line: &str) -> String {
    for property in ["stroke", "fill"] {
        let Some((before, rest)) = line.split_once(&format!(" {property}=\"#{RESERVED:02X}"))
        else {
            continue;
        };
        let (Some(code), Some(after)) = (rest.get(..4), rest.get(5..)) else {
            continue;
        };
        let byte = |range| {
            code.get(range)
                .and_then(|hex| u8::from_str_radix(hex, 16).ok())
        };
        let (kind, index) = (byte(0..2).unwrap_or(2), byte(2..4).unwrap_or(0));
        let (name, fallback) = Ink::variable(kind, index);
        let dash = match kind {
            1 => " stroke-dasharray=\"26 16\"",
            6 => " stroke-dasharray=\"8 14\"",
            _ => "",
        };
        let halo = if kind == 3 { " class=\"halo\"" } else { "" };
        return format!("{before} style=\"{property}:var({name},{fallback})\"{dash}{halo}{after}");
    }
    line.to_owned()
}

fn unescape(text: &str) -> String {
    [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&apos;", "'"),
        ("&amp;", "&"),
    ]
    .iter()
    .fold(text.to_owned(), |s, (from, to)| s.replace(from, to))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_fixed_colour_is_left() {
        let svg = Pen::sheet(10.0, 10.0, |pen| {
            for i in 0..2 * PALETTE {
                pen.marker((5.0, 5.0), i, 3.0)?;
            }
            pen.stroke(&[(0.0, 0.0), (1.0, 0.13)], Ink::Dashed(1), 1.5)?;
            pen.text("a < 10⁻³", (1.0, 1.0), Anchor::End, 10.0, Ink::Muted)
        })
        .expect("draws");
        assert!(!svg.contains("\"#"), "{svg}");
        assert!(svg.contains("var(--s7,"));
        assert!(svg.contains("stroke-dasharray"));
        assert!(svg.contains("points=\"0,0 4,1\""), "{svg}");
        assert!(svg.contains(">a &lt; 10<tspan"), "{svg}");
    }
}
