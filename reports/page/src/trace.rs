//! How samples become strokes: gaps, decimation, simplification, clipping.
//!
//! Works in page units (CSS pixels of the unscaled figure). A long record keeps, for each column of
//! half a pixel, its first, smallest, largest and last sample, so that no peak is lost.

/// A point in page units.
pub type Point = (f64, f64);

/// A rectangle in page units, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
}

/// Columns in which a long record is looked at, per page unit: more than one, so that a drawing can be enlarged.
const COLUMNS: f64 = 2.0;

/// Distance that nobody sees, in page units: strokes pass their samples by no more.
pub const NOTHING: f64 = 0.1;

/// What rounding may put a point on an edge beyond it, in page units.
const HAIR: f64 = 1e-6;

impl Frame {
    /// Where a share of the width stands, counted from the left.
    pub fn across(&self, share: f64) -> f64 {
        self.left + share * (self.right - self.left)
    }

    /// Where a share of the height stands, counted from below.
    pub fn up(&self, share: f64) -> f64 {
        self.bottom - share * (self.bottom - self.top)
    }

    /// Whether a point lies inside or on the edge (with a hair's tolerance).
    pub fn holds(&self, (x, y): Point) -> bool {
        x >= self.left - HAIR
            && x <= self.right + HAIR
            && y >= self.top - HAIR
            && y <= self.bottom + HAIR
    }

    /// The part of a segment inside the frame (Liang and Barsky); one along an edge is inside.
    pub fn clip(&self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        for (step, room) in [
            (-dx, a.0 - self.left),
            (dx, self.right - a.0),
            (-dy, a.1 - self.top),
            (dy, self.bottom - a.1),
        ] {
            if step == 0.0 {
                if room < -HAIR {
                    return None;
                }
            } else if step < 0.0 {
                enter = enter.max(room / step);
            } else {
                leave = leave.min(room / step);
            }
        }
        (enter <= leave).then(|| {
            let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
            (at(enter), at(leave))
        })
    }
}

/// Strokes for a series of placed samples; `None` marks a sample that has no place. A sample alone
/// between two gaps becomes a stroke without length, which round caps show as a dot.
pub fn strokes(placed: &[Option<Point>], frame: &Frame) -> Vec<Vec<Point>> {
    placed
        .split(Option::is_none)
        .map(|run| run.iter().copied().flatten().collect::<Vec<_>>())
        .filter(|run| !run.is_empty())
        .map(|run| if run.len() == 1 { vec![run[0]; 2] } else { run })
        .flat_map(|run| clip(&thin(&run), frame))
        .map(|stroke| simplify(&stroke, NOTHING))
        .collect()
}

/// Samples for markers: inside the frame, and no two nearer than half a pixel.
pub fn markers(placed: &[Option<Point>], frame: &Frame) -> Vec<Point> {
    let mut seen = std::collections::HashSet::new();
    placed
        .iter()
        .copied()
        .flatten()
        .filter(|point| frame.holds(*point))
        .filter(|(x, y)| seen.insert(((x * 2.0).round() as i64, (y * 2.0).round() as i64)))
        .collect()
}

/// The column of a point.
fn column_of((x, _): Point) -> i64 {
    (x * COLUMNS).floor() as i64
}

/// First, smallest, largest and last sample of each column, in their order.
fn thin(run: &[Point]) -> Vec<Point> {
    if run.windows(2).any(|w| w[1].0 < w[0].0) {
        // A curve that runs back has no columns; it loses only what no eye can tell apart.
        let cell = |p: &Point| ((p.0 * 4.0).floor() as i64, (p.1 * 4.0).floor() as i64);
        return run
            .chunk_by(|a, b| cell(a) == cell(b))
            .map(|group| group[0])
            .collect();
    }
    run.chunk_by(|a, b| column_of(*a) == column_of(*b))
        .flat_map(|column| {
            let by_y = |a: &usize, b: &usize| column[*a].1.total_cmp(&column[*b].1);
            let low = (0..column.len()).min_by(by_y).unwrap_or(0);
            let high = (0..column.len()).max_by(by_y).unwrap_or(0);
            let mut keep = [0, low, high, column.len() - 1];
            keep.sort_unstable();
            let mut last = usize::MAX;
            keep.into_iter()
                .filter(|i| std::mem::replace(&mut last, *i) != *i)
                .map(|i| column[i])
                .collect::<Vec<_>>()
        })
        .collect()
}

