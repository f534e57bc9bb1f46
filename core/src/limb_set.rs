//! Sets of limbs, as errors name them and decoders exclude them.

use core::fmt;

/// Number of limbs, and so of voltage channels.
pub const LIMBS: usize = 9;

/// A number that is no limb's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotALimb(pub usize);

impl fmt::Display for NotALimb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "limb = {}: must be a number from 1 to {LIMBS}", self.0)
    }
}

impl core::error::Error for NotALimb {}

/// Some of the nine limbs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct LimbSet(u16);

impl LimbSet {
    /// None of them.
    pub const EMPTY: Self = Self(0);

    /// From limb numbers as printed, 1 to 9; one that is there twice counts once.
    ///
    /// # Errors
    /// [`NotALimb`] for a number outside 1 to 9.
    pub fn from_numbers(numbers: impl IntoIterator<Item = usize>) -> Result<Self, NotALimb> {
        let mut set = Self::EMPTY;
        for number in numbers {
            if !(1..=LIMBS).contains(&number) {
                return Err(NotALimb(number));
            }
            set = set.with(number - 1);
        }
        Ok(set)
    }

    /// Every set of `size` limbs.
    pub fn of_size(size: usize) -> impl Iterator<Item = Self> {
        (0..1_u16 << LIMBS)
            .map(Self)
            .filter(move |set| set.len() == size)
    }

    /// With limb `index` (from 0), too; an index that is no limb's changes nothing.
    #[must_use]
    pub const fn with(self, index: usize) -> Self {
        if index < LIMBS {
            Self(self.0 | 1 << index)
        } else {
            self
        }
    }

    /// Whether limb `index` (from 0) is in it.
    #[must_use]
    pub const fn contains(self, index: usize) -> bool {
        index < LIMBS && self.0 >> index & 1 == 1
    }

    /// All nine.
    pub const ALL: Self = Self((1 << LIMBS) - 1);

    /// Those of both sets.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those that are not in the other set.
    #[must_use]
    pub const fn minus(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// How many there are.
    #[must_use]
    pub const fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Indices from 0, ascending.
    pub fn indices(self) -> impl Iterator<Item = usize> {
        (0..LIMBS).filter(move |&index| self.contains(index))
    }

    /// Numbers as printed, from 1, ascending.
    pub fn numbers(self) -> impl Iterator<Item = usize> {
        self.indices().map(|index| index + 1)
    }
}

/// "2", "2 and 4", "2, 4 and 6"; by `{:#}` "limb 2", "limbs 2 and 4".
impl fmt::Display for LimbSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if f.alternate() {
            f.write_str(if self.len() == 1 { "limb " } else { "limbs " })?;
        }
        let last = self.len().wrapping_sub(1);
        for (place, number) in self.numbers().enumerate() {
            match place {
                0 => {}
                _ if place == last => f.write_str(" and ")?,
                _ => f.write_str(", ")?,
            }
            write!(f, "{number}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::format;

    use super::*;

    #[test]
    fn sets_are_counted_and_named() {
        assert_eq!([1, 2, 3].map(|n| LimbSet::of_size(n).count()), [9, 36, 84]);
        let set = LimbSet::from_numbers([9, 2, 4, 2]).expect("limbs");
        assert_eq!(format!("{set}"), "2, 4 and 9");
        assert_eq!(format!("{set:#}"), "limbs 2, 4 and 9");
        assert_eq!(format!("{:#}", LimbSet::EMPTY.with(6)), "limb 7");
        assert!(set.contains(1) && !set.contains(0) && !set.contains(77));
        assert!(LimbSet::from_numbers([0]).is_err());
        assert!(LimbSet::from_numbers([10]).is_err());
    }
}
