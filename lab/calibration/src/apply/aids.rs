//! What a user says of a motion beside the recording: `--aid`.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Context, Result, ensure};
use glam::DQuat;
use sixaxis_core::aided::Aid;
use sixaxis_recordings::ingest::columns::{BLOCK, Columns};
use sixaxis_recordings::ingest::find;

/// Departure of a quaternion's length from 1 that rounding in a file may make.
const UNIT: f64 = 1e-3;

/// Something known of the motion.
#[derive(Debug, Clone, PartialEq)]
pub enum AidChoice {
    /// Where nine channels show nothing but noise, the sensor is at rest.
    Rest,
    /// It moves about where it is: its velocity is zero but for what the motion has of it at any time.
    Velocity {
        /// Time after which velocities are independent, s.
        every_s: f64,
        /// Standard deviation of each component, m/s.
        deviation_m_s: f64,
    },
    /// A file tells the attitude from time to time.
    Attitude {
        /// The file: columns time, qw, qx, qy, qz.
        file: PathBuf,
        /// Standard deviation about each axis, degrees.
        deviation_deg: f64,
    },
}

impl AidChoice {
    /// Its name on the command line.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Velocity { .. } => "velocity",
            Self::Attitude { .. } => "attitude",
        }
    }

    /// The file that it reads.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Attitude { file, .. } => Some(file),
            Self::Rest | Self::Velocity { .. } => None,
        }
    }
}

impl FromStr for AidChoice {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let positive = |word: &str, what: &str| match word.trim().parse::<f64>() {
            Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
            _ => Err(format!("{word:?} is no positive {what}")),
        };
        let (name, rest) = text.split_once('=').unwrap_or((text, ""));
        match (name, rest.rsplit_once(',')) {
            ("rest", None) if rest.is_empty() => Ok(Self::Rest),
            ("velocity", Some((every, deviation))) => Ok(Self::Velocity {
                every_s: positive(every, "time in s")?,
                deviation_m_s: positive(deviation, "velocity in m/s")?,
            }),
            ("attitude", Some((file, deviation))) if !file.is_empty() => Ok(Self::Attitude {
                file: file.into(),
                deviation_deg: positive(deviation, "angle in degrees")?,
            }),
            _ => Err("give rest, velocity=SECONDS,M_PER_S or attitude=FILE,DEGREES".to_owned()),
        }
    }
}

/// An attitude at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fix {
    /// Its place in the file, from 1.
    pub number: usize,
    /// On the recording's clock, s.
    pub time_s: f64,
    /// What is known then.
    pub aid: Aid,
}

/// Reads attitudes, shell axes to ground axes, in the order of time.
///
/// # Errors
/// A file that cannot be read, lacks a column, goes back in time or has a quaternion that is not of unit length.
pub fn fixes(path: &Path, deviation_deg: f64) -> Result<VecDeque<Fix>> {
    let place = path.display();
    let source = sixaxis_recordings::open(path)?;
    let layout = source.layout().clone();
    let time = find::time(path, &layout, None)?
        .with_context(|| format!("{place}: no column of times, in s"))?;
    let mut wanted = vec![time];
    wanted.extend(find::attitude(path, &layout)?);
    let mut columns = Columns::new(path, source, wanted, None, None)?;
    let mut fixes = VecDeque::new();
    let mut last_s = f64::NEG_INFINITY;
    while columns.read(BLOCK)? > 0 {
        for row in 0..columns.column(0).len() {
            let [time_s, w, x, y, z] = core::array::from_fn(|k| columns.column(k)[row]);
            let attitude = DQuat::from_xyzw(x, y, z, w);
            let number = fixes.len() + 1;
            ensure!(
                (attitude.length() - 1.0).abs() < UNIT,
                "{place}: attitude {number}: a quaternion of length {:.3}, and rotations have 1",
                attitude.length()
            );
            ensure!(
                time_s > last_s,
                "{place}: attitude {number}: its time, {time_s} s, is not after the one before"
            );
            last_s = time_s;
            let aid = Aid::Attitude {
                attitude: attitude.normalize(),
                deviation_rad: deviation_deg.to_radians(),
            };
            fixes.push_back(Fix {
                number,
                time_s,
                aid,
            });
        }
    }
    ensure!(!fixes.is_empty(), "{place}: no attitudes in it");
    Ok(fixes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inv_an_aid_is_what_its_text_says() {
        assert_eq!("rest".parse(), Ok(AidChoice::Rest));
        assert_eq!(
            "velocity=5,0.2".parse(),
            Ok(AidChoice::Velocity {
                every_s: 5.0,
                deviation_m_s: 0.2
            })
        );
        assert_eq!(
            "attitude=a,b.csv,0.5".parse(),
            Ok(AidChoice::Attitude {
                file: "a,b.csv".into(),
                deviation_deg: 0.5
            })
        );
        for wrong in [
            "",
            "rest=1",
            "velocity",
            "velocity=5",
            "velocity=-1,2",
            "velocity=1,nan",
            "attitude=,1",
            "attitude=a",
            "gravity",
        ] {
            assert!(wrong.parse::<AidChoice>().is_err(), "{wrong}");
        }
    }
}
