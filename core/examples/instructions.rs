//! One way through the decoupling mathematics, repeated as often as asked: what `.ci/instructions` counts under callgrind.
//!
//! `instructions NAME REPEATS` works on [`SAMPLES`] samples REPEATS times; `instructions` alone lists the names.
//! The difference between two runs is free of start-up, so that it is instructions per sample.

use std::array::from_fn;
use std::hint::black_box;

use glam::DVec3;
use sixaxis_core::aided::{AidedDecoupler, ErrorFilter};
use sixaxis_core::decouple::lanes::{push_lanes, push_lanes_portable};
use sixaxis_core::decouple::uncertainty::{ChannelNoise, Covariance};
use sixaxis_core::identify::inertia::InertiaIdentification;
use sixaxis_core::identify::scale::ScaleIdentification;
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::limb_set::NotALimb;
use sixaxis_core::paper::pose::Pose;
use sixaxis_core::redundancy::fault::Watch;
use sixaxis_core::redundancy::tolerant::{FaultTolerant, ROWS_KEPT};
use sixaxis_core::{
    Decoupler, Gains, Geometry, InertiaPerMass, LIMBS, LimbSet, Parameters, Scheme, Sensor,
    Settings,
};

/// Samples of one repetition: blocks of a record and chunks of lanes come out even after the first three.
const SAMPLES: usize = 2048 + 3;
const RATE_HZ: f64 = 1e4;

/// From one sample to the next by more than the block's polynomials hold for.
const RUN_AWAY_RAD_S: DVec3 = DVec3::new(1800.0, 600.0, -900.0);

const SCHEMES: [(&str, Scheme); 6] = [
    ("euler", Scheme::Euler),
    ("heun", Scheme::Heun),
    ("heun_substepped", Scheme::HeunSubstepped),
    ("ab2", Scheme::AdamsBashforth2),
    ("am4", Scheme::AdamsMoulton4),
    ("rk4", Scheme::RungeKutta4),
];

const SENSOR: Sensor = Sensor {
    geometry: Geometry::PAPER,
    gains: Gains::uniform(10.0),
};

fn parameters() -> Parameters {
    let i = [191e-6, 236e-6, 327e-6, 0.08e-6, -0.38e-6, 1.58e-6];
    Parameters {
        zero_drift_v: [0.01; LIMBS],
        scale_per_mass_per_kg: [5.0, 3.5, 6.1, 3.2, 4.9, 7.1, 3.7, 3.2, 3.2],
        inertia_per_mass: InertiaPerMass::from_paper_order(i),
        stiffness_per_mass_per_s2: 2e8,
    }
}

/// As many of limbs 1, 6 and 9, which can be excluded together and cost the most accuracy.
fn excluded(limbs: usize) -> Result<LimbSet, NotALimb> {
    LimbSet::from_numbers([1, 6, 9].into_iter().take(limbs))
}

/// Sines of 5 Hz: nobody's motion, but forces of the rig's size; or quiet ones, which turn little from one second to the next.
fn rows(peak_v: f64) -> Vec<[f64; LIMBS]> {
    let phase = |i: usize| core::f64::consts::TAU * 5.0 * i as f64 / RATE_HZ;
    (0..SAMPLES)
        .map(|i| from_fn(|c| 0.01 + peak_v * (phase(i) + c as f64).sin()))
        .collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, repeats] = &arguments[..] else {
        for (scheme, _) in SCHEMES {
            println!("push/full/{scheme}");
        }
        for name in [
            "push/full/heun/f32",
            "push/full/heun/without/1",
            "push/full/heun/without/2",
            "push/full/heun/without/3",
            "switch",
            "watch",
            "record",
            "record/columns",
            "record/heun_substepped",
            "record/without/3",
            "lanes/without/3",
            "record/portable",
            "record/run_away",
            "lanes",
            "lanes/portable",
            "aided",
            "pose",
        ] {
            println!("{name}");
        }
        println!("identify/scale\nidentify/inertia");
        return Ok(());
    };
    let rows = rows(if name == "aided" { 1e-3 } else { 0.2 });
    let columns: [Vec<f64>; LIMBS] = from_fn(|i| rows.iter().map(|row| row[i]).collect());
    let repeats = repeats.parse::<usize>()?;
    if name == "watch" {
        // Thresholds of a monitor take as many instructions as some hundred samples: they are made once.
        return watch(black_box(&rows), repeats);
    }
    for _ in 0..repeats {
        run(name, black_box(&rows), black_box(columns.each_ref()))?;
    }
    Ok(())
}

/// By itself: what else this program counts must not move the compiler's choices here.
#[inline(never)]
fn push_each(decoupler: &mut Decoupler, rows: &[[f64; LIMBS]]) -> sixaxis_core::Result<()> {
    for row in rows {
        black_box(&decoupler.push(black_box(row))?);
    }
    Ok(())
}

