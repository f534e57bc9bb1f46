//! Values of a session that are impossible, each with its key.

use sixaxis_core::Gains;
use sixaxis_core::dsp::butterworth;
use sixaxis_core::dsp::differentiate::Differentiator;

use super::channels::Channels;
use super::entry::{Entry, Role};
use super::preprocessing::{Preprocessing, Stage};
use super::schema::Session;
use super::sensor::PerLimb;
use crate::unit;

/// Largest angle by which a wedge may be stated to miss its direction, degrees: beyond half a right angle it is another
/// axis' wedge.
const WEDGE_LIMIT_DEG: f64 = 45.0;
/// Shortest vector that still has a direction.
const SHORTEST_DIRECTION: f64 = 1e-6;

/// What a path of another system comes to in TOML.
pub(super) const BACKSLASH: &str =
    "a backslash begins an escape; in paths write / or put them into 'single quotes'";

/// An impossible value.
pub(super) struct Impossible {
    /// Its key, as in `recording[3].direction`.
    pub key: String,
    /// Why it is impossible, and what would be possible.
    pub cause: String,
}

type Result = std::result::Result<(), Impossible>;

/// Refuses the value at a key unless `possible`.
fn require(possible: bool, key: &str, cause: impl FnOnce() -> String) -> Result {
    if possible {
        return Ok(());
    }
    Err(Impossible {
        key: key.to_owned(),
        cause: cause(),
    })
}

fn not_negative(key: &str, value: f64) -> Result {
    require(value >= 0.0 && value.is_finite(), key, || {
        format!("{value}: must be finite and not negative")
    })
}

/// A refusal by the mathematics, at a key.
fn accepted<T>(key: &str, answer: sixaxis_core::Result<T>) -> Result {
    answer.map(|_| ()).map_err(|error| Impossible {
        key: key.to_owned(),
        cause: error.to_string(),
    })
}

impl Session {
    /// Refuses the first value that is impossible.
    pub(super) fn check(&self) -> Result {
        let statements = toml::Value::try_from(self).map_err(|error| Impossible {
            key: "session".to_owned(),
            cause: error.to_string(),
        })?;
        check_sizes("", &statements)?;
        let sensor = &self.sensor;
        let (accelerometer, gyroscope) = (&self.accelerometer, &self.gyroscope);
        let rig = self.rig.as_ref();
        for (key, gain, class) in [
            (
                "accelerometer.gain_percent",
                accelerometer.gain_percent,
                accelerometer.class_percent,
            ),
            (
                "gyroscope.gain_percent",
                gyroscope.gain_percent,
                gyroscope.class_percent,
            ),
        ] {
            if let Some(gain) = gain {
                require(gain > 0.0 && gain <= class, key, || {
                    format!(
                        "{gain}: must be positive and not above class_percent, {class}, of which it is a part"
                    )
                })?;
            }
        }
        if let Some(wedge) = rig.and_then(|r| r.wedge_deg) {
            let possible = (0.0..WEDGE_LIMIT_DEG).contains(&wedge);
            require(possible, "rig.wedge_deg", || {
                format!("{wedge}: must be from 0 to below {WEDGE_LIMIT_DEG}")
            })?;
        }
        if let Some(gravity) = self.stated_gravity_m_s2() {
            require((9.7..9.9).contains(&gravity), "rig.gravity_m_s2", || {
                format!("{gravity}: on earth it is 9.76 to 9.84 m/s^2")
            })?;
        }
        check_gains("sensor.gain_n_per_v", &sensor.gain_n_per_v)?;
        for (key, length_mm) in [
            ("sensor.limb_length_mm", sensor.limb_length_mm),
            ("sensor.half_edge_mm", sensor.half_edge_mm),
        ] {
            require((1.0..=1000.0).contains(&length_mm), key, || {
                format!("{length_mm}: must be from 1 to 1000, in millimetres")
            })?;
        }
        // Of a body of 1 to 300 mm; square metres are a million times less.
        let moments = &sensor.design.inertia_per_mass_mm2[..3];
        require(
            moments.iter().all(|i| (1.0..=1e5).contains(i)),
            "sensor.design.inertia_per_mass_mm2",
            || {
                format!(
                    "{moments:?}: xx, yy and zz must be from 1 to 100000, in square millimetres"
                )
            },
        )?;
        let full_scale_v = sensor.full_scale_v;
        require(
            full_scale_v <= LARGEST_RANGE_V,
            "sensor.full_scale_v",
            || format!("{full_scale_v}: in volts, at most {LARGEST_RANGE_V}"),
        )?;
        accepted("sensor.limb_length_mm", sensor.geometry().validate())?;
        accepted("sensor.design", sensor.design().validate())?;
        check_stages(&self.preprocessing)?;
        check_channels("channels", &self.channels)?;
        require(!self.recording.is_empty(), "recording", || {
            "no recording at all".to_owned()
        })?;
        for (i, entry) in self.recording.iter().enumerate() {
            check_entry(&format!("recording[{i}]"), entry)?;
        }
        Ok(())
    }
}

/// Ranges of converters end far below, V: 5000 and 10 000 are millivolts.
const LARGEST_RANGE_V: f64 = 1000.0;

/// Endings of the keys whose values are sizes.
const SIZES: [&str; 11] = [
    "_mm",
    "_percent",
    "full_scale_v",
    "_mv_per_g",
    "_mv_per_deg_s",
    "rotation_amplitude_deg",
    "bandwidth_hz",
    "delay_ms",
    "frequency_hz",
    "rate_hz",
    "high_pass_hz",
];

