//! Trials by the hundred, counted.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sixaxis_core::LIMBS;
use sixaxis_core::limb_set::LimbSet;
use sixaxis_core::redundancy::fault::Kind;
use sixaxis_core::redundancy::fault::class::{CLASS_OF, CLASSES, members};

use super::{Fault, Name, Outcome, trial};

/// Samples after the failure by which detection is counted.
pub const WITHIN: [u64; 5] = [1, 8, 64, 512, 4096];

/// One kind at one size, every limb as often.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Tally {
    /// Kind.
    pub kind: Name,
    /// Size in standard deviations; none where the motion gives it.
    pub sigmas: Option<f64>,
    /// Trials.
    pub trials: usize,
    /// Trials with an alarm before the failure.
    pub alarmed_before: usize,
    /// Share with an alarm within each of [`WITHIN`] samples.
    pub detected_within: [f64; WITHIN.len()],
    /// Trials with the right class, a wrong one, and none.
    pub isolated: Counts,
    /// Samples from failure to class: median, and what 99 % stay below.
    pub isolated_after: [u64; 2],
    /// Trials with the right kind, a wrong one, and none.
    pub named: Counts,
    /// Of trials with a failed twin: the right limb, the wrong one, the pair.
    pub twins: Counts,
}

/// Right, wrong, neither.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Right.
    pub right: usize,
    /// Wrong.
    pub wrong: usize,
    /// Nothing said.
    pub open: usize,
}

impl Counts {
    /// Counts one; none is open.
    pub fn add(&mut self, right: Option<bool>) {
        match right {
            Some(true) => self.right += 1,
            Some(false) => self.wrong += 1,
            None => self.open += 1,
        }
    }

    /// All of them.
    pub const fn all(&self) -> usize {
        self.right + self.wrong + self.open
    }

    /// Share that is not right.
    pub fn missed(&self) -> f64 {
        1.0 - self.right as f64 / self.all() as f64
    }
}

/// One class over all kinds.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct OfClass {
    /// Numbers of its limbs.
    pub limbs: Vec<usize>,
    /// The class named.
    pub isolated: Counts,
    /// Samples from failure to class: median, and what 99 % stay below.
    pub isolated_after: [u64; 2],
}

/// Failures of one kind and size on every limb in turn; the second of a pair takes turns, too.
pub fn play(kind: Name, sigmas: f64, first_seed: u64, each: u64) -> Vec<(Fault, Outcome)> {
    let limbs = LIMBS as u64;
    (0..each * limbs)
        .into_par_iter()
        .map(|k| {
            let limb = (k % limbs) as usize;
            let step = 1 + (k / limbs) as usize % (LIMBS - 1);
            let fault = Fault {
                kind,
                limb,
                other: (limb + step) % LIMBS,
                sigmas,
            };
            (fault, trial(first_seed + k, &fault))
        })
        .collect()
}

/// Whether the class, or the pair, was named right; none if nothing was.
pub fn isolated(fault: &Fault, outcome: &Outcome) -> Option<bool> {
    let verdict = outcome.isolated?;
    let expected = match fault.kind {
        Name::Swapped => LimbSet::EMPTY.with(fault.limb).with(fault.other),
        _ => members(CLASS_OF[fault.limb]),
    };
    let pair = verdict.kind == Kind::Swapped;
    // A channel that stands still is named without its partner.
    let alone = !pair && verdict.limb() == Some(fault.limb);
    let right = verdict.limbs == expected || alone;
    Some(right && pair == (fault.kind == Name::Swapped))
}

/// Whether the last word names the kind; none for what has passed or is unknown.
pub fn named(fault: &Fault, outcome: &Outcome) -> Option<bool> {
    let (verdict, _) = outcome.identified?;
    match verdict.kind {
        Kind::Passed | Kind::Unknown => None,
        kind => Some(kind == fault.kind.kind()),
    }
}

/// Whether the last word names the limb; none for a pair.
pub fn limb_named(fault: &Fault, outcome: &Outcome) -> Option<bool> {
    let (verdict, _) = outcome.identified?;
    if verdict.is_open() || verdict.limbs.is_empty() {
        return None;
    }
    Some(verdict.limb() == Some(fault.limb))
}

/// Counts trials of one kind and size.
pub fn tally(kind: Name, sigmas: Option<f64>, trials: &[(Fault, Outcome)]) -> Tally {
    let mut tally = Tally {
        kind,
        sigmas,
        trials: trials.len(),
        alarmed_before: 0,
        detected_within: [0.0; WITHIN.len()],
        isolated: Counts::default(),
        isolated_after: delays(trials),
        named: Counts::default(),
        twins: Counts::default(),
    };
    for (fault, outcome) in trials {
        tally.alarmed_before += usize::from(outcome.alarmed_before);
        for (share, within) in tally.detected_within.iter_mut().zip(WITHIN) {
            // After n samples of a failure the last has number n - 1.
            let detected = outcome.alarm_after.is_some_and(|after| after < within);
            *share += f64::from(u8::from(detected)) / trials.len() as f64;
        }
        tally.isolated.add(isolated(fault, outcome));
        tally.named.add(named(fault, outcome));
        if members(CLASS_OF[fault.limb]).len() == 2 && kind != Name::Swapped {
            tally.twins.add(limb_named(fault, outcome));
        }
    }
    tally
}

/// Counts trials class by class.
pub fn of_classes(trials: &[(Fault, Outcome)]) -> Vec<OfClass> {
    (0..CLASSES)
        .map(|class| {
            let own: Vec<_> = trials
                .iter()
                .filter(|(fault, _)| CLASS_OF[fault.limb] == class)
                .copied()
                .collect();
            let mut counts = Counts::default();
            for (fault, outcome) in &own {
                counts.add(isolated(fault, outcome));
            }
            OfClass {
                limbs: members(class).numbers().collect(),
                isolated: counts,
                isolated_after: delays(&own),
            }
        })
        .collect()
}

fn delays(trials: &[(Fault, Outcome)]) -> [u64; 2] {
    let mut after: Vec<u64> = trials
        .iter()
        .filter_map(|(_, outcome)| outcome.isolated_after)
        .collect();
    after.sort_unstable();
    [0.5, 0.99].map(|share| {
        let place = (share * after.len() as f64).ceil() as usize;
        after.get(place.saturating_sub(1)).copied().unwrap_or(0)
    })
}
