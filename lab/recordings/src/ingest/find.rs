//! Names to channels: the nine limbs, the two standards, the time stamps, the columns of a motion.

use std::path::Path;

use super::units;
use crate::error::{Error, Result};
use crate::layout::Layout;
use crate::motion::MOTION_CHANNELS;
use crate::session::{Channels, LIMBS, Session};
use crate::unit::{STANDARD_GRAVITY_M_S2, Unit};

/// Columns of a motion without which it is none: its six accelerations.
pub const ACCELERATIONS: usize = 6;

/// A channel of a file that is to be read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Column {
    /// Its index in [`Layout::channels`].
    pub index: usize,
    /// Its name in the file.
    pub name: String,
    /// Size of its unit in SI: V, m/s^2, rad/s, rad/s^2 or s.
    pub size_si: f64,
}

impl Column {
    /// A channel of a layout with the size of its unit.
    pub fn new(layout: &Layout, index: usize, size_si: f64) -> Self {
        Self {
            index,
            name: layout.channels[index].name.clone(),
            size_si,
        }
    }
}

/// Index of a channel by its name, or by the last part of a TDMS name, `group/channel`, if only one group has it.
///
/// # Errors
/// [`Error::NoSuchChannel`].
fn position(path: &Path, layout: &Layout, name: &str) -> Result<usize> {
    layout
        .position(name)
        .ok_or_else(|| layout.no_such_channel(path, name))
}

/// The nine limbs, in V.
///
/// # Errors
/// Those of [`limb`].
pub fn limbs(path: &Path, layout: &Layout, channels: &Channels) -> Result<[Column; LIMBS]> {
    let mut limbs: [Column; LIMBS] = Default::default();
    for (number, column) in limbs.iter_mut().enumerate() {
        *column = limb(path, layout, channels, number)?;
    }
    Ok(limbs)
}

/// One of the nine limbs, from 0, in V.
///
/// # Errors
/// [`Error::NoSuchChannel`]; [`Error::Unit`] for a channel that is no voltage or in no unit that is known.
pub fn limb(path: &Path, layout: &Layout, channels: &Channels, limb: usize) -> Result<Column> {
    let index = position(path, layout, &channels.limbs[limb])?;
    let volts = units::volts(path, &layout.channels[index], channels)?;
    Ok(Column::new(layout, index, volts))
}

/// Accelerometer, in m/s^2, and gyroscope, in rad/s.
///
/// # Errors
/// [`Error::NoSuchChannel`]; [`Error::Unit`] for a unit of something else, and for a voltage without a sensitivity.
pub fn standards(
    path: &Path,
    layout: &Layout,
    channels: &Channels,
    session: &Session,
) -> Result<[Column; 2]> {
    let find = |name: &str, unit: Option<&str>, sensitivity| {
        let index = position(path, layout, name)?;
        let size = units::standard(path, &layout.channels[index], unit, sensitivity)?;
        Ok(Column::new(layout, index, size))
    };
    let accelerometer = (
        Unit::Acceleration(STANDARD_GRAVITY_M_S2),
        session.accelerometer.sensitivity_mv_per_g,
        "accelerometer.sensitivity_mv_per_g",
    );
    let gyroscope = (
        Unit::Rate(core::f64::consts::PI / 180.0),
        session.gyroscope.sensitivity_mv_per_deg_s,
        "gyroscope.sensitivity_mv_per_deg_s",
    );
    let (accelerometer_unit, gyroscope_unit) = (
        channels.accelerometer_unit.as_deref(),
        channels.gyroscope_unit.as_deref(),
    );
    Ok([
        find(&channels.accelerometer, accelerometer_unit, accelerometer)?,
        find(&channels.gyroscope, gyroscope_unit, gyroscope)?,
    ])
}

/// The time stamps, in s: the channel of this name, or else the one that the layout takes for them.
///
/// # Errors
/// [`Error::NoSuchChannel`] for a name that is not there; [`Error::Unit`] for a unit that is not one of time.
pub fn time(path: &Path, layout: &Layout, name: Option<&str>) -> Result<Option<Column>> {
    let index = match name {
        Some(name) => Some(position(path, layout, name)?),
        None => layout.time,
    };
    index
        .map(|index| {
            let seconds = units::seconds(path, &layout.channels[index])?;
            Ok(Column::new(layout, index, seconds))
        })
        .transpose()
}

/// The columns of a motion, in the order and units of [`MOTION_CHANNELS`]. Rates and attitude may be missing.
///
/// # Errors
/// [`Error::NoSuchChannel`] for a missing acceleration; [`Error::Unit`].
pub fn motion(path: &Path, layout: &Layout) -> Result<[Option<Column>; MOTION_CHANNELS.len()]> {
    let mut columns = [const { None }; MOTION_CHANNELS.len()];
    for (k, (name, unit)) in MOTION_CHANNELS.into_iter().enumerate() {
        let index = match position(path, layout, name) {
            Err(Error::NoSuchChannel { .. }) if k >= ACCELERATIONS => continue,
            found => found?,
        };
        let size = units::motion(path, &layout.channels[index], unit)?;
        columns[k] = Some(Column::new(layout, index, size));
    }
    Ok(columns)
}

/// The columns of an attitude as a unit quaternion: qw, qx, qy, qz.
///
/// # Errors
/// [`Error::NoSuchChannel`]; [`Error::Unit`].
pub fn attitude(path: &Path, layout: &Layout) -> Result<Vec<Column>> {
    let names = MOTION_CHANNELS.into_iter().skip(MOTION_CHANNELS.len() - 4);
    names
        .map(|(name, unit)| {
            let index = position(path, layout, name)?;
            let size = units::motion(path, &layout.channels[index], unit)?;
            Ok(Column::new(layout, index, size))
        })
        .collect()
}
