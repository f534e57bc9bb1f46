//! What is varied, which seeds, and which shard of them.

use core::fmt;
use core::ops::Range;
use core::str::FromStr;
use std::path::Path;

use sixaxis_reference::laboratory::check::check;
use sixaxis_reference::laboratory::plan::SessionPlan;
use sixaxis_reference::laboratory::plan_file::{self, with_comments};

use crate::error::{Error, Result};

/// Largest seed: what TOML, Parquet and SQL have a number for.
pub const LARGEST_SEED: u64 = i64::MAX as u64;

/// The seed that stands in the plan of a campaign, where it means nothing: each case has its own.
const NO_SEED: u64 = 1;

/// A campaign: one session plan, played with one seed after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignPlan {
    session: SessionPlan,
    first_seed: u64,
    count: u64,
}

impl CampaignPlan {
    /// A campaign of `count` cases from `first_seed` on. The session plan's own seed does not matter.
    ///
    /// # Errors
    /// [`Error::Plan`] for a plan that the first seed cannot be played with, [`Error::Seeds`] for none or for too large ones.
    pub fn new(session: &SessionPlan, first_seed: u64, count: u64) -> Result<Self> {
        check(&SessionPlan {
            seed: first_seed,
            ..session.clone()
        })?;
        if count == 0 {
            return Err(Error::Seeds("a campaign has at least one case".to_owned()));
        }
        if first_seed
            .checked_add(count - 1)
            .is_none_or(|last| last > LARGEST_SEED)
        {
            return Err(Error::Seeds(format!(
                "{count} from {first_seed} on go beyond {LARGEST_SEED}"
            )));
        }
        Ok(Self {
            session: SessionPlan {
                seed: NO_SEED,
                ..session.clone()
            },
            first_seed,
            count,
        })
    }

    /// The plan that each seed is put into.
    pub const fn session(&self) -> &SessionPlan {
        &self.session
    }

    /// Its text, with comments: the same for the same plan.
    pub fn text(&self) -> String {
        with_comments(&self.session)
    }

    /// All seeds.
    pub const fn seeds(&self) -> Range<u64> {
        self.first_seed..self.first_seed + self.count
    }

    /// The seeds of one shard: the shards' ranges follow each other without gap and differ in length by one at most.
    pub fn shard(&self, shard: Shard) -> Range<u64> {
        let at = |i: u64| {
            let share = u128::from(self.count) * u128::from(i) / u128::from(shard.of);
            // Not above the count.
            self.first_seed + share as u64
        };
        at(shard.index - 1)..at(shard.index)
    }
}

/// One of some shards, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: u64,
    of: u64,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { index: 1, of: 1 };
}

impl FromStr for Shard {
    type Err = String;

    /// `3/16` is the third of sixteen.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let parsed = text.split_once('/').and_then(|(index, of)| {
            Some(Self {
                index: index.parse().ok()?,
                of: of.parse().ok()?,
            })
        });
        match parsed {
            Some(shard) if (1..=shard.of).contains(&shard.index) => Ok(shard),
            _ => Err("expected i/n with i from 1 to n, as in 3/16".to_owned()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

/// What two plans' texts differ in, each as `key: theirs there, ours here`. Empty for the same plan. `path` is where theirs is
/// from, should it be no plan at all.
pub fn differences(path: &Path, theirs: &str, ours: &str) -> Vec<String> {
    if theirs == ours {
        return Vec::new();
    }
    let there = match plan_file::parse(path, theirs) {
        Ok(plan) => plan,
        Err(error) => return vec![format!("its plan cannot be read: {}", error.cause)],
    };
    let here = match plan_file::parse(path, ours) {
        Ok(plan) => plan,
        Err(error) => return vec![format!("the plan cannot be read: {}", error.cause)],
    };
    // Comments may have changed; of a plan, its values count. The seed is no part of it.
    let (there, here) = (leaves(&there), leaves(&here));
    let value = |of: &[(String, String)], key: &str| -> String {
        of.iter()
            .find(|(k, _)| k == key)
            .map_or_else(|| "nothing".to_owned(), |(_, value)| value.clone())
    };
    let mut keys: Vec<&String> = there.iter().chain(&here).map(|(key, _)| key).collect();
    keys.sort();
    keys.dedup();
    keys.into_iter()
        .filter(|key| *key != "seed" && value(&there, key) != value(&here, key))
        .map(|key| {
            let (theirs, ours) = (value(&there, key), value(&here, key));
            format!("{key}: {theirs} there, {ours} here")
        })
        .collect()
}

/// A plan's values with their keys, as in `rig.rest_s`.
fn leaves(plan: &SessionPlan) -> Vec<(String, String)> {
    let mut found = Vec::new();
    if let Ok(value) = toml::Value::try_from(plan) {
        collect("", &value, &mut found);
    }
    found
}

fn collect(prefix: &str, value: &toml::Value, found: &mut Vec<(String, String)>) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                let key = if prefix.is_empty() {
                    key.clone()
                } else {
                    format!("{prefix}.{key}")
                };
                collect(&key, value, found);
            }
        }
        other => found.push((prefix.to_owned(), other.to_string())),
    }
}
