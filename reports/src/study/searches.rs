//! Fig. 10 again, and what errors of the scale factors do to it.

use anyhow::Result;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use sixaxis_calibration::steps::{Campaign, FourSteps};
use sixaxis_core::identify::stiffness;
use sixaxis_core::{LimbLaw, Parameters, Scheme};

use super::results::Search;

/// Root mean square relative errors put on the scale factors.
pub const SCALE_ERRORS: [f64; 4] = [1e-6, 1e-5, 1e-4, 1e-3];

/// Seed of the pattern of scale errors; the pattern is the same at every size, so that the curves tell one story.
const PATTERN_SEED: u64 = 20131;

/// All curves of the figure, from every `stride`-th sample.
///
/// # Errors
/// Those of the search.
pub fn study(
    noise_free: &Campaign,
    found: &FourSteps,
    laboratory: &FourSteps,
    truth: &Parameters,
    stride: usize,
) -> Result<Vec<Search>> {
    let mut rng = Pcg64::seed_from_u64(PATTERN_SEED);
    let mut pattern: [f64; 9] = core::array::from_fn(|_| StandardNormal.sample(&mut rng));
    let size = (pattern.iter().map(|x| x * x).sum::<f64>() / 9.0).sqrt();
    pattern = pattern.map(|x| x / size);

    let mut searches = Vec::new();
    for sign in [LimbLaw::CompressionShortens, LimbLaw::AsPrinted] {
        for scale_error in core::iter::once(0.0).chain(SCALE_ERRORS) {
            let mut parameters = *truth;
            for (s, unit) in parameters.scale_per_mass_per_kg.iter_mut().zip(pattern) {
                *s *= 1.0 + scale_error * unit;
            }
            let curve = noise_free.search(&parameters, Scheme::Heun, stride, sign)?;
            let label = if scale_error == 0.0 {
                "true scale factors"
            } else {
                "scale factors in error"
            };
            searches.push(search(label, sign, Some(scale_error), curve)?);
        }
    }
    for (label, steps) in [
        ("four steps, noise-free", found),
        ("four steps, laboratory errors", laboratory),
    ] {
        let curve = steps.curve.clone();
        searches.push(search(label, LimbLaw::CompressionShortens, None, curve)?);
    }
    Ok(searches)
}

fn search(
    label: &str,
    sign: LimbLaw,
    scale_error: Option<f64>,
    curve: Vec<(f64, f64)>,
) -> Result<Search> {
    let judged = stiffness::judge(&curve)?;
    Ok(Search {
        label: label.to_owned(),
        sign_as_printed: sign == LimbLaw::AsPrinted,
        scale_error,
        curve,
        grid_minimum_per_s2: judged.grid_minimum_per_s2,
        interpolated_per_s2: judged.interpolated_per_s2,
        verdict: judged.verdict,
    })
}
