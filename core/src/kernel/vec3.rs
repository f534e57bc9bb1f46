//! Vectors of three components along fixed axes.
//!
//! A number type chooses how three of it are stored: split, which suits vector registers that hold other samples' numbers and
//! processors without any, or packed in one register, which more than halves the instructions of a cross product.

use core::fmt;
use core::ops::{Add, Sub};

use super::number::{Real, Scalar};

/// Three components along fixed axes.
#[derive(Clone, Copy)]
pub struct Vec3<T: Real>(T::Storage);

/// Three components.
#[inline(always)]
pub fn vec3<T: Real>(x: T, y: T, z: T) -> Vec3<T> {
    Vec3(T::Storage::new(x, y, z))
}

/// Operations on three numbers, however they are stored.
pub trait Vec3Storage<T: Real>: Copy {
    /// From its components.
    fn new(x: T, y: T, z: T) -> Self;
    /// Its components.
    fn components(self) -> [T; 3];
    /// Its components and padding.
    #[inline(always)]
    fn padded(self) -> [T; 4] {
        let [x, y, z] = self.components();
        [x, y, z, z]
    }
    /// The inverse of [`Self::padded`].
    #[inline(always)]
    fn from_padded([x, y, z, _]: [T; 4]) -> Self {
        Self::new(x, y, z)
    }
    /// Component by component.
    fn plus(self, other: Self) -> Self;
    /// Component by component.
    fn minus(self, other: Self) -> Self;
    /// Component by component.
    fn mul_elem(self, other: Self) -> Self;
    /// `self * other + term`, component by component.
    fn mul_elem_plus(self, other: Self, term: Self) -> Self;
    /// `term - self * other`, component by component.
    fn neg_mul_elem_plus(self, other: Self, term: Self) -> Self;
    /// The same number three times.
    fn all(value: T) -> Self;
    /// (y, z, x).
    fn cycled(self) -> Self;
    /// `self . other`.
    fn dot(self, other: Self) -> T;
    /// `term + self x other`.
    fn cross_plus(self, other: Self, term: Self) -> Self;
    /// `self x other`.
    fn cross(self, other: Self) -> Self;
    /// x, y and z components of three vectors' sum in the pattern of [`Vec3::moment`].
    fn moment(v: [Self; 3]) -> Self;
}

/// Bitwise selection of components.
pub trait Select {
    /// [`Scalar::and`], component by component.
    fn and(self, bits: Self) -> Self;
}

impl<T: Scalar> Select for SplitVec3<T> {
    #[inline(always)]
    fn and(self, bits: Self) -> Self {
        Self {
            x: self.x.and(bits.x),
            y: self.y.and(bits.y),
            z: self.z.and(bits.z),
        }
    }
}

/// Three components in separate registers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SplitVec3<T> {
    x: T,
    y: T,
    z: T,
}

impl<T: Real> Vec3Storage<T> for SplitVec3<T> {
    #[inline(always)]
    fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    #[inline(always)]
    fn components(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }

    #[inline(always)]
    fn mul_elem(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }

    #[inline(always)]
    fn mul_elem_plus(self, other: Self, term: Self) -> Self {
        Self::new(
            self.x.times_plus(other.x, term.x),
            self.y.times_plus(other.y, term.y),
            self.z.times_plus(other.z, term.z),
        )
    }

    #[inline(always)]
    fn neg_mul_elem_plus(self, other: Self, term: Self) -> Self {
        Self::new(
            self.x.neg_mul_add(other.x, term.x),
            self.y.neg_mul_add(other.y, term.y),
            self.z.neg_mul_add(other.z, term.z),
        )
    }

    #[inline(always)]
    fn all(value: T) -> Self {
        Self::new(value, value, value)
    }

    #[inline(always)]
    fn cycled(self) -> Self {
        Self::new(self.y, self.z, self.x)
    }

    #[inline(always)]
    fn dot(self, other: Self) -> T {
        let xy = self.x.times_plus(other.x, self.y * other.y);
        self.z.times_plus(other.z, xy)
    }

    #[inline(always)]
    fn cross_plus(self, other: Self, term: Self) -> Self {
        Self::new(
            self.y
                .times_plus(other.z, self.z.neg_mul_add(other.y, term.x)),
            self.z
                .times_plus(other.x, self.x.neg_mul_add(other.z, term.y)),
            self.x
                .times_plus(other.y, self.y.neg_mul_add(other.x, term.z)),
        )
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        Self::new(
            self.z.neg_mul_add(other.y, self.y * other.z),
            self.x.neg_mul_add(other.z, self.z * other.x),
            self.y.neg_mul_add(other.x, self.x * other.y),
        )
    }

    #[inline(always)]
    fn moment([a, b, c]: [Self; 3]) -> Self {
        Self::new(a.y - b.z, c.z - a.x, b.x - c.y)
    }
}

impl<T: Real> Vec3<T> {
    /// First component.
    #[inline(always)]
    pub fn x(self) -> T {
        self.0.components()[0]
    }

    /// Second component.
    #[inline(always)]
    pub fn y(self) -> T {
        self.0.components()[1]
    }

    /// Third component.
    #[inline(always)]
    pub fn z(self) -> T {
        self.0.components()[2]
    }

