//! Which limbs are excluded from which sample on, and which are suspected.

use sixaxis_core::LimbSet;
use sixaxis_core::redundancy::reconstruction::Reconstruction;
use sixaxis_recordings::{Block, Channel};

use super::axis_noise::SampleNoise;

/// Limbs that are excluded from certain samples on: none before the first.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Exclusions {
    /// First samples, ascending.
    changes: Vec<(u64, LimbSet)>,
}

impl Exclusions {
    /// The same limbs throughout.
    pub fn throughout(limbs: LimbSet) -> Self {
        Self {
            changes: vec![(0, limbs)],
        }
    }

    /// From this sample on these and no others, whatever was said of later ones.
    pub fn from(&mut self, sample: u64, limbs: LimbSet) {
        self.changes.retain(|(first, _)| *first < sample);
        self.changes.push((sample, limbs));
    }

    /// Each change, with the sample from which it holds.
    pub fn changes(&self) -> impl Iterator<Item = (u64, LimbSet)> {
        self.changes.iter().copied()
    }

    /// Whether all nine are read throughout.
    pub fn is_empty(&self) -> bool {
        self.changes.iter().all(|(_, limbs)| limbs.is_empty())
    }

    /// All that are excluded at some sample.
    pub fn ever(&self) -> LimbSet {
        let all = self.changes.iter().map(|(_, limbs)| *limbs);
        all.fold(LimbSet::EMPTY, LimbSet::union)
    }

    /// Those of a sample.
    pub fn at(&self, sample: u64) -> LimbSet {
        let begun = self.changes.partition_point(|(first, _)| *first <= sample);
        let last = begun.checked_sub(1).map(|last| self.changes[last].1);
        last.unwrap_or(LimbSet::EMPTY)
    }

    /// All that are excluded at some sample no farther than `reach` from this one.
    fn within(&self, sample: u64, reach: u64) -> LimbSet {
        let (first, last) = (sample.saturating_sub(reach), sample.saturating_add(reach));
        let begin = self.changes.iter();
        let begin = begin.filter(|(at, _)| (first..=last).contains(at));
        begin.fold(self.at(first), |all, (_, limbs)| all.union(*limbs))
    }

    /// As [`Self::from`], where that is a change.
    fn change_from(&mut self, sample: u64, limbs: LimbSet) {
        if limbs != self.at(sample) {
            self.from(sample, limbs);
        }
    }

    /// Those from a sample on, if they are not those of the sample before it.
    pub fn change_at(&self, sample: u64) -> Option<LimbSet> {
        let found = self
            .changes
            .binary_search_by_key(&sample, |change| change.0);
        found.ok().map(|at| self.changes[at].1)
    }
}

/// What a first pass with the monitor says of a recording.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Watched {
    /// Limbs that are excluded.
    pub excluded: Exclusions,
    /// Limbs that may have failed and are not excluded.
    pub suspected: Exclusions,
}

impl Watched {
    /// The same for rows that a filter has made of `reach` samples on either side: what a channel shows while its limb is excluded is in
    /// all of them. Where the limbs of such rows cannot be excluded together, those that are not are suspected.
    pub fn reaching(&self, reach: u64) -> Self {
        let changes = self.excluded.changes().chain(self.suspected.changes());
        let mut edges: Vec<u64> = changes
            .flat_map(|(at, _)| [at.saturating_sub(reach), at, at.saturating_add(reach)])
            .collect();
        edges.sort_unstable();
        let mut reaching = Self::default();
        for at in edges {
            let wanted = self.excluded.within(at, reach);
            let excluded = match Reconstruction::new(wanted) {
                Ok(_) => wanted,
                Err(_) => self.excluded.at(at),
            };
            let suspected = self.suspected.within(at, reach).union(wanted);
            reaching.excluded.change_from(at, excluded);
            (reaching.suspected).change_from(at, suspected.minus(excluded));
        }
        reaching
    }
}

/// What a first pass has found, and what a sample's own noise gives its accelerations without the limbs excluded from a sample on.
pub(super) struct WatchedBefore {
    pub(super) found: Watched,
    pub(super) noise: Vec<(u64, SampleNoise)>,
}

