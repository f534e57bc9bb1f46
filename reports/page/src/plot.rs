//! A figure as SVG.
//!
//! Each figure can be drawn at several sizes, because a drawing made for a wide page has
//! unreadable words on a phone: the page holds two and shows the one that fits. Words on axes are
//! horizontal, the legend stands outside ([`legend`]), labels of vertical guides stand above the
//! frame and those of horizontal guides where the fewest strokes pass.

use super::figure::{Axis, Figure, Kind, Series};
use super::guide;
use super::ink::{Anchor, FINE, Ink, Pen};
use super::layout::{Field, Layout, Naming, Size};
use super::markup;
use super::number;
use super::reading;
use super::scale::Span;
use super::trace::{self, Point};

/// Draws a figure at a given size.
pub fn to_svg(figure: &Figure, size: Size) -> String {
    let layout = Layout::of(figure, size);
    let height = layout.height();
    let mut pen = Pen::default();
    let id = format!("{}-{}", markup::escape(&figure.id), size.name);
    draw(&layout, &id, &mut pen);
    let body = pen.into_svg();
    format!(
        "<svg class=\"plot\" xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" \
         aria-labelledby=\"{id}-t {id}-d\" viewBox=\"0 0 {:.0} {:.0}\"{} \
         style=\"font-family:var(--sans,system-ui,sans-serif)\" stroke-linejoin=\"round\" \
         stroke-linecap=\"round\">\n<title id=\"{id}-t\">{}</title>\n<desc id=\"{id}-d\">{}</desc>\n\
         {body}</svg>",
        size.width * FINE,
        height * FINE,
        reading::of_abscissa(&layout),
        markup::escape(&markup::plain(&figure.title)),
        markup::escape(&description(&layout)),
    )
}

/// A legend's sample of a series: 14 page units high, 14 or 30 wide.
pub fn legend(series: &Series) -> String {
    let (width, height) = match series.kind {
        Kind::Points => (14.0, 14.0),
        _ => (30.0, 14.0),
    };
    let middle = height / 2.0;
    let mut pen = Pen::default();
    if series.kind == Kind::Band {
        let (left, right, top, bottom) = (2.0, width - 2.0, 2.0, height - 2.0);
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        pen.area(&corners, Ink::Band(series.colour));
    }
    draw_line(&mut pen, series, &[(2.0, middle), (width - 2.0, middle)]);
    if series.kind.has_markers() {
        pen.marker((width / 2.0, middle), series.colour, 4.0);
    }
    format!(
        "<svg class=\"swatch\" aria-hidden=\"true\" viewBox=\"0 0 {:.0} {:.0}\" \
         stroke-linecap=\"round\">{}</svg>",
        width * FINE,
        height * FINE,
        pen.into_svg()
    )
}

fn draw_line(pen: &mut Pen, series: &Series, points: &[Point]) {
    match series.kind {
        Kind::Line => pen.stroke(points, Ink::Series(series.colour), 1.75),
        Kind::Dashed => pen.stroke(points, Ink::Dashed(series.colour), 1.75),
        Kind::LinePoints => pen.stroke(points, Ink::Series(series.colour), 1.25),
        Kind::Points | Kind::Band => {}
    }
}

fn draw(layout: &Layout<'_>, id: &str, pen: &mut Pen) {
    let em = layout.size.font;
    for (i, field) in layout.fields.iter().enumerate() {
        pen.begin(&reading::of_ordinate(field));
        draw_axes(layout, pen, field, i + 1 == layout.fields.len());
        draw_data(layout, &format!("{id}-{i}"), pen, field);
        pen.end();
        if field.naming.is_some() {
            // What the names are, they say themselves.
            draw_names(layout, pen, field);
            continue;
        }
        let rows = if i == 0 { layout.rows_above() } else { 0 };
        let y = field.frame.top - (1.15 + rows as f64 * 1.25) * em;
        axis_text(
            layout,
            pen,
            &axis_label(field.y, field.ticks.power),
            (0.0, y),
            Anchor::Start,
        );
    }
    let top = layout.fields[0].frame.top;
    // Strokes first: a label's halo parts those that pass it.
    for above in &layout.above {
        let foot = top - above.row as f64 * 1.25 * em;
        pen.begin(&reading::of_guide(above));
        pen.stroke(&[(above.x, top), (above.x, foot)], Ink::Mark, 1.25);
        pen.end();
    }
    for above in &layout.above {
        let y = top - (0.75 + above.row as f64 * 1.25) * em;
        pen.begin(&reading::of_guide(above));
        pen.text(
            above.label,
            (above.centre, y),
            Anchor::Middle,
            0.92 * em,
            Ink::Muted,
        );
        pen.end();
    }
    if layout.is_empty() {
        let f = layout.fields[0].frame;
        let middle = ((f.left + f.right) / 2.0, (f.top + f.bottom) / 2.0);
        pen.text("no data", middle, Anchor::Middle, em, Ink::Muted);
    }
}

