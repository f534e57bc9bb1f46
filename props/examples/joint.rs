//! The joint estimator on campaigns of seeded calibrations.
use rayon::prelude::*;
use sixaxis_calibration::cleaning::Cleaning;
use sixaxis_calibration::joint::{Knowledge, Loss, fit, names};
use sixaxis_calibration::session::Role;
use sixaxis_calibration::steps::{Campaign, GyroscopeGain};
use sixaxis_calibration::trial::Trial;
use sixaxis_core::{Gains, Geometry, InertiaPerMass, Parameters};
use sixaxis_reference::session::plan::{Engine, SensorChoice, SessionPlan};
use sixaxis_reference::session::play::{PlayedSession, play};

fn trials(played: &PlayedSession) -> (Vec<[f64; 9]>, Vec<Trial>) {
    let mut rest = Vec::new();
    let mut out = Vec::new();
    for r in &played.recordings {
        if r.entry.role == Role::Static {
            rest = r.voltage_v.clone();
            continue;
        }
        let d = glam::DVec3::from_array(r.entry.direction.unwrap()).normalize();
        let down = r
            .entry
            .down
            .map_or(-d, |d| glam::DVec3::from_array(d).normalize());
        out.push(Trial {
            name: r.entry.file.display().to_string(),
            role: r.entry.role,
            sample_rate_hz: r.sample_rate_hz,
            gains: Gains {
                gain_n_per_v: r.entry.gain_n_per_v.unwrap().each(),
            },
            full_scale_v: 10.0,
            voltage_v: r.voltage_v.clone(),
            accelerometer_m_s2: r.accelerometer_m_s2.clone(),
            gyroscope_rad_s: r.gyroscope_rad_s.clone(),
            direction_ground: d,
            gravity_ground_m_s2: down * 9.80665,
            frequency_hz: r.entry.frequency_hz.unwrap(),
        });
    }
    (rest, out)
}
fn truth25(p: &Parameters) -> [f64; 25] {
    core::array::from_fn(|i| {
        if i < 9 {
            p.zero_drift_v[i]
        } else if i < 18 {
            p.scale_per_mass_per_kg[i - 9]
        } else if i < 24 {
            p.inertia_per_mass.to_paper_order()[i - 18]
        } else {
            1.0 / p.stiffness_per_mass_per_s2
        }
    })
}
fn main() {
    let arg = |i: usize, d: f64| std::env::args().nth(i).map_or(d, |a| a.parse().unwrap());
    let seeds = arg(1, 1.0) as u64;
    let snr = arg(2, 60.0);
    let wedge = arg(3, 0.0);
    let hp = arg(4, 0.0);
    let rate = arg(5, 2000.0);
    let rows: Vec<_> = (1..=seeds)
        .into_par_iter()
        .map(|seed| {
            let mut plan = SessionPlan {
                seed,
                sensor: SensorChoice::Random,
                engine: Engine::Rigid,
                ..SessionPlan::default()
            };
            plan.chain.signal_to_noise_db = snr;
            if snr.is_infinite() {
                plan.chain.resolution_bits = 0;
                plan.instruments.signal_to_noise_db = snr;
            }
            plan.rig.wedge_error_deg = wedge;
            plan.sample_rate_hz = rate;
            if arg(6, 0.0) > 0.0 {
                plan.rig.mounting = sixaxis_reference::rig::Mounting::AxisLevel;
            }
            plan.chain.amplifier_high_pass_hz = hp;
            let t0 = std::time::Instant::now();
            let played = play(&plan).unwrap();
            let t1 = t0.elapsed();
            let (rest, trials) = trials(&played);
            let cleaning = Cleaning::of(&played.session);
            let design = sixaxis_reference::paper::design_parameters();
            let campaign = Campaign {
                geometry: Geometry::PAPER,
                design: Parameters {
                    inertia_per_mass: InertiaPerMass::from_paper_order(
                        design.inertia_per_mass.to_paper_order(),
                    ),
                    ..design
                },
                static_voltage_v: rest,
                trials: trials
                    .into_iter()
                    .map(|t| {
                        let c = cleaning.clean(&t).unwrap();
                        (t, c)
                    })
                    .collect(),
            };
            let t2 = t0.elapsed();
            let steps = campaign
                .identify(GyroscopeGain::Certified { class: 0.01 })
                .unwrap();
            let t3 = t0.elapsed();
            let knowledge = Knowledge::of(&played.session);
            let report = fit(&campaign, &steps, &knowledge, Loss::Squares).unwrap();
            let t4 = t0.elapsed();
            if seed == 1 {
                eprintln!(
                    "play {t1:?} clean {:?} steps {:?} joint {:?} its {} misfit {} dof {}",
                    t2 - t1,
                    t3 - t2,
                    t4 - t3,
                    report.estimate.iterations,
                    report.estimate.misfit(),
                    report.estimate.degrees_of_freedom
                );
                eprintln!("gains true {:?}", played.truth.instruments);
                let u = &report.estimate.unknowns.values;
                let c = &report.estimate.covariance;
                for i in 25..u.len() {
                    eprintln!("u{i} {:.6e} +- {:.2e}", u[i], c[(i, i)].sqrt());
                }
            }
            let truth = truth25(&played.truth.parameters);
            let four = truth25(&steps.found());
            (truth, report, four, played.truth.instruments)
        })
        .collect();
    let names = names();
    let n = rows.len() as f64;
    for p in 0..25 {
        let z: Vec<f64> = rows
            .iter()
            .map(|(t, r, _, i)| {
                let e = &r.estimate;
                (e.values(i.accelerometer_gain_error)[p] - t[p]) / e.deviations()[p]
            })
            .collect();
        let mean = z.iter().sum::<f64>() / n;
        let var = z.iter().map(|z| z * z).sum::<f64>() / n;
        let cover = rows
            .iter()
            .filter(|(t, r, _, _)| {
                let (a, b) = r.intervals_95[p];
                a <= t[p] && t[p] <= b
            })
            .count() as f64
            / n;
        let (t, r, f, _) = &rows[0];
        println!(
            "{:6} true {:.6e} joint {:.6e} rel.noise {:.1e} sd {:.1e} four-rel {:.1e} | mean z {:+.3} msq z {:.3} cover {:.3}",
            names[p],
            t[p],
            r.values[p],
            r.estimate.deviations()[p] / t[p].abs(),
            r.deviations[p] / t[p].abs(),
            (f[p] - t[p]) / t[p].abs(),
            mean,
            var,
            cover
        );
    }
    let m = rows.iter().map(|r| r.1.estimate.misfit()).sum::<f64>() / n;
    println!("misfit mean {m}");
}
