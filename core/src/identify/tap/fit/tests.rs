//! The step of the decay's fit against what it must be: slopes and covariance by differences of the decay itself, and an error that
//! a step leaves of second order.

use nalgebra::SMatrix;

use super::*;
use crate::identify::tap::model::MODES;

const SAMPLES: usize = 400;
const STEP_S: f64 = 2e-5;
const PARAMETERS: usize = SHARED + INITIAL + 2 * LIMBS;
/// Initial forces, m/s^2, and their slopes over 10^4/s.
const INITIALS: [f64; MODES] = [3.0, -2.0, 5.0, 4.0, -6.0, 2.5];
const SLOPES: [f64; MODES] = [1.0, 2.0, -1.5, 3.0, 0.5, -2.0];
/// Size of each shared unknown.
const SIZES: [f64; SHARED] = [1.0, 1e-2, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6];

fn truth() -> Unknowns {
    Unknowns {
        stiffness_per_mass_per_s2: 2e8,
        damping_ratio: 0.01,
        inertia_m2: [230e-6, 251e-6, 275e-6, 4e-6, -3e-6, 2e-6],
        gain_ln: [0.0; LIMBS],
    }
}

fn prior() -> Prior {
    let mut whitening = Matrix6::identity() * 3e5;
    for row in 1..6 {
        whitening[(row, row - 1)] = 1e5 * row as f64;
    }
    Prior {
        geometry: Geometry::PAPER,
        inertia_m2: truth().inertia_m2,
        whitening,
        gain_deviation: core::array::from_fn(|limb| 3e-3 * (1.0 + limb as f64)),
    }
}

fn ring(unknowns: &Unknowns) -> RingDown {
    let inertia = InertiaPerMass::from_paper_order(unknowns.inertia_m2);
    let (k, z) = (unknowns.stiffness_per_mass_per_s2, unknowns.damping_ratio);
    RingDown::new(&Geometry::PAPER, &inertia, k, z).expect("six modes")
}

fn initial() -> [f64; INITIAL] {
    core::array::from_fn(|j| match j.checked_sub(MODES) {
        None => INITIALS[j],
        Some(j) => 1e4 * SLOPES[j],
    })
}

/// Voltages of a decay, whose sizes and noise differ from channel to channel.
fn voltages() -> Vec<[f64; LIMBS]> {
    let (ring, window) = (ring(&truth()), window(&[]));
    (0..SAMPLES)
        .map(|sample| {
            let force = ring.force_per_mass_m_s2(sample as f64 * STEP_S, &initial());
            core::array::from_fn(|i| 0.01 * i as f64 + window.volts_per_m_s2[i] * force[i])
        })
        .collect()
}

fn window(voltage_v: &[[f64; LIMBS]]) -> Window<'_> {
    Window {
        voltage_v,
        step_s: STEP_S,
        volts_per_m_s2: core::array::from_fn(|limb| 0.01 + 0.002 * limb as f64),
        noise_v: core::array::from_fn(|limb| 1e-3 + 2e-4 * limb as f64),
    }
}

