//! Every set of up to three failed limbs: what it costs. `cargo run --release -p sixaxis-props --example failed_limbs`.
//!
//! For each of the 129: whether six axes are left, or the lost load; by how much the noise of each acceleration grows, in closed
//! form and measured; what it adds to a noise-free answer; and the error with laboratory errors over that with all limbs, as it
//! comes and with scale factors that obey the coordination equations on the run itself. `--publish` writes what the report shows.

use std::array::from_fn;
use std::process::ExitCode;

use glam::DVec3;
use nalgebra::{DMatrix, DVector, SMatrix};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use sixaxis_calibration::conditioning::Conditioning;
use sixaxis_core::LimbSet;
use sixaxis_core::geometry::{DIRECTIONS_SHELL, LIMBS_PER_NODE, NODE_DIRECTIONS_MASS};
use sixaxis_core::paper::signal::SignalChain;
use sixaxis_core::redundancy::parity::{COORDINATION, SIGNATURES};
use sixaxis_core::redundancy::reconstruction::MOST_EXCLUDED;
use sixaxis_core::redundancy::reconstruction::Reconstruction;
use sixaxis_core::{
    Decoupler, Error, Gains, LIMBS, Parameters, Scheme, Sensor, Settings, StaticResponse,
};
use sixaxis_props::joint::{Fitted, small};
use sixaxis_props::manufactured::examples;
use sixaxis_props::problem::rig;
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::{ExcludedSet, FailedLimbs};
use sixaxis_props::truth;
use sixaxis_props::truth::InCore;
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::Laboratory;
use sixaxis_reference::laboratory::plan::SensorChoice;
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::rig::run::{Mounting, Run};

/// Sample rate of the noise measurement, Hz: low, so that second differences of the noise do not drown the forces' own.
const NOISE_RATE_HZ: f64 = 100.0;
const NOISE_SAMPLES: usize = 20_000;
const NOISE_SEED: u64 = 7;
/// The laboratory's run in its count of runs.
const RUN: usize = 1002;

type Six = Vec<[f64; 6]>;

fn main() -> ExitCode {
    run(Seeds::alone(1_000, 10), study)
}

