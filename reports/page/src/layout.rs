//! Where everything of a figure stands, before anything is drawn.
//!
//! Margins follow from the labels: nothing is clipped, nothing is left wider than it must be.

use super::figure::{Axis, Figure, Mark, Series};
use super::markup;
use super::scale::{Span, Ticks};
use super::trace::{Frame, Point};

/// A sheet, in page units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Name, used in anchors.
    pub name: &'static str,
    /// Width.
    pub width: f64,
    /// Height of a figure without a lower panel.
    pub height: f64,
    /// What a lower panel adds.
    pub below: f64,
    /// Size of the words.
    pub font: f64,
}

impl Size {
    /// The width of the text.
    pub const STANDARD: Self = Self {
        name: "standard",
        width: 720.0,
        height: 400.0,
        below: 150.0,
        font: 14.5,
    };
    /// A phone, or one of several side by side.
    pub const COMPACT: Self = Self {
        name: "compact",
        width: 360.0,
        height: 280.0,
        below: 115.0,
        font: 14.0,
    };
}

/// Where the names of an ordinate stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// Left of the frame.
    Beside,
    /// In the frame, each above its own row: long names would leave no room for the data.
    Above,
}

impl Naming {
    /// Widest share of the sheet that names beside the frame may take.
    const WIDEST: f64 = 0.42;

    fn of(names: &[String], size: Size) -> Self {
        let widest = names.iter().map(|n| markup::width(n)).fold(0.0, f64::max);
        if widest * size.font <= Self::WIDEST * size.width {
            Self::Beside
        } else {
            Self::Above
        }
    }

    /// Height of one row in units of the font size.
    fn pitch(self) -> f64 {
        match self {
            Self::Beside => 1.7,
            Self::Above => 2.6,
        }
    }
}

/// One drawn field: the figure itself or its lower panel.
pub struct Field<'a> {
    /// Ordinate.
    pub y: &'a Axis,
    /// Curves.
    pub series: &'a [Series],
    /// Guides.
    pub marks: &'a [Mark],
    /// The ordinate's ends.
    pub span: Span,
    /// The ordinate's ticks.
    pub ticks: Ticks,
    /// Where the ordinate's names stand, if it has names.
    pub naming: Option<Naming>,
    /// Where it stands.
    pub frame: Frame,
}

/// The label of a vertical guide, above the frame.
pub struct Above<'a> {
    /// Where the guide stands.
    pub x: f64,
    /// The label's middle: the guide, unless the sheet ends there.
    pub centre: f64,
    /// Row, counted upwards from the frame.
    pub row: usize,
    /// Text.
    pub label: &'a str,
}

/// Room under the lowest frame for the abscissa's ticks and label, in units of the font size.
const BELOW: f64 = 3.2;

/// Everything placed, nothing drawn.
pub struct Layout<'a> {
    /// What is drawn.
    pub figure: &'a Figure,
    /// On which sheet.
    pub size: Size,
    /// The abscissa's ends.
    pub x_span: Span,
    /// The abscissa's ticks.
    pub x_ticks: Ticks,
    /// The figure itself and its lower panel.
    pub fields: Vec<Field<'a>>,
    /// Labels of vertical guides.
    pub above: Vec<Above<'a>>,
}

impl<'a> Layout<'a> {
    /// Places a figure on a sheet.
    pub fn of(figure: &'a Figure, size: Size) -> Self {
        let mut parts = vec![(&figure.y, &figure.series[..], &figure.marks[..])];
        let below = figure.below.as_ref();
        parts.extend(below.map(|panel| (&panel.y, &panel.series[..], &[][..])));
        let mut series = parts.iter().flat_map(|(_, series, _)| *series);
        let marked = series.any(|s| s.kind.has_markers());
        let x_values = parts.iter().flat_map(|(_, series, marks)| {
            let points = series
                .iter()
                .flat_map(|s| &s.points)
                .filter(|p| p.1.is_finite());
            points
                .map(|p| p.0)
                .chain(marks.iter().filter_map(|mark| match mark {
                    Mark::Vertical { x, .. } => Some(*x),
                    _ => None,
                }))
        });
        let x_span = Span::fit(&figure.x, x_values, if marked { 0.025 } else { 0.0 });
        let spans: Vec<Span> = parts
            .iter()
            .map(|(y, series, marks)| fit_y(y, series, marks, &x_span))
            .collect();

        // Margins depend on labels and labels on margins: three rounds settle both.
        let em = size.font;
        let naming = |y: &Axis| (!y.names.is_empty()).then(|| Naming::of(&y.names, size));
        let (mut first, mut right, mut rows) = (0.0, 0.9 * em, 0);
        let mut layout = Self {
            figure,
            size,
            x_span,
            x_ticks: Ticks::default(),
            fields: Vec::new(),
            above: Vec::new(),
        };
        for _ in 0..3 {
            // Above the frame stands the ordinate's label; names need none.
            let label = if figure.y.names.is_empty() { 1.9 } else { 0.5 };
            let top = (label + rows as f64 * 1.25) * em;
            let bottom = match naming(&figure.y) {
                Some(naming) => top + figure.y.names.len() as f64 * naming.pitch() * em,
                None => size.height - BELOW * em,
            };
            let heights = [(top, bottom), (bottom + 2.4 * em, bottom + size.below)];
            let ticks: Vec<Ticks> = spans
                .iter()
                .zip(heights)
                .zip(&parts)
                .map(|((span, (from, to)), (y, _, _))| match naming(y) {
                    Some(_) => span.named(&y.names),
                    None => span.ticks(|t| spaced(t, to - from, |_| 0.9 * em, 1.0 * em)),
                })
                .collect();
            let left = ticks
                .iter()
                .zip(&parts)
                .filter(|(_, (y, _, _))| naming(y) != Some(Naming::Above))
                .map(|(t, _)| widest(t) * em)
                .fold(first, f64::max)
                + 0.7 * em;
            let plot_right = size.width - right;
            layout.x_ticks = x_span.ticks(|t| {
                spaced(
                    t,
                    plot_right - left,
                    |label| markup::width(label) * em,
                    1.8 * em,
                )
            });
            layout.fields = parts
                .iter()
                .zip(spans.iter().zip(ticks))
                .zip(heights)
                .map(
                    |(((y, series, marks), (span, ticks)), (top, bottom))| Field {
                        y,
                        series,
                        marks,
                        span: *span,
                        ticks,
                        naming: naming(y),
                        frame: Frame {
                            left,
                            top,
                            right: plot_right,
                            bottom,
                        },
                    },
                )
                .collect();
            let overhang = layout.x_ticks.ticks.iter().filter_map(|t| {
                let half = markup::width(t.label.as_deref()?) * em / 2.0;
                Some(half - (1.0 - t.at) * (plot_right - left) + 2.0)
            });
            right = overhang.fold(0.9 * em, f64::max);
            // Wide labels of the abscissa need room on the left, too, where names leave none. It is never given back:
            // with it the labels would come and go from round to round.
            first = layout
                .x_ticks
                .ticks
                .iter()
                .filter_map(|t| {
                    let half = markup::width(t.label.as_deref()?) * em / 2.0;
                    Some(half - t.at * (plot_right - left) - 0.6 * em)
                })
                .fold(first, f64::max);
            layout.above = layout.labels_above();
            rows = layout.rows_above();
        }
        layout
    }

