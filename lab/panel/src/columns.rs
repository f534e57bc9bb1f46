//! The columns that the instrument keeps of each sample, and samples on their way from a source.

use std::ops::Range;

use serde::Serialize;
use sixaxis_calibration::apply::voltages::Voltages;
use sixaxis_core::LIMBS;

/// Nine voltages as they came, V.
pub const VOLTAGE: Range<usize> = 0..9;
/// Reference accelerometer, m/s^2, and gyroscope, rad/s.
pub const STANDARD: Range<usize> = 9..11;
/// Nine voltages behind the stages, V.
pub const CONDITIONED: Range<usize> = 11..20;
/// Linear acceleration, m/s^2, angular acceleration, rad/s^2, both in ground axes; rate in shell axes, rad/s.
pub const MOTION: Range<usize> = 20..29;
/// The three sums of limb forces that are zero while no limb has failed, m/s^2.
pub const PARITY: Range<usize> = 29..32;
/// True linear and angular acceleration, ground axes, of a simulated laboratory, behind the same low-pass.
pub const TRUTH: Range<usize> = 32..38;
/// The accelerations of [`MOTION`] as a tared sensor feels them in its own axes, and the true ones.
pub const FELT: Range<usize> = 38..44;
/// See [`FELT`].
pub const TRULY_FELT: Range<usize> = 44..50;
/// Acceleration along the run's direction and rate about it, m/s^2 and rad/s, as decoupled.
pub const ALONG: Range<usize> = 50..52;
/// What the reference instruments show of them, behind the same low-pass.
pub const STANDARD_BEHIND: Range<usize> = 52..54;
/// All of them.
pub const COLUMNS: usize = 54;

/// Numbers of a true motion: accelerations, rate, attitude as w, x, y, z.
pub const TRUTH_NUMBERS: usize = 13;

/// What a browser is told of a column.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
}

/// Names and units of all columns.
pub fn described() -> Vec<Column> {
    let column = |name: String, unit| Column { name, unit };
    let limbs =
        |prefix: &'static str| (1..=LIMBS).map(move |i| column(format!("{prefix}{i}"), "V"));
    let axes = |names: [&str; 3], unit| names.map(|name| column(name.to_owned(), unit));
    let mut all: Vec<Column> = limbs("u").collect();
    all.push(column("accelerometer".to_owned(), "m/s²"));
    all.push(column("gyroscope".to_owned(), "rad/s"));
    all.extend(limbs("c"));
    all.extend(axes(["ax", "ay", "az"], "m/s²"));
    all.extend(axes(["αx", "αy", "αz"], "rad/s²"));
    all.extend(axes(["ωx", "ωy", "ωz"], "rad/s"));
    all.extend(axes(["f1+f2+f4+f5", "f1+f3+f7+f9", "f5+f6+f8+f9"], "m/s²"));
    all.extend(axes(["true ax", "true ay", "true az"], "m/s²"));
    all.extend(axes(["true αx", "true αy", "true αz"], "rad/s²"));
    for prefix in ["felt", "truly felt"] {
        let three = |name: &str| ["x", "y", "z"].map(|axis| format!("{prefix} {name}{axis}"));
        all.extend(three("a").map(|name| column(name, "m/s²")));
        all.extend(three("α").map(|name| column(name, "rad/s²")));
    }
    for whose in ["decoupled", "instrument"] {
        all.push(column(format!("{whose}, along the direction"), "m/s²"));
        all.push(column(format!("{whose}, about the direction"), "rad/s"));
    }
    all
}

/// Consecutive samples from a source.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Batch {
    /// Nine voltages, V. NaN where a row had none.
    pub voltage_v: Voltages,
    /// Reference accelerometer, m/s^2, and gyroscope, rad/s; both empty or as many as voltages.
    pub standard: [Vec<f64>; 2],
    /// The true motion; empty or as many as voltages.
    pub truth: Vec<[f64; TRUTH_NUMBERS]>,
}

impl Batch {
    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.voltage_v.samples()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inv_every_column_has_a_name() {
        assert_eq!(described().len(), COLUMNS);
        assert_eq!(STANDARD_BEHIND.end, COLUMNS);
        assert_eq!(described()[MOTION.start].name, "ax");
        assert_eq!(described()[TRUTH.start].name, "true ax");
        assert_eq!(described()[TRULY_FELT.start].name, "truly felt ax");
    }
}
