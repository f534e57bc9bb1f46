//! How a number is printed: few digits, a real minus sign, powers of ten as `×10ⁿ`.
//!
//! All functions return plain text with Unicode superscripts; [`super::markup`] and
//! [`super::plot`] set those as raised figures. What is not a number prints as an em dash, what is
//! not finite as ∞, and a value that rounds to zero never keeps a minus sign.

use super::markup::{Level, relevel};

/// What stands for "not a number".
pub const MISSING: &str = "—";

/// Groups of three digits are parted by this narrow space, from five digits on.
pub const GROUP: char = '\u{202f}';

/// `digits` significant digits: plain between 10⁻³ and 10⁶, scientific outside.
///
/// `significant(0.0123456, 3)` is `0.0123`, `significant(-98735.8, 3)` is `−98 700`.
pub fn significant(value: f64, digits: usize) -> String {
    let Some((_, exponent)) = parts(value, digits) else {
        return special(value);
    };
    if (-3..6).contains(&exponent) {
        plain(value, digits, exponent)
    } else {
        scientific(value, digits)
    }
}

/// `digits` significant digits and a power of ten: `1.23×10⁻⁴`. The power is left out if it is 10⁰.
pub fn scientific(value: f64, digits: usize) -> String {
    let Some((_, exponent)) = parts(value, digits) else {
        return special(value);
    };
    if value == 0.0 {
        return "0".to_owned();
    }
    let mantissa = plain(shift(value, -exponent), digits, 0);
    match exponent {
        0 => mantissa,
        power => format!("{mantissa}×10{}", superscript(power)),
    }
}

/// A fixed number of decimals: `fixed(-12.345, 1)` is `−12.3`.
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return special(value);
    }
    dress(&format!("{value:.decimals$}"))
}

/// A share of one as percent with `digits` significant digits: `0.07479` is `7.48 %`.
pub fn percent(share: f64, digits: usize) -> String {
    suffixed(significant(share * 1e2, digits), "%")
}

/// A share of one as parts per million with `digits` significant digits.
pub fn ppm(share: f64, digits: usize) -> String {
    suffixed(significant(share * 1e6, digits), "ppm")
}

/// Significant digits at which a value prints differently from the limit that it is held to, at least `least`: a limit of 5 % is not
/// missed by "5.0 %".
pub fn digits_apart(value: f64, limit: f64, least: usize) -> usize {
    let print = |x: f64, digits: usize| format!("{x:.*e}", digits.max(1) - 1);
    apart(least, |digits| print(value, digits) != print(limit, digits))
}

/// The same for a fixed number of decimals.
pub fn decimals_apart(value: f64, limit: f64, least: usize) -> usize {
    apart(least, |decimals| {
        format!("{value:.decimals$}") != format!("{limit:.decimals$}")
    })
}

/// Digits beyond which a double has none of its own.
const MOST_DIGITS: usize = 15;

fn apart(least: usize, differ: impl Fn(usize) -> bool) -> usize {
    (least..=MOST_DIGITS)
        .find(|digits| differ(*digits))
        .unwrap_or(least)
}

/// With a unit and the SI prefix that leaves one to three digits before the point:
/// `si(2.0e4, 3, "Hz")` is `20.0 kHz`. For units that take prefixes only.
pub fn si(value: f64, digits: usize, unit: &str) -> String {
    const PREFIX: [&str; 9] = ["p", "n", "µ", "m", "", "k", "M", "G", "T"];
    let Some((_, exponent)) = parts(value, digits) else {
        return suffixed(special(value), unit);
    };
    let group = exponent.div_euclid(3);
    match usize::try_from(group + 4).ok().and_then(|i| PREFIX.get(i)) {
        Some(prefix) => {
            let shown = plain(shift(value, -3 * group), digits, exponent - 3 * group);
            suffixed(shown, &format!("{prefix}{unit}"))
        }
        None => suffixed(scientific(value, digits), unit),
    }
}

/// A whole number with its digits grouped: `12 345`.
pub fn count(value: impl ToString) -> String {
    dress(&value.to_string())
}

/// A number and its unit with a no-break space between: the unit may be empty.
pub fn with_unit(value: f64, digits: usize, unit: &str) -> String {
    suffixed(significant(value, digits), unit)
}

/// An exponent as raised figures: `superscript(-12)` is `⁻¹²`.
pub fn superscript(exponent: i32) -> String {
    let digits = exponent.to_string();
    digits.chars().map(|c| relevel(c, Level::Sup)).collect()
}

/// Mantissa text and decimal exponent after rounding to `digits` significant digits; zero has
/// exponent 0; `None` for what is not finite.
fn parts(value: f64, digits: usize) -> Option<(String, i32)> {
    if !value.is_finite() {
        return None;
    }
    let text = format!("{value:.*e}", digits.max(1) - 1);
    let (mantissa, exponent) = text.split_once('e')?;
    Some((mantissa.to_owned(), exponent.parse().ok()?))
}

fn special(value: f64) -> String {
    match value {
        v if v.is_nan() => MISSING.to_owned(),
        v if v > 0.0 => "∞".to_owned(),
        _ => "−∞".to_owned(),
    }
}

