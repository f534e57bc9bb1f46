//! The nine limbs and the standards, where they can be told: from the session, from their names, or from their units.

use std::path::{Path, PathBuf};

use serde::Serialize;
use sixaxis_core::LIMBS;
use sixaxis_recordings::session::{Role, SessionFile};
use sixaxis_recordings::unit::{self, Unit};
use sixaxis_recordings::{Channel, Layout};

use super::findings::ChannelFacts;

/// A limb that shows less than so many times its noise does not move.
const STILL: f64 = 1.5;
/// Limbs that move show more than so many times theirs.
const MOVES: f64 = 30.0;

/// What a session says of its recordings, as far as one of them can be held against it.
#[derive(Debug, Clone)]
pub struct Expectations {
    session: SessionFile,
}

impl Expectations {
    /// From a session file.
    #[must_use]
    pub const fn new(session: SessionFile) -> Self {
        Self { session }
    }

    /// What is expected of one file.
    #[must_use]
    pub fn of(&self, path: &Path) -> Expected {
        let same = |file: &Path| {
            let listed = self.session.resolve(file);
            match (listed.canonicalize(), path.canonicalize()) {
                (Ok(a), Ok(b)) => a == b,
                _ => listed == path,
            }
        };
        let session = &self.session.session;
        let entry = session.recording.iter().find(|e| same(&e.file));
        let reference = session
            .recording
            .iter()
            .find(|e| e.reference_file.as_deref().is_some_and(same));
        let channels = entry
            .or(reference)
            .and_then(|e| e.channels.as_ref())
            .unwrap_or(&session.channels);
        Expected {
            session: self.session.path.clone(),
            listed: entry.or(reference).is_some(),
            role: entry.map(|e| e.role),
            limbs: channels.limbs.to_vec(),
            limbs_unit: channels.limbs_unit.clone(),
            accelerometer: (
                channels.accelerometer.clone(),
                channels.accelerometer_unit.clone(),
            ),
            gyroscope: (channels.gyroscope.clone(), channels.gyroscope_unit.clone()),
            time: channels.time.clone(),
            sample_rate_hz: entry
                .and_then(|e| e.sample_rate_hz)
                .or_else(|| reference.and_then(|e| e.reference_sample_rate_hz)),
            full_scale_v: session.sensor.full_scale_v,
        }
    }
}

/// What a session says of one file.
#[derive(Debug, Clone)]
pub struct Expected {
    /// The session file.
    pub session: PathBuf,
    /// The file is among its recordings.
    pub listed: bool,
    /// What it is for.
    pub role: Option<Role>,
    /// Names of the limbs.
    pub limbs: Vec<String>,
    /// Their unit where the file does not say.
    pub limbs_unit: Option<String>,
    /// Name and unit of the accelerometer.
    pub accelerometer: (String, Option<String>),
    /// Name and unit of the gyroscope.
    pub gyroscope: (String, Option<String>),
    /// Name of the time stamps.
    pub time: Option<String>,
    /// Sample rate where the file does not say.
    pub sample_rate_hz: Option<f64>,
    /// Limit of the limbs' converter, V.
    pub full_scale_v: f64,
}

impl Expected {
    /// Fills in what the file leaves open: units and the time stamps' channel.
    pub fn complete(&self, layout: &mut Layout) {
        let mut state = |name: &str, unit: Option<&String>| {
            if let Some(index) = position(&layout.channels, name)
                && layout.channels[index].unit.is_none()
            {
                layout.channels[index].unit = unit.cloned();
            }
        };
        for limb in &self.limbs {
            state(limb, self.limbs_unit.as_ref());
        }
        state(&self.accelerometer.0, self.accelerometer.1.as_ref());
        state(&self.gyroscope.0, self.gyroscope.1.as_ref());
        if let Some(time) = &self.time {
            layout.time = position(&layout.channels, time).or(layout.time);
        }
    }

    /// Standards that this recording's motion does not reach, and that may therefore read one value throughout.
    #[must_use]
    pub fn may_be_still(&self, name: &str) -> bool {
        let (accelerometer, gyroscope) = match self.role {
            Some(Role::Static | Role::Tap) => (true, true),
            Some(Role::Linear | Role::HighFrequencyLinear) => (false, true),
            Some(Role::Angular) => (true, false),
            Some(Role::Validation) | None => (false, false),
        };
        (accelerometer && last_part(name) == last_part(&self.accelerometer.0))
            || (gyroscope && last_part(name) == last_part(&self.gyroscope.0))
    }

