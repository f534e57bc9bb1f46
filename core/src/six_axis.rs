//! The answer of every decoder, one by one or as columns.

use glam::{DQuat, DVec3};

/// One decoupled sample. `V` and `Q` are vector and quaternion of the decoder's precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SixAxis<V = DVec3, Q = DQuat> {
    /// Index of the voltage sample that this belongs to, from 0.
    pub sample: u64,
    /// a, linear acceleration of the shell, ground axes, m/s^2.
    pub linear_ground_m_s2: V,
    /// w', angular acceleration of the shell, ground axes, rad/s^2.
    pub angular_ground_rad_s2: V,
    /// w*, angular velocity of the shell, shell axes, rad/s.
    pub rate_shell_rad_s: V,
    /// R, shell axes to ground axes.
    pub attitude: Q,
}

/// a then w' in ground axes, m/s^2 and rad/s^2.
pub type Accelerations = [f64; 6];

/// Numbers of an answer: a, w', w*, then the attitude as w, x, y, z.
pub const NUMBERS: usize = 13;

impl SixAxis {
    /// Sample 0 of a sensor that is at rest in this attitude.
    #[must_use]
    pub const fn still(attitude: DQuat) -> Self {
        Self {
            sample: 0,
            linear_ground_m_s2: DVec3::ZERO,
            angular_ground_rad_s2: DVec3::ZERO,
            rate_shell_rad_s: DVec3::ZERO,
            attitude,
        }
    }

    /// Linear acceleration, m/s^2, then angular acceleration, rad/s^2, both in ground axes.
    #[must_use]
    pub fn accelerations(&self) -> Accelerations {
        let (a, alpha) = (self.linear_ground_m_s2, self.angular_ground_rad_s2);
        [a.x, a.y, a.z, alpha.x, alpha.y, alpha.z]
    }

    /// Everything but the index: [`Self::accelerations`], rate in shell axes, rad/s, attitude as w, x, y, z.
    #[must_use]
    pub fn numbers(&self) -> [f64; NUMBERS] {
        let [ax, ay, az, bx, by, bz] = self.accelerations();
        let (w, q) = (self.rate_shell_rad_s, self.attitude);
        [ax, ay, az, bx, by, bz, w.x, w.y, w.z, q.w, q.x, q.y, q.z]
    }

    /// Inverse of [`Self::numbers`].
    #[must_use]
    pub fn from_numbers(sample: u64, numbers: [f64; NUMBERS]) -> Self {
        let [ax, ay, az, bx, by, bz, wx, wy, wz, qw, qx, qy, qz] = numbers;
        Self {
            sample,
            linear_ground_m_s2: DVec3::new(ax, ay, az),
            angular_ground_rad_s2: DVec3::new(bx, by, bz),
            rate_shell_rad_s: DVec3::new(wx, wy, wz),
            attitude: DQuat::from_xyzw(qx, qy, qz, qw),
        }
    }
}

/// Consecutive answers as columns, in the order of [`SixAxis::numbers`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SixAxisColumns<'a> {
    first_sample: u64,
    columns: [&'a [f64]; NUMBERS],
}

impl<'a> SixAxisColumns<'a> {
    /// Row by row the answers to the samples from `first_sample` on.
    pub(crate) fn new<const N: usize>(first_sample: u64, columns: &'a [[f64; N]; NUMBERS]) -> Self {
        Self {
            first_sample,
            columns: columns.each_ref().map(|column| &column[..]),
        }
    }

    /// Number of answers.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns[0].len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.columns[0].is_empty()
    }

    /// The columns, all of one length.
    #[must_use]
    pub fn columns(&self) -> [&'a [f64]; NUMBERS] {
        self.columns
    }

    /// The answers one by one.
    pub fn iter(&self) -> impl Iterator<Item = SixAxis> + use<'a> {
        let Self {
            first_sample,
            columns,
        } = *self;
        (first_sample..)
            .zip(0..columns[0].len())
            .map(move |(sample, row)| {
                SixAxis::from_numbers(sample, columns.map(|column| column[row]))
            })
    }
}
