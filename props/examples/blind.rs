//! dev
use rayon::prelude::*;
use sixaxis_calibration::cleaning::Cleaning;
use sixaxis_calibration::session::{Role, SessionFile};
use sixaxis_calibration::suspicion::{Facts, examine};
use sixaxis_calibration::trial::Trial;
use sixaxis_core::Gains;
use sixaxis_reference::session::defect::Kind;
use sixaxis_reference::session::plan::*;
use sixaxis_reference::session::play::{Played, play};

fn trial(p: &Played, full: f64) -> Trial {
    let d = glam::DVec3::from_array(p.entry.direction.unwrap_or([0.0, 0.0, 1.0])).normalize();
    let down = p
        .entry
        .down
        .map_or(-d, |v| glam::DVec3::from_array(v).normalize());
    Trial {
        name: p.entry.file.display().to_string(),
        role: p.entry.role,
        sample_rate_hz: p.sample_rate_hz,
        gains: p.entry.gain_n_per_v.map_or(Gains::uniform(1.0), |g| Gains {
            gain_n_per_v: g.each(),
        }),
        full_scale_v: full,
        voltage_v: p.voltage_v.clone(),
        accelerometer_m_s2: p.accelerometer_m_s2.clone(),
        gyroscope_rad_s: p.gyroscope_rad_s.clone(),
        direction_ground: d,
        gravity_ground_m_s2: down * 9.80665,
        frequency_hz: p.entry.frequency_hz.unwrap_or(0.0),
    }
}

fn main() {
    let args: Vec<u64> = std::env::args()
        .skip(1)
        .filter_map(|a| a.parse().ok())
        .collect();
    let (first, count) = (args[0], args[1]);
    let verbose = args.len() > 2;
    let rows: Vec<(u64, Option<Kind>, String)> = (first..first + count)
        .into_par_iter()
        .map(|seed| {
            let index = (seed % 15) as usize;
            let kind = (index < 13).then(|| Kind::ALL[index]);
            let plan = SessionPlan {
                seed,
                sensor: SensorChoice::Random,
                engine: Engine::Rigid,
                rig: RigPlan {
                    wedge_error_deg: 0.1,
                    ..RigPlan::default()
                },
                chain: ChainPlan {
                    stiffness_spread: 2e-3,
                    ..ChainPlan::default()
                },
                defect: kind.map_or(DefectChoice::None, DefectChoice::Kind),
                ..SessionPlan::default()
            };
            let played = play(&plan).unwrap();
            let file = SessionFile::parse(
                std::path::Path::new("session.toml"),
                toml::to_string(&played.session).unwrap(),
            )
            .unwrap();
            let cleaning = Cleaning::of(&file.session);
            let full = file.session.sensor.full_scale_v;
            let rest = trial(&played.recordings[0], full);
            let trials: Vec<_> = played.recordings[1..]
                .iter()
                .map(|p| {
                    let t = trial(p, full);
                    let c = cleaning.clean(&t).unwrap();
                    (t, c)
                })
                .collect();
            assert!(trials.iter().all(|t| t.0.role != Role::Static));
            let design = file.design();
            let e = examine(
                &Facts {
                    geometry: file.geometry(),
                    design: &design,
                    rig: file.session.rig.as_ref(),
                    gyroscope_lag_undone: file.session.gyroscope.bandwidth_hz.is_some(),
                },
                Some(&rest),
                &trials,
            );
            let mut text = String::new();
            let first = e.findings.first().map(|f| format!("{:?}", f.cause));
            let want = kind.map(|k| format!("{k:?}"));
            let ok = first == want;
            let worst = e
                .departures
                .iter()
                .flatten()
                .fold(0.0_f64, |a, b| a.max(*b));
            text += &format!(
                "{} {seed} want {want:?} got {first:?} n={} worst departure {worst:.4}\n",
                if ok { "ok " } else { "BAD" },
                e.findings.len()
            );
            if !ok || verbose {
                text += &format!("     {:?}\n", played.truth.defect);
                for f in e.findings.iter().take(6) {
                    text += &format!(
                        "     {:?} {:?} {:?}: {}\n",
                        f.cause,
                        f.recordings.iter().take(4).collect::<Vec<_>>(),
                        f.channels,
                        f.evidence
                    );
                }
            }
            (seed, kind, text)
        })
        .collect();
    let mut bad = 0;
    for (_, _, text) in &rows {
        if text.starts_with("BAD") || verbose {
            print!("{text}");
        }
        bad += usize::from(text.starts_with("BAD"));
    }
    println!("{bad} bad of {count}");
}