fn study(first_seed: u64, seeds: u64) -> Result<FailedLimbs, String> {
    let sets: Vec<LimbSet> = (1..=MOST_EXCLUDED).flat_map(LimbSet::of_size).collect();
    let free = noise_free(&sets)?;
    let noise = noise(&sets)?;
    let played = played()?;
    let laboratory: Vec<Vec<Option<[[f64; 2]; 2]>>> = (first_seed..first_seed + seeds)
        .map(|seed| in_laboratory(seed, &sets, &played))
        .collect::<Result<_, _>>()?;
    let healthy_largest_error = laboratory
        .iter()
        .filter_map(|all| Some(all.last()?.as_ref()?[0][0]))
        .collect();
    let published: Vec<ExcludedSet> = sets
        .iter()
        .enumerate()
        .map(|(i, set)| {
            let ratio = |way: usize, measure: usize| {
                let ratios = laboratory.iter().filter_map(|all| {
                    let healthy = all.last()?.as_ref()?;
                    Some(all[i]?[way][measure] / healthy[way][measure])
                });
                median(ratios.collect())
            };
            ExcludedSet {
                failed: set.numbers().collect(),
                lost: match Reconstruction::new(*set) {
                    Err(Error::LostLoad { load, .. }) => Some(load.to_string()),
                    _ => None,
                },
                amplification: closed_form(*set),
                amplification_measured: noise[i],
                noise_free_excess: free[i],
                error_ratio: ratio(0, 0),
                error_ratio_consistent: ratio(1, 0),
                rms_ratio: ratio(0, 1),
                rms_ratio_consistent: ratio(1, 1),
            }
        })
        .collect();
    let count = |of: fn(&ExcludedSet) -> Option<f64>| {
        published
            .iter()
            .filter(|s| of(s).is_some_and(|r| r <= 2.0))
            .count()
    };
    let result = FailedLimbs {
        first_seed,
        seeds,
        noise_samples: NOISE_SAMPLES,
        survivable: published.iter().filter(|s| s.lost.is_none()).count(),
        within_twice: count(|s| s.error_ratio),
        within_twice_consistent: count(|s| s.error_ratio_consistent),
        within_twice_rms: count(|s| s.rms_ratio),
        within_twice_rms_consistent: count(|s| s.rms_ratio_consistent),
        largest_noise_free_excess: free.iter().flatten().fold(0.0, |m, x| m.max(*x)),
        healthy_largest_error,
        sets: published,
    };
    for s in &result.sets {
        println!(
            "{:?}: {:.3?} measured {:.3?}, noise-free {:.1e}, error {:.2?}, {:.2?} consistent, rms {:.2?}, {:.2?} {}",
            s.failed,
            s.amplification.unwrap_or([f64::NAN; 6]),
            s.amplification_measured.unwrap_or([f64::NAN; 6]),
            s.noise_free_excess.unwrap_or(f64::NAN),
            s.error_ratio,
            s.error_ratio_consistent,
            s.rms_ratio,
            s.rms_ratio_consistent,
            s.lost.as_deref().unwrap_or("")
        );
    }
    println!(
        "{} survivable; at most twice the healthy error: largest {} ({} consistent), rms {} ({}); noise-free {:.1e}; healthy {:.4?}",
        result.survivable,
        result.within_twice,
        result.within_twice_consistent,
        result.within_twice_rms,
        result.within_twice_rms_consistent,
        result.largest_noise_free_excess,
        result.healthy_largest_error
    );
    Ok(result)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// sqrt of the diagonal of (J_S^T J_S)^-1 under (force, torque), turned to accelerations, over the same with all limbs.
fn closed_form(set: LimbSet) -> Option<[f64; 6]> {
    Reconstruction::new(set).ok()?;
    let j = SMatrix::<f64, LIMBS, 6>::from_fn(|limb, axis| {
        let e = DIRECTIONS_SHELL[limb];
        let m = NODE_DIRECTIONS_MASS[limb / LIMBS_PER_NODE].cross(e);
        [e.x, e.y, e.z, m.x, m.y, m.z][axis]
    });
    let all = j.transpose() * j;
    let inertia = truth::identified_parameters()
        .inertia_per_mass
        .matrix_mass_m2()
        .inverse();
    let turn = SMatrix::<f64, 6, 6>::from_fn(|i, k| match (i < 3, k < 3) {
        (true, true) => f64::from(u8::from(i == k)),
        (false, false) => inertia.col(k - 3)[i - 3],
        _ => 0.0,
    });
    // Wrench = J^T J times the pose that the others see.
    let covariance = |kept: &dyn Fn(usize) -> bool| {
        let seen =
            SMatrix::<f64, LIMBS, 6>::from_fn(
                |limb, axis| {
                    if kept(limb) { j[(limb, axis)] } else { 0.0 }
                },
            );
        let pose = (seen.transpose() * seen).try_inverse()?;
        let wrench = turn * all;
        Some(wrench * pose * wrench.transpose())
    };
    let reduced = covariance(&|limb| !set.contains(limb))?;
    let healthy = covariance(&|_| true)?;
    Some(from_fn(|i| (reduced[(i, i)] / healthy[(i, i)]).sqrt()))
}

fn decouple(
    sensor: &Sensor,
    parameters: &Parameters,
    settings: &Settings,
    failed: LimbSet,
    rows: &[[f64; LIMBS]],
) -> Result<Six, String> {
    let mut answers = Vec::with_capacity(rows.len());
    Decoupler::new(sensor, parameters, settings)
        .and_then(|decoupler| decoupler.excluding(failed))
        .and_then(|mut decoupler| decoupler.push_all(rows, |s| answers.push(s.accelerations())))
        .map_err(|e| e.to_string())?;
    Ok(answers)
}

/// For each survivable set.
fn each<T: Send>(
    sets: &[LimbSet],
    of: impl Fn(LimbSet) -> Result<T, String> + Sync,
) -> Result<Vec<Option<T>>, String> {
    sets.par_iter()
        .map(|set| Reconstruction::new(*set).ok().map(|_| of(*set)).transpose())
        .collect()
}

/// Equal white noise of the forces on a sensor at rest.
fn noise(sets: &[LimbSet]) -> Result<Vec<Option<[f64; 6]>>, String> {
    let parameters = truth::identified_parameters();
    let sensor = Sensor {
        geometry: sixaxis_core::Geometry::PAPER,
        gains: Gains::uniform(1.0),
    };
    let settings = Settings::new(NOISE_RATE_HZ);
    let chain = SignalChain::new(&sensor.gains, &parameters);
    let mut rng = Pcg64::new(u128::from(NOISE_SEED), 1);
    let rows: Vec<[f64; LIMBS]> = (0..NOISE_SAMPLES)
        .map(|_| {
            // Small, so that the attitude does not walk off.
            chain.voltage_v(&from_fn(|_| {
                let z: f64 = StandardNormal.sample(&mut rng);
                1e-6 * z
            }))
        })
        .collect();
    let deviations = |failed| -> Result<[f64; 6], String> {
        let answers = decouple(&sensor, &parameters, &settings, failed, &rows)?;
        Ok(from_fn(|axis| {
            let squares: f64 = answers.iter().map(|a| a[axis] * a[axis]).sum();
            (squares / answers.len() as f64).sqrt()
        }))
    };
    let healthy = deviations(LimbSet::EMPTY)?;
    each(sets, |set| {
        let reduced = deviations(set)?;
        Ok(from_fn(|axis| reduced[axis] / healthy[axis]))
    })
}

/// What a set adds to the error on a manufactured motion about all six axes, over full scale.
fn noise_free(sets: &[LimbSet]) -> Result<Vec<Option<f64>>, String> {
    let motion = examples::turning_from_rest();
    let sensor = Sensor {
        geometry: motion.geometry,
        gains: Gains::uniform(2.0),
    };
    let rate_hz = 4000.0;
    let settings = Settings {
        static_response: StaticResponse::Full,
        gravity_ground_m_s2: motion.gravity_ground_m_s2,
        ..Settings::new(rate_hz)
    };
    let rows: Vec<_> = (0..1200_u32)
        .map(|i| {
            motion.voltage_v(
                &sensor.gains.gain_n_per_v,
                &motion.at(f64::from(i) / rate_hz),
            )
        })
        .collect();
    let healthy = decouple(
        &sensor,
        &motion.parameters,
        &settings,
        LimbSet::EMPTY,
        &rows,
    )?;
    each(sets, |set| {
        let ours = decouple(&sensor, &motion.parameters, &settings, set, &rows)?;
        Ok(errors(&ours, &healthy)[0])
    })
}

/// Largest error and largest root mean square of the six, over the peaks of the vectors.
fn errors(ours: &Six, truth: &Six) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    for first in [0, 3] {
        let vector = |row: &[f64; 6]| DVec3::from_slice(&row[first..first + 3]);
        let peak = truth.iter().map(|r| vector(r).length()).fold(0.0, f64::max);
        for axis in first..first + 3 {
            let off = || {
                ours.iter()
                    .zip(truth)
                    .map(|(a, b)| (a[axis] - b[axis]) / peak)
            };
            worst[0] = off().fold(worst[0], |m, x| m.max(x.abs()));
            let mean = off().map(|x| x * x).sum::<f64>() / ours.len() as f64;
            worst[1] = worst[1].max(mean.sqrt());
        }
    }
    worst
}

