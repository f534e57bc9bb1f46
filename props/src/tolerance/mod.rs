//! The one table of limits that tests and benches hold errors to, each with its reason; one file a truth.
//!
//! A limit is *derived* (an expression in code), *measured* (the largest error seen, and a margin over it),
//! *reference-limited* (the truth is not known better) or *required* (somebody asks for it).

mod control;
mod exact;
mod limbs;
mod mujoco;
mod statistical;
mod timing;

use std::fmt;

pub use self::control::*;
pub use self::exact::*;
pub use self::limbs::*;
pub use self::mujoco::*;
pub use self::statistical::*;
pub use self::timing::*;

/// Why a limit is what it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reason {
    /// It follows from the arithmetic: the limit is an expression in code, of these terms.
    Derived(&'static str),
    /// The largest error seen when the limit was written. The margin covers other machines and other cases.
    Measured {
        /// The error seen.
        value: f64,
        /// Limit over that.
        margin: f64,
        /// What the error consists of, where that is known.
        note: &'static str,
    },
    /// The reference is not known better.
    ReferenceLimited {
        /// The error seen, most of which is the reference's own.
        value: f64,
        /// What the reference's error consists of.
        note: &'static str,
    },
    /// A requirement: what is asked for, or a rate of false alarms that is chosen.
    Required(&'static str),
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (note, end) = match self {
            Self::Derived(terms) => return write!(f, "derived: {terms}"),
            Self::Required(what) => return write!(f, "required: {what}"),
            Self::Measured {
                value,
                margin,
                note,
            } => {
                write!(f, "measured: {value:e}, margin {margin:.1}")?;
                (note, "")
            }
            Self::ReferenceLimited { value, note } => {
                write!(f, "limited by the reference ({value:e} seen")?;
                (note, ")")
            }
        };
        let colon = if note.is_empty() { "" } else { ": " };
        write!(f, "{colon}{note}{end}")
    }
}

/// A limit on the magnitude of an error, in the unit of the comparison (mostly relative).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Largest error that passes.
    pub limit: f64,
    /// Why.
    pub reason: Reason,
}

impl Tolerance {
    /// Whether an error passes; NaN and negative numbers do not.
    pub fn allows(&self, error: f64) -> bool {
        (0.0..=self.limit).contains(&error)
    }
}

/// Limits on the distribution of an error over many cases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gate {
    /// On the median.
    pub median: f64,
    /// On what 99 % of the cases stay below.
    pub q99: f64,
    /// On the largest.
    pub max: f64,
    /// Why.
    pub reason: Reason,
}

const fn derived(limit: f64, terms: &'static str) -> Tolerance {
    Tolerance {
        limit,
        reason: Reason::Derived(terms),
    }
}

const fn measured(limit: f64, value: f64, note: &'static str) -> Tolerance {
    assert!(value <= limit, "the error seen exceeds its limit");
    Tolerance {
        limit,
        reason: Reason::Measured {
            value,
            margin: limit / value,
            note,
        },
    }
}

const fn reference_limited(limit: f64, value: f64, note: &'static str) -> Tolerance {
    assert!(value <= limit, "the error seen exceeds its limit");
    Tolerance {
        limit,
        reason: Reason::ReferenceLimited { value, note },
    }
}

const fn required(limit: f64, what: &'static str) -> Tolerance {
    Tolerance {
        limit,
        reason: Reason::Required(what),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_refuses_what_is_no_magnitude() {
        let limit = required(1.0, "a test");
        assert!(limit.allows(0.0) && limit.allows(1.0));
        for error in [f64::NAN, f64::INFINITY, -0.1, 1.1] {
            assert!(!limit.allows(error), "{error}");
        }
    }

    #[test]
    fn a_reason_reads_as_a_sentence() {
        assert_eq!(
            measured(1e-12, 2.5e-13, "").reason.to_string(),
            "measured: 2.5e-13, margin 4.0"
        );
        assert_eq!(
            reference_limited(1e-9, 2e-10, "rounding")
                .reason
                .to_string(),
            "limited by the reference (2e-10 seen: rounding)"
        );
    }
}
