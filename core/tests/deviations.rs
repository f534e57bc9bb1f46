//! Stated standard deviations of decoupled samples against derivatives of the decoupler itself, by differences: each voltage of a record
//! and each parameter moved by itself.

use glam::DVec3;
use sixaxis_core::decouple::uncertainty::{ChannelNoise, Covariance, SampleUncertainty, Spread};
use sixaxis_core::parameter::PARAMETERS;
use sixaxis_core::{
    Decoupler, Gains, Geometry, InertiaPerMass, LIMBS, LimbSet, Parameters, Sensor, Settings,
    SixAxis,
};

/// a, w', w* of a sample.
const NUMBERS: usize = 9;

fn sensor() -> Sensor {
    Sensor {
        geometry: Geometry::PAPER,
        gains: Gains {
            gain_n_per_v: core::array::from_fn(|i| 0.2 + 0.05 * i as f64),
        },
    }
}

/// Moments far apart, so that w x I w counts.
fn parameters() -> Parameters {
    Parameters {
        zero_drift_v: core::array::from_fn(|i| 0.01 * i as f64 - 0.03),
        scale_per_mass_per_kg: core::array::from_fn(|i| 5.0 + 0.1 * i as f64),
        inertia_per_mass: InertiaPerMass::from_paper_order([
            200e-6, 300e-6, 420e-6, 10e-6, -20e-6, 15e-6,
        ]),
        stiffness_per_mass_per_s2: 2e8,
    }
}

/// A sensor that turns from the first sample on, under gravity.
fn settings(sample_rate_hz: f64) -> Settings {
    Settings {
        gravity_ground_m_s2: DVec3::new(3.0, -4.0, -8.4),
        initial_rate_shell_rad_s: DVec3::new(6.0, -4.0, 5.0),
        ..Settings::new(sample_rate_hz)
    }
}

fn voltages(sample_rate_hz: f64, samples: usize) -> Vec<[f64; LIMBS]> {
    let wave = |i: usize, t: f64| {
        let (rate, phase) = (20.0 + 3.0 * i as f64, 0.7 * i as f64);
        0.01 * i as f64 - 0.03 + 1.5 * (rate * t + phase).sin()
    };
    (0..samples + 2)
        .map(|sample| core::array::from_fn(|i| wave(i, sample as f64 / sample_rate_hz)))
        .collect()
}

fn decoupled(
    excluded: LimbSet,
    parameters: &Parameters,
    settings: &Settings,
    rows: &[[f64; LIMBS]],
) -> Vec<SixAxis> {
    let decoupler = Decoupler::new(&sensor(), parameters, settings).expect("a sound sensor");
    let mut decoupler = decoupler.excluding(excluded).expect("six axes are left");
    rows.iter()
        .filter_map(|row| decoupler.push(row).expect("a sound sample"))
        .collect()
}

fn last(answers: &[SixAxis]) -> [f64; NUMBERS] {
    let numbers = answers.last().expect("samples").numbers();
    core::array::from_fn(|i| numbers[i])
}

/// Standard deviations of the last sample of these.
fn stated(
    sample_rate_hz: f64,
    excluded: LimbSet,
    rows: &[[f64; LIMBS]],
    covariance: &Covariance,
    noise: &ChannelNoise,
) -> [f64; NUMBERS] {
    let (parameters, settings) = (parameters(), settings(sample_rate_hz));
    let mut stream = SampleUncertainty::new(
        &sensor(),
        &parameters,
        &settings,
        excluded,
        covariance,
        noise,
    )
    .expect("a sound covariance");
    let answers = decoupled(excluded, &parameters, &settings, rows);
    let spreads = answers.iter().zip(&rows[1..]);
    let spreads = spreads.map(|(sample, row)| stream.push(row, sample).expect("finite"));
    let Spread {
        linear_ground_m_s2: a,
        angular_ground_rad_s2: alpha,
        rate_shell_rad_s: w,
        ..
    } = spreads.last().expect("samples");
    [a.x, a.y, a.z, alpha.x, alpha.y, alpha.z, w.x, w.y, w.z]
}

/// Sizes below which a deviation of a, w' and w* is none here: limbs 1, 5 and 9 have no torque.
const NONE: [f64; 3] = [1e-4, 1e-2, 1e-4];

/// Largest departure of a stated deviation, over the largest of its vector.
fn departs(stated: &[f64; NUMBERS], differences: &[f64; NUMBERS]) -> f64 {
    let departures = (0..NUMBERS).map(|i| {
        let vector = i / 3 * 3..i / 3 * 3 + 3;
        let size = differences[vector]
            .iter()
            .fold(NONE[i / 3], |a, b| a.max(*b));
        (stated[i] - differences[i]).abs() / size
    });
    departures.fold(0.0, f64::max)
}