/// The fastest compound run of Tables 4 to 6, in MuJoCo.
fn played() -> Result<SimulatedRun, String> {
    let truth = truth::identified_parameters();
    let long = Run {
        steady_periods: 2.0,
        ..rig::compound_run()
    };
    let model = rig::model(&truth, long.direction_ground, Mounting::AxisVertical);
    sixaxis_reference::mujoco::simulate_run(&model, &long, rig::RATE_HZ / 5.0, 20)
        .map_err(|e| e.to_string())
}

/// Errors with a campaign's own parameters on its 5 Hz compound run: as they come, and with consistent scale factors. Last the
/// healthy decoder.
fn in_laboratory(
    seed: u64,
    sets: &[LimbSet],
    run: &SimulatedRun,
) -> Result<Vec<Option<[[f64; 2]; 2]>>, String> {
    let truth = truth::identified_parameters();
    let mut plan = small(seed);
    plan.sensor = SensorChoice::Paper;
    let mut found = Fitted::of(&plan)?.steps.found();
    // Step 4 is a story of its own, and the reference's own design would do.
    found.stiffness_per_mass_per_s2 = truth.stiffness_per_mass_per_s2;
    let recording = Laboratory::with_errors(truth::sensor(&truth), seed).record(run, RUN);
    let conditioning = Conditioning {
        level_samples: None,
        stages: sixaxis_recordings::session::Preprocessing::default(),
        accelerometer_bandwidth_hz: None,
        gyroscope_bandwidth_hz: None,
    };
    let rows = conditioning
        .condition(&recording.trial(Role::Validation))
        .map_err(|e| e.to_string())?
        .voltage_v;
    let samples = run.truth.len();
    let true_six: Six = run.truth[1..samples - 1]
        .iter()
        .map(|t| {
            let (a, w) = (t.linear_ground_m_s2, t.angular_ground_rad_s2);
            [a.x, a.y, a.z, w.x, w.y, w.z]
        })
        .collect();
    let consistent = consistent(&found, &recording.gains(), &rows);
    let settings = recording.settings(Scheme::Heun);
    let both = |set| -> Result<[[f64; 2]; 2], String> {
        let mut ways = [[0.0; 2]; 2];
        for (way, parameters) in ways.iter_mut().zip([&found, &consistent]) {
            let ours = decouple(&recording.sensor(), parameters, &settings, set, &rows)?;
            *way = errors(&ours, &true_six);
        }
        Ok(ways)
    };
    let mut all = each(sets, both)?;
    all.push(Some(both(LimbSet::EMPTY)?));
    Ok(all)
}

