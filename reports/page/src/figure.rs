//! The description of a figure: data and words, no drawing.
//!
//! Everything is plain and public; the constructors only save typing. Drawing is [`super::plot`]'s.

use serde::Serialize;

/// Palette index of the neutral grey, for truth and theory.
pub const NEUTRAL: usize = 6;

/// Points from two columns of the same length.
pub fn paired(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    x.iter().copied().zip(y.iter().copied()).collect()
}

/// How an axis maps values to distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Equal differences are equal distances.
    #[default]
    Linear,
    /// Equal ratios are equal distances; values that are not positive are not drawn.
    Log,
}

/// One axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// What is plotted, as inline text.
    pub label: String,
    /// Its unit, printed in brackets after the label; empty for a pure number.
    pub unit: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Fixed ends; `None` fits the data and the marks. Data outside are clipped, not moved.
    pub range: Option<(f64, f64)>,
    /// Names instead of numbers, of an ordinate only: the first stands at 0 and at the top, the next at 1 below it. A
    /// figure with names is as high as they need; scale and range are not looked at.
    pub names: Vec<String>,
}

impl Axis {
    /// A linear axis that fits its data.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            unit: unit.into(),
            ..Self::default()
        }
    }

    /// A logarithmic axis that fits its data.
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            scale: Scale::Log,
            ..Self::linear(label, unit)
        }
    }

    /// An ordinate of names.
    pub fn names(
        label: impl Into<String>,
        names: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        Self {
            names: names.into_iter().map(Into::into).collect(),
            ..Self::linear(label, "")
        }
    }

    /// The same axis with fixed ends.
    #[must_use]
    pub fn range(mut self, from: f64, to: f64) -> Self {
        self.range = Some((from, to));
        self
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A full line.
    #[default]
    Line,
    /// A broken line, for a theory or a reference.
    Dashed,
    /// Markers alone. The marker's shape follows the colour index, so that colour is never the
    /// only difference.
    Points,
    /// Markers joined by a thin line.
    LinePoints,
    /// An area: samples go once round it, along the lower edge and back along the upper one.
    Band,
}

impl Kind {
    /// Whether its samples are marked one by one.
    pub fn has_markers(self) -> bool {
        matches!(self, Self::Points | Self::LinePoints)
    }
}

/// One curve.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Series {
    /// Legend text; a series with an empty label has no legend entry.
    pub label: String,
    /// What a read-out calls it; if empty, as the legend does, or as the series of the same colour is called.
    pub name: String,
    /// Samples in drawing order. A point with a non-finite coordinate (or, on a logarithmic axis,
    /// a non-positive one) is not drawn and breaks the line.
    #[serde(skip_serializing)]
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub kind: Kind,
    /// Index into the palette, modulo [`super::ink::PALETTE`].
    pub colour: usize,
}

/// A guide on top of the data.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Mark {
    /// A full-height line at one abscissa.
    Vertical {
        /// Where.
        x: f64,
        /// Short text at its upper end; may be empty.
        label: String,
    },
    /// A full-width line at one ordinate.
    Horizontal {
        /// Where.
        y: f64,
        /// Short text above its right end; may be empty.
        label: String,
    },
    /// A slope triangle: from `(x, y)` over `decades` decades of x with `slope` decades of y per
    /// decade of x. Drawn only if both axes are logarithmic.
    Slope {
        /// Abscissa of the triangle's foot.
        x: f64,
        /// Ordinate of the triangle's foot.
        y: f64,
        /// Decades of y per decade of x.
        slope: f64,
        /// Width in decades of x.
        decades: f64,
        /// Text beside the upright side, usually the slope itself.
        label: String,
    },
}

/// A second, lower panel that shares a figure's x axis, usually for the error of what is above. Vertical guides of the
/// figure are repeated in it without their labels.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Panel {
    /// Its own ordinate.
    pub y: Axis,
    /// Its own series.
    pub series: Vec<Series>,
}