    /// All three.
    #[inline(always)]
    pub fn components(self) -> [T; 3] {
        self.0.components()
    }

    /// The same number three times.
    #[inline(always)]
    pub fn all(value: T) -> Self {
        Self(T::Storage::all(value))
    }

    /// A constant of the components' type: [`Real::constant`].
    #[inline(always)]
    pub fn constant(self, value: f64) -> T {
        self.x().constant(value)
    }

    /// All three times a number.
    #[inline(always)]
    pub fn times(self, factor: T) -> Self {
        Self(self.0.mul_elem(T::Storage::all(factor)))
    }

    /// `self * factor + term`.
    #[inline(always)]
    pub fn times_plus(self, factor: T, term: Self) -> Self {
        Self(self.0.mul_elem_plus(T::Storage::all(factor), term.0))
    }

    /// Component by component.
    #[inline(always)]
    pub fn mul_elem(self, other: Self) -> Self {
        Self(self.0.mul_elem(other.0))
    }

    /// `self * other + term`, component by component.
    #[inline(always)]
    pub fn mul_elem_plus(self, other: Self, term: Self) -> Self {
        Self(self.0.mul_elem_plus(other.0, term.0))
    }

    /// `term - self * other`, component by component.
    #[inline(always)]
    pub fn neg_mul_elem_plus(self, other: Self, term: Self) -> Self {
        Self(self.0.neg_mul_elem_plus(other.0, term.0))
    }

    /// (y, z, x).
    #[inline(always)]
    pub fn cycled(self) -> Self {
        Self(self.0.cycled())
    }

    /// `self . other`.
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        self.0.dot(other.0)
    }

    /// `self x other`.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self(self.0.cross(other.0))
    }

    /// `term + self x other`.
    #[inline(always)]
    pub fn cross_plus(self, other: Self, term: Self) -> Self {
        Self(self.0.cross_plus(other.0, term.0))
    }

    /// `(1, 1, 1) x self`.
    #[inline(always)]
    pub fn ones_cross(self) -> Self {
        let yzx = self.0.cycled();
        Self(yzx.cycled().minus(yzx))
    }

    /// Sum of the three.
    #[inline(always)]
    pub fn sum(self) -> T {
        let [x, y, z] = self.components();
        x + y + z
    }

    /// -z x a - y x b - x x c for three vectors: their moment about the origin when they act at the points -z, -y and -x.
    #[inline(always)]
    pub fn moment([a, b, c]: [Self; 3]) -> Self {
        Self(T::Storage::moment([a.0, b.0, c.0]))
    }

    /// Every component in its place, in order.
    #[inline(always)]
    pub(crate) fn visit(&mut self, f: &mut impl FnMut(T) -> T) {
        let [x, y, z] = self.components();
        let x = f(x);
        let y = f(y);
        *self = vec3(x, y, f(z));
    }

    /// Another number type, component by component.
    #[inline(always)]
    pub fn map<U: Real>(self, f: impl Fn(T) -> U) -> Vec3<U> {
        // With the padding: between two packed vectors it is one move.
        let [x, y, z, w] = self.0.padded();
        Vec3(U::Storage::from_padded([f(x), f(y), f(z), f(w)]))
    }
}

/// [`Vec3::map`] of three. Written out: the library's maps of arrays are calls that no vector register survives.
#[inline(always)]
pub(super) fn three<T: Real, U: Real>([a, b, c]: [Vec3<T>; 3], f: impl Fn(T) -> U) -> [Vec3<U>; 3] {
    [a.map(&f), b.map(&f), c.map(&f)]
}

/// [`Vec3::visit`] of three, in order. Written out: by a loop they would go by memory.
#[inline(always)]
pub(super) fn visit_three<T: Real>([a, b, c]: &mut [Vec3<T>; 3], f: &mut impl FnMut(T) -> T) {
    a.visit(f);
    b.visit(f);
    c.visit(f);
}

impl<T: Scalar> Vec3<T> {
    /// [`Scalar::and`], component by component.
    #[inline(always)]
    pub fn and(self, bits: Self) -> Self {
        Self(self.0.and(bits.0))
    }

    /// Whether all three are finite.
    pub fn is_finite(self) -> bool {
        self.components().iter().all(|x| x.to_f64().is_finite())
    }
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0.plus(other.0))
    }
}

impl<T: Real> Sub for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0.minus(other.0))
    }
}

impl<T: Real + PartialEq> PartialEq for Vec3<T> {
    fn eq(&self, other: &Self) -> bool {
        self.components() == other.components()
    }
}

impl<T: Real + Default> Default for Vec3<T> {
    fn default() -> Self {
        Self::all(T::default())
    }
}

impl<T: Real + fmt::Debug> fmt::Debug for Vec3<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.components().fmt(f)
    }
}

/// How three f64 are stored: packed where the program is compiled for registers of four or may find them.
#[cfg(any(target_feature = "avx", all(feature = "std", target_arch = "x86_64")))]
pub type Vec3F64 = super::packed_vec3::PackedVec3<wide::f64x4>;
/// How three f64 are stored: packed where the program is compiled for registers of four or may find them.
#[cfg(not(any(target_feature = "avx", all(feature = "std", target_arch = "x86_64"))))]
pub type Vec3F64 = SplitVec3<f64>;