/// `value` rounded to `digits` significant digits, given its exponent after that rounding.
fn plain(value: f64, digits: usize, exponent: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = i32::try_from(digits.max(1)).unwrap_or(i32::MAX) - 1 - exponent;
    match usize::try_from(decimals) {
        Ok(decimals) => dress(&format!("{value:.decimals$}")),
        Err(_) => {
            // Fewer digits asked for than the integer has: the rest are zeros.
            let unit = 10f64.powi(-decimals);
            dress(&format!("{:.0}", (value / unit).round() * unit))
        }
    }
}

/// `value`·10^`power` through decimal text, which neither overflows nor loses a rounding.
fn shift(value: f64, power: i32) -> f64 {
    let text = format!("{value:e}");
    let Some((mantissa, exponent)) = text.split_once('e') else {
        return value;
    };
    let exponent = exponent.parse::<i32>().unwrap_or(0) + power;
    format!("{mantissa}e{exponent}").parse().unwrap_or(value)
}

fn suffixed(number: String, unit: &str) -> String {
    if unit.is_empty() || number == MISSING {
        number
    } else {
        format!("{number}\u{a0}{unit}")
    }
}

/// Puts a real minus sign and groups the integer's digits; drops the sign of a zero.
fn dress(text: &str) -> String {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (rest.bytes().any(|b| (b'1'..=b'9').contains(&b)), rest),
        None => (false, text),
    };
    let (whole, fraction) = digits
        .split_once('.')
        .map_or((digits, None), |(w, f)| (w, Some(f)));
    let mut out = String::new();
    if negative {
        out.push('−');
    }
    for (i, digit) in whole.chars().enumerate() {
        if whole.len() >= 5 && i > 0 && (whole.len() - i).is_multiple_of(3) {
            out.push(GROUP);
        }
        out.push(digit);
    }
    if let Some(fraction) = fraction {
        out.push('.');
        out.push_str(fraction);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_that_is_missed_prints_otherwise_than_what_misses_it() {
        for (value, limit, expected) in [
            (0.0503, 0.05, "5.03\u{a0}%"),
            (0.050_000_1, 0.05, "5.00001\u{a0}%"),
            (0.0612, 0.05, "6.1\u{a0}%"),
            (0.05, 0.05, "5.0\u{a0}%"),
        ] {
            assert_eq!(percent(value, digits_apart(value, limit, 2)), expected);
        }
        assert_eq!(
            (decimals_apart(5.03, 5.0, 1), decimals_apart(7.0, 5.0, 1)),
            (2, 1)
        );
        assert_eq!(decimals_apart(f64::NAN, 5.0, 1), 1);
    }

    #[test]
    fn significant_digits() {
        assert_eq!(significant(0.012_345_6, 3), "0.0123");
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(999.9, 3), "1000");
        assert_eq!(significant(-98_735.8, 3), "−98\u{202f}700");
        assert_eq!(significant(999_999.0, 3), "1.00×10⁶");
        assert_eq!(significant(0.000_999_6, 3), "0.00100");
        assert_eq!(significant(7.479e-7, 2), "7.5×10⁻⁷");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(-0.0, 3), "0");
        assert_eq!(significant(5.0, 0), "5");
    }

    #[test]
    fn not_finite() {
        assert_eq!(significant(f64::NAN, 3), "—");
        assert_eq!(percent(f64::NAN, 3), "—");
        assert_eq!(si(f64::NAN, 3, "Hz"), "—");
        assert_eq!(fixed(f64::INFINITY, 2), "∞");
        assert_eq!(scientific(f64::NEG_INFINITY, 2), "−∞");
    }

    #[test]
    fn powers_of_ten() {
        assert_eq!(scientific(-1.234e-4, 3), "−1.23×10⁻⁴");
        assert_eq!(scientific(9.999e8, 3), "1.00×10⁹");
        assert_eq!(scientific(3.25, 3), "3.25");
        assert_eq!(scientific(f64::MIN_POSITIVE, 3), "2.23×10⁻³⁰⁸");
        assert_eq!(scientific(f64::MAX, 3), "1.80×10³⁰⁸");
    }

    #[test]
    fn shares_and_units() {
        assert_eq!(percent(0.074_79, 3), "7.48\u{a0}%");
        assert_eq!(ppm(1.5e-6, 2), "1.5\u{a0}ppm");
        assert_eq!(si(2.0e4, 3, "Hz"), "20.0\u{a0}kHz");
        assert_eq!(si(2.5e-7, 3, "m"), "250\u{a0}nm");
        assert_eq!(si(0.0, 3, "m"), "0\u{a0}m");
        assert_eq!(si(1e20, 3, "m"), "1.00×10²⁰\u{a0}m");
        assert_eq!(with_unit(25.5, 3, "mm"), "25.5\u{a0}mm");
        assert_eq!(with_unit(2.0, 2, ""), "2.0");
    }

    #[test]
    fn fixed_and_counts() {
        assert_eq!(fixed(-12.345, 1), "−12.3");
        assert_eq!(fixed(-0.001, 1), "0.0");
        assert_eq!(count(1234), "1234");
        assert_eq!(count(12_345_678), "12\u{202f}345\u{202f}678");
    }
}