/// With so much noise that these rows, which are no motion's, raise no alarm.
fn watch(rows: &[[f64; LIMBS]], repeats: usize) -> Result<(), Box<dyn std::error::Error>> {
    let watch = Watch::exact(1.0, [1.0; LIMBS]);
    let settings = Settings::new(RATE_HZ);
    let room = vec![[0.0; LIMBS]; ROWS_KEPT];
    let mut watched = FaultTolerant::new(&SENSOR, &parameters(), &settings, &watch, room)?;
    for _ in 0..repeats {
        for row in rows {
            let answer = watched.push(black_box(row))?;
            assert!(answer.event.is_none(), "an alarm is isolated");
            black_box(&answer);
        }
    }
    Ok(())
}

fn run(
    name: &str,
    rows: &[[f64; LIMBS]],
    columns: [&Vec<f64>; LIMBS],
) -> Result<(), Box<dyn std::error::Error>> {
    let (name, without) = match name.split_once("/without/") {
        None => (name, LimbSet::EMPTY),
        Some((name, limbs)) => (name, excluded(limbs.parse()?)?),
    };
    let scheme = name.rsplit('/').next();
    let scheme = SCHEMES.iter().find(|(s, _)| Some(*s) == scheme);
    let settings = Settings {
        scheme: scheme.map_or(Scheme::Heun, |(_, scheme)| *scheme),
        initial_rate_shell_rad_s: match name {
            "record/run_away" => RUN_AWAY_RAD_S,
            _ => DVec3::ZERO,
        },
        ..Settings::new(RATE_HZ)
    };
    let mut decoupler = Decoupler::new(&SENSOR, &parameters(), &settings)?;
    decoupler.set_excluded(without)?;
    match name {
        "record" | "record/run_away" => decoupler.push_record(rows, &mut |done| {
            black_box(done);
        })?,
        "record/columns" => decoupler.push_columns(columns.map(|c| &c[..]), &mut |done| {
            black_box(done);
        })?,
        "record/heun_substepped" => decoupler.push_record(rows, &mut |done| {
            black_box(done);
        })?,
        "record/portable" => decoupler.push_record_portable(rows, &mut |done| {
            black_box(done);
        })?,
        "lanes" => {
            let mut streams: [Decoupler; LANES] = from_fn(|_| decoupler.clone());
            push_lanes(&mut streams, [rows; LANES], &mut |done| {
                black_box(done);
            })?;
        }
        "lanes/portable" => {
            let mut streams: [Decoupler; LANES] = from_fn(|_| decoupler.clone());
            push_lanes_portable(&mut streams, [rows; LANES], &mut |done| {
                black_box(done);
            })?;
        }
        "push/full/heun/f32" => {
            let mut single = Decoupler::new_f32(&SENSOR, &parameters(), &settings)?;
            for row in rows {
                black_box(&single.push(black_box(&row.map(|u| u as f32)))?);
            }
        }
        "aided" => {
            let white = ChannelNoise::white([1e-4; LIMBS]);
            let covariance = Covariance::identity() * 1e-12;
            let filter =
                ErrorFilter::new(&SENSOR, &parameters(), &settings, &covariance, &white, 1e-3)?;
            let mut aided = AidedDecoupler::new(decoupler, filter, &parameters(), &settings);
            for row in rows {
                black_box(&aided.push(black_box(row))?);
            }
        }
        "switch" => {
            // In mid-stream, there and back.
            decoupler.push_record(&rows[..8], &mut |_| {})?;
            for i in 0..rows.len() {
                decoupler.set_excluded(black_box(excluded(3 * (i % 2))?))?;
            }
            black_box(decoupler);
        }
        "pose" => {
            for row in rows {
                let elongation = row.map(|u| 1e-7 * u);
                black_box(Pose::from_elongations(
                    &Geometry::PAPER,
                    black_box(&elongation),
                )?);
            }
        }
        "identify/scale" => {
            let mut step = ScaleIdentification::default();
            for row in rows {
                step.push(black_box(row), DVec3::new(row[0], row[3], row[7]))?;
            }
            black_box(step);
        }
        "identify/inertia" => {
            let mut step = InertiaIdentification::new(Geometry::PAPER);
            for row in rows {
                let v = DVec3::new(row[0], row[3], row[7]);
                step.push(black_box(row), v, v * 3.0)?;
            }
            black_box(step);
        }
        name if name.starts_with("push/full/") => push_each(&mut decoupler, rows)?,
        name => {
            return Err(format!("{name}: no such way; without arguments all are listed").into());
        }
    }
    Ok(())
}
