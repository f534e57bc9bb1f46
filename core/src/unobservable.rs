//! What some limbs or some motion cannot observe: plain data that errors carry.

use core::fmt;

use crate::limb_set::{LIMBS, LimbSet};

/// A load of which no limb but excluded ones bears any part: what cannot be measured without them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LostLoad {
    /// The force, shell axes; in the unit of the limb force.
    pub force_shell: [i32; 3],
    /// The torque about the mass's centre over the half edge, shell axes; in the unit of the limb force.
    pub torque_over_half_edge_shell: [i32; 3],
}

impl fmt::Display for LostLoad {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let turns = self.torque_over_half_edge_shell != [0; 3];
        if self.force_shell != [0; 3] {
            write!(f, "a force along {}", Along(self.force_shell))?;
            if turns {
                f.write_str(" together with ")?;
            }
        }
        if turns {
            let about = Along(self.torque_over_half_edge_shell);
            write!(f, "a torque about {about} over the half edge")?;
        }
        Ok(())
    }
}

/// Whole multiples of shell axes: "y - z".
struct Along([i32; 3]);

impl fmt::Display for Along {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut first = true;
        for (share, axis) in self.0.into_iter().zip(["x", "y", "z"]) {
            let sign = match (share.signum(), first) {
                (0, _) => continue,
                (1, true) => "",
                (1, false) => " + ",
                (_, true) => "-",
                (_, false) => " - ",
            };
            first = false;
            f.write_str(sign)?;
            if share.abs() != 1 {
                write!(f, "{} ", share.abs())?;
            }
            f.write_str(axis)?;
        }
        Ok(())
    }
}

/// Changes of nine ln scale factors of which a motion says nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct UnobservableDirections {
    /// Limbs that grow and limbs that shrink.
    pairs: [(LimbSet, LimbSet); LIMBS - 1],
    count: usize,
}

impl UnobservableDirections {
    /// With one direction more, as long as there is room.
    pub(crate) fn add(&mut self, up: LimbSet, down: LimbSet) {
        if let Some(place) = self.pairs.get_mut(self.count) {
            *place = (up, down);
            self.count += 1;
        }
    }

    /// For each direction the limbs that grow and the limbs that shrink by it; the latter empty for one limb against all others.
    pub fn pairs(&self) -> impl Iterator<Item = (LimbSet, LimbSet)> {
        self.pairs.into_iter().take(self.count)
    }

    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }
}

/// "limb 2 against limb 4, limb 3 against limb 7".
impl fmt::Display for UnobservableDirections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, (up, down)) in self.pairs().enumerate() {
            if place > 0 {
                f.write_str(", ")?;
            }
            write!(f, "{up:#} against ")?;
            if down.is_empty() {
                f.write_str("the others")?;
            } else {
                write!(f, "{down:#}")?;
            }
        }
        Ok(())
    }
}
