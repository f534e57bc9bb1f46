//! Units that channels come in: what a unit's name is worth in SI.

use core::f64::consts::PI;

/// Standard gravity, m/s^2: what `g` means.
pub const STANDARD_GRAVITY_M_S2: f64 = 9.80665;

/// The units of voltage, as they are said.
pub const VOLTAGES: &str = "V, mV or uV";

/// What a unit measures and its size in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    /// Volts per unit.
    Voltage(f64),
    /// m/s^2 per unit.
    Acceleration(f64),
    /// rad/s per unit.
    Rate(f64),
    /// Seconds per unit.
    Time(f64),
}

impl Unit {
    /// What it measures, as a person would name it.
    pub const fn quantity(self) -> &'static str {
        match self {
            Self::Voltage(_) => "voltage",
            Self::Acceleration(_) => "acceleration",
            Self::Rate(_) => "rate of rotation",
            Self::Time(_) => "time",
        }
    }

    /// Its size in V, m/s^2, rad/s or s.
    pub const fn size_si(self) -> f64 {
        let (Self::Voltage(size) | Self::Acceleration(size) | Self::Rate(size) | Self::Time(size)) =
            self;
        size
    }
}

/// Looks a unit up by the names that recorders use. None: not known.
pub fn named(name: &str) -> Option<Unit> {
    let squeezed: String = name
        .chars()
        .filter(|c| !c.is_whitespace())
        .map(|c| match c {
            '²' => '2',
            // The sign of micro, and the Greek letter.
            'µ' | 'μ' => 'u',
            other => other,
        })
        .filter(|c| *c != '^')
        .collect();
    let unit = match squeezed.as_str() {
        "V" | "Volt" | "Volts" | "volt" | "volts" | "v" => Unit::Voltage(1.0),
        "mV" | "millivolt" | "millivolts" => Unit::Voltage(1e-3),
        "uV" => Unit::Voltage(1e-6),
        "m/s2" | "m*s-2" | "ms-2" | "m.s-2" | "m/s/s" => Unit::Acceleration(1.0),
        "mm/s2" => Unit::Acceleration(1e-3),
        "g" | "G" | "gn" => Unit::Acceleration(STANDARD_GRAVITY_M_S2),
        "mg" => Unit::Acceleration(1e-3 * STANDARD_GRAVITY_M_S2),
        "rad/s" | "rads-1" | "rad*s-1" => Unit::Rate(1.0),
        "deg/s" | "°/s" | "dps" | "degs-1" => Unit::Rate(PI / 180.0),
        "rpm" => Unit::Rate(2.0 * PI / 60.0),
        "s" | "sec" | "second" | "seconds" | "Seconds" => Unit::Time(1.0),
        "ms" | "msec" | "milliseconds" => Unit::Time(1e-3),
        "us" | "usec" | "microseconds" => Unit::Time(1e-6),
        "ns" | "nsec" | "nanoseconds" => Unit::Time(1e-9),
        "min" | "minutes" => Unit::Time(60.0),
        "h" | "hr" | "hours" => Unit::Time(3600.0),
        "d" | "days" => Unit::Time(86_400.0),
        _ => return None,
    };
    Some(unit)
}

/// Units at the end of a column's name, as they can be written without signs, and as they are.
const IN_NAMES: [(&str, &str); 13] = [
    ("m_s2", "m/s^2"),
    ("rad_s2", "rad/s^2"),
    ("deg_s2", "deg/s^2"),
    ("rad_s", "rad/s"),
    ("deg_s", "deg/s"),
    ("V", "V"),
    ("mV", "mV"),
    ("uV", "uV"),
    ("g", "g"),
    ("s", "s"),
    ("ms", "ms"),
    ("us", "us"),
    ("ns", "ns"),
];

/// Parts `ax_m_s2` into `ax` and `m/s^2`. None: no unit stands at its end.
pub fn in_name(column: &str) -> Option<(&str, &'static str)> {
    IN_NAMES.iter().find_map(|(plain, unit)| {
        let name = column.strip_suffix(plain)?.strip_suffix('_')?;
        (!name.is_empty()).then_some((name, *unit))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings() {
        assert_eq!(named("m/s^2"), Some(Unit::Acceleration(1.0)));
        assert_eq!(named("m / s²"), Some(Unit::Acceleration(1.0)));
        assert_eq!(named("mV"), Some(Unit::Voltage(1e-3)));
        assert_eq!(named("°/s"), Some(Unit::Rate(PI / 180.0)));
        // A thousandth of a volt and a million of them are one letter apart.
        assert_eq!(named("MV"), None);
        assert_eq!(named(""), None);
        assert_eq!(named("\u{3bc}V"), named("\u{b5}V"));
        assert_eq!(named("hours"), Some(Unit::Time(3600.0)));
    }
}
