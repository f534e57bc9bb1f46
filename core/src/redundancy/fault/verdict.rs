//! What the monitor says: its events, and the result of an isolation with limb, kind, onset, and the odds.

use core::fmt;

use super::detector::Alarm;
use crate::limb_set::LimbSet;

/// An event of the monitored sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// A test failed; its isolation follows.
    Alarm(Alarm),
    /// The limb, or those that share its signature, is known, how it failed is not.
    Isolated(Verdict),
    /// The isolation is complete.
    Identified(Verdict),
    /// The rows became quiet again before any class led: to all appearances a false alarm.
    Dismissed,
    /// All nine have been quiet for [`super::monitor::QUIET`] samples after a failure, and those that had failed move again.
    Quiet,
}

/// How a channel has failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// NaN, infinite, or beyond any strain.
    Unreadable,
    /// No signal: only noise about zero force.
    Dead,
    /// The same value, whatever the motion.
    Stuck,
    /// Another sensitivity.
    ScaleJump,
    /// Another zero.
    Offset,
    /// A zero that moves.
    Drift,
    /// Far more noise.
    NoiseBurst,
    /// Two channels are exchanged.
    Swapped,
    /// The failure ended before its kind was determined.
    Passed,
    /// None of these, or more than one.
    Unknown,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unreadable => "no readable value",
            Self::Dead => "dead",
            Self::Stuck => "stuck",
            Self::ScaleJump => "its sensitivity is another",
            Self::Offset => "its zero is another",
            Self::Drift => "its zero drifts",
            Self::NoiseBurst => "noise",
            Self::Swapped => "swapped",
            Self::Passed => "failed for a moment",
            Self::Unknown => "failed",
        })
    }
}

/// Which limb has failed, how, since when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// The limb or limbs; those that forces cannot distinguish, of which one has failed ([`Self::is_open`]); both channels of an
    /// exchanged pair; none where several explanations are left, or none.
    pub limbs: LimbSet,
    /// How.
    pub kind: Kind,
    /// First and last sample at which it may have begun; of another sensitivity or zero, and of a zero that drifts, to show.
    pub since: (u64, u64),
    /// Sample at which this was decided.
    pub said_at: u64,
    /// ln of the odds of this class of limbs against the next best explanation.
    pub class_ln_odds: f64,
    /// ln of the odds of this kind against the next best, 0 while it is open.
    pub kind_ln_odds: f64,
    /// ln of the odds of this limb against those that share its signature; infinite where none does, 0 while it is open.
    pub partner_ln_odds: f64,
}

impl Verdict {
    /// The limb (from 0), if it is one.
    #[must_use]
    pub fn limb(&self) -> Option<usize> {
        let mut indices = self.limbs.indices();
        indices.next().filter(|_| self.limbs.len() == 1)
    }

    /// Whether only one of the limbs has failed, and it is not known which.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.limbs.len() > 1 && self.partner_ln_odds == 0.0
    }
}

/// "limb 5: dead since sample 1234", "limb 2 or 4: its zero drifts, which shows since sample 0 to 63; forces cannot tell which".
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.limbs.len() {
            0 => {
                let passed = match self.kind {
                    Kind::Passed => " for a moment",
                    _ => "",
                };
                return write!(
                    f,
                    "it cannot be told which limbs have failed{passed}{}",
                    Since(self.since)
                );
            }
            1 => write!(f, "limb {}", self.limbs)?,
            size if self.is_open() => {
                f.write_str("limb ")?;
                for (place, number) in self.limbs.numbers().enumerate() {
                    f.write_str(match place {
                        0 => "",
                        _ if place + 1 == size => " or ",
                        _ => ", ",
                    })?;
                    write!(f, "{number}")?;
                }
            }
            _ => write!(f, "limbs {}", self.limbs)?,
        }
        // What has changed little by little, or long before, shows where it has grown beyond the noise.
        let shows = match self.kind {
            Kind::ScaleJump | Kind::Offset | Kind::Drift => ", which shows",
            _ => "",
        };
        write!(f, ": {}{shows}{}", self.kind, Since(self.since))?;
        if self.is_open() {
            f.write_str("; forces cannot tell which")?;
        }
        Ok(())
    }
}

struct Since((u64, u64));

impl fmt::Display for Since {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (from, to) = self.0;
        write!(f, " since sample {from}")?;
        if to > from {
            write!(f, " to {to}")?;
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
    fn verdicts_in_words() {
        let said = |limbs: &[usize], kind, since| {
            let limbs = LimbSet::from_numbers(limbs.iter().copied()).expect("limbs");
            let verdict = Verdict {
                limbs,
                kind,
                since,
                said_at: 1300,
                class_ln_odds: 10.0,
                kind_ln_odds: 10.0,
                partner_ln_odds: if matches!(kind, Kind::Swapped | Kind::Stuck) {
                    f64::INFINITY
                } else {
                    0.0
                },
            };
            format!("{verdict}")
        };
        assert_eq!(
            said(&[5], Kind::Dead, (1234, 1234)),
            "limb 5: dead since sample 1234"
        );
        assert_eq!(
            said(&[2, 4], Kind::Drift, (0, 63)),
            "limb 2 or 4: its zero drifts, which shows since sample 0 to 63; forces cannot tell which"
        );
        assert_eq!(
            said(&[1, 6], Kind::Swapped, (8, 15)),
            "limbs 1 and 6: swapped since sample 8 to 15"
        );
        assert_eq!(
            said(&[], Kind::Unknown, (8, 8)),
            "it cannot be told which limbs have failed since sample 8"
        );
        assert_eq!(
            said(&[2, 5, 9], Kind::Stuck, (8, 9)),
            "limbs 2, 5 and 9: stuck since sample 8 to 9"
        );
        assert_eq!(
            said(&[1, 3, 7], Kind::Offset, (8, 8)),
            "limb 1, 3 or 7: its zero is another, which shows since sample 8; forces cannot tell which"
        );
    }
}