/// Outlines of areas whose placed samples go along the lower edge and back along the upper one; `None` parts them. What lies above or
/// below the frame ends at its edge; what lies beside it is left out.
pub fn bands(placed: &[Option<Point>], frame: &Frame) -> Vec<Vec<Point>> {
    let beside = |x: f64| x < frame.left - HAIR || x > frame.right + HAIR;
    let mut areas = Vec::new();
    for run in placed.split(Option::is_none) {
        let inside = run.iter().copied().flatten().filter(|(x, _)| !beside(*x));
        let mut lower: Vec<Point> = inside
            .map(|(x, y)| (x, y.clamp(frame.top, frame.bottom)))
            .collect();
        let turn = lower.windows(2).position(|w| w[1].0 < w[0].0);
        let mut upper = lower.split_off(turn.map_or(lower.len(), |last| last + 1));
        upper.reverse();
        let edges = [lower, upper].map(|edge| match edge.len() {
            0 => edge,
            _ => simplify(&thin(&edge), NOTHING),
        });
        let [mut outline, upper] = edges;
        outline.extend(upper.into_iter().rev());
        if !outline.is_empty() {
            areas.push(outline);
        }
    }
    areas
}

fn clip(run: &[Point], frame: &Frame) -> Vec<Vec<Point>> {
    let mut out: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for pair in run.windows(2) {
        match frame.clip(pair[0], pair[1]) {
            Some((a, b)) => {
                match out.last_mut() {
                    Some(stroke) if open => stroke.push(b),
                    _ => out.push(vec![a, b]),
                }
                open = frame.holds(pair[1]);
            }
            None => open = false,
        }
    }
    out
}

/// Leaves out points nearer than `tolerance` to the stroke without them (Douglas and Peucker).
fn simplify(stroke: &[Point], tolerance: f64) -> Vec<Point> {
    let mut keep = vec![false; stroke.len()];
    let last = stroke.len().saturating_sub(1);
    keep[0] = true;
    keep[last] = true;
    let mut todo = vec![(0, last)];
    while let Some((a, b)) = todo.pop() {
        let farthest = (a + 1..b)
            .map(|i| (i, distance(stroke[i], stroke[a], stroke[b])))
            .max_by(|p, q| p.1.total_cmp(&q.1));
        if let Some((i, far)) = farthest
            && far > tolerance
        {
            keep[i] = true;
            todo.push((a, i));
            todo.push((i, b));
        }
    }
    stroke
        .iter()
        .zip(keep)
        .filter_map(|(point, kept)| kept.then_some(*point))
        .collect()
}

/// Distance of a point from a segment.
fn distance(p: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length2 = dx * dx + dy * dy;
    let t = if length2 == 0.0 {
        0.0
    } else {
        (((p.0 - a.0) * dx + (p.1 - a.1) * dy) / length2).clamp(0.0, 1.0)
    };
    (p.0 - a.0 - t * dx).hypot(p.1 - a.1 - t * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame {
        left: 0.0,
        top: 0.0,
        right: 100.0,
        bottom: 50.0,
    };

    #[test]
    fn a_gap_breaks_the_line() {
        let placed = [
            Some((0.0, 1.0)),
            Some((1.0, 2.0)),
            None,
            Some((3.0, 1.0)),
            Some((4.0, 9.0)),
        ];
        assert_eq!(strokes(&placed, &FRAME).len(), 2);
    }

    #[test]
    fn a_single_peak_survives_decimation() {
        let mut placed: Vec<_> = (0..1_000_000)
            .map(|i| Some((f64::from(i) * 1e-4, 25.0)))
            .collect();
        placed[654_321] = Some((65.4321, 3.0));
        let found = strokes(&placed, &FRAME);
        let points = found.concat();
        assert!(points.len() < 10, "{} points", points.len());
        assert!(points.contains(&(65.4321, 3.0)));
    }

    #[test]
    fn outside_is_clipped_not_moved() {
        let placed = [
            Some((-10.0, 25.0)),
            Some((50.0, 25.0)),
            Some((50.0, 500.0)),
            Some((60.0, 10.0)),
        ];
        let found = strokes(&placed, &FRAME);
        assert_eq!(found.len(), 2);
        assert_eq!(found[0], [(0.0, 25.0), (50.0, 25.0), (50.0, 50.0)]);
        assert!(found.concat().into_iter().all(|p| FRAME.holds(p)));
    }

    #[test]
    fn a_stroke_along_an_edge_is_kept() {
        for y in [-1e-13, 0.0, 50.0, 50.0 + 1e-13] {
            let placed = [Some((0.0, 25.0)), Some((40.0, y)), Some((90.0, y))];
            let last = strokes(&placed, &FRAME).concat().pop();
            assert_eq!(last, Some((90.0, y)));
        }
    }

    #[test]
    fn smooth_curves_need_few_points() {
        let sine = |i: i32| {
            (
                f64::from(i) * 1e-3,
                25.0 + 20.0 * (f64::from(i) * 2e-4).sin(),
            )
        };
        let placed: Vec<_> = (0..100_000).map(|i| Some(sine(i))).collect();
        let kept = strokes(&placed, &FRAME).concat();
        assert!(kept.len() < 120, "{}", kept.len());
    }

    #[test]
    fn markers_do_not_pile_up() {
        let placed: Vec<_> = (0..1000)
            .map(|i| Some((f64::from(i) * 1e-3, 5.0)))
            .collect();
        assert!(markers(&placed, &FRAME).len() <= 3);
        assert!(markers(&[Some((200.0, 5.0)), None], &FRAME).is_empty());
    }
}
