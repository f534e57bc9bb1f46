//! The 25 parameters one by one: kind, limb or entry, name, unit, the step that determines it.

use core::fmt;
use core::ops::Range;

use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::geometry::LIMBS;
use crate::model::Parameters;

/// How many there are: nine drifts, nine scale factors, six inertias, one stiffness.
pub const PARAMETERS: usize = 25;
/// Places of the zero drifts among the 25.
pub const DRIFT: Range<usize> = 0..LIMBS;
/// Places of the scale factors.
pub const SCALE: Range<usize> = LIMBS..2 * LIMBS;
/// Places of the inertias.
pub const INERTIA: Range<usize> = 2 * LIMBS..2 * LIMBS + 6;
/// Place of the stiffness, or of its reciprocal, the compliance, where that is estimated.
pub const COMPLIANCE: usize = PARAMETERS - 1;

/// One of the 25 parameters. Limbs and entries count from 0 here, and from 1 in names.
///
/// It is serialised by its name, which is also what [`fmt::Display`] gives: `d1`, `s1/m`, `I1/m`, `k/m`, `m/k`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// Zero drift of a limb's channel, V.
    Drift(usize),
    /// Scale factor of a limb's channel over mass, 1/kg.
    Scale(usize),
    /// Entry of the inertia tensor over mass in the paper's order I1 to I6, m^2: three moments, then three products.
    Inertia(usize),
    /// Stiffness of one limb over mass, 1/s^2.
    Stiffness,
    /// Its reciprocal, s^2, in which voltages and rates are linear: what fits estimate in the stiffness's place.
    Compliance,
}

impl Parameter {
    /// The parameter at a place in the paper's order: drifts, scale factors, inertias, stiffness; none beyond the 25.
    #[must_use]
    pub fn at(place: usize) -> Option<Self> {
        if DRIFT.contains(&place) {
            Some(Self::Drift(place))
        } else if SCALE.contains(&place) {
            Some(Self::Scale(place - SCALE.start))
        } else if INERTIA.contains(&place) {
            Some(Self::Inertia(place - INERTIA.start))
        } else {
            (place == COMPLIANCE).then_some(Self::Stiffness)
        }
    }

