//! Where calibration, session and user contradict one another about a recording: refused, or said.

use anyhow::{Result, bail};
use sixaxis_core::{Gains, LIMBS, LimbSet};
use sixaxis_recordings::session::{Entry, Role, SessionFile};

use super::setup::Overrides;
use crate::calibration::Calibration;

/// Lengths that are further apart are of two drawings, relative: a file may have rounded them.
const SAME_LENGTH: f64 = 1e-6;

/// Where down is by a session's entry, with the key that says it.
pub(super) fn stated_down(entry: &Entry) -> Option<(&'static str, [f64; 3])> {
    match (entry.role, entry.down, entry.direction) {
        (Role::Static, ..) => None,
        (_, Some(down), _) => Some(("down", down)),
        // Without a word the rig's axis stands upright: gravity does not turn in the sensor.
        (_, None, Some(direction)) => Some(("direction", direction.map(|x| 0.0 - x))),
        (_, None, None) => None,
    }
}

/// What the user says otherwise than the session, in sentences: nothing is overruled in silence.
pub(super) fn overruled(file: &SessionFile, entry: &Entry, overrides: &Overrides) -> Vec<String> {
    let session = &file.session;
    let channels = entry.channels.as_ref().unwrap_or(&session.channels);
    let gains = entry.gain_n_per_v.unwrap_or(session.sensor.gain_n_per_v);
    let text = |numbers: &[f64]| {
        numbers
            .iter()
            .map(f64::to_string)
            .collect::<Vec<_>>()
            .join(",")
    };
    let said = [
        (
            "--rate",
            entry.sample_rate_hz.map(|hz| format!("{hz} Hz")),
            overrides.rate_hz.map(|hz| format!("{hz} Hz")),
        ),
        (
            "--gain",
            Some(format!("{} N/V", list(&gains.each()))),
            match overrides.gain_n_per_v.as_slice() {
                [] => None,
                [one] => Some(format!("{one} N/V")),
                nine => Some(format!("{} N/V", text(nine))),
            },
        ),
        (
            "--down",
            stated_down(entry).map(|(key, down)| format!("{key} {}", text(&down))),
            overrides.down.map(|down| format!("down {}", text(&down))),
        ),
        (
            "--channels",
            Some(channels.limbs.join(",")),
            overrides.limbs.as_ref().map(|names| names.join(",")),
        ),
        (
            "--unit",
            channels.limbs_unit.clone(),
            overrides.limbs_unit.clone(),
        ),
    ];
    let path = file.path.display();
    let differ = said.into_iter().filter_map(|(option, stated, used)| {
        let (stated, used) = (stated?, used?);
        (stated != used)
            .then(|| format!("{path} states {stated}; {option} overrules it: {used} used"))
    });
    differ.collect()
}

/// Gains of another sign than at the calibration. Where all nine have it, nothing in the voltages contradicts it.
pub(super) fn other_signs(calibrated: &Gains, used: &Gains) -> Option<String> {
    let limbs = (0..LIMBS)
        .filter(|&limb| calibrated.gain_n_per_v[limb] * used.gain_n_per_v[limb] < 0.0)
        .fold(LimbSet::EMPTY, LimbSet::with);
    let (have, what) = match limbs.len() {
        0 => return None,
        1 => (format!("the gain of limb {limbs} has"), "its signal is"),
        LIMBS => ("all nine gains have".to_owned(), "accelerations are"),
        _ => (
            format!("the gains of limbs {limbs} have"),
            "their signals are",
        ),
    };
    Some(format!(
        "{have} another sign than at the calibration: unless plugs were turned since, {what} of the wrong sign"
    ))
}

/// Refuses a session whose sensor is not the one that was calibrated.
///
/// # Errors
/// The serial number or length that differs.
pub fn same_sensor(calibration: &Calibration, file: &SessionFile) -> Result<()> {
    let (ours, theirs) = (&calibration.sensor, &file.session.sensor);
    let path = file.path.display();
    if ours.serial != theirs.serial && !ours.serial.is_empty() && !theirs.serial.is_empty() {
        bail!(
            "{path}: it is a session of sensor {:?}, and the calibration is of {:?}",
            theirs.serial,
            ours.serial
        );
    }
    let lengths = [
        ("limb_length_mm", ours.limb_length_m, theirs.limb_length_mm),
        ("half_edge_mm", ours.half_edge_m, theirs.half_edge_mm),
    ];
    for (key, calibrated_m, stated_mm) in lengths {
        if (1e3 * calibrated_m / stated_mm - 1.0).abs() > SAME_LENGTH {
            bail!(
                "{path}: {key} is {stated_mm}, and the calibration is of a sensor with {}",
                1e3 * calibrated_m
            );
        }
    }
    Ok(())
}

/// Gains as one number where they are one.
pub(super) fn list(gains: &[f64; LIMBS]) -> String {
    if gains.iter().all(|gain| gain == &gains[0]) {
        return gains[0].to_string();
    }
    let texts: Vec<String> = gains.iter().map(f64::to_string).collect();
    texts.join(",")
}
