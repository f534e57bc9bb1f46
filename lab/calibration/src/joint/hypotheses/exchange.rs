//! Two channels that are exchanged from one trial on, or all day: limb and piezo come along, the amplifier stays.
//!
//! Which two, and from which trial on, is looked for among the channels' responses, where a pair and a trial cost less than a millisecond; the
//! joint fit then says whether the trials agree to the noise with these two put right.

use std::borrow::Cow;

use sixaxis_core::identify::joint::AtRest;
use sixaxis_core::identify::static_load_sharing::StaticLoadSharing;
use sixaxis_core::{InertiaPerMass, LIMBS, Parameters};

use super::Unaccounted;
use crate::diagnosis::table::Table;
use crate::diagnosis::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::joint::{at_rest, record};
use crate::trial::Trial;

/// Departure of a channel, relative to its trial, beyond which more makes no difference to who belongs where.
const COST_CAP: f64 = 0.2;
/// Share of the squared departures that an exchange may leave to be worth a fit.
const WORTH_A_FIT: f64 = 0.5;

/// Two channels, exchanged in the trials from this one on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Exchange {
    pair: (usize, usize),
    from: usize,
}

/// The exchange that accounts for all trials.
#[must_use]
pub fn tried(day: &Unaccounted<'_>) -> Option<Finding> {
    let shares = StaticLoadSharing::new(&day.campaign.geometry).ok()?;
    let (exchange, table) = likeliest(&shares, day.cases)?;
    let trials: Vec<Cow<'_, Trial>> = day
        .campaign
        .trials
        .iter()
        .enumerate()
        .map(|(index, (trial, _))| {
            if index < exchange.from {
                Cow::Borrowed(trial)
            } else {
                Cow::Owned(put_right(trial, exchange.pair))
            }
        })
        .collect();
    let fitted = |trial: &&Cow<'_, Trial>| record(trial).is_some();
    let all_day = !trials[..exchange.from].iter().any(|trial| fitted(&trial));
    let (a, b) = exchange.pair;
    let mut rest = at_rest(day.drift);
    if all_day {
        rest.drift_v.swap(a, b);
        rest.deviation_v.swap(a, b);
    }
    let start = start(&table, &rest, &day.campaign.design);
    let borrowed: Vec<&Trial> = trials.iter().map(AsRef::as_ref).collect();
    let joint = day.accounting(&borrowed, &rest, &start, day.knowledge)?;
    let names = trials[exchange.from..]
        .iter()
        .map(|trial| trial.name.clone());
    Some(Finding {
        cause: Cause::SwappedChannels,
        recordings: if all_day { Vec::new() } else { names.collect() },
        channels: vec![a + 1, b + 1],
        evidence: format!(
            "with channels {} and {} exchanged all trials agree to the noise (misfit {:.2}), and as they are they do not",
            a + 1,
            b + 1,
            joint.misfit.per_degree
        ),
        advice: format!(
            "exchange channels {} and {} in the [channels] of the session or of these recordings, or their plugs",
            a + 1,
            b + 1
        ),
    })
}

/// The exchange with which the trials' responses agree best, and the scale factors and inertias they then have.
fn likeliest(shares: &StaticLoadSharing, cases: &[TrialCase<'_>]) -> Option<(Exchange, Table)> {
    // What was found of trials before was found with channels taken for each other.
    let mut cases: Vec<TrialCase<'_>> = cases
        .iter()
        .map(|case| TrialCase {
            ignored: [false; LIMBS],
            explained: false,
            ..case.clone()
        })
        .collect();
    let of = |cases: &[TrialCase<'_>]| {
        let table = Table::linear(shares, cases, &[false; LIMBS])?.exchanged(cases, None);
        Some((table.cost(cases, COST_CAP), table))
    };
    let (as_they_are, _) = of(&cases)?;
    let mut best: Option<(Exchange, f64, Table)> = None;
    for a in 0..LIMBS {
        for b in a + 1..LIMBS {
            each_from_the_end(&mut cases, (a, b), |from, cases| {
                let Some((cost, table)) = of(cases) else {
                    return;
                };
                if best.as_ref().is_none_or(|(_, least, _)| cost < *least) {
                    best = Some((Exchange { pair: (a, b), from }, cost, table));
                }
            });
        }
    }
    let (exchange, least, table) = best?;
    (least < WORTH_A_FIT * as_they_are).then_some((exchange, table))
}

/// Shows the cases with a pair exchanged in the last one, in the last two ... in all of them, and leaves them as they were.
fn each_from_the_end<'a>(
    cases: &mut [TrialCase<'a>],
    (a, b): (usize, usize),
    mut show: impl FnMut(usize, &[TrialCase<'a>]),
) {
    let exchange = |case: &mut TrialCase<'_>| {
        if let Some(response) = &mut case.response {
            response.channels.swap(a, b);
        }
    };
    for from in (0..cases.len()).rev() {
        exchange(&mut cases[from]);
        show(from, cases);
    }
    cases.iter_mut().for_each(exchange);
}

/// The trial with each limb's signal in its own channel, and with the gain of the amplifier that it went through.
fn put_right(trial: &Trial, (a, b): (usize, usize)) -> Trial {
    let mut right = trial.clone();
    right.voltage_v.iter_mut().for_each(|row| row.swap(a, b));
    right.gains.gain_n_per_v.swap(a, b);
    right
}

/// Where the fit starts: as the responses have it, and as designed where they leave something open.
fn start(table: &Table, rest: &AtRest, design: &Parameters) -> Parameters {
    let inertia = table.inertia_m2.map(|i| InertiaPerMass {
        xx_m2: i.x_axis.x,
        yy_m2: i.y_axis.y,
        zz_m2: i.z_axis.z,
        xy_m2: i.x_axis.y,
        xz_m2: i.x_axis.z,
        yz_m2: i.y_axis.z,
    });
    Parameters {
        zero_drift_v: rest.drift_v,
        scale_per_mass_per_kg: table.mass_over_scale_kg.map(|h| 1.0 / h),
        inertia_per_mass: inertia.unwrap_or(design.inertia_per_mass),
        ..*design
    }
}
