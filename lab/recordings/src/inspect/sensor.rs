//! The nine limbs and the standards, where they can be told: from the session, from their names, or from their units.

use std::path::{Path, PathBuf};

use super::facts::{ChannelFacts, Sensor};
use crate::layout::Layout;
use crate::session::{Channels, LIMBS, Role, SessionFile};
use crate::unit::{self, Unit};

/// A limb that shows less than so many times its noise does not move.
const STILL: f64 = 1.5;
/// Limbs that move show more than so many times theirs.
const MOVES: f64 = 30.0;

/// What a session, or the options of a command, say of one file.
#[derive(Debug, Clone, Default)]
pub struct Expected {
    /// The session file that does not have the file among its recordings.
    pub foreign_to: Option<PathBuf>,
    /// What it is for.
    pub role: Option<Role>,
    /// Names and units of its channels.
    pub channels: Channels,
    /// Sample rate where the file does not say.
    pub sample_rate_hz: Option<f64>,
    /// Limit of the limbs' converter, V.
    pub full_scale_v: Option<f64>,
}

impl Expected {
    /// What a session says of the file at `path`, whether it is a recording of the session or the file of its standards.
    pub fn of(file: &SessionFile, path: &Path) -> Self {
        let session = &file.session;
        let own = session.recording.iter().find(|e| file.names(&e.file, path));
        let standards = session.recording.iter().find(|e| {
            e.reference_file
                .as_deref()
                .is_some_and(|listed| file.names(listed, path))
        });
        let entry = own.or(standards);
        Self {
            foreign_to: entry.is_none().then(|| file.path.clone()),
            role: own.map(|e| e.role),
            channels: entry
                .and_then(|e| e.channels.as_ref())
                .unwrap_or(&session.channels)
                .clone(),
            sample_rate_hz: own
                .and_then(|e| e.sample_rate_hz)
                .or_else(|| standards.and_then(|e| e.reference_sample_rate_hz)),
            full_scale_v: Some(session.sensor.full_scale_v),
        }
    }

    /// Fills in what the file leaves open: units and the time stamps' channel.
    pub fn complete(&self, layout: &mut Layout) {
        let stated = &self.channels;
        let limbs = stated.limbs.iter().map(|name| (name, &stated.limbs_unit));
        for (name, unit) in limbs.chain([
            (&stated.accelerometer, &stated.accelerometer_unit),
            (&stated.gyroscope, &stated.gyroscope_unit),
        ]) {
            if let Some(index) = layout.position(name)
                && layout.channels[index].unit.is_none()
            {
                layout.channels[index].unit.clone_from(unit);
            }
        }
        if let Some(time) = &stated.time {
            layout.time = layout.position(time).or(layout.time);
        }
    }

    /// Standards that this recording's motion does not reach, and that may therefore read one value throughout.
    pub fn may_be_still(&self, name: &str) -> bool {
        let (accelerometer, gyroscope) = match self.role {
            Some(Role::Static | Role::Tap) => (true, true),
            Some(Role::Linear | Role::HighFrequencyLinear) => (false, true),
            Some(Role::Angular) => (true, false),
            Some(Role::Validation) | None => (false, false),
        };
        let is = |stated: &str| last_part(name) == last_part(stated);
        (accelerometer && is(&self.channels.accelerometer))
            || (gyroscope && is(&self.channels.gyroscope))
    }

    /// Limit of a channel's converter in the channel's unit; infinite if it is none of the limbs.
    pub fn full_scale(&self, layout: &Layout, index: usize) -> f64 {
        let mut limbs = self.channels.limbs.iter();
        let limb = limbs.any(|name| layout.position(name) == Some(index));
        match layout.channels[index].unit.as_deref().and_then(unit::named) {
            Some(Unit::Voltage(volts)) if limb => self
                .full_scale_v
                .map_or(f64::INFINITY, |limit| limit / volts),
            _ => f64::INFINITY,
        }
    }
}

/// A TDMS name without its group.
pub(super) fn last_part(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// Finds the sensor's channels: nine limbs by name (`u1` to `u9`, or as the session has them) or, where exactly nine channels are
/// voltages, by unit. None without nine limbs.
pub fn find(channels: &[&ChannelFacts], expected: Option<&Expected>) -> Option<Sensor> {
    let some = |which: &dyn Fn(&ChannelFacts) -> bool| -> Vec<&ChannelFacts> {
        channels.iter().copied().filter(|c| which(c)).collect()
    };
    let first = |which: &dyn Fn(&ChannelFacts) -> bool| some(which).first().copied();
    let by_name = |name: &str| {
        first(&|c| c.name == name)
            .or_else(|| first(&|c| last_part(&c.name).eq_ignore_ascii_case(name)))
    };
    let names = expected.map_or_else(|| Channels::default().limbs, |e| e.channels.limbs.clone());
    let named: Option<Vec<&ChannelFacts>> = names.iter().map(|name| by_name(name)).collect();
    // Where most of the names are there, another channel is none of the missing ones.
    let there = names.iter().filter(|name| by_name(name).is_some()).count();
    if expected.is_none() && (LIMBS / 2 + 1..LIMBS).contains(&there) {
        return None;
    }
    let limbs = named.or_else(|| {
        let volts =
            some(&|c| c.measures("voltage") && !is_standard(c, "acc") && !is_standard(c, "gyr"));
        (volts.len() == LIMBS).then_some(volts)
    })?;
    let standard = |stated: Option<&String>, initial: &str, quantity: &str| {
        stated
            .and_then(|name| by_name(name))
            .or_else(|| first(&|c| is_standard(c, initial)))
            .or_else(|| match some(&|c| c.measures(quantity)).as_slice() {
                [only] => Some(*only),
                _ => None,
            })
            .map(|c| c.name.clone())
    };
    let over_noise = |c: &ChannelFacts| match (c.standard_deviation, c.noise_floor) {
        (Some(deviation), Some(noise)) if noise > 0.0 => Some(deviation / noise),
        _ => None,
    };
    let moves = |c: &&&ChannelFacts| over_noise(c).is_some_and(|ratio| ratio > MOVES);
    let most_move = limbs.iter().filter(moves).count() > LIMBS / 2;
    let silent = |c: &ChannelFacts| {
        most_move && !c.constant && over_noise(c).is_some_and(|ratio| ratio < STILL)
    };
    let names = |which: &dyn Fn(&ChannelFacts) -> bool| -> Vec<String> {
        let limbs = limbs.iter().filter(|c| which(c));
        limbs.map(|c| c.name.clone()).collect()
    };
    Some(Sensor {
        dead: names(&|c| c.constant && c.finite() > 1),
        silent: names(&silent),
        accelerometer: standard(
            expected.map(|e| &e.channels.accelerometer),
            "acc",
            "acceleration",
        ),
        gyroscope: standard(
            expected.map(|e| &e.channels.gyroscope),
            "gyr",
            "rate of rotation",
        ),
        limbs: names(&|_| true),
    })
}

/// Whether a channel's name begins as that of a standard.
fn is_standard(channel: &ChannelFacts, initial: &str) -> bool {
    last_part(&channel.name)
        .to_ascii_lowercase()
        .starts_with(initial)
}
