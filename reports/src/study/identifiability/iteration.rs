//! Steps 2 to 4 repeated until k/m stands still, from several starts.

use anyhow::{Context, Result};
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
    let starts = [None, Some(first.design_stiffness_per_mass_per_s2)]
        .into_iter()
        .chain(STARTS_OVER_TRUTH.map(|share| Some(share * truth_per_s2)));
    runs(records, campaign, first, truth, starts, false)
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
    let mut all = Vec::new();
    for records in RECORDS {
        let campaign = recorded(campaign, records);
        let first = searched(&campaign, first)?;
        let starts = [None, Some(first.design_stiffness_per_mass_per_s2)];
        all.extend(runs(
            records,
            &campaign,
            &first,
            truth,
            starts.into_iter(),
            true,
        )?);
    }
    Ok(all)
}

fn runs(
    records: Records,
    campaign: &Campaign,
    first: &FourSteps,
    truth: &Parameters,
    starts: impl Iterator<Item = Option<f64>>,
    with_errors: bool,
) -> Result<Vec<IterationRun>> {
    starts
        .map(|start_per_s2| {
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
