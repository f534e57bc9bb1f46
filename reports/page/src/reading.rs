//! What a drawing says of itself, so that `figure.js` can read it by a pointer and enlarge it: attributes of the SVG element and of
//! its groups.
//!
//! | element | attribute |
//! |---|---|
//! | `svg` | `data-x`: the abscissa |
//! | `g`, one for the figure and one for its lower panel | `data-y`: the ordinate |
//! | in it `g.ticks` | ticks and grid of the abscissa |
//! | in it `g.data` | strokes that move with the abscissa; in it a `g` for each series with `data-name` and `data-colour` |
//! | `g` with `data-at` | the label of a vertical guide and where that stands |
//!
//! The points themselves are in the strokes: what a reader is told is what is drawn, within half a drawing unit
//! ([`super::ink::FINE`]) and a tenth of a page unit, by which a stroke may pass its samples.

use super::figure::{Axis, Figure, Scale, Series};
use super::ink::{FINE, PALETTE};
use super::layout::{Above, Field, Layout};
use super::markup::{escape, plain};
use super::scale::Span;
use super::trace::NOTHING;
use serde_json::{Value, json};

/// Attributes of the group of the abscissa's ticks.
pub const TICKS: &str = " class=\"ticks\"";

/// Attributes of the group of everything that moves with the abscissa.
pub const DATA: &str = " class=\"data\"";

fn axis(axis: &Axis, span: &Span, (begin, end): (f64, f64)) -> Value {
    let (from, to) = span.ends();
    let unit = |length: f64| (length * FINE).round();
    json!({
        "at": [unit(begin), unit(end)],
        "ends": [from, to],
        "log": axis.scale == Scale::Log && axis.names.is_empty(),
        "name": plain(&axis.label),
        "unit": plain(&axis.unit),
    })
}

fn attribute(name: &str, value: &Value) -> String {
    let text = value.to_string();
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    format!(" {name}='{}'", text.replace('\'', "&#39;"))
}

/// The abscissa: left and right end of the frame, the values there, the power of ten that its label states, and how
/// many drawing units a stroke may pass its samples by.
pub fn of_abscissa(layout: &Layout<'_>) -> String {
    let frame = layout.fields[0].frame;
    let (left, right) = (frame.left, frame.right);
    let mut x = axis(&layout.figure.x, &layout.x_span, (left, right));
    x["power"] = json!(layout.x_ticks.power);
    x["near"] = json!(NOTHING * FINE);
    attribute("data-x", &x)
}

/// An ordinate: lower and upper end of the frame, the values there, and its names, if it has names.
pub fn of_ordinate(field: &Field<'_>) -> String {
    let (bottom, top) = (field.frame.bottom, field.frame.top);
    let mut y = axis(field.y, &field.span, (bottom, top));
    if field.naming.is_some() {
        let names = field.y.names.iter();
        y["names"] = names.map(|name| plain(name)).collect();
    }
    attribute("data-y", &y)
}

/// A series: what its values are called, and its colour.
pub fn of_series(figure: &Figure, field: &Field<'_>, series: &Series) -> String {
    let name = escape(&plain(&name(figure, field, series)));
    format!(
        " data-name=\"{name}\" data-colour=\"{}\"",
        series.colour % PALETTE
    )
}

/// A series without a name of its own and without an entry in the legend has that of the same colour. In a lower panel the ordinate says of what it is.
fn name(figure: &Figure, field: &Field<'_>, series: &Series) -> String {
    for name in [&series.name, &series.label] {
        if !name.is_empty() {
            return name.clone();
        }
    }
    let alike = |other: &&Series| {
        !other.label.is_empty() && (other.kind, other.colour) == (series.kind, series.colour)
    };
    let all = figure.series.iter();
    let upper = core::ptr::eq(field.series, figure.series.as_slice());
    match all.clone().find(alike) {
        Some(other) if upper => other.label.clone(),
        Some(other) => format!("{}, {}", field.y.label, other.label),
        None => field.y.label.clone(),
    }
}