/// Refuses a size that is not positive and finite, at any depth.
fn check_sizes(key: &str, value: &toml::Value) -> Result {
    match value {
        toml::Value::Float(value) if SIZES.iter().any(|ending| key.ends_with(ending)) => {
            require(*value > 0.0 && value.is_finite(), key, || {
                format!("{value} is not positive and finite")
            })
        }
        toml::Value::Table(table) => table.iter().try_for_each(|(name, value)| match key {
            "" => check_sizes(name, value),
            _ => check_sizes(&format!("{key}.{name}"), value),
        }),
        toml::Value::Array(values) => values
            .iter()
            .enumerate()
            .try_for_each(|(i, value)| check_sizes(&format!("{key}[{i}]"), value)),
        _ => Ok(()),
    }
}

fn check_stages(stages: &Preprocessing) -> Result {
    fn switched_on<T>(stage: &Stage<T>) -> bool {
        matches!(stage, Stage::Switch(true))
    }
    for (key, meaningless, settings) in [
        (
            "preprocessing.outliers",
            switched_on(&stages.outliers),
            "{ half_width = 5, sigmas = 5.0 }",
        ),
        (
            "preprocessing.detrend",
            switched_on(&stages.detrend),
            "{ rest_s = 0.5 }",
        ),
        (
            "preprocessing.low_pass",
            switched_on(&stages.low_pass),
            "{ order = 4, times_drive = 4.0, plus_hz = 8.0 }",
        ),
    ] {
        require(!meaningless, key, || {
            format!(
                "`true` says nothing: give its settings, {settings} for example, or `false` to switch it off"
            )
        })?;
    }
    if let Stage::On(low_pass) = &stages.low_pass {
        let order = low_pass.order;
        let possible = (1..=butterworth::MAX_ORDER).contains(&order);
        require(possible, "preprocessing.low_pass.order", || {
            format!("{order}: from 1 to {}", butterworth::MAX_ORDER)
        })?;
        not_negative("preprocessing.low_pass.times_drive", low_pass.times_drive)?;
        not_negative("preprocessing.low_pass.plus_hz", low_pass.plus_hz)?;
        let possible = low_pass.times_drive + low_pass.plus_hz > 0.0;
        require(possible, "preprocessing.low_pass", || {
            "a corner of 0 Hz lets nothing through".to_owned()
        })?;
    }
    if let Stage::On(detrend) = &stages.detrend {
        not_negative("preprocessing.detrend.rest_s", detrend.rest_s)?;
    }
    if let Stage::On(outliers) = &stages.outliers {
        not_negative("preprocessing.outliers.sigmas", outliers.sigmas)?;
    }
    let settings = stages.differentiator;
    accepted(
        "preprocessing.differentiator",
        Differentiator::new(settings.half_width, settings.order, 1.0),
    )
}

fn check_entry(key: &str, entry: &Entry) -> Result {
    for (name, vector) in [("direction", entry.direction), ("down", entry.down)] {
        if let Some(v) = vector {
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let possible = length.is_finite() && length > SHORTEST_DIRECTION;
            require(possible, &format!("{key}.{name}"), || {
                format!("{v:?} has no direction")
            })?;
        }
    }
    for (name, file) in [
        ("file", Some(&entry.file)),
        ("reference_file", entry.reference_file.as_ref()),
    ] {
        let path = file.map(|file| file.to_string_lossy());
        let possible = path.is_none_or(|path| !path.contains(char::is_control));
        require(possible, &format!("{key}.{name}"), || {
            format!("a control character: {BACKSLASH}")
        })?;
    }
    if !matches!(entry.role, Role::Static | Role::Tap) {
        for (name, given) in [
            ("direction", entry.direction.is_some()),
            ("frequency_hz", entry.frequency_hz.is_some()),
        ] {
            require(given, &format!("{key}.{name}"), || {
                let role = entry.role.name();
                format!("missing; a recording of role \"{role}\" needs it")
            })?;
        }
    }
    if let Some(gains) = &entry.gain_n_per_v {
        check_gains(&format!("{key}.gain_n_per_v"), gains)?;
    }
    match &entry.channels {
        Some(channels) => check_channels(&format!("{key}.channels"), channels),
        None => Ok(()),
    }
}

fn check_gains(key: &str, gains: &PerLimb) -> Result {
    let gains = Gains {
        gain_n_per_v: gains.each(),
    };
    accepted(key, gains.validate())
}

fn check_channels(key: &str, channels: &Channels) -> Result {
    for (name, unit, own) in [
        ("limbs_unit", &channels.limbs_unit, ""),
        (
            "accelerometer_unit",
            &channels.accelerometer_unit,
            "m/s^2, g, ",
        ),
        ("gyroscope_unit", &channels.gyroscope_unit, "rad/s, deg/s, "),
    ] {
        if let Some(unit) = unit {
            let known = unit::named(unit).is_some();
            require(known, &format!("{key}.{name}"), || {
                format!(
                    "{unit:?} is not a unit that is known; give {own}{}",
                    unit::VOLTAGES
                )
            })?;
        }
    }
    let mut names: Vec<&String> = channels.limbs.iter().collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => require(false, &format!("{key}.limbs"), || {
            format!("{:?} stands there twice", pair[0])
        }),
        None => Ok(()),
    }
}