    /// All 25 in that order.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..PARAMETERS).filter_map(Self::at)
    }

    /// Its place in that order, from 0.
    #[must_use]
    pub const fn place(self) -> usize {
        match self {
            Self::Drift(limb) => DRIFT.start + limb,
            Self::Scale(limb) => SCALE.start + limb,
            Self::Inertia(entry) => INERTIA.start + entry,
            Self::Stiffness | Self::Compliance => COMPLIANCE,
        }
    }

    /// The step that determines it, from 1 to 4.
    #[must_use]
    pub const fn step(self) -> usize {
        match self {
            Self::Drift(_) => 1,
            Self::Scale(_) => 2,
            Self::Inertia(_) => 3,
            Self::Stiffness | Self::Compliance => 4,
        }
    }

    /// The letter that stands for it in the paper.
    #[must_use]
    pub const fn symbol(self) -> char {
        match self {
            Self::Drift(_) => 'd',
            Self::Scale(_) => 's',
            Self::Inertia(_) => 'I',
            Self::Stiffness => 'k',
            Self::Compliance => 'm',
        }
    }

    /// The number beside its letter, from 1; the stiffness has none.
    #[must_use]
    pub const fn number(self) -> Option<usize> {
        match self {
            Self::Drift(index) | Self::Scale(index) | Self::Inertia(index) => Some(index + 1),
            Self::Stiffness | Self::Compliance => None,
        }
    }

    /// Its unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Drift(_) => "V",
            Self::Scale(_) => "1/kg",
            Self::Inertia(_) => "m²",
            Self::Stiffness => "1/s²",
            Self::Compliance => "s²",
        }
    }

    /// Whether it is a scale factor or a moment of inertia: of the 24 without the stiffness these have a size to hold an error
    /// against, whereas a zero drift and a product of inertia may vanish.
    #[must_use]
    pub const fn has_size(self) -> bool {
        matches!(self, Self::Scale(_) | Self::Inertia(0..3))
    }

    /// The parameter that fits estimate in its place: the compliance for the stiffness, else itself.
    #[must_use]
    pub const fn estimated(self) -> Self {
        match self {
            Self::Stiffness => Self::Compliance,
            other => other,
        }
    }

    /// Its value in a set of parameters.
    #[must_use]
    pub fn of(self, parameters: &Parameters) -> f64 {
        let inertia = parameters.inertia_per_mass.to_paper_order();
        match self {
            Self::Drift(limb) => parameters.zero_drift_v[limb],
            Self::Scale(limb) => parameters.scale_per_mass_per_kg[limb],
            Self::Inertia(entry) => inertia[entry],
            Self::Stiffness => parameters.stiffness_per_mass_per_s2,
            Self::Compliance => 1.0 / parameters.stiffness_per_mass_per_s2,
        }
    }

    /// The parameter of that name; none without one.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all()
            .chain([Self::Compliance])
            .find(|parameter| parameter.is_named(name))
    }

    fn is_named(self, name: &str) -> bool {
        if self == Self::Compliance {
            return name == "m/k";
        }
        let (stem, over_mass) = match name.strip_suffix("/m") {
            Some(stem) => (stem, true),
            None => (name, false),
        };
        let number = stem.strip_prefix(self.symbol());
        over_mass == (self.step() > 1)
            && match self.number() {
                Some(own) => number.and_then(|n| n.parse().ok()) == Some(own),
                None => number == Some(""),
            }
    }
}

impl Parameters {
    /// All 25 values in the paper's order: drifts, V; scale factors over mass, 1/kg; inertias over mass, m^2; stiffness over
    /// mass, 1/s^2.
    #[must_use]
    pub fn to_paper_order(&self) -> [f64; PARAMETERS] {
        let mut values = [0.0; PARAMETERS];
        for (value, parameter) in values.iter_mut().zip(Parameter::all()) {
            *value = parameter.of(self);
        }
        values
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::Compliance {
            return f.write_str("m/k");
        }
        write!(f, "{}", self.symbol())?;
        if let Some(number) = self.number() {
            write!(f, "{number}")?;
        }
        f.write_str(if self.step() > 1 { "/m" } else { "" })
    }
}

impl Serialize for Parameter {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Parameter {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;
        impl Visitor<'_> for Name {
            type Value = Parameter;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a parameter: d1 to d9, s1/m to s9/m, I1/m to I6/m, k/m or m/k")
            }

            fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Parameter, E> {
                Parameter::named(name)
                    .ok_or_else(|| E::invalid_value(serde::de::Unexpected::Str(name), &self))
            }
        }
        deserializer.deserialize_str(Name)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString;

    use super::*;

    #[test]
    fn names_and_places_lead_back() {
        for (place, parameter) in Parameter::all().enumerate() {
            assert_eq!(parameter.place(), place);
            assert_eq!(Parameter::named(&parameter.to_string()), Some(parameter));
        }
        assert_eq!(Parameter::all().count(), PARAMETERS);
        let names = [0, 17, 18, 24].map(|place| Parameter::at(place).map(|p| p.to_string()));
        assert_eq!(
            names,
            ["d1", "s9/m", "I1/m", "k/m"].map(|name| Some(name.to_string()))
        );
        for name in ["d0", "d10", "s1", "d1/m", "I7/m", "k", "k1/m", ""] {
            assert_eq!(Parameter::named(name), None, "{name}");
        }
        let compliance = Parameter::Stiffness.estimated();
        assert_eq!(compliance.to_string(), "m/k");
        assert_eq!(Parameter::named("m/k"), Some(compliance));
    }
}
