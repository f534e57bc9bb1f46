//! The true sensor: what the simulator knows and a laboratory has to find.

use glam::{DMat3, DVec3};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use crate::geometry::{Geometry, LIMBS};
use crate::paper;

/// Seismic mass that the design s/m implies at s = 1, kg. Only ratios to the mass matter.
pub const MASS_KG: f64 = 1.0 / paper::DESIGN_SCALE_PER_MASS_PER_KG;

/// Spread of a random sensor's scale factors: standard deviation of their logarithm. The paper's have 0.31.
const SCALE_SPREAD: f64 = 0.25;
/// Largest zero drift of a random sensor, V: the paper's largest is 17 mV.
const LARGEST_DRIFT_V: f64 = 20e-3;
/// Moments of inertia of a random sensor over the design's, from and to.
const MOMENTS: (f64, f64) = (0.85, 1.2);
/// Products of inertia of a random sensor, m^2, at most.
const PRODUCT_M2: f64 = 2e-6;
/// k/m of a random sensor, from and to, s^-2.
const STIFFNESS_PER_S2: (f64, f64) = (1.5e8, 5.0e8);

/// Inertia of the mass about its centre over the mass, mass axes: the tensor of equation (16), m^2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InertiaPerMass {
    /// I1.
    pub xx_m2: f64,
    /// I2.
    pub yy_m2: f64,
    /// I3.
    pub zz_m2: f64,
    /// I4.
    pub xy_m2: f64,
    /// I5.
    pub xz_m2: f64,
    /// I6.
    pub yz_m2: f64,
}

impl InertiaPerMass {
    /// From I1 to I6, m^2.
    pub const fn from_paper_order(i: [f64; 6]) -> Self {
        Self {
            xx_m2: i[0],
            yy_m2: i[1],
            zz_m2: i[2],
            xy_m2: i[3],
            xz_m2: i[4],
            yz_m2: i[5],
        }
    }

    /// I1 to I6, m^2.
    pub const fn to_paper_order(&self) -> [f64; 6] {
        [
            self.xx_m2, self.yy_m2, self.zz_m2, self.xy_m2, self.xz_m2, self.yz_m2,
        ]
    }

    /// The symmetric tensor, mass axes, m^2.
    pub fn tensor_m2(&self) -> DMat3 {
        DMat3::from_cols(
            DVec3::new(self.xx_m2, self.xy_m2, self.xz_m2),
            DVec3::new(self.xy_m2, self.yy_m2, self.yz_m2),
            DVec3::new(self.xz_m2, self.yz_m2, self.zz_m2),
        )
    }
}

/// A true sensor: the drawing and the 25 parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrueSensor {
    /// The drawing. No secret: it stands in the session file, and so not among the truths that are written apart.
    #[serde(skip)]
    pub geometry: Geometry,
    /// d_i, voltage without load, V: equation (10).
    pub zero_drift_v: [f64; LIMBS],
    /// s_i/m, scale factor over mass, 1/kg: equation (11).
    pub scale_per_mass_per_kg: [f64; LIMBS],
    /// I/m about the mass's centre: equation (16).
    pub inertia_per_mass: InertiaPerMass,
    /// k/m, stiffness of one limb over the mass, s^-2: equation (2).
    pub stiffness_per_mass_per_s2: f64,
    /// From the cube's centre, which the limbs are arranged about, to that of its mass, mass axes, m; the paper's sensor has it there.
    #[serde(skip_serializing_if = "is_the_cubes")]
    pub mass_centre_m: [f64; 3],
}

fn is_the_cubes(mass_centre_m: &[f64; 3]) -> bool {
    *mass_centre_m == [0.0; 3]
}

impl TrueSensor {
    /// The paper's sensor as designed: the "design" columns of its tables.
    pub fn design() -> Self {
        Self {
            geometry: Geometry::PAPER,
            zero_drift_v: [0.0; LIMBS],
            scale_per_mass_per_kg: [paper::DESIGN_SCALE_PER_MASS_PER_KG; LIMBS],
            inertia_per_mass: InertiaPerMass::from_paper_order(
                paper::DESIGN_INERTIA_PER_MASS_MM2.map(|i| i * 1e-6),
            ),
            stiffness_per_mass_per_s2: paper::DESIGN_STIFFNESS_PER_MASS_PER_S2,
            mass_centre_m: [0.0; 3],
        }
    }

    /// The paper's sensor as identified: the "identified" columns and k/m of Fig. 10.
    pub fn identified() -> Self {
        Self {
            geometry: Geometry::PAPER,
            zero_drift_v: paper::ZERO_DRIFT_MV.map(|d| d * 1e-3),
            scale_per_mass_per_kg: paper::SCALE_PER_MASS_PER_KG,
            inertia_per_mass: InertiaPerMass::from_paper_order(
                paper::INERTIA_PER_MASS_MM2.map(|i| i * 1e-6),
            ),
            stiffness_per_mass_per_s2: paper::STIFFNESS_PER_MASS_PER_S2,
            mass_centre_m: [0.0; 3],
        }
    }

    /// Zero drifts, V; scale factors over mass, 1/kg; I1 to I6 over mass, m^2; stiffness over mass, s^-2.
    pub fn to_paper_order(&self) -> [f64; 25] {
        let inertia_m2 = self.inertia_per_mass.to_paper_order();
        core::array::from_fn(|i| match i {
            0..9 => self.zero_drift_v[i],
            9..18 => self.scale_per_mass_per_kg[i - 9],
            18..24 => inertia_m2[i - 18],
            _ => self.stiffness_per_mass_per_s2,
        })
    }

    /// The nine voltages, V, under limb forces per mass, m/s^2, through amplifiers of the given gains, N/V: equations (10) and
    /// (11) solved for u.
    pub fn voltage_v(
        &self,
        force_per_mass_m_s2: &[f64; LIMBS],
        gain_n_per_v: &[f64; LIMBS],
    ) -> [f64; LIMBS] {
        core::array::from_fn(|i| {
            let sensitivity = self.scale_per_mass_per_kg[i] * gain_n_per_v[i];
            force_per_mass_m_s2[i] / sensitivity + self.zero_drift_v[i]
        })
    }

    /// A sensor scattered about the paper's design, with the paper's drawing.
    pub fn random(rng: &mut impl Rng) -> Self {
        let design = Self::design();
        let moments = design.inertia_per_mass.to_paper_order();
        Self {
            geometry: design.geometry,
            zero_drift_v: core::array::from_fn(|_| {
                rng.random_range(-LARGEST_DRIFT_V..LARGEST_DRIFT_V)
            }),
            scale_per_mass_per_kg: design.scale_per_mass_per_kg.map(|s| {
                let unit: f64 = StandardNormal.sample(rng);
                s * (SCALE_SPREAD * unit).exp()
            }),
            inertia_per_mass: InertiaPerMass::from_paper_order(core::array::from_fn(|i| {
                if i < 3 {
                    moments[i] * rng.random_range(MOMENTS.0..MOMENTS.1)
                } else {
                    rng.random_range(-PRODUCT_M2..PRODUCT_M2)
                }
            })),
            stiffness_per_mass_per_s2: rng.random_range(STIFFNESS_PER_S2.0..STIFFNESS_PER_S2.1),
            mass_centre_m: [0.0; 3],
        }
    }
}