    /// Limit of a channel's converter in the channel's unit; infinite if it is none of the limbs.
    #[must_use]
    pub fn full_scale(&self, channels: &[Channel], index: usize) -> f64 {
        let limb = self
            .limbs
            .iter()
            .any(|name| position(channels, name) == Some(index));
        match channels[index].unit.as_deref().and_then(unit::named) {
            Some(Unit::Voltage(volts)) if limb => self.full_scale_v / volts,
            _ => f64::INFINITY,
        }
    }
}

/// Index of a channel by its name, or by the name without its group.
fn position(channels: &[Channel], name: &str) -> Option<usize> {
    channels
        .iter()
        .position(|c| c.name == name)
        .or_else(|| channels.iter().position(|c| last_part(&c.name) == name))
}

fn last_part(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// What is known of the sensor's channels.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Sensor {
    /// The nine limbs, in order.
    pub limbs: Vec<String>,
    /// Standard accelerometer.
    pub accelerometer: Option<String>,
    /// Standard gyroscope.
    pub gyroscope: Option<String>,
    /// Limbs that read one value throughout.
    pub dead: Vec<String>,
    /// Limbs that show nothing but noise while most others move: dead, or out of this motion's reach.
    pub silent: Vec<String>,
}

/// Finds the sensor's channels: nine limbs by name (`u1` to `u9`, or as the session has them) or, where exactly nine channels are
/// voltages, by unit. None without nine limbs.
#[must_use]
pub fn find(channels: &[&ChannelFacts], expected: Option<&Expected>) -> Option<Sensor> {
    let by_name = |name: &str| {
        channels
            .iter()
            .find(|c| c.name == name)
            .or_else(|| {
                channels
                    .iter()
                    .find(|c| last_part(&c.name).eq_ignore_ascii_case(name))
            })
            .copied()
    };
    let measures = |c: &ChannelFacts, what: &str| {
        c.unit
            .as_ref()
            .and_then(|u| u.measures)
            .is_some_and(|m| m == what)
    };
    let named: Option<Vec<&ChannelFacts>> = match expected {
        Some(expected) => expected.limbs.iter().map(|name| by_name(name)).collect(),
        None => (1..=LIMBS).map(|k| by_name(&format!("u{k}"))).collect(),
    };
    let limbs = named.or_else(|| {
        let volts: Vec<&ChannelFacts> = channels
            .iter()
            .filter(|c| measures(c, "voltage") && standard(&c.name).is_none())
            .copied()
            .collect();
        (volts.len() == LIMBS).then_some(volts)
    })?;
    let standard_of = |what: Standard, unit: &str, stated: Option<&str>| {
        stated
            .and_then(by_name)
            .or_else(|| {
                channels
                    .iter()
                    .find(|c| standard(&c.name) == Some(what))
                    .copied()
            })
            .or_else(|| {
                let mut fitting = channels.iter().filter(|c| measures(c, unit));
                fitting.next().filter(|_| fitting.next().is_none()).copied()
            })
            .map(|c| c.name.clone())
    };
    let over_noise = |c: &&ChannelFacts| {
        c.standard_deviation
            .zip(c.noise_floor)
            .filter(|(_, noise)| *noise > 0.0)
            .map(|(deviation, noise)| deviation / noise)
    };
    let moving = limbs
        .iter()
        .filter(|c| over_noise(c).is_some_and(|ratio| ratio > MOVES))
        .count();
    let names = |some: &dyn Fn(&&ChannelFacts) -> bool| {
        limbs
            .iter()
            .filter(|c| some(c))
            .map(|c| c.name.clone())
            .collect::<Vec<String>>()
    };
    Some(Sensor {
        dead: names(&|c| c.constant),
        silent: names(&|c| {
            moving > LIMBS / 2 && !c.constant && over_noise(c).is_some_and(|ratio| ratio < STILL)
        }),
        accelerometer: standard_of(
            Standard::Accelerometer,
            "acceleration",
            expected.map(|e| e.accelerometer.0.as_str()),
        ),
        gyroscope: standard_of(
            Standard::Gyroscope,
            "rate of rotation",
            expected.map(|e| e.gyroscope.0.as_str()),
        ),
        limbs: limbs.iter().map(|c| c.name.clone()).collect(),
    })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Standard {
    Accelerometer,
    Gyroscope,
}

fn standard(name: &str) -> Option<Standard> {
    let name = last_part(name).to_ascii_lowercase();
    if name.starts_with("acc") {
        Some(Standard::Accelerometer)
    } else if name.starts_with("gyr") {
        Some(Standard::Gyroscope)
    } else {
        None
    }
}
