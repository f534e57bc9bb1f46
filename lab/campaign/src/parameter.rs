//! The 25 parameters as columns: their names, units and order.

use sixaxis_core::{InertiaPerMass, LIMBS, Parameters};
use sixaxis_reference::sensor::TrueSensor;

pub use sixaxis_core::model::PARAMETERS;

/// Name of a parameter in SQL, with its unit: `d1_v`, `s1_per_kg`, `i1_m2`, `k_per_s2`; order as in [`values`].
#[must_use]
pub fn column(parameter: usize) -> String {
    match parameter {
        0..9 => format!("d{}_v", parameter + 1),
        9..18 => format!("s{}_per_kg", parameter - 8),
        18..24 => format!("i{}_m2", parameter - 17),
        _ => "k_per_s2".to_owned(),
    }
}

/// Name of a parameter as the paper has it: `d1`, `s1/m`, `I1/m`, `k/m`.
#[must_use]
pub fn name(parameter: usize) -> String {
    match parameter {
        0..9 => format!("d{}", parameter + 1),
        9..18 => format!("s{}/m", parameter - 8),
        18..24 => format!("I{}/m", parameter - 17),
        _ => "k/m".to_owned(),
    }
}

/// Unit of a parameter.
#[must_use]
pub const fn unit(parameter: usize) -> &'static str {
    match parameter {
        0..9 => "V",
        9..18 => "1/kg",
        18..24 => "m^2",
        _ => "1/s^2",
    }
}

/// Drifts, V; scale factors over mass, 1/kg; inertias over mass in the paper's order, m^2; stiffness over mass, 1/s^2.
#[must_use]
pub fn values(parameters: &Parameters) -> [f64; PARAMETERS] {
    let inertia_m2 = parameters.inertia_per_mass.to_paper_order();
    core::array::from_fn(|i| match i {
        0..9 => parameters.zero_drift_v[i],
        9..18 => parameters.scale_per_mass_per_kg[i - LIMBS],
        18..24 => inertia_m2[i - 2 * LIMBS],
        _ => parameters.stiffness_per_mass_per_s2,
    })
}

/// [`values`] of a simulated sensor: where the reference's types become core's.
#[must_use]
pub fn true_values(sensor: &TrueSensor) -> [f64; PARAMETERS] {
    values(&Parameters {
        zero_drift_v: sensor.zero_drift_v,
        scale_per_mass_per_kg: sensor.scale_per_mass_per_kg,
        inertia_per_mass: InertiaPerMass::from_paper_order(
            sensor.inertia_per_mass.to_paper_order(),
        ),
        stiffness_per_mass_per_s2: sensor.stiffness_per_mass_per_s2,
    })
}
