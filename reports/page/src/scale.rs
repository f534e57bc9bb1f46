//! Where an axis begins, where its ticks go and how they are labelled.
//!
//! Positions are shares of the axis: 0 at its beginning, 1 at its end.

use super::figure::{Axis, Scale};
use super::number;

/// An axis with known ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    scale: Scale,
    from: f64,
    to: f64,
}

/// One tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Position on the axis, 0 to 1.
    pub at: f64,
    /// Its label; `None` for a minor tick.
    pub label: Option<String>,
}

/// The ticks of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ticks {
    /// Major and minor ticks.
    pub ticks: Vec<Tick>,
    /// Labels are to be multiplied by ten to this power, which belongs into the axis' label.
    pub power: i32,
}

impl Span {
    /// Ends from the axis' fixed range, or else from the values with `margin` (a share of the
    /// whole) left free on both sides.
    pub fn fit(axis: &Axis, values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let scale = axis.scale;
        let usable = |v: f64| forward(scale, v).is_finite();
        if let Some((a, b)) = axis.range
            && usable(a)
            && usable(b)
            && a < b
        {
            return Self {
                scale,
                from: a,
                to: b,
            };
        }
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in values
            .into_iter()
            .filter(|v| usable(*v))
            .map(|v| forward(scale, v))
        {
            lo = lo.min(v);
            hi = hi.max(v);
        }
        if lo > hi {
            (lo, hi) = (0.0, 1.0);
        }
        let whole = hi - lo;
        // A flat line still needs an axis around it.
        let pad = match scale {
            _ if whole > 1e-12 * lo.abs().max(hi.abs()) => whole * margin,
            Scale::Log => 0.5,
            Scale::Linear if lo == 0.0 => 1.0,
            Scale::Linear => 0.05 * lo.abs(),
        };
        Self {
            scale,
            from: backward(scale, lo - pad),
            to: backward(scale, hi + pad),
        }
    }

    /// The axis of `count` names: 0 near its far end, so that on an ordinate the first stands at the top.
    pub fn of_names(count: usize) -> Self {
        Self {
            scale: Scale::Linear,
            from: count.max(1) as f64 - 0.5,
            to: -0.5,
        }
    }

    /// One tick for each name.
    pub fn named(&self, names: &[String]) -> Ticks {
        let ticks = names
            .iter()
            .enumerate()
            .filter_map(|(i, name)| self.tick(i as f64, Some(name.clone())))
            .collect();
        Ticks { ticks, power: 0 }
    }

    /// Position of a value on the axis, beyond 0 and 1 if it lies outside; `None` if it has none.
    pub fn place(&self, value: f64) -> Option<f64> {
        let inner = |v| match self.scale {
            Scale::Linear => v,
            Scale::Log => f64::log10(v),
        };
        let (a, b) = (inner(self.from), inner(self.to));
        let at = (forward(self.scale, value) - a) / (b - a);
        at.is_finite().then_some(at)
    }

    /// First and last value.
    pub fn ends(&self) -> (f64, f64) {
        (self.from, self.to)
    }

    /// The densest ticks whose labels keep their distance: `fits` is asked with candidates.
    pub fn ticks(&self, fits: impl Fn(&Ticks) -> bool) -> Ticks {
        let candidates = match self.scale {
            Scale::Linear => self.linear(),
            Scale::Log => self.logarithmic(),
        };
        let mut last = Ticks::default();
        for candidate in candidates {
            if candidate.labelled() < 2 && last.labelled() >= 2 {
                break;
            }
            if fits(&candidate) {
                return candidate;
            }
            last = candidate;
        }
        last
    }

    fn tick(&self, value: f64, label: Option<String>) -> Option<Tick> {
        let at = self.place(value)?;
        (-1e-9..=1.0 + 1e-9)
            .contains(&at)
            .then_some(Tick { at, label })
    }

    /// Equal steps of 1, 2 or 5 times a power of ten, finest first.
    fn linear(&self) -> Vec<Ticks> {
        let whole = self.to - self.from;
        let largest = self.from.abs().max(self.to.abs());
        let exponent = (whole / 12.0).log10().floor() as i32;
        (exponent..exponent + 3)
            .flat_map(|e| [(1.0, e), (2.0, e), (5.0, e)])
            .map(|(mantissa, e)| {
                let step = mantissa * 10f64.powi(e);
                let first = (self.from / step - 1e-6).ceil() as i64;
                let last = (self.to / step + 1e-6).floor() as i64;
                let top = step * first.unsigned_abs().max(last.unsigned_abs()) as f64;
                // "2 4 … 10" in units of 10⁸ reads better than "0.2 … 1.0" in units of 10⁹.
                let power = match (top / 1.000_001).log10().floor() {
                    p if (-2.0..5.0).contains(&p) || !p.is_finite() => 0,
                    p => p as i32,
                };
                let decimals = usize::try_from(power - e).unwrap_or(0);
                let ticks = (first..=last.min(first + 60))
                    .filter_map(|i| {
                        let value = i as f64 * step;
                        let shown = i as f64 * mantissa * 10f64.powi(e - power);
                        self.tick(value, Some(number::fixed(shown, decimals)))
                    })
                    .collect();
                Ticks { ticks, power }
            })
            .filter(|t| largest == 0.0 || t.labelled() > 0)
            .collect()
    }

