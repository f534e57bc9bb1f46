//! The numbers by which [`super::reconstruct`] takes what the parity relations leave to strains, and these to force and torque.

use super::constants::Constants;
use super::number::{Real, Scalar};
use super::order::{Limbs, to_kernel_order};
use super::parity::{halves, left, second_order};
use super::placement::{LimbLoad, by_nodes, nodes, shell_axes};
use super::vec3::{Vec3, three, visit_three};
use crate::geometry::{LIMBS, LIMBS_PER_NODE};
use crate::redundancy::parity::ROWS;
use crate::redundancy::reconstruction::Reconstruction;

/// The order in which [`super::parity`] has the rows: 1, 3, 2.
const ORDER: [usize; ROWS] = [0, 2, 1];

/// The weights K in kernel order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrainWeights<T: Real> {
    /// Of each row, in the order 1, 3, 2.
    weights: [Limbs<T>; ROWS],
    /// The same times -1/2, for [`second_order`].
    minus_half: [Limbs<T>; ROWS],
    /// What they add to the difference of the relations' halves.
    differences: [Vec3<T>; ROWS],
    /// One over each limb's stiffness ratio, and the ratio: the kernel's strains are those that limbs of the mean stiffness would have under
    /// the same forces, and the relations are between the limbs' own.
    own: [Limbs<T>; 2],
}

/// What strains K rho of limbs at rest add to force and torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadWeights<T: Real> {
    /// To the resultant over chi.
    force: [Vec3<T>; ROWS],
    /// To the torque over the principal moments, principal axes.
    torque: [Vec3<T>; ROWS],
}

impl<T: Scalar> StrainWeights<T> {
    /// Of no limb: strains stay as they are.
    pub(super) fn none() -> Self {
        Self {
            own: [[Vec3::all(T::from_f64(1.0)); LIMBS_PER_NODE]; 2],
            ..Self::splat(T::default())
        }
    }

    /// Rounded.
    pub(super) fn new(reconstruction: &Reconstruction) -> Self {
        let of = reconstruction.weights();
        let weights = ORDER
            .map(|row| to_kernel_order(core::array::from_fn(|limb| T::from_f64(of[limb][row]))));
        Self {
            weights,
            minus_half: weights.map(|row| row.map(|limbs| limbs.times(T::from_f64(-0.5)))),
            differences: weights.map(|column| {
                let [a, b] = halves(column);
                a - b
            }),
            own: [f64::recip, core::convert::identity].map(|of| {
                to_kernel_order(reconstruction.stiffness_ratio().map(|r| T::from_f64(of(r))))
            }),
        }
    }
}

impl<T: Real> StrainWeights<T> {
    /// The same numbers in another type.
    #[inline(always)]
    pub(super) fn map<U: Real>(&self, f: impl Fn(T) -> U) -> StrainWeights<U> {
        let nine = |[k, l, m]: [Limbs<T>; ROWS]| [three(k, &f), three(l, &f), three(m, &f)];
        StrainWeights {
            weights: nine(self.weights),
            minus_half: nine(self.minus_half),
            differences: three(self.differences, &f),
            own: self.own.map(|limbs| three(limbs, &f)),
        }
    }

    /// The same number everywhere.
    #[inline(always)]
    pub(crate) fn splat(number: T) -> Self {
        Self {
            own: [[Vec3::all(number); LIMBS_PER_NODE]; 2],
            weights: [[Vec3::all(number); LIMBS_PER_NODE]; ROWS],
            minus_half: [[Vec3::all(number); LIMBS_PER_NODE]; ROWS],
            differences: [Vec3::all(number); ROWS],
        }
    }

    /// Every number in its place, always in the same order.
    #[inline(always)]
    pub(crate) fn visit(&mut self, f: &mut impl FnMut(T) -> T) {
        let Self {
            weights: [k, l, m],
            minus_half: [n, o, p],
            differences,
            own: [to_own, from_own],
        } = self;
        visit_three(k, f);
        visit_three(l, f);
        visit_three(m, f);
        visit_three(n, f);
        visit_three(o, f);
        visit_three(p, f);
        visit_three(differences, f);
        visit_three(to_own, f);
        visit_three(from_own, f);
    }

