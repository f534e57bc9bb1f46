//! Guides: lines at chosen values, slope triangles, and a place for their labels.

use super::figure::{Mark, Scale};
use super::ink::{Anchor, Ink, Pen};
use super::layout::{Field, Layout};
use super::markup;
use super::trace::{Frame, Point};

/// Draws the guides of a field, without their labels.
pub fn lines(layout: &Layout<'_>, pen: &mut Pen, field: &Field<'_>) {
    let f = field.frame;
    // A lower panel repeats the vertical guides of its figure.
    let upper = f == layout.fields[0].frame;
    let figure = layout.figure.marks.iter();
    let repeated = figure.filter(|mark| !upper && matches!(mark, Mark::Vertical { .. }));
    for mark in field.marks.iter().chain(repeated) {
        let line = match mark {
            Mark::Vertical { x, .. } => {
                let x = layout.x_span.place(*x).map(|at| f.across(at));
                x.map(|x| [(x, f.top), (x, f.bottom)])
            }
            Mark::Horizontal { y, .. } => {
                let y = field.span.place(*y).map(|at| f.up(at));
                y.map(|y| [(f.left, y), (f.right, y)])
            }
            Mark::Slope { .. } => {
                if let Some([foot, corner, tip]) = triangle(layout, field, mark) {
                    pen.stroke(&[foot, corner, tip, foot], Ink::Axis, 1.25);
                }
                None
            }
        };
        if let Some(line) = line.filter(|l| f.holds(l[0]) && f.holds(l[1])) {
            pen.stroke(&line, Ink::Mark, 1.25);
        }
    }
}

/// Writes the labels of horizontal guides and slope triangles where the fewest `strokes` and upright
/// guides pass.
pub fn labels(layout: &Layout<'_>, pen: &mut Pen, field: &Field<'_>, strokes: &[Vec<Point>]) {
    let em = 0.92 * layout.size.font;
    let f = field.frame;
    let upright: Vec<f64> = (layout.figure.marks.iter().chain(field.marks))
        .filter_map(|mark| match mark {
            Mark::Vertical { x, .. } => layout.x_span.place(*x),
            _ => None,
        })
        .map(|at| f.across(at))
        .collect();
    let mut taken: Vec<Frame> = Vec::new();
    for mark in field.marks {
        let (label, candidates) = match mark {
            Mark::Vertical { .. } => continue,
            Mark::Horizontal { y, label } => {
                let Some(at) = field.span.place(*y).filter(|at| (0.0..=1.0).contains(at)) else {
                    continue;
                };
                let y = f.up(at);
                let width = markup::width(label) * em;
                let room = (f.right - f.left - width - em).max(0.0);
                let lefts = [1.0, 0.0, 0.5, 0.75, 0.25].map(|s| f.left + 0.5 * em + s * room);
                let heights = [y - 0.75 * em, y + 0.8 * em];
                let places = lefts
                    .iter()
                    .flat_map(|l| heights.map(|h| (*l, h)))
                    .map(|(left, middle)| around(left, middle, width, em));
                (
                    label,
                    places
                        .filter(|b| b.top > f.top - em && b.bottom < f.bottom)
                        .collect(),
                )
            }
            Mark::Slope { label, .. } => {
                let Some([_, corner, tip]) = triangle(layout, field, mark) else {
                    continue;
                };
                let middle = (corner.1 + tip.1) / 2.0;
                (
                    label,
                    vec![around(
                        corner.0 + 0.45 * em,
                        middle,
                        markup::width(label) * em,
                        em,
                    )],
                )
            }
        };
        let crossed = |b: &Frame| {
            let by_strokes = strokes.iter().filter(|s| crosses(s, b)).count();
            let by_guides = upright
                .iter()
                .filter(|x| b.left < **x && **x < b.right)
                .count();
            by_strokes + by_guides + 10 * taken.iter().filter(|t| overlap(t, b)).count()
        };
        let candidates: Vec<Frame> = candidates;
        if label.is_empty() {
            continue;
        }
        if let Some(best) = candidates.into_iter().min_by_key(crossed) {
            let at = (best.left, (best.top + best.bottom) / 2.0);
            pen.text(label, at, Anchor::Start, em, Ink::Muted);
            taken.push(best);
        }
    }
}

/// Foot, right angle and tip of a slope triangle, if it lies in the frame.
fn triangle(layout: &Layout<'_>, field: &Field<'_>, mark: &Mark) -> Option<[Point; 3]> {
    let Mark::Slope {
        x,
        y,
        slope,
        decades,
        ..
    } = mark
    else {
        return None;
    };
    if layout.figure.x.scale != Scale::Log || field.y.scale != Scale::Log {
        return None;
    }
    let (far, high) = (x * 10f64.powf(*decades), y * 10f64.powf(slope * decades));
    let corners = [(*x, *y), (far, *y), (far, high)].map(|p| layout.place(field, p));
    let [Some(a), Some(b), Some(c)] = corners else {
        return None;
    };
    [a, b, c]
        .iter()
        .all(|p| field.frame.holds(*p))
        .then_some([a, b, c])
}

/// The box of a text that begins at `left`.
fn around(left: f64, middle: f64, width: f64, em: f64) -> Frame {
    Frame {
        left,
        top: middle - 0.65 * em,
        right: left + width,
        bottom: middle + 0.65 * em,
    }
}

fn crosses(stroke: &[Point], area: &Frame) -> bool {
    match stroke {
        [only] => area.holds(*only),
        _ => stroke.windows(2).any(|w| area.clip(w[0], w[1]).is_some()),
    }
}

fn overlap(a: &Frame, b: &Frame) -> bool {
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom
}