    /// Decades and their parts, finest first.
    fn logarithmic(&self) -> Vec<Ticks> {
        let (a, b) = (self.from.log10(), self.to.log10());
        let (first, last) = ((a - 1e-9).floor() as i32, (b + 1e-9).ceil() as i32);
        let mut out = Vec::new();
        if b - a < 0.5 {
            out = self.linear();
        }
        let parts: &[&[u32]] = match b - a {
            d if d < 1.0 => &[&[1, 2, 3, 4, 5, 6, 8], &[1, 2, 5], &[1, 3], &[1]],
            d if d < 3.0 => &[&[1, 2, 5], &[1, 3], &[1]],
            _ => &[&[1]],
        };
        for set in parts {
            out.push(self.decades(first, last, 1, set));
        }
        for stride in [2, 3, 4, 5, 10, 20, 50, 100] {
            out.push(self.decades(first, last, stride, &[1]));
        }
        out
    }

    fn decades(&self, first: i32, last: i32, stride: i32, parts: &[u32]) -> Ticks {
        let mut ticks = Vec::new();
        // Minor ticks of many decades would only be a smear.
        let minor = last - first <= 4;
        // Short axes near one read better with plain numbers than with powers.
        let (lowest, highest) = (self.from.log10() + 1e-9, self.to.log10() - 1e-9);
        let plain = lowest > -2.5 && highest < if last - first > 3 { 4.0 } else { 5.0 };
        for e in first..=last {
            let on_stride = e.rem_euclid(stride) == 0;
            for m in 1..10 {
                let value = f64::from(m) * 10f64.powi(e);
                let labelled = on_stride && parts.contains(&m);
                if !labelled && (stride > 2 || (m > 1 && (stride > 1 || !minor))) {
                    continue;
                }
                let label = labelled.then(|| match (plain, m, e) {
                    (true, ..) => number::fixed(value, usize::try_from(-e).unwrap_or(0)),
                    (false, 1, 0) => "1".to_owned(),
                    (false, 1, 1) => "10".to_owned(),
                    (false, 1, _) => format!("10{}", number::superscript(e)),
                    (false, ..) => format!("{m}×10{}", number::superscript(e)),
                });
                ticks.extend(self.tick(value, label));
            }
        }
        Ticks { ticks, power: 0 }
    }
}

impl Ticks {
    /// How many ticks carry a label.
    pub fn labelled(&self) -> usize {
        self.ticks.iter().filter(|t| t.label.is_some()).count()
    }
}

/// Beyond this (and, on a logarithmic axis, below its reciprocal) nothing is drawn; it keeps all
/// arithmetic of this file clear of overflow.
const LARGEST: f64 = 1e150;

fn forward(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear if value.abs() < 1.0 / LARGEST => 0.0,
        Scale::Linear if value.abs() <= LARGEST => value,
        Scale::Log if (1.0 / LARGEST..=LARGEST).contains(&value) => value.log10(),
        Scale::Linear | Scale::Log => f64::NAN,
    }
}

fn backward(scale: Scale, at: f64) -> f64 {
    match scale {
        Scale::Linear => at,
        Scale::Log => 10f64.powf(at),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, most: usize) -> (Vec<String>, i32) {
        let found = Span::fit(axis, [], 0.0).ticks(|t| t.labelled() <= most);
        (
            found.ticks.into_iter().filter_map(|t| t.label).collect(),
            found.power,
        )
    }

    #[test]
    fn linear_labels_are_short() {
        let axis = Axis::linear("", "").range(0.0, 1.0);
        assert_eq!(
            labels(&axis, 6).0,
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        let axis = Axis::linear("", "").range(1e8, 10e8);
        assert_eq!(
            labels(&axis, 6),
            (["2", "4", "6", "8", "10"].map(str::to_owned).to_vec(), 8)
        );
        let axis = Axis::linear("", "").range(-3e-6, 3e-6);
        assert_eq!(
            labels(&axis, 4),
            (["−2", "0", "2"].map(str::to_owned).to_vec(), -6)
        );
    }

    #[test]
    fn decades_are_powers() {
        let axis = Axis::log("", "").range(1e-9, 1e-3);
        assert_eq!(labels(&axis, 9).0[..2], ["10⁻⁹", "10⁻⁸"]);
        assert_eq!(labels(&axis, 4).0, ["10⁻⁸", "10⁻⁶", "10⁻⁴"]);
        let axis = Axis::log("", "").range(0.1, 5.0);
        assert_eq!(labels(&axis, 8).0, ["0.1", "0.2", "0.5", "1", "2", "5"]);
        let axis = Axis::log("", "").range(250.0, 2e4);
        assert_eq!(labels(&axis, 4).0, ["300", "1000", "3000", "10\u{202f}000"]);
    }

    #[test]
    fn names_stand_from_the_top_down() {
        let span = Span::of_names(4);
        let ticks = span.named(&["a", "b", "c", "d"].map(str::to_owned)).ticks;
        assert_eq!(
            ticks.iter().map(|t| t.at).collect::<Vec<_>>(),
            [0.875, 0.625, 0.375, 0.125]
        );
        assert!(Span::of_names(0).place(0.0).is_some());
    }

    #[test]
    fn values_without_a_place() {
        let log = Span::fit(&Axis::log("", ""), [f64::NAN, -1.0, 0.0, 1.0, 100.0], 0.0);
        assert_eq!(log.place(10.0), Some(0.5));
        assert_eq!(log.place(0.0), None);
        assert_eq!(log.place(f64::NAN), None);
    }

    #[test]
    fn degenerate_data_still_have_an_axis() {
        for values in [vec![], vec![3.0], vec![0.0, 0.0], vec![-2.0; 5]] {
            let span = Span::fit(&Axis::linear("", ""), values, 0.05);
            assert!(span.ends().0 < span.ends().1);
            assert!(span.ticks(|t| t.labelled() <= 6).labelled() >= 2);
        }
    }
}