    /// Strains to second order from those of the limbs that are used, the others zero.
    #[inline(always)]
    pub fn to_second_order(&self, used: Limbs<T>, inverse_nu: T) -> Limbs<T> {
        let [to_own, from_own] = self.own;
        let used = each(used, to_own);
        let [a, b] = halves(used);
        let sums = a + b;
        let [k, l, m] = self.differences;
        let [s, t, u] = sums.components();
        let difference = m.times_plus(u, l.times_plus(t, k.times_plus(s, a - b)));
        let first = onto(used, &self.weights, sums);
        let second = second_order(first, difference, inverse_nu);
        each(onto(first, &self.minus_half, second), from_own)
    }
}

impl<T: Scalar> LoadWeights<T> {
    /// Rounded.
    pub(super) fn new(reconstruction: &Reconstruction, constants: &Constants<f64>) -> Self {
        // Third order is less than what is known of ratios other than 1, of which sums of forces have more left.
        let equal = *reconstruction.stiffness_ratio() == [1.0; LIMBS];
        let of = reconstruction
            .weights()
            .map(|limb| if equal { limb } else { [0.0; ROWS] });
        let row = |row: usize| to_kernel_order(core::array::from_fn(|limb| of[limb][row]));
        let at_rest = ORDER.map(|r| shell_axes(row(r)));
        Self {
            force: at_rest.map(|[a, b, c]| (a + b + c).map(T::from_f64)),
            torque: at_rest.map(|nodes| {
                let torque = constants.torque_to_principal(Vec3::moment(nodes));
                torque.map(T::from_f64)
            }),
        }
    }
}

impl<T: Real> LoadWeights<T> {
    /// The same numbers in another type.
    #[inline(always)]
    pub(super) fn map<U: Real>(&self, f: impl Fn(T) -> U) -> LoadWeights<U> {
        LoadWeights {
            force: three(self.force, &f),
            torque: three(self.torque, &f),
        }
    }

    /// The same number everywhere.
    #[inline(always)]
    pub(crate) fn splat(number: T) -> Self {
        Self {
            force: [Vec3::all(number); ROWS],
            torque: [Vec3::all(number); ROWS],
        }
    }

    /// Every number in its place, always in the same order.
    #[inline(always)]
    pub(crate) fn visit(&mut self, f: &mut impl FnMut(T) -> T) {
        let Self { force, torque } = self;
        visit_three(force, f);
        visit_three(torque, f);
    }

    /// Places the mass by strains that are right to second order, and adds the third order to force and torque.
    #[inline(always)]
    pub fn by_strains(&self, constants: &Constants<T>, strain: Limbs<T>) -> LimbLoad<T> {
        let (displacement, force, squares) = nodes(strain);
        // Before the pose: three numbers are kept longer then, and not nine.
        let [a, b] = halves(displacement);
        let sums = a + b;
        let placed = by_nodes(constants, displacement, force, squares);
        let third = left(sums, placed.rotation, constants.nu);
        LimbLoad {
            force: along(placed.force, &self.force, third),
            torque: along(placed.torque, &self.torque, third),
            ..placed
        }
    }
}

/// `to` + a matrix of three columns times the rows.
#[inline(always)]
fn along<T: Real>(to: Vec3<T>, columns: &[Vec3<T>; ROWS], rows: Vec3<T>) -> Vec3<T> {
    let [k, l, m] = *columns;
    let [a, b, c] = rows.components();
    m.times_plus(c, l.times_plus(b, k.times_plus(a, to)))
}

/// Limb by limb.
#[inline(always)]
fn each<T: Real>([a, b, c]: Limbs<T>, [x, y, z]: Limbs<T>) -> Limbs<T> {
    [a.mul_elem(x), b.mul_elem(y), c.mul_elem(z)]
}

/// `to` + K rows.
#[inline(always)]
fn onto<T: Real>(to: Limbs<T>, weights: &[Limbs<T>; ROWS], rows: Vec3<T>) -> Limbs<T> {
    let [[k, l, m], [n, o, p], [q, r, s]] = *weights;
    let [u, v, w] = to;
    let [a, b, c] = rows.components();
    [
        q.times_plus(c, n.times_plus(b, k.times_plus(a, u))),
        r.times_plus(c, o.times_plus(b, l.times_plus(a, v))),
        s.times_plus(c, p.times_plus(b, m.times_plus(a, w))),
    ]
}