#[test]
fn ref_noise_acts_as_its_derivatives() {
    const MOVED_V: f64 = 1e-4;
    // What the closed form's own steps in time leave is of their square. In the short record half a step of noise
    // counts, at 10 kHz the limbs' compliance. Correlated noise is taken for white wherever it is integrated, which a short record feels.
    let records = [
        (1000.0, &[][..], 300, [1e-2, 1e-2]),
        (1000.0, &[], 12, [2e-3, 3e-2]),
        (10_000.0, &[], 300, [2e-3, 3e-3]),
        (1000.0, &[5], 300, [1e-2, 1e-2]),
        (10_000.0, &[2, 6, 9], 300, [2e-3, 3e-3]),
    ];
    for (sample_rate_hz, excluded, samples, limits) in records {
        let excluded = LimbSet::from_numbers(excluded.iter().copied()).expect("limbs");
        let white_v: [f64; LIMBS] = core::array::from_fn(|i| 1e-3 * (1.0 + i as f64));
        let (parameters, settings) = (parameters(), settings(sample_rate_hz));
        let mut rows = voltages(sample_rate_hz, samples);
        let mut variance = [[0.0; NUMBERS]; 2];
        for limb in 0..LIMBS {
            let mut before = [0.0; NUMBERS];
            for sample in 0..rows.len() {
                let [up, down] = [MOVED_V, -MOVED_V].map(|by| {
                    rows[sample][limb] += by;
                    let answers = last(&decoupled(excluded, &parameters, &settings, &rows));
                    rows[sample][limb] -= by;
                    answers
                });
                for i in 0..NUMBERS {
                    let slope = (up[i] - down[i]) / (2.0 * MOVED_V) * white_v[limb];
                    variance[0][i] += slope * slope;
                    // The mean of this sample's noise and the one before, without gain at frequency zero.
                    let mean = 0.5 * (slope + before[i]);
                    variance[1][i] += mean * mean;
                    before[i] = slope;
                }
            }
            for (sum, last) in variance[1].iter_mut().zip(before) {
                *sum += 0.25 * last * last;
            }
        }
        let noises = [[1.0, 0.0, 0.0], [0.5, 0.25, 0.0]].map(|correlation| ChannelNoise {
            white_v,
            correlation,
        });
        for ((noise, variance), limit) in noises.iter().zip(variance).zip(limits) {
            let mut rows = rows.clone();
            // What cannot be read is not.
            for row in &mut rows {
                excluded.indices().for_each(|limb| row[limb] = f64::NAN);
            }
            let ours = stated(sample_rate_hz, excluded, &rows, &Covariance::zeros(), noise);
            let departs = departs(&ours, &variance.map(f64::sqrt));
            let correlation = noise.correlation;
            assert!(
                departs < limit,
                "{sample_rate_hz} Hz, {correlation:?}, without {excluded}: {departs:e}"
            );
        }
    }
}

#[test]
fn ref_each_parameter_acts_as_its_derivative() {
    const SAMPLE_RATE_HZ: f64 = 1000.0;
    let (settings, rows) = (settings(SAMPLE_RATE_HZ), voltages(SAMPLE_RATE_HZ, 300));
    let truth = parameters().to_paper_order();
    let quiet = ChannelNoise::white([0.0; LIMBS]);
    let sets = [&[][..], &[5], &[2, 6, 9]]
        .map(|numbers| LimbSet::from_numbers(numbers.iter().copied()).expect("limbs"));
    let all = (0..PARAMETERS - 1).flat_map(|parameter| sets.map(|excluded| (parameter, excluded)));
    for (parameter, excluded) in all {
        let size = match parameter {
            0..9 => 1e-3,
            9..18 => 1e-3 * truth[parameter],
            _ => 1e-7,
        };
        let moved = |by: f64| {
            let mut values = truth;
            values[parameter] += by * size;
            let parameters = Parameters {
                zero_drift_v: core::array::from_fn(|i| values[i]),
                scale_per_mass_per_kg: core::array::from_fn(|i| values[9 + i]),
                inertia_per_mass: InertiaPerMass::from_paper_order(core::array::from_fn(|i| {
                    values[18 + i]
                })),
                stiffness_per_mass_per_s2: values[PARAMETERS - 1],
            };
            last(&decoupled(excluded, &parameters, &settings, &rows))
        };
        let (up, down) = (moved(0.01), moved(-0.01));
        let differences = core::array::from_fn(|i| ((up[i] - down[i]) / 0.02).abs());
        let mut covariance = Covariance::zeros();
        covariance[(parameter, parameter)] = size * size;
        let ours = stated(SAMPLE_RATE_HZ, excluded, &rows, &covariance, &quiet);
        let departs = departs(&ours, &differences);
        assert!(
            departs < 4e-3,
            "parameter {parameter} without {excluded}: {departs:e}"
        );
    }
}