fn axis_text(layout: &Layout<'_>, pen: &mut Pen, text: &str, at: Point, anchor: Anchor) {
    let fit = (layout.size.width / markup::width(text).max(1e-9)).min(layout.size.font);
    pen.text(text, at, anchor, fit, Ink::Text);
}

fn draw_axes(layout: &Layout<'_>, pen: &mut Pen, field: &Field<'_>, lowest: bool) {
    let (em, f) = (layout.size.font, field.frame);
    for tick in &field.ticks.ticks {
        let y = f.up(tick.at);
        match &tick.label {
            Some(label) => {
                pen.stroke(&[(f.left, y), (f.right, y)], Ink::Grid, 1.0);
                if field.naming.is_none() {
                    let at = (f.left - 0.5 * em, y);
                    pen.text(label, at, Anchor::End, em, Ink::Muted);
                }
            }
            None => pen.stroke(&[(f.left, y), (f.left + 4.0, y)], Ink::Axis, 0.75),
        }
    }
    pen.begin(reading::TICKS);
    for tick in &layout.x_ticks.ticks {
        let x = f.across(tick.at);
        match &tick.label {
            Some(label) => {
                pen.stroke(&[(x, f.top), (x, f.bottom)], Ink::Grid, 1.0);
                if lowest {
                    let at = (x, f.bottom + 1.0 * em);
                    pen.text(label, at, Anchor::Middle, em, Ink::Muted);
                }
            }
            None => pen.stroke(&[(x, f.bottom - 4.0), (x, f.bottom)], Ink::Axis, 0.75),
        }
    }
    pen.end();
    pen.stroke(
        &[(f.left, f.top), (f.left, f.bottom), (f.right, f.bottom)],
        Ink::Axis,
        1.0,
    );
    if lowest {
        let text = axis_label(&layout.figure.x, layout.x_ticks.power);
        let at = ((f.left + f.right) / 2.0, f.bottom + 2.45 * em);
        axis_text(layout, pen, &text, at, Anchor::Middle);
    }
}

/// The names of an ordinate. In the frame they come after the guides, whose lines their halo parts.
fn draw_names(layout: &Layout<'_>, pen: &mut Pen, field: &Field<'_>) {
    let (em, f) = (layout.size.font, field.frame);
    for tick in &field.ticks.ticks {
        let Some(name) = &tick.label else { continue };
        let y = f.up(tick.at);
        if field.naming == Some(Naming::Above) {
            let room = f.right - f.left - 0.5 * em;
            let fit = (room / markup::width(name).max(1e-9)).min(0.95 * em);
            let at = (f.left + 0.4 * em, y - 0.95 * em);
            pen.text(name, at, Anchor::Start, fit, Ink::Muted);
        } else {
            pen.text(name, (f.left - 0.5 * em, y), Anchor::End, em, Ink::Muted);
        }
    }
}

fn draw_data(layout: &Layout<'_>, id: &str, pen: &mut Pen, field: &Field<'_>) {
    pen.begin(reading::DATA);
    guide::lines(layout, pen, field);
    let mut all = Vec::new();
    for (i, series) in field.series.iter().enumerate() {
        let placed = layout.placed(field, series);
        pen.begin(&reading::of_series(layout.figure, field, series));
        if series.kind == Kind::Band {
            for area in trace::bands(&placed, &field.frame) {
                pen.area(&area, Ink::Band(series.colour));
            }
        } else if series.kind != Kind::Points {
            let strokes = trace::strokes(&placed, &field.frame);
            for stroke in &strokes {
                draw_line(pen, series, stroke);
            }
            all.extend(strokes);
        }
        if series.kind.has_markers() {
            let markers = trace::markers(&placed, &field.frame);
            let radius = match markers.len() {
                0..100 => 3.2,
                100..400 => 2.4,
                _ => 1.6,
            };
            pen.markers(&format!("{id}-{i}"), &markers, series.colour, radius);
            all.extend(markers.iter().map(|at| vec![*at]));
        }
        pen.end();
    }
    pen.end();
    guide::labels(layout, pen, field, &all);
}

/// Label, power of ten and unit of an axis.
fn axis_label(axis: &Axis, power: i32) -> String {
    let ten = format!("10{}", number::superscript(power));
    match (axis.unit.is_empty(), power) {
        (true, 0) => axis.label.clone(),
        (false, 0) => format!("{} ({})", axis.label, axis.unit),
        (true, _) => format!("{} (×{ten})", axis.label),
        (false, _) => format!("{} ({ten} {})", axis.label, axis.unit),
    }
}

