//! From limb forces to limb lengths: eq. (2).

use crate::geometry::LIMBS;
use crate::model::LimbLaw;

impl LimbLaw {
    /// Limb elongations dl_i = l_i - L, m: eq. (2).
    #[must_use]
    pub fn elongations_m(
        self,
        force_per_mass_m_s2: &[f64; LIMBS],
        stiffness_per_mass_per_s2: f64,
    ) -> [f64; LIMBS] {
        let compliance = match self {
            Self::CompressionShortens => -1.0 / stiffness_per_mass_per_s2,
            Self::AsPrinted => 1.0 / stiffness_per_mass_per_s2,
        };
        force_per_mass_m_s2.map(|f| f * compliance)
    }
}