/// The truth with each unknown off by a share of its size.
fn off(by: f64) -> Unknowns {
    let truth = truth();
    let signs = [1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
    Unknowns {
        stiffness_per_mass_per_s2: truth.stiffness_per_mass_per_s2 * exp(by),
        damping_ratio: truth.damping_ratio + 0.1 * by,
        inertia_m2: core::array::from_fn(|k| truth.inertia_m2[k] + 1e-4 * by * signs[k]),
        gain_ln: signs.map(|sign| by * sign),
    }
}

/// Error of each unknown over the share by which [`off`] moves it, without sign.
fn errors(found: &Unknowns) -> Vec<f64> {
    let truth = truth();
    let stiffness = (found.stiffness_per_mass_per_s2 / truth.stiffness_per_mass_per_s2).ln();
    let inertia = (0..6).map(|k| 1e4 * (found.inertia_m2[k] - truth.inertia_m2[k]));
    let damping = 10.0 * (found.damping_ratio - truth.damping_ratio);
    let all = inertia.chain(found.gain_ln).chain([stiffness, damping]);
    all.map(f64::abs).collect()
}

#[test]
fn order_a_step_leaves_the_square_of_the_error() {
    let (voltage_v, prior) = (voltages(), prior());
    let window = window(&voltage_v);
    let left = |by: f64| {
        let start = window.solve(&prior, &off(by)).expect("a decay");
        let step = window.step(&prior, &start).expect("a step");
        let left = errors(&start.unknowns.moved(&step, 1.0));
        left.into_iter().fold(0.0, f64::max)
    };
    let (whole, half) = (left(2e-4), left(1e-4));
    assert!((whole / half - 4.0).abs() < 0.4, "{whole:e} {half:e}");
    assert!(whole < 0.2 * 2e-4, "{whole:e}");
    // Half a step takes off half of the error.
    let start = window.solve(&prior, &off(1e-5)).expect("a decay");
    let step = window.step(&prior, &start).expect("a step");
    for half_way in errors(&start.unknowns.moved(&step, 0.5)) {
        assert!((half_way / 1e-5 - 0.5).abs() < 0.01, "{half_way:e}");
    }
}

/// Predicted voltages over noise, then priors, at shared unknowns, initial values, gains and offsets about the truth. The forces at the
/// first sample and their slopes are held, not the modes' own values, whose basis is only known up to signs.
fn residuals(at: &SMatrix<f64, PARAMETERS, 1>) -> Vec<f64> {
    let (truth, prior, window) = (truth(), prior(), window(&[]));
    let shapes = |ring: &RingDown| {
        SMatrix::<f64, LIMBS, MODES>::from_fn(|limb, mode| ring.shape(limb)[mode])
    };
    let before = shapes(&ring(&truth));
    let moved = Unknowns {
        stiffness_per_mass_per_s2: truth.stiffness_per_mass_per_s2 * exp(at[0]),
        damping_ratio: truth.damping_ratio + at[1],
        inertia_m2: core::array::from_fn(|k| truth.inertia_m2[k] + at[2 + k]),
        ..truth
    };
    let ring = ring(&moved);
    let after = shapes(&ring);
    let inverse = (after.transpose() * after)
        .try_inverse()
        .expect("six modes");
    let turn = inverse * after.transpose() * before;
    let start = initial();
    let modes = |first: usize| {
        let values =
            SMatrix::<f64, MODES, 1>::from_fn(|j, _| start[first + j] + at[SHARED + first + j]);
        turn * values
    };
    let (a, b) = (modes(0), modes(MODES));
    let initial: [f64; INITIAL] = core::array::from_fn(|j| match j.checked_sub(MODES) {
        None => a[j],
        Some(j) => b[j],
    });
    let mut rows = Vec::new();
    for sample in 0..SAMPLES {
        let force = ring.force_per_mass_m_s2(sample as f64 * STEP_S, &initial);
        for limb in 0..LIMBS {
            let (gain, offset) = (at[SHARED + INITIAL + limb], at[PARAMETERS - LIMBS + limb]);
            let shown = offset + exp(gain) * window.volts_per_m_s2[limb] * force[limb];
            rows.push(shown / window.noise_v[limb]);
        }
    }
    let departure = prior.whitening * at.fixed_rows::<6>(2);
    rows.extend(departure.iter());
    rows.extend((0..LIMBS).map(|i| at[SHARED + INITIAL + i] / prior.gain_deviation[i]));
    rows
}

#[test]
fn ref_the_covariance_is_that_of_differences() {
    let sizes = SMatrix::<f64, PARAMETERS, 1>::from_fn(|i, _| match i {
        0..SHARED => SIZES[i],
        _ if i < SHARED + MODES => 1.0,
        _ if i < SHARED + INITIAL => 1e4,
        _ => 1e-2,
    });
    let slopes: Vec<Vec<f64>> = (0..PARAMETERS)
        .map(|i| {
            let mut at = SMatrix::<f64, PARAMETERS, 1>::zeros();
            at[i] = 1e-5 * sizes[i];
            let pairs = residuals(&at).into_iter().zip(residuals(&-at));
            pairs.map(|(up, down)| (up - down) / 2e-5).collect()
        })
        .collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let information =
        SMatrix::<f64, PARAMETERS, PARAMETERS>::from_fn(|i, j| dot(&slopes[i], &slopes[j]));
    let known = SMatrix::<f64, PARAMETERS, PARAMETERS>::from_fn(|i, j| {
        let priors = SAMPLES * LIMBS;
        dot(&slopes[i][priors..], &slopes[j][priors..])
    });
    let covariance = information.try_inverse().expect("all is seen");
    let from_known = (covariance * known * covariance)[(0, 0)];

    let (voltage_v, prior) = (voltages(), prior());
    let window = window(&voltage_v);
    let (_, shared) = window.fit(&prior, &off(1e-4)).expect("a fit");
    // A covariance is stated in units of the residuals' own variance, of which there is nothing here but rounding.
    let scaled = |i: usize, j: usize| shared.covariance[(i, j)] / (sizes[i] * sizes[j]);
    let variance = scaled(0, 0) / covariance[(0, 0)];
    let mut largest = 0.0_f64;
    for i in 0..SHARED {
        for j in 0..SHARED {
            let scale = sqrt(covariance[(i, i)] * covariance[(j, j)]);
            let departs = scaled(i, j) / variance - covariance[(i, j)];
            largest = largest.max((departs / scale).abs());
        }
    }
    assert!(largest < 1e-5, "{largest:e}");
    let departs = shared.from_known_ln2 / (variance * variance) / from_known - 1.0;
    assert!(departs.abs() < 1e-5, "{departs:e}");
}

#[test]
fn inv_a_step_is_negligible_by_either_measure() {
    let (voltage_v, prior) = (voltages(), prior());
    let window = window(&voltage_v);
    let start = window.solve(&prior, &off(1e-4)).expect("a decay");
    let decay = Decay {
        window: &window,
        prior: &prior,
    };
    let of = |ln_stiffness: f64, damping_errors: f64| {
        let mut step = window.step(&prior, &start).expect("a step");
        let covariance = step.shared_covariance.covariance;
        step.shared = [0.0; SHARED];
        step.shared[0] = ln_stiffness * sqrt(covariance[(0, 0)]);
        step.shared[1] = damping_errors * sqrt(covariance[(1, 1)]);
        decay.is_negligible(&step)
    };
    assert!(of(0.1 * SETTLED, 0.1 * SETTLED));
    assert!(!of(10.0 * SETTLED, 0.0));
    // A k/m that no longer moves, whatever else does; and all else settled, whatever rounding is.
    assert!(of(0.0, 10.0 * SETTLED));
    assert!(!of(0.1 * SETTLED, 10.0 * SETTLED));
}
