//! How parameters, recordings and directions are written.

use sixaxis_core::Parameter;
use sixaxis_recordings::session::Role;

use sixaxis_core::identify::Verdict;
use sixaxis_page::number::{MISSING, digits_apart, fixed, percent};
use sixaxis_page::{Table, TableBuilder};

/// `3 things`, `1 thing`.
pub fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// A parameter's name as in the paper: `s1/m` with its index lowered and letters italic.
pub fn symbol(parameter: Parameter) -> String {
    let letter = parameter.symbol();
    match (parameter, parameter.number()) {
        (Parameter::Drift(_), Some(number)) => format!("${letter}$_{{{number}}}"),
        (_, Some(number)) => format!("${letter}$_{{{number}}}/$m$"),
        (Parameter::Compliance, None) => "$m$/$k$".to_owned(),
        (_, None) => format!("${letter}$/$m$"),
    }
}

/// The kinds of parameter: first letter, heading, and the heading's unit over SI.
const KINDS: [(char, &str, f64); 5] = [
    ('d', "Zero drift $d$, mV", 1e3),
    ('s', "Scale factor over mass $s$/$m$, 1/kg", 1.0),
    ('I', "Inertia over mass $I$/$m$, mm²", 1e6),
    ('k', "Stiffness over mass $k$/$m$, 1/s²", 1.0),
    ('m', "Mass over stiffness $m$/$k$, 10⁻⁹ s²", 1e9),
];

/// A table of parameters, grouped by their kind; beside what each row shows stands the unit of its kind over SI.
pub fn by_kind<R>(
    rows: impl IntoIterator<Item = R>,
    parameter: impl Fn(&R) -> Parameter,
) -> TableBuilder<(R, f64)> {
    let mut rows: Vec<R> = rows.into_iter().collect();
    let mut table = Table::grouped("parameter");
    for (letter, heading, per_si) in KINDS {
        let of_kind = |row: &R| parameter(row).symbol() == letter;
        let (family, others): (Vec<R>, Vec<R>) = rows.into_iter().partition(of_kind);
        rows = others;
        if !family.is_empty() {
            let family = family.into_iter().map(|row| (row, per_si));
            table = table.group(heading, family, |(row, _)| symbol(parameter(row)));
        }
    }
    table
}

/// A recording's name, safe from being read as markup.
pub fn file_name(name: &str) -> String {
    if name.contains(['$', '*', '_', '^']) && !name.contains('`') {
        format!("`{name}`")
    } else {
        name.to_owned()
    }
}

/// The same without a place to break a line at a hyphen.
pub fn unbroken(name: &str) -> String {
    file_name(&name.replace('-', "-\u{2060}"))
}

/// What a role is called in a heading.
pub const fn role(role: Role) -> &'static str {
    match role {
        Role::Static => "At rest (step 1)",
        Role::Linear => "Linear (step 2)",
        Role::Angular => "Angular (step 3)",
        Role::HighFrequencyLinear => "High-frequency linear (step 4)",
        Role::Validation => "Validation (never fitted)",
        Role::Tap => "Taps (stiffness)",
    }
}

/// Largest whole number that a direction is tried in.
const LARGEST_INDEX: i32 = 6;

/// A direction in the smallest whole numbers, `(1, 1, 2)`, or else as a unit vector.
pub fn direction(unit: [f64; 3]) -> String {
    let largest = unit.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    for scale in 1..=LARGEST_INDEX {
        let scaled = unit.map(|x| x / largest * f64::from(scale));
        if scaled.iter().all(|x| (x - x.round()).abs() < 1e-3) {
            let [x, y, z] = scaled.map(|x| fixed(x, 0));
            return format!("({x}, {y}, {z})");
        }
    }
    let [x, y, z] = unit.map(|x| fixed(x, 3));
    format!("({x}, {y}, {z})")
}

