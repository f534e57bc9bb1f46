//! The numbers the paper prints, in the units it prints them in converted to SI.
//!
//! You, Li, Wu, Optics and Precision Engineering 21(10), 2013, 2627-2638. The sensor that the campaign simulates has
//! the *identified* columns as its truth; identification starts from the *design* columns ([`crate::sensor::TrueSensor`] has both).

use glam::DVec3;

/// Standard gravity, m/s^2.
pub const GRAVITY_M_S2: f64 = 9.80665;

/// Table 1, identified zero drift, mV (design: 0).
pub const ZERO_DRIFT_MV: [f64; 9] = [-12.3, 16.8, -15.5, -10.1, -4.7, -16.6, -11.7, -8.3, -10.9];

/// Table 2, identified s_i/m, 1/kg.
pub const SCALE_PER_MASS_PER_KG: [f64; 9] = [
    5.0892, 3.5501, 6.1199, 3.2308, 4.8763, 7.0909, 3.6896, 3.1624, 3.1838,
];

/// Table 2, design s_i/m, 1/kg.
pub const DESIGN_SCALE_PER_MASS_PER_KG: f64 = 5.3476;

/// Table 3, identified I1..I6 over m, mm^2.
pub const INERTIA_PER_MASS_MM2: [f64; 6] = [191.0846, 236.4900, 326.5389, 0.0804, -0.3794, 1.5799];

/// Table 3, design I1..I6 over m, mm^2.
pub const DESIGN_INERTIA_PER_MASS_MM2: [f64; 6] =
    [238.76, 250.71, 252.588, 0.0512, -0.0295, 0.5544];

/// Fig. 10, identified k/m, s^-2.
pub const STIFFNESS_PER_MASS_PER_S2: f64 = 2.0e8;

/// Section 4.2, design k/m, s^-2.
pub const DESIGN_STIFFNESS_PER_MASS_PER_S2: f64 = 3.1e8;

/// Thresholds of relative motion: 0.01 mm/s^2 and 0.01 deg/s^2, SI.
pub const LINEAR_THRESHOLD_M_S2: f64 = 0.01e-3;
/// See [`LINEAR_THRESHOLD_M_S2`].
pub const ANGULAR_THRESHOLD_RAD_S2: f64 = 0.01 * core::f64::consts::PI / 180.0;

/// Fig. 7: linear and angular threshold frequency, Hz.
pub const THRESHOLD_FREQUENCY_HZ: (f64, f64) = (2.3, 2.5);

/// One of Tables 4 to 6.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompoundTable {
    /// Table number in the paper.
    pub number: u32,
    /// Drive frequency, Hz.
    pub frequency_hz: f64,
    /// Direction, not normalised, that reproduces the printed targets.
    pub direction: DVec3,
    /// Printed target, linear in g and angular in deg/s^2, x y z each.
    pub target: [f64; 6],
    /// Printed error before identification, %.
    pub error_before_percent: [f64; 6],
    /// Printed error after identification, %.
    pub error_after_percent: [f64; 6],
}

/// Tables 4, 5 and 6. The scan lost the leading digit of Table 6's three angular targets; restored here.
pub const COMPOUND_TABLES: [CompoundTable; 3] = [
    CompoundTable {
        number: 4,
        frequency_hz: 1.0,
        direction: DVec3::new(1.0, 1.0, 2.0),
        target: [0.15, 0.15, 0.30, 1612.35, 1612.35, 3224.70],
        error_before_percent: [39.841, 77.004, 50.986, 40.587, 69.031, 55.897],
        error_after_percent: [5.058, 7.428, 6.017, 5.017, 7.387, 7.477],
    },
    CompoundTable {
        number: 5,
        frequency_hz: 3.0,
        direction: DVec3::new(1.0, 2.0, 1.0),
        target: [1.38, 2.75, 1.38, 14511.10, 29022.30, 14511.10],
        error_before_percent: [70.005, 71.801, 62.901, 55.260, 76.358, 39.881],
        error_after_percent: [6.899, 6.990, 7.470, 6.382, 7.089, 7.184],
    },
    CompoundTable {
        number: 6,
        frequency_hz: 5.0,
        direction: DVec3::new(2.0, 1.0, 1.0),
        target: [7.64, 3.82, 3.82, 80617.40, 40308.70, 40308.70],
        error_before_percent: [60.112, 75.584, 55.368, 52.687, 72.879, 41.589],
        error_after_percent: [7.479, 7.108, 5.984, 7.061, 6.148, 5.742],
    },
];
