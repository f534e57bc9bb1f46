//! The size of a channel's unit in SI: what the file says, what the session says, and that the two agree.

use std::path::Path;

use crate::channel::Channel;
use crate::error::{Error, Result};
use crate::session::Channels;
use crate::unit::{self, Unit};

/// A refusal of a channel's unit.
fn refuse(path: &Path, channel: &Channel, cause: impl Into<String>) -> Error {
    Error::Unit {
        file: path.display().to_string(),
        channel: channel.name.clone(),
        cause: cause.into(),
    }
}

/// A channel's unit. The session's counts where the file states none, or one that is not known; where nobody states any, that at the end of
/// the channel's name, as in `u1_V`.
fn of(path: &Path, channel: &Channel, stated: Option<&str>) -> Result<Unit> {
    let refuse = |cause| Err(refuse(path, channel, cause));
    match (channel.unit.as_deref(), stated) {
        (Some(own), stated) => match (unit::named(own), stated.and_then(unit::named)) {
            (Some(unit), Some(other)) if unit != other => Err(Error::UnitContradicted {
                file: path.display().to_string(),
                channel: channel.name.clone(),
                own: own.to_owned(),
                stated: stated.unwrap_or_default().to_owned(),
            }),
            (Some(unit), _) | (None, Some(unit)) => Ok(unit),
            (None, None) => refuse(format!(
                "unit {own:?} is not known; give the session a *_unit for it"
            )),
        },
        (None, Some(name)) => match unit::named(name) {
            Some(unit) => Ok(unit),
            None => refuse(format!("unit {name:?} is not known")),
        },
        // Software that turns our own Parquet into text keeps no more than the columns' names.
        (None, None) => match unit::in_name(&channel.name).and_then(|(_, plain)| unit::named(plain)) {
            Some(unit) => Ok(unit),
            None => refuse(
            "neither the file nor a session says its unit; set limbs_unit, accelerometer_unit or gyroscope_unit in [channels] of the \
             session, or where there is none give the limbs' by --unit"
                .to_owned(),
            ),
        },
    }
}

/// Volts per unit of a limb's channel.
///
/// # Errors
/// [`Error::Unit`] for a unit that is no voltage or that is not known, [`Error::UnitContradicted`].
pub(super) fn volts(path: &Path, channel: &Channel, channels: &Channels) -> Result<f64> {
    match of(path, channel, channels.limbs_unit.as_deref())? {
        Unit::Voltage(volts) => Ok(volts),
        _ => Err(refuse(
            path,
            channel,
            format!(
                "a limb's channel is a voltage, not {:?}",
                channel.unit.as_deref().unwrap_or_default()
            ),
        )),
    }
}

/// m/s^2 or rad/s per unit of a standard's channel. One in volts needs the instrument's sensitivity, mV per `per`, which the
/// session has at `key`.
///
/// # Errors
/// Those of [`volts`]; [`Error::Unit`] for a channel in volts without a sensitivity.
pub(super) fn standard(
    path: &Path,
    channel: &Channel,
    stated: Option<&str>,
    (per, sensitivity_mv, key): (Unit, Option<f64>, &str),
) -> Result<f64> {
    let cause = match (of(path, channel, stated)?, per, sensitivity_mv) {
        (Unit::Acceleration(si), Unit::Acceleration(_), _) | (Unit::Rate(si), Unit::Rate(_), _) => {
            return Ok(si);
        }
        (Unit::Voltage(volts), Unit::Acceleration(si) | Unit::Rate(si), Some(mv)) => {
            return Ok(volts / (mv * 1e-3) * si);
        }
        (Unit::Voltage(_), _, None) => format!("in volts; {key} is missing"),
        _ => "neither in a unit of what it measures nor in volts".to_owned(),
    };
    Err(refuse(path, channel, cause))
}

/// Seconds per unit of a channel of time stamps; 1 where it states none.
///
/// # Errors
/// [`Error::Unit`] for one that is no unit of time.
pub(super) fn seconds(path: &Path, channel: &Channel) -> Result<f64> {
    channel.seconds().ok_or_else(|| {
        let own = channel.unit.as_deref().unwrap_or_default();
        let cause = format!(
            "{own:?} is no unit of time stamps (ns, us, ms, s, min, h, d); call the channel otherwise where it has none, and give the rate"
        );
        refuse(path, channel, cause)
    })
}

/// Size of a motion's column in the SI unit that it is `expected` in; 1 where the file states no unit.
///
/// # Errors
/// [`Error::Unit`] for a unit of something else.
pub(super) fn motion(path: &Path, channel: &Channel, expected: &str) -> Result<f64> {
    let own = channel.unit.as_deref().unwrap_or(expected);
    size_in(own, expected).ok_or_else(|| {
        let cause = format!("{own:?} is not a unit of it; {expected} is");
        refuse(path, channel, cause)
    })
}

/// Size of `unit` in the SI unit `expected`. None: it measures something else.
fn size_in(unit: &str, expected: &str) -> Option<f64> {
    if unit == expected {
        return Some(1.0);
    }
    if expected == "rad/s^2" {
        // An angular acceleration's unit is a rate's per second.
        let unit = unit.trim();
        let rate = unit.trim_end_matches(['2', '²']).trim_end_matches('^');
        return match unit::named(rate) {
            Some(Unit::Rate(size)) if rate.len() < unit.len() => Some(size),
            _ => None,
        };
    }
    match (unit::named(unit)?, expected) {
        (Unit::Acceleration(size), "m/s^2") | (Unit::Rate(size), "rad/s") => Some(size),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::size_in;

    #[test]
    fn units_of_a_motion() {
        let degree = core::f64::consts::PI / 180.0;
        assert_eq!(size_in("rad/s^2", "rad/s^2"), Some(1.0));
        assert_eq!(size_in("deg/s^2", "rad/s^2"), Some(degree));
        assert_eq!(size_in("°/s²", "rad/s^2"), Some(degree));
        assert_eq!(size_in("deg/s", "rad/s^2"), None);
        assert_eq!(size_in("g", "m/s^2"), Some(9.80665));
        assert_eq!(size_in("deg/s", "rad/s"), Some(degree));
        assert_eq!(size_in("V", "m/s^2"), None);
    }
}
