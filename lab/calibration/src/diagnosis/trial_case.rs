//! A trial under diagnosis, and the facts of its session.

use sixaxis_core::{Geometry, LIMBS, Parameters};
use sixaxis_recordings::session::Rig;

use crate::conditioning::Conditioned;
use crate::response::Response;
use crate::trial::Trial;

/// What the session says of a standard.
#[derive(Debug, Clone, Copy)]
pub struct Standard {
    /// Largest relative error of its sensitivity.
    pub gain_limit: f64,
    /// First-order lag, s.
    pub lag_s: f64,
}

/// Facts of the session that the diagnosis uses.
#[derive(Debug, Clone, Copy)]
pub struct Facts<'a> {
    /// The sensor's lengths.
    pub geometry: Geometry,
    /// Design values.
    pub design: &'a Parameters,
    /// What is known of the rig.
    pub rig: Option<&'a Rig>,
    /// The standard accelerometer.
    pub accelerometer: Standard,
    /// The standard gyroscope.
    pub gyroscope: Standard,
    /// Largest relative error that the gyroscope's certificate allows.
    pub gyroscope_class: f64,
    /// Whether a gyroscope's lag is being undone.
    pub gyroscope_lag_undone: bool,
}

/// One trial under diagnosis.
#[derive(Debug, Clone)]
pub struct TrialCase<'a> {
    /// As recorded.
    pub trial: &'a Trial,
    /// As conditioned.
    pub conditioned: &'a Conditioned,
    /// Measured forces less the zero drift and the expected share of gravity, N.
    pub force_n: Vec<[f64; LIMBS]>,
    /// What each channel shows of it; none where nothing could be fitted.
    pub response: Option<Response>,
    /// Channels that something has already been found about.
    pub ignored: [bool; LIMBS],
    /// An earlier finding explains this trial; later stages pass it over.
    pub explained: bool,
}

/// Angle turned since the first sample, rad, by the trapezoidal rule.
pub(crate) fn angles(conditioned: &Conditioned, trial: &Trial) -> impl Iterator<Item = f64> {
    let step_s = 1.0 / trial.sample_rate_hz;
    let direction = trial.direction_ground;
    let (mut angle, mut before) = (0.0, 0.0);
    conditioned.rate_shell_rad_s.iter().map(move |rate| {
        let now = rate.dot(direction);
        angle += 0.5 * (before + now) * step_s;
        before = now;
        angle
    })
}

/// Marks these cases as explained by a finding, and returns the names of their recordings.
pub(crate) fn mark_explained(
    cases: &mut [TrialCase<'_>],
    indices: impl IntoIterator<Item = usize>,
) -> Vec<String> {
    let mark = |index: usize| {
        cases[index].explained = true;
        cases[index].trial.name.clone()
    };
    indices.into_iter().map(mark).collect()
}

/// The names of some trials.
pub(crate) fn names<'s, 'a: 's>(cases: impl IntoIterator<Item = &'s TrialCase<'a>>) -> Vec<String> {
    cases
        .into_iter()
        .map(|case| case.trial.name.clone())
        .collect()
}
