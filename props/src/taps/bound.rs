//! The Cramér-Rao bound of a tap.
//!
//! It shares no code with the fit: states instead of modes, a matrix exponential instead of eigenvalues, differences instead of
//! derivatives.

use nalgebra::{DMatrix, DVector, Matrix6, SMatrix, SVector};
use sixaxis_core::LIMBS;
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_reference::geometry::Geometry;
use sixaxis_reference::rig::tap::SAMPLE_RATE_HZ;

use super::{Case, KNOWN_TO, Recorded, inertia_deviation_m2};

/// Displacement, rotation and their rates.
const STATES: usize = 12;
/// ln k/m, damping ratio, I/m.
const SHARED: usize = 8;
/// Differences by which the derivatives are taken, relative: phases of up to a thousand radians move by a hundredth.
const DIFFERENCE: f64 = 1e-5;

type Output = SMatrix<f64, LIMBS, STATES>;

/// The decay of a sensor at rest as a linear system in its state.
#[derive(Debug, Clone)]
pub struct States {
    /// From one sample to the next.
    pub step: SMatrix<f64, STATES, STATES>,
    /// Limb forces per mass, m/s^2, of a state.
    pub output: Output,
}

impl States {
    /// From M x'' + C x' + K x = 0.
    pub fn new(inertia_m2: &[f64; 6], stiffness: f64, damping_ratio: f64, step_s: f64) -> Self {
        let jacobian = Geometry::PAPER.limb_wrenches();
        let damping = 2.0 * damping_ratio * stiffness.sqrt();
        let mut mass = Matrix6::identity();
        let [xx, yy, zz, xy, xz, yz] = *inertia_m2;
        mass.fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz));
        let inverse = mass.try_inverse().expect("an inertia is regular");
        let pull = -inverse * (jacobian.transpose() * jacobian);
        let mut rate = DMatrix::<f64>::zeros(STATES, STATES);
        for i in 0..6 {
            rate[(i, 6 + i)] = 1.0;
            for j in 0..6 {
                rate[(6 + i, j)] = stiffness * pull[(i, j)];
                rate[(6 + i, 6 + j)] = damping * pull[(i, j)];
            }
        }
        let step = (rate * step_s).exp();
        Self {
            step: SMatrix::from_fn(|i, j| step[(i, j)]),
            output: SMatrix::from_fn(|limb, column| {
                if column < 6 {
                    -stiffness * jacobian[(limb, column)]
                } else {
                    -damping * jacobian[(limb, column - 6)]
                }
            }),
        }
    }

    /// Forces of each sample from a state on.
    pub fn forces(&self, start: SVector<f64, STATES>) -> impl Iterator<Item = SVector<f64, LIMBS>> {
        let mut state = start;
        core::iter::from_fn(move || {
            let force = self.output * state;
            state = self.step * state;
            Some(force)
        })
    }

    /// The state at the beginning of a stretch of forces that fits them best.
    pub fn start(&self, force: &[[f64; LIMBS]]) -> SVector<f64, STATES> {
        let mut basis = DMatrix::zeros(LIMBS * force.len(), STATES);
        let mut output = self.output;
        for sample in 0..force.len() {
            basis
                .fixed_view_mut::<LIMBS, STATES>(LIMBS * sample, 0)
                .copy_from(&output);
            output *= self.step;
        }
        // States differ by six orders of size.
        let sizes: Vec<f64> = basis.column_iter().map(|c| c.norm()).collect();
        for (column, size) in sizes.iter().enumerate() {
            basis.column_mut(column).unscale_mut(*size);
        }
        let right = DVector::from_iterator(LIMBS * force.len(), force.iter().flatten().copied());
        let svd = basis.svd(true, true);
        let scaled = svd.solve(&right, 0.0).expect("both sides were asked for");
        SVector::from_fn(|i, _| scaled[i] / sizes[i])
    }
}

/// Cramér-Rao bound of the standard deviation of ln k/m for the stretch that was fitted, with what is known beforehand: no
/// unbiased estimate of the same samples is better.
pub fn bound_ln(case: &Case, recorded: &Recorded, fitted: &core::ops::Range<usize>) -> f64 {
    let force = &recorded.force_per_mass_m_s2[fitted.clone()];
    let truth = [
        case.truth.stiffness_per_mass_per_s2.ln(),
        case.damping_ratio,
    ]
    .into_iter()
    .chain(case.truth.inertia_per_mass.to_paper_order())
    .collect::<Vec<f64>>();
    let states = |p: &[f64]| {
        let inertia: [f64; 6] = core::array::from_fn(|k| p[2 + k]);
        States::new(&inertia, p[0].exp(), p[1], 1.0 / SAMPLE_RATE_HZ)
    };
    let true_states = states(&truth);
    let start = true_states.start(force);
    let deviation = inertia_deviation_m2(&case.truth);
    let sizes: [f64; SHARED] = core::array::from_fn(|k| {
        if k < 2 {
            DIFFERENCE
        } else {
            DIFFERENCE * deviation / KNOWN_TO
        }
    });
    let slopes: Vec<Vec<SVector<f64, LIMBS>>> = (0..SHARED)
        .map(|k| {
            let moved = |by: f64| -> Vec<SVector<f64, LIMBS>> {
                let mut p = truth.clone();
                p[k] += by;
                states(&p).forces(start).take(force.len()).collect()
            };
            moved(sizes[k])
                .iter()
                .zip(moved(-sizes[k]))
                .map(|(a, b)| (a - b) / (2.0 * sizes[k]))
                .collect()
        })
        .collect();
    // Unknowns: shared, gains, states, offsets, each column scaled to unit length before it is inverted.
    const UNKNOWNS: usize = SHARED + LIMBS + STATES + LIMBS;
    let known = 6 + LIMBS;
    let mut rows = DMatrix::zeros(LIMBS * force.len() + known, UNKNOWNS);
    let volts: Vec<f64> = SignalChain::new(&recorded.sensor.gains, &case.truth)
        .sensitivity_m_s2_per_v()
        .iter()
        .map(|s| 1.0 / (s * recorded.noise_v))
        .collect();
    let mut output = true_states.output;
    for (sample, now) in true_states.forces(start).take(force.len()).enumerate() {
        for limb in 0..LIMBS {
            let row = LIMBS * sample + limb;
            for (k, slope) in slopes.iter().enumerate() {
                rows[(row, k)] = volts[limb] * slope[sample][limb];
            }
            rows[(row, SHARED + limb)] = volts[limb] * now[limb];
            for state in 0..STATES {
                rows[(row, SHARED + LIMBS + state)] = volts[limb] * output[(limb, state)];
            }
            rows[(row, SHARED + LIMBS + STATES + limb)] = 1.0 / recorded.noise_v;
        }
        output *= true_states.step;
    }
    let first_known = LIMBS * force.len();
    for k in 0..6 {
        rows[(first_known + k, 2 + k)] = 1.0 / deviation;
    }
    for limb in 0..LIMBS {
        rows[(first_known + 6 + limb, SHARED + limb)] = 1.0 / KNOWN_TO;
    }
    let first = rows.column(0).norm();
    for mut column in rows.column_iter_mut() {
        let size = column.norm();
        column.unscale_mut(size);
    }
    let triangle = rows.qr().r();
    let inverse = triangle.try_inverse().expect("every unknown shows");
    inverse.row(0).norm() / first
}