/// Where a vertical guide stands.
pub fn of_guide(above: &Above<'_>) -> String {
    format!(" data-at=\"{:.0}\"", above.x * FINE)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::layout::Size;
    use crate::plot::to_svg;

    /// Strokes of a piece of SVG, in drawing units.
    fn strokes(svg: &str) -> Vec<Vec<(f64, f64)>> {
        let data = svg
            .split(" d=\"M")
            .skip(1)
            .filter_map(|rest| rest.split('"').next());
        data.map(|data| {
            let parted = data.replace('-', " -").replace(['l', 'z'], " ");
            let numbers: Vec<f64> = parted
                .split_whitespace()
                .map(|number| number.parse().expect("a number"))
                .collect();
            let (pairs, rest) = numbers.as_chunks::<2>();
            assert!(rest.is_empty(), "{data}");
            let mut at = (0.0, 0.0);
            let step = |[dx, dy]: &[f64; 2]| {
                at = (at.0 + dx, at.1 + dy);
                at
            };
            pairs.iter().map(step).collect()
        })
        .collect()
    }

    /// Places of markers, in drawing units.
    fn places(svg: &str) -> Vec<(f64, f64)> {
        let places = svg.split("<use ").skip(1);
        let place = |rest: &str| {
            let mut numbers = rest.split('"').skip(3).step_by(2);
            let mut number = || numbers.next()?.parse().ok();
            Some((number()?, number()?))
        };
        places.map(|rest| place(rest).expect("a place")).collect()
    }

    /// All points of strokes and markers.
    pub(crate) fn points(svg: &str) -> Vec<(f64, f64)> {
        let strokes = strokes(svg).into_iter().flatten();
        strokes.chain(places(svg)).collect()
    }

    /// The value of an attribute.
    fn attribute_of(svg: &str, name: &str) -> Value {
        let (_, rest) = svg.split_once(&format!(" {name}='")).expect(name);
        let text = rest.split('\'').next().expect("its end");
        serde_json::from_str(&text.replace("&#39;", "'").replace("&lt;", "<")).expect("JSON")
    }

    /// Value at a place of an axis, as `figure.js` finds it.
    fn value(axis: &Value, at: f64) -> f64 {
        let number = |v: &Value| v.as_f64().expect("a number");
        let pair = |name: &str| (number(&axis[name][0]), number(&axis[name][1]));
        let ((begin, end), (from, to)) = (pair("at"), pair("ends"));
        let share = (at - begin) / (end - begin);
        if axis["log"] == true {
            10f64.powf(from.log10() + share * (to / from).log10())
        } else {
            from + share * (to - from)
        }
    }

    /// The group of a series.
    fn series<'a>(svg: &'a str, name: &str) -> &'a str {
        let begin = format!("<g data-name=\"{name}\"");
        let (_, rest) = svg.split_once(&begin).expect(name);
        rest.split("</g>\n<g data-name").next().expect("its end")
    }

    #[test]
    fn what_is_read_back_is_what_was_drawn() {
        // Corners that no simplification takes away.
        let samples: Vec<(f64, f64)> = (0..40)
            .map(|k| {
                let sign = f64::from(k % 2 * 2 - 1);
                (
                    1.0 + 0.317 * f64::from(k),
                    (5.0 * sign + 0.1 * f64::from(k)).exp2(),
                )
            })
            .collect();
        for (x, y) in [
            (Axis::linear("t", "s"), Axis::linear("a", "m/s²")),
            (Axis::log("f", "Hz"), Axis::log("a", "m/s²")),
        ] {
            let figure = Figure::new("f", "t", x, y)
                .line("line", 0, samples.iter().copied())
                .points("points", 1, samples.iter().copied());
            for size in [Size::STANDARD, Size::COMPACT] {
                let svg = to_svg(&figure, size);
                let (x, y) = (attribute_of(&svg, "data-x"), attribute_of(&svg, "data-y"));
                for name in ["line", "points"] {
                    let group = series(&svg, name);
                    let read = match name {
                        "line" => strokes(group).concat(),
                        _ => places(group),
                    };
                    let layout = Layout::of(&figure, size);
                    for (sample, at) in samples.iter().zip(&read) {
                        let (a, b) = (value(&x, at.0), value(&y, at.1));
                        let back = layout.place(&layout.fields[0], (a, b)).expect("a place");
                        let there = layout.place(&layout.fields[0], *sample).expect("a place");
                        // Half a unit of rounding in the point, and as much in the frame's ends.
                        let apart = (back.0 - there.0).abs().max((back.1 - there.1).abs());
                        assert!(apart <= 1.0 / FINE, "{name}: {sample:?} {at:?} {apart}");
                    }
                    assert_eq!(read.len(), samples.len(), "{name}");
                }
            }
        }
    }

    #[test]
    fn a_series_is_called_as_its_legend_calls_it() {
        let axis = || Axis::linear("a", "m/s²");
        let figure = Figure::new("f", "t", Axis::linear("t", "s"), axis())
            .line("truth's", 6, [(0.0, 0.0), (1.0, 1.0)])
            .line("", 6, [(0.0, 0.0), (1.0, 1.0)])
            .line("", 1, [(0.0, 0.0), (1.0, 1.0)])
            .below(Axis::linear("error", "m/s²"))
            .line("", 6, [(0.0, 0.0), (1.0, 1.0)])
            .line("", 2, [(0.0, 0.0), (1.0, 1.0)])
            .line("b", 2, [(0.0, 0.0), (1.0, 1.0)])
            .named("c");
        let svg = to_svg(&figure, Size::COMPACT);
        let names = svg.split("data-name=\"").skip(1);
        let names: Vec<_> = names.filter_map(|rest| rest.split('"').next()).collect();
        let expected = [
            "truth&#39;s",
            "truth&#39;s",
            "a",
            "error, truth&#39;s",
            "error",
            "c",
        ];
        assert_eq!(names, expected);
    }

    #[test]
    fn a_band_is_drawn_as_wide_as_it_is() {
        let edge = |sign: f64| {
            let samples = (0..1000).map(|k| {
                let wide = 1.0 + f64::from(k % 7);
                let y = if k == 500 { f64::NAN } else { sign * wide };
                (f64::from(k), y)
            });
            samples.collect()
        };
        let figure = Figure::new("f", "t", Axis::linear("t", "s"), Axis::linear("a", "g"));
        let figure = figure.band("± one", 0, [edge(-1.0), edge(1.0)]);
        let svg = to_svg(&figure, Size::STANDARD);
        let areas = strokes(series(&svg, "± one"));
        assert_eq!(areas.len(), 2);
        let (x, y) = (attribute_of(&svg, "data-x"), attribute_of(&svg, "data-y"));
        let values: Vec<Vec<(f64, f64)>> = areas
            .iter()
            .map(|area| {
                area.iter()
                    .map(|p| (value(&x, p.0), value(&y, p.1)))
                    .collect()
            })
            .collect();
        let ordinates = values.iter().flatten().map(|p| p.1);
        let (low, high) = ordinates.fold((f64::MAX, f64::MIN), |(a, b), y| (a.min(y), b.max(y)));
        assert!(
            (low + 7.0).abs() < 0.02 && (high - 7.0).abs() < 0.02,
            "{low} {high}"
        );
        // Once round: what a planimeter shows, against twice the widths between the samples.
        let round = |area: &Vec<(f64, f64)>| -> f64 {
            let after = area.iter().cycle().skip(1);
            let steps = area.iter().zip(after);
            steps.map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>() / 2.0
        };
        let wide = |k: u32| 1.0 + f64::from(k % 7);
        let between = |k: u32| wide(k) + wide(k + 1);
        let expected: f64 = (0..499).chain(501..999).map(between).sum();
        let area: f64 = values.iter().map(round).sum();
        assert!((area / expected - 1.0).abs() < 0.02, "{area} {expected}");
    }
}