/// The scale factors moved as little as possible so that the run's forces obey the coordination equations best.
fn consistent(parameters: &Parameters, gains: &Gains, rows: &[[f64; LIMBS]]) -> Parameters {
    let chain = SignalChain::new(gains, parameters);
    let mut normal = DMatrix::<f64>::zeros(LIMBS, LIMBS);
    let mut right = DVector::<f64>::zeros(LIMBS);
    for row in rows {
        let force = chain.force_per_mass_m_s2(row);
        for (k, limbs) in COORDINATION.iter().enumerate() {
            let left: f64 = limbs.iter().map(|&i| force[i]).sum();
            let a: [f64; LIMBS] = from_fn(|i| force[i] * f64::from(SIGNATURES[i][k]));
            for i in 0..LIMBS {
                right[i] -= a[i] * left;
                for j in 0..LIMBS {
                    normal[(i, j)] += a[i] * a[j];
                }
            }
        }
    }
    // A common factor, and what the run does not excite, stay as they are.
    let svd = normal.svd(true, true);
    let cut = 1e-4 * svd.singular_values[0];
    let change = svd
        .solve(&right, cut)
        .unwrap_or_else(|_| DVector::zeros(LIMBS));
    let mut moved = *parameters;
    for (s, c) in moved.scale_per_mass_per_kg.iter_mut().zip(change.iter()) {
        *s *= 1.0 + c;
    }
    moved
}
