//! Numbers of fifty digits, vectors and linear systems of them. Shares no code with what is judged.

use std::ops::{Add, Div, Mul, Neg, Sub, SubAssign};

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

/// A number of fifty decimal digits. Its arithmetic is called and not inlined: as generic code at each of its hundred places it took half
/// of the time in which these laws are built.
#[derive(Debug, Clone)]
pub struct Big(FBig<HalfEven, 2>);

macro_rules! arithmetic {
    ($($operation:ident::$of:ident),*) => {$(
        impl $operation for &Big {
            type Output = Big;
            #[inline(never)]
            fn $of(self, other: Self) -> Big {
                Big($operation::$of(&self.0, &other.0))
            }
        }
        impl $operation<Big> for &Big {
            type Output = Big;
            fn $of(self, other: Big) -> Big {
                $operation::$of(self, &other)
            }
        }
        impl $operation<&Self> for Big {
            type Output = Self;
            fn $of(self, other: &Self) -> Self {
                $operation::$of(&self, other)
            }
        }
        impl $operation for Big {
            type Output = Self;
            fn $of(self, other: Self) -> Self {
                $operation::$of(&self, &other)
            }
        }
    )*};
}

arithmetic!(Add::add, Sub::sub, Mul::mul, Div::div);

impl Neg for Big {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl SubAssign for Big {
    fn sub_assign(&mut self, other: Self) {
        *self = &*self - other;
    }
}

impl Big {
    #[inline(never)]
    pub fn sqrt(&self) -> Self {
        Self(self.0.sqrt())
    }
}

/// Bits of fifty digits, and a few more.
const BITS: usize = 170;
/// Terms of the series of an angle below a hundredth: the first one dropped is 1e-60 of the sum.
const TERMS: u32 = 12;

/// The same number; every f64 is one.
#[inline(never)]
pub fn big(value: f64) -> Big {
    let exact = FBig::try_from(value).expect("a finite number");
    Big(exact.with_precision(BITS).value())
}

/// The nearest f64.
#[inline(never)]
pub fn near(value: &Big) -> f64 {
    value.0.to_f64().value()
}

/// Three components.
#[derive(Debug, Clone)]
pub struct Vector(pub [Big; 3]);

impl Vector {
    pub fn new(components: [f64; 3]) -> Self {
        Self(components.map(big))
    }

    pub fn dot(&self, other: &Self) -> Big {
        let [a, b] = [&self.0, &other.0];
        &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
    }

    pub fn cross(&self, other: &Self) -> Self {
        let [a, b] = [&self.0, &other.0];
        let at = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
        Self([at(1, 2), at(2, 0), at(0, 1)])
    }

    pub fn length(&self) -> Big {
        self.dot(self).sqrt()
    }

    pub fn near(&self) -> [f64; 3] {
        self.0.each_ref().map(near)
    }
}

impl Add for &Vector {
    type Output = Vector;
    fn add(self, other: Self) -> Vector {
        Vector(core::array::from_fn(|i| &self.0[i] + &other.0[i]))
    }
}

impl Sub for &Vector {
    type Output = Vector;
    fn sub(self, other: Self) -> Vector {
        Vector(core::array::from_fn(|i| &self.0[i] - &other.0[i]))
    }
}

impl Mul<&Big> for &Vector {
    type Output = Vector;
    fn mul(self, factor: &Big) -> Vector {
        Vector(core::array::from_fn(|i| &self.0[i] * factor))
    }
}

/// A rotation by a rotation vector, as what it adds to a vector.
pub struct Turn {
    rotation_rad: Vector,
    /// sin(x)/x and (1 - cos x)/x^2 of its length.
    quotients: [Big; 2],
}

impl Turn {
    /// By a rotation vector shorter than a hundredth.
    pub fn by(rotation_rad: Vector) -> Self {
        let squared = rotation_rad.dot(&rotation_rad);
        let quotients = [1, 2].map(|first| {
            let mut term = big(1.0) / big(f64::from(first));
            let mut sum = term.clone();
            for k in 1..TERMS {
                let factors = f64::from((2 * k + first - 1) * (2 * k + first));
                term = -(&term * &squared) / big(factors);
                sum = &sum + &term;
            }
            sum
        });
        Self {
            rotation_rad,
            quotients,
        }
    }

