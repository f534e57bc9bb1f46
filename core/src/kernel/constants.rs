//! Everything that a sensor, its parameters and its sample rate put into the formulas, multiplied out once.
//!
//! The unit of length is the limb length L, that of time the sample interval h: most factors of the formulas become one.

use nalgebra::Matrix3;

use super::number::{Real, Scalar};
use super::order::{from_kernel_order, to_kernel_order};
use super::vec3::{Vec3, three, vec3, visit_three};
use crate::error::{Error, Result};
use crate::geometry::{LIMBS, LIMBS_PER_NODE};
use crate::model::{InertiaPerMass, Model};
use crate::paper::preload::hidden_preload_m_s2;
use crate::paper::signal::SignalChain;

/// Size above which constants are refused, with room for what samples do to them.
const LARGEST: f64 = 1e304;

/// The numbers of the kernel's formulas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants<T: Real> {
    /// Strain of a limb per volt, (1), (10), (11) and (2) in one; in kernel order.
    pub strain_per_v: [Vec3<T>; LIMBS_PER_NODE],
    /// Its strain at zero volt: drift, and the preload that a tared channel does not show.
    pub strain_at_zero: [Vec3<T>; LIMBS_PER_NODE],
    /// n/L.
    pub nu: T,
    /// L/n.
    pub inverse_nu: T,
    /// chi: force per mass of a limb of unit strain; -(k/m) h^2 where compression shortens.
    pub chi: T,
    /// Columns that take a torque over chi nu in mass axes to one over the principal moments in principal axes.
    pub torque: [Vec3<T>; 3],
    /// The principal axes in mass axes: columns that take the former to the latter.
    pub principal: [Vec3<T>; 3],
    /// (I_2 - I_3)/I_1 and its cyclic permutations.
    pub gyroscopic: Vec3<T>,
    /// g in ground axes, m/s^2.
    pub gravity_ground_m_s2: Vec3<T>,
    /// 1/h: rates, rad/s.
    pub per_s: T,
    /// 1/h^2: angular accelerations, rad/s^2.
    pub per_s2: T,
    /// L/h^2: linear accelerations, m/s^2.
    pub m_per_s2: T,
}

impl Constants<f64> {
    /// Multiplies out.
    ///
    /// # Errors
    /// [`Error::NotConverged`] when gravity finds no equilibrium or the inertia no principal axes; [`Error::OutOfRange`] for
    /// sizes, each sound by itself, whose products overflow or vanish.
    pub fn new(model: &Model) -> Result<Self> {
        let (sensor, parameters, settings) = (model.sensor(), model.parameters(), model.settings());
        let chain = SignalChain::new(&sensor.gains, parameters);
        let preload = hidden_preload_m_s2(model)?;
        let length = sensor.geometry.limb_length_m;
        let h = 1.0 / settings.sample_rate_hz;
        let stiffness = parameters.stiffness_per_mass_per_s2;
        // The sign of (2), and strain per force.
        let strain_per_force =
            settings.limb_law.elongations_m(&[1.0; LIMBS], stiffness)[0] / length;
        let at_rest = chain.force_per_mass_m_s2(&[0.0; LIMBS]);
        let per_v = chain.sensitivity_m_s2_per_v();
        let nu = sensor.geometry.half_edge_m / length;
        let chi = h * h / (length * strain_per_force);
        let (moments, axes) = principal(&parameters.inertia_per_mass)?;
        let moments = moments.map(|i| i / (length * length));
        let [i1, i2, i3] = moments;
        let column = |j: usize| vec3(axes[(0, j)], axes[(1, j)], axes[(2, j)]);
        let row = |i: usize| vec3(axes[(i, 0)], axes[(i, 1)], axes[(i, 2)]);
        let g = settings.gravity_ground_m_s2;
        let constants = Self {
            strain_per_v: to_kernel_order(per_v.map(|s| s * strain_per_force)),
            strain_at_zero: to_kernel_order(core::array::from_fn(|i| {
                (at_rest[i] + preload[i]) * strain_per_force
            })),
            nu,
            inverse_nu: 1.0 / nu,
            chi,
            torque: core::array::from_fn(|i| {
                let row = row(i).components();
                let over = |j: usize| row[j] * (chi * nu / moments[j]);
                vec3(over(0), over(1), over(2))
            }),
            principal: core::array::from_fn(column),
            gyroscopic: vec3((i2 - i3) / i1, (i3 - i1) / i2, (i1 - i2) / i3),
            gravity_ground_m_s2: vec3(g.x, g.y, g.z),
            per_s: 1.0 / h,
            per_s2: 1.0 / (h * h),
            m_per_s2: length / (h * h),
        };
        constants.validate()?;
        Ok(constants)
    }

