//! A failure of which it cannot be told which limbs it is: for how long answers are marked, and where a later alarm of it came from.

use super::isolation::Origin;
use super::recovery::QUIET;
use super::verdict::Kind;

/// Such a failure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Untold {
    /// Where it came from; nowhere if it has passed: what follows is another one.
    origin: Option<Origin>,
    /// Samples without an alarm since.
    quiet: u64,
}

impl Untold {
    /// After a verdict of this kind on a failure of this origin; one that was untold already goes on.
    pub fn new(earlier: Option<Self>, kind: Kind, origin: Origin) -> Self {
        let origin = (kind != Kind::Passed).then_some(origin);
        Self {
            origin: earlier.and_then(Self::goes_on).or(origin),
            quiet: 0,
        }
    }

    /// Where it came from, unless it has passed.
    pub const fn goes_on(self) -> Option<Origin> {
        self.origin
    }

    /// There has been an alarm.
    pub const fn alarmed(&mut self) {
        self.quiet = 0;
    }

    /// Takes a sample without an alarm, and says whether it is over with that.
    pub const fn is_over(&mut self) -> bool {
        self.quiet += 1;
        self.quiet >= QUIET
    }
}