/// A share as percent, or a dash. Beyond ten times the whole only that it is so: what has run away has no size.
pub fn share(share: Option<f64>) -> String {
    match share {
        Some(share) if share > 10.0 => "> 1000\u{a0}%".to_owned(),
        Some(share) => percent(share, 2),
        None => MISSING.to_owned(),
    }
}

/// A share as percent beside the limit that it is held to: with as many digits as tell the two apart.
pub fn share_beside(value: Option<f64>, limit: f64) -> String {
    match value {
        Some(value) if value <= 10.0 => percent(value, digits_apart(value, limit, 2)),
        other => share(other),
    }
}

/// An acceptance limit as the session states it, without digits that it has not.
pub fn stated(limit: f64) -> String {
    let percent = 1e6 * 100.0 * limit;
    format!("{}\u{a0}%", percent.round() / 1e6)
}

/// An estimate and its half width with as many decimals as the half width's second digit has.
pub fn with_interval(estimate: f64, half_width: f64) -> (String, String) {
    let decimals = if half_width > 0.0 && half_width.is_finite() {
        (1.0 - half_width.log10().floor()).clamp(0.0, 9.0) as usize
    } else {
        3
    };
    (fixed(estimate, decimals), fixed(half_width, decimals))
}

/// The largest of some values with what it belongs to; NaN counts as larger than any number.
pub fn largest<T>(values: impl Iterator<Item = (f64, T)>) -> Option<(f64, T)> {
    values.max_by(|a, b| {
        let key = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
        key(a.0).total_cmp(&key(b.0))
    })
}

/// Whether a step determines its unknowns, and why not.
pub fn verdict(verdict: &Verdict) -> String {
    use sixaxis_core::identify::Reason;
    match verdict {
        Verdict::Determined => "determined".to_owned(),
        Verdict::Undetermined { reason } => match reason {
            Reason::Noise {
                unknown,
                relative_standard_error,
            } => format!(
                "not determined: unknown {unknown} is uncertain by {}",
                percent(*relative_standard_error, 2)
            ),
            Reason::EdgeOfGrid => "not determined: no minimum inside the grid".to_owned(),
            Reason::Flat { floor_over_largest } => format!(
                "not determined: the smallest rate is {} of the largest on the grid",
                percent(*floor_over_largest, 2)
            ),
            Reason::Misfit {
                residual_over_signal,
                ..
            } => format!(
                "not determined: {} of the signal are neither the model nor noise",
                percent(*residual_over_signal, 2)
            ),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_interval() {
        let text = |e, h| {
            let (e, h) = with_interval(e, h);
            format!("{e} ± {h}")
        };
        assert_eq!(text(12.345_67, 0.0123), "12.346 ± 0.012");
        assert_eq!(text(239.456, 2.345), "239.5 ± 2.3");
        assert_eq!(text(239.456, 23.4), "239 ± 23");
        assert_eq!(text(1.0, f64::NAN), "1.000 ± —");
    }

    #[test]
    fn directions_in_whole_numbers() {
        let s = 6.0_f64.sqrt();
        assert_eq!(direction([1.0 / s, -1.0 / s, 2.0 / s]), "(1, −1, 2)");
        assert_eq!(direction([0.0, 0.0, 1.0]), "(0, 0, 1)");
        assert_eq!(direction([0.6, 0.0, 0.8]), "(3, 0, 4)");
        assert_eq!(direction([0.36, 0.48, 0.8]), "(0.360, 0.480, 0.800)");
    }

    #[test]
    fn symbols_of_the_paper() {
        assert_eq!(symbol(Parameter::Scale(0)), "$s$_{1}/$m$");
        assert_eq!(symbol(Parameter::Drift(8)), "$d$_{9}");
        assert_eq!(symbol(Parameter::Stiffness), "$k$/$m$");
    }

    #[test]
    fn what_is_no_number_is_never_overlooked() {
        let worst = largest([(1.0, 'a'), (f64::NAN, 'b'), (2.0, 'c')].into_iter());
        assert_eq!(worst.map(|w| w.1), Some('b'));
        assert!(largest(core::iter::empty::<(f64, ())>()).is_none());
    }
}