    /// Height of the sheet, lower panel included.
    pub fn height(&self) -> f64 {
        let lowest = self.fields.last().map_or(0.0, |field| field.frame.bottom);
        lowest + BELOW * self.size.font
    }

    /// Labels of the figure's vertical guides, in as few rows as they need.
    fn labels_above(&self) -> Vec<Above<'a>> {
        let (em, frame) = (0.92 * self.size.font, self.fields[0].frame);
        let half_of = |label: &str| markup::width(label) * em / 2.0;
        let mut placed: Vec<Above<'a>> = Vec::new();
        for mark in &self.figure.marks {
            let Mark::Vertical { x, label } = mark else {
                continue;
            };
            let Some(at) = self.x_span.place(*x).filter(|at| (0.0..=1.0).contains(at)) else {
                continue;
            };
            if label.is_empty() {
                continue;
            }
            let half = half_of(label);
            let x = frame.across(at);
            let centre = x.clamp(
                half.min(self.size.width / 2.0),
                (self.size.width - half).max(half),
            );
            let free = |row: &usize| {
                placed
                    .iter()
                    .filter(|other| other.row == *row)
                    .all(|other| {
                        (other.centre - centre).abs() > half + half_of(other.label) + 0.8 * em
                    })
            };
            let row = (0..).find(free).unwrap_or(0);
            placed.push(Above {
                x,
                centre,
                row,
                label,
            });
        }
        placed
    }

    /// How many rows the labels above the frame take.
    pub fn rows_above(&self) -> usize {
        self.above
            .iter()
            .map(|above| above.row + 1)
            .max()
            .unwrap_or(0)
    }

    /// Where a value of a field stands on the sheet; `None` if it stands nowhere.
    pub fn place(&self, field: &Field<'_>, (x, y): (f64, f64)) -> Option<Point> {
        let f = field.frame;
        let (x, y) = (self.x_span.place(x)?, field.span.place(y)?);
        Some((f.across(x), f.up(y)))
    }

    /// Where the samples of a series stand.
    pub fn placed(&self, field: &Field<'_>, series: &Series) -> Vec<Option<Point>> {
        series
            .points
            .iter()
            .map(|point| self.place(field, *point))
            .collect()
    }

    /// Whether not a single sample has a place.
    pub fn is_empty(&self) -> bool {
        self.fields.iter().all(|field| {
            field
                .series
                .iter()
                .all(|s| s.points.iter().all(|p| self.place(field, *p).is_none()))
        })
    }
}

fn fit_y(axis: &Axis, series: &[Series], marks: &[Mark], x_span: &Span) -> Span {
    if !axis.names.is_empty() {
        return Span::of_names(axis.names.len());
    }
    let visible = |x: f64| {
        x_span
            .place(x)
            .is_some_and(|at| (-1e-9..=1.0 + 1e-9).contains(&at))
    };
    let points = series
        .iter()
        .flat_map(|s| &s.points)
        .filter(|p| visible(p.0))
        .map(|p| p.1);
    let guides = marks.iter().flat_map(|mark| match mark {
        Mark::Horizontal { y, .. } => vec![*y],
        Mark::Slope {
            y, slope, decades, ..
        } => vec![*y, y * 10f64.powf(slope * decades)],
        Mark::Vertical { .. } => vec![],
    });
    Span::fit(axis, points.chain(guides), 0.06)
}

/// Whether labels of the given extents keep `gap` between them on an axis of this length.
fn spaced(ticks: &Ticks, length: f64, extent: impl Fn(&str) -> f64, gap: f64) -> bool {
    let boxes: Vec<(f64, f64)> = ticks
        .ticks
        .iter()
        .filter_map(|t| Some((t.at * length, extent(t.label.as_deref()?) / 2.0)))
        .collect();
    boxes
        .windows(2)
        .all(|w| w[1].0 - w[1].1 - w[0].0 - w[0].1 >= gap)
}

/// Width of the widest label in units of the font size.
fn widest(ticks: &Ticks) -> f64 {
    ticks
        .ticks
        .iter()
        .filter_map(|t| t.label.as_deref())
        .map(markup::width)
        .fold(0.0, f64::max)
}
