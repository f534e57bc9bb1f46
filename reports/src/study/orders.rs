//! Error of each scheme against the sample rate, on MuJoCo's 5 Hz compound run.

use anyhow::Result;
use rayon::prelude::*;
use sixaxis_core::{Parameters, Scheme};
use sixaxis_props::truth;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::mujoco::threshold::log_slope;

use super::decoupling::decouple;
use super::results::{Gravity, Order};

/// Points nearer than this factor to the reference's own error say nothing of the scheme.
const ABOVE_REFERENCE: f64 = 10.0;
/// Lowest sample rate at which a scheme's error has taken its asymptotic form: 80 samples a cycle.
const ASYMPTOTIC_RATE_HZ: f64 = 399.0;

/// Largest error of w* over its peak.
fn rate_error(run: &SimulatedRun, parameters: &Parameters, scheme: Scheme) -> Result<f64> {
    let recording = Laboratory::noise_free(truth::sensor(parameters)).record(run, 0);
    let samples = decouple(
        &recording,
        &recording.voltage_v,
        parameters,
        scheme,
        Gravity::Kept,
    )?;
    let (mut largest, mut peak) = (0.0_f64, 0.0_f64);
    for sample in &samples {
        let truth = run.truth[sample.sample as usize].rate_shell_rad_s;
        largest = largest.max((sample.rate_shell_rad_s - truth).length());
        peak = peak.max(truth.length());
    }
    Ok(largest / peak)
}

/// Errors of all schemes over the sample rates that the divisors give.
///
/// # Errors
/// Those of the decoupler.
pub fn study(
    run: &SimulatedRun,
    parameters: &Parameters,
    divisors: &[usize],
) -> Result<Vec<Order>> {
    // The best scheme at the highest rate leaves the reference's own error and nothing else to speak of.
    let reference_error = rate_error(run, parameters, Scheme::AdamsMoulton4)?;
    Scheme::ALL
        .into_par_iter()
        .map(|scheme| {
            let points = divisors
                .iter()
                .map(|&divisor| {
                    let run = run.decimated(divisor);
                    Ok((run.sample_rate_hz, rate_error(&run, parameters, scheme)?))
                })
                .collect::<Result<Vec<_>>>()?;
            let fit: Vec<(f64, f64)> = points
                .iter()
                .filter(|(rate, error)| {
                    *rate >= ASYMPTOTIC_RATE_HZ && *error > ABOVE_REFERENCE * reference_error
                })
                .copied()
                .collect();
            Ok(Order {
                scheme,
                theoretical: scheme.order(),
                points,
                measured: (fit.len() >= 3).then(|| -log_slope(fit)),
                reference_error,
            })
        })
        .collect()
}
