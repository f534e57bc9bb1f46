//! How good the other parameters must be for step 4 to find k/m.

use anyhow::Result;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use sixaxis_calibration::steps::Campaign;
use sixaxis_core::dsp::outlier::median;
use sixaxis_core::identify::stiffness::{self, StiffnessPerMass};
use sixaxis_core::identify::{Reason, Verdict};
use sixaxis_core::{InertiaPerMass, LIMBS, LimbLaw, Parameters, Scheme};

use super::bias::{FirstOrderSearch, ends};
use crate::study::plan::Plan;
use crate::study::results::identifiability::{Erring, Records, Tolerance, TolerancePoint};

/// Seed of the first draw.
const SEED: u64 = 40_000;
/// Sizes of error: from, to, as powers of ten.
const DECADES: (i32, i32) = (-8, -2);
/// Largest number of parameters of one kind.
const MOST: usize = LIMBS;

/// Curves for scale factors, zero drifts and inertias.
///
/// # Errors
/// Those of the search.
pub fn study(
    plan: &Plan,
    records: Records,
    campaign: &Campaign,
    truth: &Parameters,
    theory: &FirstOrderSearch,
) -> Result<Vec<Tolerance>> {
    [Erring::Scale, Erring::Drift, Erring::Inertia]
        .into_iter()
        .map(|erring| {
            let draws = plan.tolerance_draws();
            let patterns: Vec<[f64; MOST]> = (0..draws as u64).map(|d| pattern(SEED + d)).collect();
            let per_decade = plan.tolerance_sizes_per_decade();
            let points = (0..=(DECADES.1 - DECADES.0) * per_decade)
                .map(|step| {
                    let power = f64::from(DECADES.0) + f64::from(step) / f64::from(per_decade);
                    point(plan, campaign, truth, theory, erring, power, &patterns)
                })
                .collect::<Result<Vec<_>>>()?;
            Ok(Tolerance {
                records,
                erring,
                seed: SEED,
                draws,
                points,
            })
        })
        .collect()
}

fn pattern(seed: u64) -> [f64; MOST] {
    let mut rng = Pcg64::seed_from_u64(seed);
    core::array::from_fn(|_| StandardNormal.sample(&mut rng))
}

fn point(
    plan: &Plan,
    campaign: &Campaign,
    truth: &Parameters,
    theory: &FirstOrderSearch,
    erring: Erring,
    power_of_ten: f64,
    patterns: &[[f64; MOST]],
) -> Result<TolerancePoint> {
    let size = 10.0_f64.powf(power_of_ten);
    let found: Vec<StiffnessPerMass> = patterns
        .par_iter()
        .map(|pattern| {
            let wrong = spoiled(campaign, truth, erring, pattern.map(|unit| size * unit));
            let curve = campaign.search(
                &wrong,
                Scheme::Heun,
                plan.search_stride(),
                LimbLaw::CompressionShortens,
            )?;
            Ok(stiffness::judge(&curve)?)
        })
        .collect::<Result<_>>()?;
    let error = |k: f64| (k / truth.stiffness_per_mass_per_s2).ln().abs();
    let mut errors: Vec<f64> = found.iter().map(|f| error(f.interpolated_per_s2)).collect();
    let share = |holds: &dyn Fn(&Verdict) -> bool| {
        found.iter().filter(|f| holds(&f.verdict)).count() as f64 / found.len() as f64
    };
    let predicted_median = if erring == Erring::Scale {
        let mut predicted = patterns
            .par_iter()
            .map(|pattern| {
                let curve = theory.curve(&pattern.map(|unit| size * unit));
                Ok(error(stiffness::judge(&curve)?.interpolated_per_s2))
            })
            .collect::<Result<Vec<_>>>()?;
        Some(median(&mut predicted))
    } else {
        None
    };
    Ok(TolerancePoint {
        size,
        median: median(&mut errors),
        range: ends(&errors),
        predicted_median,
        at_edge: share(&|verdict| {
            let reason = Reason::EdgeOfGrid;
            *verdict == Verdict::Undetermined { reason }
        }),
        determined: share(&Verdict::is_determined),
    })
}

/// The truth with one kind of parameter in error.
fn spoiled(
    campaign: &Campaign,
    truth: &Parameters,
    erring: Erring,
    errors: [f64; MOST],
) -> Parameters {
    let mut wrong = *truth;
    match erring {
        Erring::Scale => {
            for (s, error) in wrong.scale_per_mass_per_kg.iter_mut().zip(errors) {
                *s *= 1.0 + error;
            }
        }
        Erring::Drift => {
            let full_scale_v = campaign
                .trials
                .first()
                .map_or(f64::NAN, |(trial, _)| trial.full_scale_v);
            for (d, error) in wrong.zero_drift_v.iter_mut().zip(errors) {
                *d += error * full_scale_v;
            }
        }
        Erring::Inertia => {
            let mut entries = truth.inertia_per_mass.to_paper_order();
            let largest = entries.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            for (entry, error) in entries.iter_mut().zip(errors) {
                *entry += error * largest;
            }
            wrong.inertia_per_mass = InertiaPerMass::from_paper_order(entries);
        }
    }
    wrong
}