    /// (R - 1) v.
    pub fn added(&self, v: &Vector) -> Vector {
        let once = self.rotation_rad.cross(v);
        let twice = self.rotation_rad.cross(&once);
        &(&once * &self.quotients[0]) + &(&twice * &self.quotients[1])
    }

    /// R v.
    pub fn turned(&self, v: &Vector) -> Vector {
        v + &self.added(v)
    }

    /// R^T v.
    pub fn back(&self, v: &Vector) -> Vector {
        let once = v.cross(&self.rotation_rad);
        let twice = once.cross(&self.rotation_rad);
        v + &(&(&once * &self.quotients[0]) + &(&twice * &self.quotients[1]))
    }
}

/// Three rows.
#[derive(Debug, Clone)]
pub struct Matrix(pub [Vector; 3]);

impl Matrix {
    pub fn times(&self, v: &Vector) -> Vector {
        Vector(self.0.each_ref().map(|row| row.dot(v)))
    }

    pub fn column(&self, index: usize) -> Vector {
        Vector(self.0.each_ref().map(|row| row.0[index].clone()))
    }

    pub fn of_columns(columns: [Vector; 3]) -> Self {
        Self(core::array::from_fn(|i| {
            Vector(columns.each_ref().map(|column| column.0[i].clone()))
        }))
    }

    pub fn inverse(&self) -> Self {
        let rows: Vec<Vec<Big>> = self.0.iter().map(|row| row.0.to_vec()).collect();
        Self::of_columns(core::array::from_fn(|axis| {
            let unit = (0..3)
                .map(|i| big(f64::from(u8::from(i == axis))))
                .collect();
            let column = solve(rows.clone(), unit);
            Vector(core::array::from_fn(|i| column[i].clone()))
        }))
    }
}

/// Solution of a square system, by elimination with the largest pivot of each column.
pub fn solve(mut rows: Vec<Vec<Big>>, mut right: Vec<Big>) -> Vec<Big> {
    let size = rows.len();
    for pivot in 0..size {
        let largest = (pivot..size)
            .max_by(|&a, &b| {
                near(&rows[a][pivot])
                    .abs()
                    .total_cmp(&near(&rows[b][pivot]).abs())
            })
            .expect("a row");
        rows.swap(pivot, largest);
        right.swap(pivot, largest);
        for row in pivot + 1..size {
            let factor = &rows[row][pivot] / &rows[pivot][pivot];
            let (above, below) = rows.split_at_mut(row);
            for (value, other) in below[0].iter_mut().zip(&above[pivot]).skip(pivot) {
                *value -= &factor * other;
            }
            right[row] = &right[row] - &(&factor * &right[pivot]);
        }
    }
    for pivot in (0..size).rev() {
        for column in pivot + 1..size {
            right[pivot] = &right[pivot] - &(&rows[pivot][column] * &right[column]);
        }
        right[pivot] = &right[pivot] / &rows[pivot][pivot];
    }
    right
}

/// Least squares by the normal equations, which fifty digits afford.
pub struct Normal {
    rows: Vec<Vec<Big>>,
    right: Vec<Big>,
}

impl Normal {
    pub fn of(unknowns: usize) -> Self {
        Self {
            rows: vec![vec![big(0.0); unknowns]; unknowns],
            right: vec![big(0.0); unknowns],
        }
    }

    /// Adds an equation; coefficients that are not there are zero.
    pub fn push(&mut self, coefficients: &[(usize, Big)], value: &Big) {
        for (i, a) in coefficients {
            for (j, b) in coefficients {
                self.rows[*i][*j] = &self.rows[*i][*j] + &(a * b);
            }
            self.right[*i] = &self.right[*i] + &(a * value);
        }
    }

    /// Its matrix.
    pub fn matrix(self) -> Vec<Vec<Big>> {
        self.rows
    }

    pub fn solve(self) -> Vec<Big> {
        solve(self.rows, self.right)
    }
}
