//! How errors, limits and margins are printed.

use sixaxis_page::number::{self, scientific, significant};
use sixaxis_page::{Cell, State};

/// Under this margin a limit is held, but barely.
const NARROW: f64 = 1.5;

/// An error with few digits, all of them on hovering.
pub fn error(value: f64, digits: usize) -> Cell {
    Cell::of(value, |v| match v {
        v if v.is_nan() => "NaN".to_owned(),
        v => significant_or_power(v, digits),
    })
}

/// A limit, or the range of several.
pub fn limit(smallest: f64, largest: f64) -> Cell {
    // Most limits are round; one that is not gets a second digit.
    let text = |value: f64| {
        let round = format!("{value:.0e}").parse() == Ok(value);
        significant_or_power(value, if round { 1 } else { 2 })
    };
    if smallest == largest {
        Cell::of(smallest, text)
    } else {
        Cell::from(format!("{} to {}", text(smallest), text(largest)))
            .title(format!("{smallest} to {largest}"))
    }
}

/// How often the largest share goes into what is allowed.
pub fn margin(largest_share: f64) -> Cell {
    let margin = 1.0 / largest_share;
    let state = match margin {
        m if m >= NARROW => State::Good,
        m if m >= 1.0 => State::Warn,
        _ => State::Bad,
    };
    // Rounded down: a margin just under one is not "1.0".
    let floor = |m: f64, decimals: i32| {
        let unit = 10f64.powi(decimals);
        number::fixed((m * unit).floor() / unit, decimals as usize)
    };
    Cell::of(margin, |margin| match margin {
        m if m.is_nan() || m == 0.0 => "none".to_owned(),
        m if m < 0.01 => "< 0.01×".to_owned(),
        m if m > 1e6 => "> 10⁶×".to_owned(),
        m if m < 1.0 => format!("{}×", floor(m, 2)),
        m if m < 10.0 => format!("{}×", floor(m, 1)),
        m => format!("{}×", significant(m, 2)),
    })
    .state(state)
}

/// Plain from a hundredth to a thousand, with a power of ten outside.
fn significant_or_power(value: f64, digits: usize) -> String {
    if value == 0.0 || (0.01..1000.0).contains(&value.abs()) {
        significant(value, digits)
    } else {
        scientific(value, digits)
    }
}

/// A suite's name as words.
pub fn words(suite: &str) -> String {
    suite.replace('_', " ")
}