/// What a reader who cannot see the figure is told.
fn description(layout: &Layout<'_>) -> String {
    let axis = |axis: &Axis, span: &Span| {
        let (from, to) = span.ends();
        format!(
            "{} from {} to {}",
            markup::plain(&axis_label(axis, 0)),
            number::significant(from, 2),
            number::significant(to, 2)
        )
    };
    let mut text = format!("Abscissa: {}.", axis(&layout.figure.x, &layout.x_span));
    for field in &layout.fields {
        text += &if field.y.names.is_empty() {
            format!(" Ordinate: {}.", axis(field.y, &field.span))
        } else {
            let names: Vec<_> = field.y.names.iter().map(|n| markup::plain(n)).collect();
            format!(
                " One row for each {}: {}.",
                markup::plain(&field.y.label),
                names.join("; ")
            )
        };
        let labels: Vec<_> = field
            .series
            .iter()
            .map(|s| markup::plain(&s.label))
            .filter(|l| !l.is_empty())
            .collect();
        if !labels.is_empty() {
            text += &format!(" Curves: {}.", labels.join("; "));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(x: Axis, y: Axis, points: &[(f64, f64)]) -> Figure {
        Figure::new("f", "t", x, y)
            .line("line", 0, points.iter().copied())
            .points("points", 1, points.iter().copied())
            .vertical(
                2.0,
                "a label far wider than the whole compact sheet could ever be",
            )
            .horizontal(f64::NAN, "nowhere")
            .slope((1.0, 1.0), 2.0, 1.0, "2")
    }

    #[test]
    fn nothing_is_drawn_off_the_sheet() {
        let points: Vec<_> = (1..400)
            .map(|i| (f64::from(i), f64::from(i).sin() * 1e3))
            .collect();
        let figure = figure(
            Axis::linear("x", "s").range(10.0, 20.0),
            Axis::linear("y", "").range(-1.0, 1.0),
            &points,
        );
        for size in [Size::STANDARD, Size::COMPACT] {
            let svg = to_svg(&figure, size);
            for (x, y) in crate::reading::tests::points(&svg) {
                assert!((0.0..=size.width * FINE).contains(&x), "{x}");
                assert!((0.0..=size.height * FINE).contains(&y), "{y}");
            }
        }
    }

    #[test]
    fn hostile_data_are_drawn_or_left_out() {
        let wild = [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            0.0,
            -0.0,
            1e-320,
            -1e-200,
            f64::MAX,
            f64::MIN,
            1e150,
            -1e150,
            1e-150,
            1.0,
            1.0 + f64::EPSILON,
        ];
        let axes = [Axis::linear("l", ""), Axis::log("g", "")];
        for (x, y) in axes.iter().flat_map(|x| axes.iter().map(move |y| (x, y))) {
            for a in wild {
                for b in wild {
                    let points = [(a, b), (b, a), (a, a)];
                    let svg = to_svg(&figure(x.clone(), y.clone(), &points), Size::STANDARD);
                    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{a} {b}");
                }
            }
        }
        let empty =
            Figure::new("f", "t", Axis::log("x", ""), Axis::default()).below(Axis::log("e", ""));
        assert!(to_svg(&empty, Size::STANDARD).contains("no data"));
    }

    #[test]
    fn names_take_the_height_they_need_and_the_abscissa_stays_on_the_sheet() {
        let height = |count: usize, length: usize, size| {
            let names = (0..count).map(|i| format!("{i} {}", "name ".repeat(length)));
            let figure = Figure::new(
                "f",
                "t",
                Axis::log("x", "").range(1e-9, 1e3),
                Axis::names("n", names),
            )
            .points("p", 0, (0..count).map(|i| (1.0, i as f64)));
            let layout = Layout::of(&figure, size);
            let first = layout.x_ticks.ticks.iter().find_map(|t| {
                let half = markup::width(t.label.as_deref()?) * size.font / 2.0;
                let frame = layout.fields[0].frame;
                Some(frame.across(t.at) - half)
            });
            assert!(first >= Some(0.0), "{first:?}");
            let svg = to_svg(&figure, size);
            assert!((0..count).all(|i| svg.contains(&format!(">{i} name"))));
            layout.height()
        };
        for size in [Size::STANDARD, Size::COMPACT] {
            assert!(height(30, 1, size) > 3.0 * height(5, 1, size));
            // Names too long to stand beside the frame stand in it, on rows of their own.
            assert!(height(30, 12, size) > 1.4 * height(30, 1, size));
        }
    }

    #[test]
    fn units_and_powers_of_ten_stand_in_the_label() {
        assert_eq!(axis_label(&Axis::linear("k", "s⁻²"), 8), "k (10⁸ s⁻²)");
        assert_eq!(axis_label(&Axis::linear("k", ""), -6), "k (×10⁻⁶)");
        assert_eq!(axis_label(&Axis::linear("k", ""), 0), "k");
    }
}