impl WatchedBefore {
    /// Appends the flags of the rows in a block that have none yet; so many were answered before it.
    pub(super) fn flag(&self, rows: u64, block: &mut Block) {
        let answered = block.columns[1].len() as u64;
        let flags = block.columns.len() - FLAGS.len();
        for row in 0..answered {
            let sample = rows + row + 1;
            let excluded = self.found.excluded.at(sample);
            // Suspected once the sample after it has been seen.
            let suspected = self.found.suspected.at(sample + 1).minus(excluded);
            for (column, limbs) in block.columns[flags..].iter_mut().zip([excluded, suspected]) {
                column.push(digits(limbs));
            }
        }
    }
}

/// Columns of the excluded and of the suspected limbs: their numbers as digits of one number, 0 for none.
pub const FLAGS: [(&str, &str); 2] = [("excluded_limbs", ""), ("suspected_limbs", "")];

/// The channels of [`FLAGS`].
pub fn flags(sample_rate_hz: f64) -> impl Iterator<Item = Channel> {
    FLAGS.into_iter().map(move |(name, unit)| Channel {
        sample_rate_hz: Some(sample_rate_hz),
        ..Channel::new(name, Some(unit))
    })
}

/// Limb numbers as digits of one number.
pub(super) fn digits(limbs: LimbSet) -> f64 {
    limbs
        .numbers()
        .fold(0.0, |digits, number| 10.0 * digits + number as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_found_later_counts() {
        let of = |numbers: &[usize]| LimbSet::from_numbers(numbers.iter().copied()).expect("limbs");
        let mut found = Exclusions::default();
        assert!(found.is_empty());
        found.from(100, of(&[4]));
        found.from(300, of(&[]));
        found.from(90, of(&[4, 5]));
        let at = [0, 89, 90, 100, 300].map(|sample| found.at(sample));
        assert_eq!(
            at,
            [of(&[]), of(&[]), of(&[4, 5]), of(&[4, 5]), of(&[4, 5])]
        );
        assert_eq!(found.change_at(90), Some(of(&[4, 5])));
        assert_eq!(found.change_at(100), None);
        assert!(!found.is_empty());
        assert_eq!(Exclusions::throughout(of(&[2])).at(0), of(&[2]));
    }

    #[test]
    fn a_filter_carries_a_failure_to_rows_on_both_sides() {
        let of = |numbers: &[usize]| LimbSet::from_numbers(numbers.iter().copied()).expect("limbs");
        let mut found = Watched::default();
        found.excluded.from(100, of(&[5]));
        found.excluded.from(300, of(&[]));
        found.suspected.from(500, of(&[2, 4]));
        found.suspected.from(600, of(&[]));
        assert_eq!(found.reaching(0), found);
        let reaching = found.reaching(30);
        let excluded = [69, 70, 329, 330].map(|sample| reaching.excluded.at(sample));
        assert_eq!(excluded, [of(&[]), of(&[5]), of(&[5]), of(&[])]);
        let suspected = [469, 470, 629, 630].map(|sample| reaching.suspected.at(sample));
        assert_eq!(suspected, [of(&[]), of(&[2, 4]), of(&[2, 4]), of(&[])]);
        // Limbs of an ambiguous pair and a third of their relation cannot be excluded together.
        let mut found = Watched::default();
        found.excluded.from(100, of(&[1, 2]));
        found.excluded.from(200, of(&[4]));
        let reaching = found.reaching(30);
        let at = |sample| [&reaching.excluded, &reaching.suspected].map(|limbs| limbs.at(sample));
        assert_eq!(at(150), [of(&[1, 2]), of(&[])]);
        assert_eq!(at(190), [of(&[1, 2]), of(&[4])]);
        assert_eq!(at(210), [of(&[4]), of(&[1, 2])]);
        assert_eq!(at(230), [of(&[4]), of(&[])]);
    }

    #[test]
    fn limbs_are_digits() {
        let of = |numbers: &[usize]| {
            digits(LimbSet::from_numbers(numbers.iter().copied()).expect("limbs"))
        };
        assert_eq!([of(&[]), of(&[5]), of(&[2, 4])], [0.0, 5.0, 24.0]);
    }
}