    /// Refuses sizes, each sound by itself, that no f64 can work with together.
    fn validate(&self) -> Result<()> {
        let out_of_range = |name, value| {
            Err(Error::out_of_range(
                name,
                value,
                "of sizes whose products neither overflow nor vanish",
            ))
        };
        let numbers = |rows: [Vec3<f64>; LIMBS_PER_NODE]| rows.map(Vec3::components);
        let slopes = numbers(self.strain_per_v);
        let values = numbers(self.strain_at_zero);
        for (&slope, &value) in slopes.as_flattened().iter().zip(values.as_flattened()) {
            if !(slope.is_normal() && slope.abs() < LARGEST && value.abs() < LARGEST) {
                return out_of_range(
                    "zero_drift_v, scale_per_mass_per_kg, gain_n_per_v and limb_length_m together",
                    if slope.is_normal() { value } else { slope },
                );
            }
        }
        let torque = self.torque.map(|column| {
            column
                .components()
                .iter()
                .fold(0.0_f64, |m, x| m.max(x.abs()))
        });
        let others = [
            self.nu,
            self.inverse_nu,
            self.chi,
            self.per_s2,
            self.m_per_s2,
        ];
        for value in torque.into_iter().chain(others) {
            let value = value.abs();
            if !(value.is_normal() && value < LARGEST) {
                return out_of_range(
                    "limb_length_m, half_edge_m, sample_rate_hz, gravity_ground_m_s2 and inertia together",
                    value,
                );
            }
        }
        Ok(())
    }

    /// The same numbers rounded to another scalar.
    pub fn rounded<T: Scalar>(&self) -> Constants<T> {
        self.map(T::from_f64)
    }
}

impl<T: Real> Constants<T> {
    /// The same numbers in another type.
    #[inline(always)]
    pub fn map<U: Real>(&self, f: impl Fn(T) -> U) -> Constants<U> {
        Constants {
            strain_per_v: three(self.strain_per_v, &f),
            strain_at_zero: three(self.strain_at_zero, &f),
            nu: f(self.nu),
            inverse_nu: f(self.inverse_nu),
            chi: f(self.chi),
            torque: three(self.torque, &f),
            principal: three(self.principal, &f),
            gyroscopic: self.gyroscopic.map(&f),
            gravity_ground_m_s2: self.gravity_ground_m_s2.map(&f),
            per_s: f(self.per_s),
            per_s2: f(self.per_s2),
            m_per_s2: f(self.m_per_s2),
        }
    }

    /// The same number everywhere.
    #[inline(always)]
    pub(crate) fn splat(number: T) -> Self {
        Self {
            strain_per_v: [Vec3::all(number); LIMBS_PER_NODE],
            strain_at_zero: [Vec3::all(number); LIMBS_PER_NODE],
            nu: number,
            inverse_nu: number,
            chi: number,
            torque: [Vec3::all(number); 3],
            principal: [Vec3::all(number); 3],
            gyroscopic: Vec3::all(number),
            gravity_ground_m_s2: Vec3::all(number),
            per_s: number,
            per_s2: number,
            m_per_s2: number,
        }
    }

    /// Every number in its place, always in the same order.
    #[inline(always)]
    pub(crate) fn visit(&mut self, f: &mut impl FnMut(T) -> T) {
        let Self {
            strain_per_v,
            strain_at_zero,
            nu,
            inverse_nu,
            chi,
            torque,
            principal,
            gyroscopic,
            gravity_ground_m_s2,
            per_s,
            per_s2,
            m_per_s2,
        } = self;
        visit_three(strain_per_v, f);
        visit_three(strain_at_zero, f);
        visit_three(torque, f);
        visit_three(principal, f);
        gyroscopic.visit(f);
        gravity_ground_m_s2.visit(f);
        *nu = f(*nu);
        *inverse_nu = f(*inverse_nu);
        *chi = f(*chi);
        *per_s = f(*per_s);
        *per_s2 = f(*per_s2);
        *m_per_s2 = f(*m_per_s2);
    }
}

impl<T: Real> Constants<T> {
    /// Strain of one limb.
    pub fn strain(&self, limb: usize, voltage_v: T) -> T {
        let slope = from_kernel_order(self.strain_per_v)[limb];
        voltage_v.times_plus(slope, from_kernel_order(self.strain_at_zero)[limb])
    }

    /// Torque over chi nu in mass axes to angular acceleration of the mass in principal axes.
    #[inline(always)]
    pub fn torque_to_principal(&self, torque: Vec3<T>) -> Vec3<T> {
        of_columns(&self.torque, torque)
    }

    /// Principal axes to mass axes.
    #[inline(always)]
    pub fn principal_to_mass(&self, v: Vec3<T>) -> Vec3<T> {
        of_columns(&self.principal, v)
    }

    /// Mass axes to principal axes.
    #[inline(always)]
    pub fn mass_to_principal(&self, v: Vec3<T>) -> Vec3<T> {
        let [a, b, c] = self.principal;
        vec3(a.dot(v), b.dot(v), c.dot(v))
    }
}

/// Matrix of three columns times a vector.
#[inline(always)]
fn of_columns<T: Real>(columns: &[Vec3<T>; 3], v: Vec3<T>) -> Vec3<T> {
    let [a, b, c] = *columns;
    let [x, y, z] = v.components();
    c.times_plus(z, b.times_plus(y, a.times(x)))
}

/// Principal moments per mass, m^2, and right-handed principal axes as columns in mass axes.
fn principal(inertia: &InertiaPerMass) -> Result<([f64; 3], Matrix3<f64>)> {
    let eigen = inertia.eigen("principal axes of inertia")?;
    let mut axes = eigen.eigenvectors;
    // Euler's equations need a right-handed basis.
    if axes.determinant() < 0.0 {
        axes.column_mut(2).neg_mut();
    }
    Ok((eigen.eigenvalues.into(), axes))
}
