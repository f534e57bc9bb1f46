//! The 25 parameters that the four steps identify.

use glam::{DMat3, DVec3};
use nalgebra::{SymmetricEigen, U3};
use serde::{Deserialize, Serialize};

use crate::columns::matrix;
use crate::error::{Error, Result, require, require_finite};
use crate::geometry::LIMBS;

/// Design range of k/m, s^-2: the interval searched in step 4 (Fig. 10), widened by a decade on either side.
pub const STIFFNESS_PER_MASS_RANGE_PER_S2: (f64, f64) = (1.0e7, 1.0e10);

/// Largest relative asymmetry of rounding that the eigenvalue iteration is asked to resolve.
const EIGEN_TOLERANCE: f64 = 1e-15;
/// A symmetric 3 x 3 matrix settles in a handful of sweeps; the cap only guards against a hang.
const EIGEN_ITERATIONS: usize = 100;

/// Inertia tensor of the mass about its centre in mass axes, divided by the mass: eq. (16), m^2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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
    /// From the paper's order (I1, I2, I3, I4, I5, I6), m^2.
    #[must_use]
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

    /// In the paper's order (I1, I2, I3, I4, I5, I6), m^2.
    #[must_use]
    pub const fn to_paper_order(&self) -> [f64; 6] {
        [
            self.xx_m2, self.yy_m2, self.zz_m2, self.xy_m2, self.xz_m2, self.yz_m2,
        ]
    }

    /// The symmetric tensor in mass axes, m^2.
    #[must_use]
    pub fn matrix_mass_m2(&self) -> DMat3 {
        DMat3::from_cols(
            DVec3::new(self.xx_m2, self.xy_m2, self.xz_m2),
            DVec3::new(self.xy_m2, self.yy_m2, self.yz_m2),
            DVec3::new(self.xz_m2, self.yz_m2, self.zz_m2),
        )
    }

    /// Principal moments per mass, ascending, m^2.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for an entry that is not finite or of a size whose principal moments are not,
    /// [`Error::NotConverged`] if the eigenvalue iteration does not settle.
    pub fn principal_m2(&self) -> Result<[f64; 3]> {
        const NAMES: [&str; 6] = ["xx_m2", "yy_m2", "zz_m2", "xy_m2", "xz_m2", "yz_m2"];
        for (name, value) in NAMES.into_iter().zip(self.to_paper_order()) {
            require_finite(name, value)?;
        }
        let mut p: [f64; 3] = self
            .eigen("principal moments of inertia")?
            .eigenvalues
            .into();
        p.sort_unstable_by(f64::total_cmp);
        require(
            p.iter().all(|moment| moment.is_finite()),
            "inertia_per_mass",
            self.to_paper_order()
                .iter()
                .fold(0.0, |a, b| a.max(b.abs())),
            "of a size whose principal moments are finite",
        )?;
        Ok(p)
    }

    /// Principal moments and axes; `what` is for the error.
    pub(crate) fn eigen(&self, what: &'static str) -> Result<SymmetricEigen<f64, U3>> {
        SymmetricEigen::try_new(
            matrix(self.matrix_mass_m2()),
            EIGEN_TOLERANCE,
            EIGEN_ITERATIONS,
        )
        .ok_or(Error::NotConverged {
            what,
            iterations: EIGEN_ITERATIONS,
        })
    }

    /// Refuses a tensor that no rigid body can have.
    ///
    /// # Errors
    /// As [`Self::principal_m2`], [`Error::ImpossibleInertia`] when a principal moment is not positive or exceeds the
    /// sum of the other two, and [`Error::OutOfRange`] when the determinant overflows or vanishes or the inverse is not finite.
    pub fn validate(&self) -> Result<()> {
        let p = self.principal_m2()?;
        if !(p[0] > 0.0 && p[2] <= p[0] + p[1]) {
            return Err(Error::ImpossibleInertia { principal_m2: p });
        }
        let tensor = self.matrix_mass_m2();
        require(
            tensor.determinant().is_normal() && tensor.inverse().is_finite(),
            "inertia_per_mass",
            p[2],
            "of a size whose cube neither overflows nor vanishes and whose inverse is finite",
        )?;
        Ok(())
    }
}

/// The 25 decoupling parameters: 9 zero drifts, 9 scale/mass, 6 inertia/mass, 1 stiffness/mass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameters {
    /// d_i, output voltage without load, V: eq. (10), Table 1.
    pub zero_drift_v: [f64; LIMBS],
    /// s_i/m, scale factor over mass, 1/kg: eq. (11), Table 2.
    pub scale_per_mass_per_kg: [f64; LIMBS],
    /// I/m, m^2: eq. (16), Table 3.
    pub inertia_per_mass: InertiaPerMass,
    /// k/m, stiffness of one limb over mass, s^-2: eq. (2), Fig. 10.
    pub stiffness_per_mass_per_s2: f64,
}

impl Parameters {
    /// Refuses parameters that no sensor of this kind can have.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a drift that is not finite, a scale factor that is not finite or zero, or k/m
    /// outside [`STIFFNESS_PER_MASS_RANGE_PER_S2`]; the errors of [`InertiaPerMass::validate`].
    pub fn validate(&self) -> Result<()> {
        for value in self.zero_drift_v {
            require_finite("zero_drift_v", value)?;
        }
        for value in self.scale_per_mass_per_kg {
            // A reversed channel has a negative factor and decouples all the same.
            require(
                value.is_finite() && value != 0.0,
                "scale_per_mass_per_kg",
                value,
                "finite and not zero",
            )?;
        }
        self.inertia_per_mass.validate()?;
        let (low, high) = STIFFNESS_PER_MASS_RANGE_PER_S2;
        let value = self.stiffness_per_mass_per_s2;
        require(
            (low..=high).contains(&value),
            "stiffness_per_mass_per_s2",
            value,
            "between 1e7 and 1e10",
        )?;
        Ok(())
    }
}
