//! The same sessions played by two engines: whether a verdict depends on who played.

use sixaxis_reference::laboratory::plan::Engine;

use super::harm::Harm;
use super::share::Share;
use super::{Outcome, table};
use crate::results::{BlindPair, BlindPairs, BlindVerdict};

/// Outcomes of the same seeds in the same order, side by side.
pub fn of(mujoco: Vec<Outcome>, rigid: &[Outcome]) -> BlindPairs {
    let pairs: Vec<BlindPair> = mujoco
        .iter()
        .zip(rigid)
        .map(|(mujoco, rigid)| BlindPair {
            seed: mujoco.seed,
            cell: mujoco.cell,
            magnitude: mujoco.magnitude,
            mujoco: verdict(mujoco),
            rigid: verdict(rigid),
        })
        .collect();
    BlindPairs {
        same_grade: Share::of(&pairs, |pair| pair.mujoco.grade == pair.rigid.grade),
        same_cause: Share::of(&pairs, |pair| pair.mujoco.cause == pair.rigid.cause),
        same_promise: Share::of(&pairs, |pair| {
            pair.mujoco.breaks_the_promise == pair.rigid.breaks_the_promise
        }),
        differing: pairs
            .into_iter()
            .filter(|pair| pair.mujoco != pair.rigid)
            .collect(),
        mujoco: table::of(mujoco, Engine::Mujoco),
    }
}

fn verdict(outcome: &Outcome) -> BlindVerdict {
    BlindVerdict {
        grade: outcome.grade,
        cause: outcome.cause,
        breaks_the_promise: outcome.harm.as_ref().map(Harm::breaks_the_promise),
    }
}
