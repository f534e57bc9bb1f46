//! Steps 2 to 4 repeated until k/m stands still, from several starts.

use anyhow::{Context, Result};
use rayon::prelude::*;
use sixaxis_calibration::iteration::Criterion;
use sixaxis_calibration::steps::{Campaign, FourSteps};
use sixaxis_core::Parameters;

use super::{RECORDS, recorded, searched};
use crate::study::results::identifiability::{IterationRun, Records};

/// Starts besides step 4's own and the design's, over the true k/m.
const STARTS_OVER_TRUTH: [f64; 2] = [0.5, 2.0];

/// On records without errors: from step 4's own k/m, the design's, half and twice the true one.
///
/// # Errors
/// The first step which refuses its data.
pub fn noise_free(
    records: Records,
    campaign: &Campaign,
    first: &FourSteps,
    truth: &Parameters,
) -> Result<Vec<IterationRun>> {
    let truth_per_s2 = truth.stiffness_per_mass_per_s2;
    let [half, double] = STARTS_OVER_TRUTH.map(|share| Some(share * truth_per_s2));
    let design = Some(first.design_stiffness_per_mass_per_s2);
    let starts = [None, design, half, double];
    runs(records, campaign, first, truth, &starts, false)
}

/// On records with a laboratory's errors: from step 4's own k/m and the design's.
///
/// # Errors
/// As [`noise_free`].
pub fn with_errors(
    campaign: &Campaign,
    first: &FourSteps,
    truth: &Parameters,
) -> Result<Vec<IterationRun>> {
    let all = RECORDS.into_par_iter().map(|records| {
        let campaign = recorded(campaign, records);
        let first = searched(&campaign, first)?;
        let starts = [None, Some(first.design_stiffness_per_mass_per_s2)];
        runs(records, &campaign, &first, truth, &starts, true)
    });
    Ok(all.collect::<Result<Vec<_>>>()?.concat())
}

fn runs(
    records: Records,
    campaign: &Campaign,
    first: &FourSteps,
    truth: &Parameters,
    starts: &[Option<f64>],
    with_errors: bool,
) -> Result<Vec<IterationRun>> {
    starts
        .par_iter()
        .map(|&start_per_s2| {
            let iteration = campaign
                .repeat_until(first, start_per_s2, &Criterion::default())
                .context("steps 2 to 4, repeated")?;
            Ok(IterationRun {
                records,
                with_errors,
                start_per_s2,
                truth_per_s2: truth.stiffness_per_mass_per_s2,
                sentence: iteration.sentence(),
                passes: iteration.passes,
                end: iteration.end,
            })
        })
        .collect()
}
