//! How well the campaign with errors knows each parameter ([`known`]), k/m from a tap beside it ([`tap`]).
//!
//! And why step 4 does not determine k/m, in four numbers: how good the other parameters would have to be ([`tolerance`]), what any
//! method could know ([`bound`]), what step 2's neglect alone does ([`bias`]), and how far repetition gets ([`iteration`]).
//!
//! Each is asked twice of step 4: with its runs from rest to rest, as the rig plays them, and with the turns at full speed alone,
//! as a laboratory records them. Between rest and rest an error that swings with the acceleration leaves no rate behind; cut out
//! of a motion it does.

pub mod bias;
pub mod bound;
pub mod iteration;
pub mod known;
pub mod tap;
pub mod tolerance;

use anyhow::Result;
use rayon::prelude::*;
use sixaxis_calibration::steps::{Campaign, FourSteps};
use sixaxis_core::identify::stiffness;
use sixaxis_core::{LimbLaw, Parameters, Scheme};
use sixaxis_recordings::session::Role;
use sixaxis_reference::rig::run::{Mode, Run};

use super::plan::Plan;
use super::results::identifiability::{Identifiability, IterationRun, Known, Records};

/// Both ways to record step 4.
pub const RECORDS: [Records; 2] = [Records::WholeRuns, Records::EvenTurns];

/// All of it, but for what needs the records with errors, which the caller has.
///
/// # Errors
/// Those of search, steps and bound.
pub fn study(
    plan: &Plan,
    noise_free: &Campaign,
    found: &FourSteps,
    known: Known,
    with_errors: Vec<IterationRun>,
    truth: &Parameters,
) -> Result<Identifiability> {
    let of_records = RECORDS.into_par_iter().map(|records| {
        let campaign = recorded(noise_free, records);
        let found = searched(&campaign, found)?;
        let theory = bias::FirstOrderSearch::new(&campaign, truth)?;
        let tolerances = tolerance::study(plan, records, &campaign, truth, &theory)?;
        let bias = bias::study(records, &campaign, &found, truth, &theory)?;
        let runs = iteration::noise_free(records, &campaign, &found, truth)?;
        anyhow::Ok((tolerances, bias, runs))
    });
    let (bound, of_records) = rayon::join(
        || bound::study(truth),
        || of_records.collect::<Result<Vec<_>>>(),
    );
    let mut study = Identifiability {
        known,
        tolerances: Vec::new(),
        bound: bound?,
        biases: Vec::new(),
        iterations: Vec::new(),
    };
    for (tolerances, bias, runs) in of_records? {
        study.tolerances.extend(tolerances);
        study.biases.push(bias);
        study.iterations.extend(runs);
    }
    study.iterations.extend(with_errors);
    Ok(study)
}

/// The campaign with step 4's trials cut to what is asked for.
fn recorded(campaign: &Campaign, records: Records) -> Campaign {
    let mut campaign = campaign.clone();
    if records == Records::WholeRuns {
        return campaign;
    }
    for (trial, conditioned) in &mut campaign.trials {
        if trial.role != Role::HighFrequencyLinear {
            continue;
        }
        let run = Run::new(Mode::Linear, trial.frequency_hz, trial.direction_ground);
        let (from, to) = run.steady_span_s();
        let sample = |time_s: f64| (time_s * trial.sample_rate_hz).round() as usize;
        let last = conditioned.voltage_v.len().min(sample(to) + 1);
        let span = sample(from).min(last)..last;
        conditioned.voltage_v = conditioned.voltage_v[span.clone()].to_vec();
        conditioned.linear_ground_m_s2 = conditioned.linear_ground_m_s2[span].to_vec();
    }
    campaign
}

/// The four steps with step 4 done again on this campaign's trials.
fn searched(campaign: &Campaign, found: &FourSteps) -> Result<FourSteps> {
    let law = LimbLaw::CompressionShortens;
    let curve = campaign.search(&found.found(), Scheme::Heun, 1, law)?;
    Ok(FourSteps {
        stiffness: Some(stiffness::judge(&curve)?),
        curve,
        ..found.clone()
    })
}