/// One figure.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Figure {
    /// Anchor, unique on its page: letters, digits and hyphens.
    pub id: String,
    /// A short title, printed above.
    pub title: String,
    /// What to see in it, inline text printed below; may be empty.
    pub caption: String,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// Curves, drawn in this order.
    pub series: Vec<Series>,
    /// Guides.
    pub marks: Vec<Mark>,
    /// A lower panel with the same abscissa.
    pub below: Option<Panel>,
}

impl Figure {
    /// A figure without data yet.
    pub fn new(id: impl Into<String>, title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            id: id.into(),
            title: title.into(),
            x,
            y,
            ..Self::default()
        }
    }

    /// Sets the caption.
    #[must_use]
    pub fn caption(mut self, text: impl Into<String>) -> Self {
        self.caption = text.into();
        self
    }

    /// Adds a full line. Of this and of the other kinds of curve: once there is a lower panel, it is added there.
    #[must_use]
    pub fn line(
        self,
        label: impl Into<String>,
        colour: usize,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        self.curve(label, Kind::Line, colour, points)
    }

    /// Adds a broken line.
    #[must_use]
    pub fn dashed(
        self,
        label: impl Into<String>,
        colour: usize,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        self.curve(label, Kind::Dashed, colour, points)
    }

    /// Adds markers alone.
    #[must_use]
    pub fn points(
        self,
        label: impl Into<String>,
        colour: usize,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        self.curve(label, Kind::Points, colour, points)
    }

    /// Adds markers joined by a thin line.
    #[must_use]
    pub fn line_points(
        self,
        label: impl Into<String>,
        colour: usize,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        self.curve(label, Kind::LinePoints, colour, points)
    }

    /// Adds an area between two edges, the lower one and the upper one, each in drawing order. A point that is not finite parts it
    /// and stands in both.
    #[must_use]
    pub fn band(
        self,
        label: impl Into<String>,
        colour: usize,
        [lower, upper]: [Vec<(f64, f64)>; 2],
    ) -> Self {
        let gap = |point: &(f64, f64)| !point.1.is_finite();
        let mut outline = Vec::new();
        for (lower, upper) in lower.split(gap).zip(upper.split(gap)) {
            outline.extend_from_slice(lower);
            outline.extend(upper.iter().rev());
            outline.push((f64::NAN, f64::NAN));
        }
        self.curve(label, Kind::Band, colour, outline)
    }

    fn curve(
        mut self,
        label: impl Into<String>,
        kind: Kind,
        colour: usize,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        let panel = self.below.as_mut();
        let series = panel.map_or(&mut self.series, |panel| &mut panel.series);
        series.push(Series {
            label: label.into(),
            name: String::new(),
            points: points.into_iter().collect(),
            kind,
            colour,
        });
        self
    }

    /// Names the curve that was added last for a read-out.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        let panel = self.below.as_mut();
        let series = panel.map_or(&mut self.series, |panel| &mut panel.series);
        if let Some(last) = series.last_mut() {
            last.name = name.into();
        }
        self
    }

    /// Adds a full-height line.
    #[must_use]
    pub fn vertical(mut self, x: f64, label: impl Into<String>) -> Self {
        let label = label.into();
        self.marks.push(Mark::Vertical { x, label });
        self
    }

    /// Adds a full-width line.
    #[must_use]
    pub fn horizontal(mut self, y: f64, label: impl Into<String>) -> Self {
        let label = label.into();
        self.marks.push(Mark::Horizontal { y, label });
        self
    }

    /// Adds a slope triangle.
    #[must_use]
    pub fn slope(
        mut self,
        (x, y): (f64, f64),
        slope: f64,
        decades: f64,
        label: impl Into<String>,
    ) -> Self {
        let label = label.into();
        self.marks.push(Mark::Slope {
            x,
            y,
            slope,
            decades,
            label,
        });
        self
    }

    /// Adds a lower panel with this ordinate. The curves that follow belong to it.
    #[must_use]
    pub fn below(mut self, y: Axis) -> Self {
        let series = Vec::new();
        self.below = Some(Panel { y, series });
        self
    }
}
