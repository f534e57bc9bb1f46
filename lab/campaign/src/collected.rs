//! A played session as the analysis has it: its recordings as trials, conditioned, without a detour by files.

use rayon::prelude::*;
use sixaxis_calibration::conditioning::{Conditioned, Conditioning};
use sixaxis_calibration::steps::Campaign;
use sixaxis_calibration::trial::{Readings, Trial};
use sixaxis_recordings::ingest::averaged::Averaged;
use sixaxis_recordings::session::{LIMBS, Role, Session};
use sixaxis_reference::session::play::Played;

use crate::row::Status;

/// What a laboratory has of a session.
#[derive(Debug, Clone)]
pub struct Collected {
    /// Trials of steps 2 to 4, conditioned, and the static record.
    pub campaign: Campaign,
    /// Taps.
    pub taps: Vec<Trial>,
    /// The conditioning that was done.
    pub conditioning: Conditioning,
}

/// Why there are no parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// How far the session got.
    pub status: Status,
    /// The reason.
    pub cause: String,
}

/// Sorts a session's recordings by what they are for and cleans those of steps 2 to 4.
///
/// # Errors
/// The first recording that cannot be conditioned.
pub fn collect(session: &Session, recordings: Vec<Played>) -> Result<Collected, Failure> {
    let conditioning = Conditioning::of(session);
    let mut static_voltage_v = Vec::new();
    let mut moving = Vec::new();
    let mut struck = Vec::new();
    for recording in recordings {
        match recording.entry.role {
            Role::Static => static_voltage_v = at_rest(&recording),
            // Held against the standards, never fitted.
            Role::Validation => {}
            Role::Tap => struck.push(trial(session, recording)),
            _ => moving.push(recording),
        }
    }
    let trials = moving
        .into_par_iter()
        .map(|recording| {
            let trial = trial(session, recording);
            let conditioned = conditioning.condition(&trial).map_err(|error| Failure {
                status: Status::NotCleaned,
                cause: format!("{}: {error}", trial.name),
            })?;
            Ok((trial, conditioned))
        })
        .collect::<Result<Vec<(Trial, Conditioned)>, Failure>>()?;
    let campaign = Campaign {
        geometry: session.sensor.geometry(),
        design: session.sensor.design(),
        static_voltage_v,
        trials,
    };
    Ok(Collected {
        campaign,
        taps: struck,
        conditioning,
    })
}

fn at_rest(recording: &Played) -> Vec<[f64; LIMBS]> {
    let mut averaged: [Averaged; LIMBS] = Default::default();
    for row in &recording.voltage_v {
        for (averaged, voltage_v) in averaged.iter_mut().zip(row) {
            averaged.push(*voltage_v);
        }
    }
    let columns = averaged.map(Averaged::finish);
    (0..columns[0].len())
        .map(|row| core::array::from_fn(|limb| columns[limb][row]))
        .collect()
}

fn trial(session: &Session, recording: Played) -> Trial {
    let readings = Readings {
        sample_rate_hz: recording.sample_rate_hz,
        voltage_v: recording.voltage_v,
        accelerometer_m_s2: recording.accelerometer_m_s2,
        gyroscope_rad_s: recording.gyroscope_rad_s,
    };
    Trial::of(session, &recording.entry, readings)
}
