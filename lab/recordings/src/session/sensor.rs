//! The sensor under calibration: lengths, converter, amplifier, design values.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sixaxis_core::{Geometry, InertiaPerMass, Parameters};

/// Limbs of the sensor, each with a channel.
pub const LIMBS: usize = 9;

/// Largest factor, either way, between limbs and half edges of a sensor. Limbs lie along the mass's faces, from their middles to the shell beyond
/// their edges, so that one is about as long as the other: 25.5 and 21 mm in the paper. Beyond the root of ten they are nearer to each other with
/// one decimal point moved.
const LIKELY: f64 = 3.0;

/// What is known of the sensor without identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorCard {
    /// Serial number or name.
    #[serde(default)]
    pub serial: String,
    /// L, length of an unloaded limb, mm.
    pub limb_length_mm: f64,
    /// n, half edge of the cubic mass, mm.
    pub half_edge_mm: f64,
    /// Limit of the converter, V.
    pub full_scale_v: f64,
    /// c_i, gain of the amplifier, N/V: one number or nine. A recording may have its own.
    pub gain_n_per_v: PerLimb,
    /// Design values: what an identified parameter is compared with, and what k/m is set to if it cannot be determined.
    pub design: Design,
}

/// One number for all limbs or nine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "one number, or nine in brackets")]
pub enum PerLimb {
    /// The same for all.
    All(f64),
    /// Limb 1 to 9.
    Each([f64; LIMBS]),
}

impl PerLimb {
    /// Nine numbers.
    pub fn each(&self) -> [f64; LIMBS] {
        match *self {
            Self::All(value) => [value; LIMBS],
            Self::Each(values) => values,
        }
    }
}

/// Design values of the identified parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// s_i/m, 1/kg: one number or nine.
    pub scale_per_mass_per_kg: PerLimb,
    /// I1 to I6 over m, mm^2.
    pub inertia_per_mass_mm2: [f64; 6],
    /// k/m, 1/s^2.
    pub stiffness_per_mass_per_s2: f64,
}

impl SensorCard {
    /// The sensor's lengths, m.
    pub fn geometry(&self) -> Geometry {
        Geometry {
            limb_length_m: self.limb_length_mm * 1e-3,
            half_edge_m: self.half_edge_mm * 1e-3,
        }
    }

    /// What is odd about the lengths, if they are not those of one sensor. Of trials only the second order shows how long limbs are.
    pub fn odd_lengths(&self) -> Option<String> {
        let Self {
            limb_length_mm,
            half_edge_mm,
            ..
        } = self;
        let ratio = limb_length_mm / half_edge_mm;
        (!(1.0 / LIKELY..=LIKELY).contains(&ratio)).then(|| {
            format!(
                "limb_length_mm is {limb_length_mm} and half_edge_mm {half_edge_mm}, which are about the same in this kind of sensor, and no trial shows a wrong limb_length_mm: check both against the drawing"
            )
        })
    }

    /// The sensor's design values as parameters, with a zero drift of 0 V.
    pub fn design(&self) -> Parameters {
        let design = &self.design;
        Parameters {
            zero_drift_v: [0.0; LIMBS],
            scale_per_mass_per_kg: design.scale_per_mass_per_kg.each(),
            inertia_per_mass: InertiaPerMass::from_paper_order(
                design.inertia_per_mass_mm2.map(|i| i * 1e-6),
            ),
            stiffness_per_mass_per_s2: design.stiffness_per_mass_per_s2,
        }
    }
}
