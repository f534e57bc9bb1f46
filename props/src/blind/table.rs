//! Outcomes counted: verdict, cause and harm, cell by cell and by size of the defect.

use sixaxis_calibration::report::Grade;
use sixaxis_reference::laboratory::defect::Kind;
use sixaxis_reference::laboratory::plan::Engine;

use super::harm::{Harm, STATED_DECOUPLING, WIDTHS};
use super::share::Share;
use super::{Cell, Naming, Outcome, SAMPLE_RATE_HZ, STATIC_DURATION_S};
use crate::results::{Blind, BlindBin, BlindCell, BlindKind, BlindTally};

/// Bins of a kind's range.
pub const BINS: usize = 7;

/// The published table of outcomes from a first seed on, whatever order they come in.
pub fn of(mut outcomes: Vec<Outcome>, engine: Engine) -> Blind {
    outcomes.sort_by_key(|outcome| outcome.seed);
    let select = |so: &dyn Fn(&Outcome) -> bool| -> Vec<&Outcome> {
        outcomes.iter().filter(|outcome| so(outcome)).collect()
    };
    let mut healthy: Vec<BlindCell> = Vec::new();
    for outcome in &outcomes {
        if outcome.cell.kind().is_none() && healthy.iter().all(|cell| cell.cell != outcome.cell) {
            let tally = tally(&select(&|o| o.cell == outcome.cell));
            healthy.push(BlindCell {
                cell: outcome.cell,
                tally,
            });
        }
    }
    let place = |cell: &Cell| super::HEALTHY.iter().position(|other| other == cell);
    healthy.sort_by_key(|cell| place(&cell.cell));
    let good = select(&|o| o.grade == Some(Grade::Good));
    let named = select(&|o| o.naming() != Naming::None);
    Blind {
        first_seed: outcomes.first().map_or(0, |outcome| outcome.seed),
        sessions: outcomes.len(),
        engine,
        sample_rate_hz: SAMPLE_RATE_HZ,
        static_duration_s: STATIC_DURATION_S,
        promised_widths: WIDTHS,
        promised_decoupling: STATED_DECOUPLING,
        false_good: Share::of(&outcomes, Outcome::is_false_good),
        false_good_that_could_show: {
            let could = select(&Outcome::could_show);
            Share::of(&could, |o| o.is_false_good())
        },
        false_good_at_rest: Share::of(&outcomes, |o| {
            o.is_false_good() && o.harm.as_ref().is_some_and(Harm::breaks_it_at_rest)
        }),
        false_good_of_good: Share::of(&good, |o| o.is_false_good()),
        wrong_cause_of_named: Share::of(&named, |o| o.naming() == Naming::Wrong),
        healthy,
        kinds: Kind::ALL
            .iter()
            .map(|kind| by_magnitude(*kind, &select(&|o| o.cell == Cell::Defect(*kind))))
            .collect(),
    }
}

fn by_magnitude(kind: Kind, outcomes: &[&Outcome]) -> BlindKind {
    let facts = kind.facts();
    let (low, high) = facts.range;
    let edge = |bin: usize| low * (high / low).powf(bin as f64 / BINS as f64);
    let bin_of = |magnitude: f64| {
        let place = (magnitude / low).ln() / (high / low).ln() * BINS as f64;
        (place.floor().max(0.0) as usize).min(BINS - 1)
    };
    BlindKind {
        kind,
        unit: facts.unit.to_owned(),
        meaning: facts.reason.to_owned(),
        bins: (0..BINS)
            .map(|bin| {
                let here: Vec<&Outcome> = outcomes
                    .iter()
                    .copied()
                    .filter(|o| o.magnitude.is_some_and(|m| bin_of(m) == bin))
                    .collect();
                BlindBin {
                    from: edge(bin),
                    to: edge(bin + 1),
                    tally: tally(&here),
                }
            })
            .collect(),
    }
}

fn tally(outcomes: &[&Outcome]) -> BlindTally {
    let graded = |grade| Share::of(outcomes, |o| o.grade == grade);
    let named = |naming| Share::of(outcomes, |o| o.naming() == naming);
    let ordered = |of: &dyn Fn(&Harm) -> Option<f64>| {
        let mut values: Vec<f64> = outcomes
            .iter()
            .filter_map(|o| o.harm.as_ref().and_then(of))
            .collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let median = |of: &dyn Fn(&Harm) -> Option<f64>| {
        let values = ordered(of);
        values.get(values.len().saturating_sub(1) / 2).copied()
    };
    let in_95 = |kind: usize| {
        let values = ordered(&|h| Some(h.beyond_gain?[kind]));
        values
            .get((19 * values.len()).div_ceil(20).saturating_sub(1))
            .copied()
    };
    BlindTally {
        sessions: outcomes.len(),
        good: graded(Some(Grade::Good)),
        reserved: graded(Some(Grade::Reserved)),
        not_good: graded(Some(Grade::Bad)),
        refused: graded(None),
        right_cause: named(Naming::Right),
        no_cause: named(Naming::None),
        wrong_cause: named(Naming::Wrong),
        false_good: Share::of(outcomes, |o| o.is_false_good()),
        median_parameter_error: median(&|h| Some(h.parameter)),
        median_over_interval: median(&|h| h.over_interval),
        median_decoupling_error: median(&|h| h.decoupling),
        beyond_gain_95: in_95(0)
            .zip(in_95(1))
            .map(|(linear, angular)| [linear, angular]),
    }
}
