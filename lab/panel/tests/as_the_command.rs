//! The panel decodes as `sixaxis decouple` does: cross-talk and channel delays of a calibration are undone by both.

use std::path::Path;

use serde_json::json;
use sixaxis_calibration::apply::columns::Columns;
use sixaxis_calibration::apply::job::Job;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_core::{LIMBS, LimbSet, Scheme};
use sixaxis_panel::chain::{Beside, Chain, Choice};
use sixaxis_panel::columns::{ALONG, COLUMNS, FELT, MOTION};
use sixaxis_panel::control::Stages;
use sixaxis_panel::source::settings::Settings;
use sixaxis_recordings::{Block, Layout, create, open};
use sixaxis_reference::laboratory::plan::Engine;

const RATE_HZ: f64 = 1000.0;
const SAMPLES: u32 = 1500;
const GAIN_N_PER_V: f64 = 5.0;
/// Direction of the instruments.
const ALONG_N: glam::DVec3 = glam::DVec3::new(0.6, 0.0, 0.8);
/// Samples that the delays hold back, which the panel never sees and the command takes at the end.
const HELD: usize = 8;
/// Rounding to the 32 bits of the charts, and that of whole records against streams.
const ROUNDING: f64 = 1e-6;

/// A calibration with zeros, and with what each channel shows of the others.
fn calibration(folder: &Path, cross_talk: f64, lag_us: f64) -> Calibration {
    let wave = |k: usize, size: f64| size * (1.0 + k as f64).sin();
    let each = |size: f64| (0..LIMBS).map(|k| wave(k, size)).collect::<Vec<_>>();
    let square = |size: f64| {
        (0..LIMBS)
            .map(|i| (0..LIMBS).map(|j| wave(3 * i + 5 * j, size)).collect())
            .collect()
    };
    let shares: Vec<Vec<f64>> = square(cross_talk);
    let none: Vec<Vec<f64>> = square(0.0);
    let limbs: Vec<String> = (1..=LIMBS).map(|limb| format!("u{limb}")).collect();
    let file = json!({
        "format": "sixaxis-calibration-3",
        "verdict": "good",
        "findings": [],
        "sensor": {
            "serial": "", "limb_length_m": 0.025, "half_edge_m": 0.026, "full_scale_v": 10.0,
            "gain_n_per_v": vec![1.0; LIMBS], "amplifier_high_pass_hz": null,
        },
        "parameters": {
            "zero_drift_v": each(0.02),
            "scale_per_mass_per_kg": (0..LIMBS).map(|k| 5.0 + wave(k, 1.0)).collect::<Vec<_>>(),
            "inertia_per_mass_m2": [2.4e-4, 2.5e-4, 2.5e-4, 5e-8, -3e-8, 5e-7],
            "stiffness_per_mass_per_s2": 3.1e8,
        },
        "intervals": [],
        "covariance": { "zero_drift_v2": each(0.0), "scale_per_mass_per_kg2": [], "inertia_per_mass_m4": [] },
        "limbs": {
            "stiffness_ratio": vec![1.0; LIMBS], "cross_talk": shares, "cross_talk_spread": 0.0,
            "strain_covariance": none,
        },
        "channels": { "limbs": limbs, "accelerometer": "a", "gyroscope": "w", "limbs_lag_us": each(lag_us) },
        "provenance": { "sixaxis_version": "0.1.0", "session": "", "recordings": [] },
    });
    let path = folder.join("calibration.json");
    std::fs::write(&path, file.to_string()).expect("is written");
    Calibration::read(&path).expect("is read")
}

/// Nine voltages of a motion that begins at rest, in a file.
fn recorded(path: &Path, zero_v: &[f64; LIMBS]) -> Vec<[f64; LIMBS]> {
    let voltage = |k: u32, limb: usize| {
        let t = f64::from(k) / RATE_HZ;
        let (start, phase) = ((2.0 * t).min(1.0), 0.7 * limb as f64);
        zero_v[limb] + 0.3 * start * start * (core::f64::consts::TAU * 3.0 * t + phase).sin()
    };
    let rows: Vec<[f64; LIMBS]> = (0..SAMPLES)
        .map(|k| core::array::from_fn(|limb| voltage(k, limb)))
        .collect();
    let layout = Layout::of_a_sensor(Some(RATE_HZ), false);
    let mut sink = create(path, &layout).expect("begins");
    let columns = (0..LIMBS)
        .map(|limb| rows.iter().map(|row| row[limb]).collect())
        .collect();
    sink.write(&Block { columns }).expect("writes");
    sink.finish().expect("finishes");
    rows
}

/// The motion by the command's own way from file to file.
fn by_the_command(folder: &Path, calibration: &Calibration, recording: &Path) -> Vec<Vec<f64>> {
    let overrides = Overrides {
        gain_n_per_v: vec![GAIN_N_PER_V],
        ..Overrides::default()
    };
    let setup = Setup::new(calibration, None, None, &overrides).expect("is set up");
    let job = Job {
        calibration,
        calibration_name: Path::new("calibration.json"),
        setup: &setup,
        columns: Columns::MOTION,
        scheme: Scheme::Heun,
        rest_to_rest: false,
        uncertainty: false,
        false_alarms_per_hour: None,
        excluded: LimbSet::EMPTY,
        until_sd_deg: sixaxis_calibration::apply::attitude::UNTIL_SD_DEG,
        aids: &[],
        smooth: false,
        picture: false,
    };
    let out = folder.join("motion.parquet");
    job.run(recording, &|layout| Ok(create(&out, layout)?), &|_, _| {})
        .expect("decouples");
    let mut source = open(&out).expect("opens");
    let (mut block, mut rows) = (Block::default(), Vec::new());
    while source.read(&mut block, 500).expect("reads") > 0 {
        // Behind the time: accelerations and rates.
        rows.extend(
            (0..block.rows()).map(|row| block.columns[1..10].iter().map(|c| c[row]).collect()),
        );
    }
    rows
}

/// The same as the panel shows it.
fn by_the_panel(calibration: &Calibration, rows: &[[f64; LIMBS]]) -> Vec<Vec<f64>> {
    let stages = Stages {
        low_pass_hz: None,
        ..Stages::default()
    };
    let lags = calibration.channels.limbs_lag_us;
    let delays_s = lags.map(|lags| lags.each().map(|us| us * 1e-6));
    let session = Settings {
        seed: 1,
        sample_rate_hz: RATE_HZ,
        trials_per_step: 3,
        engine: Engine::Rigid,
    }
    .session();
    let mut chain = Chain::idle();
    chain
        .condition(&stages, delays_s, RATE_HZ)
        .expect("conditions");
    chain
        .restart(&Choice {
            session: &session,
            calibration: Some(calibration),
            gain_n_per_v: [GAIN_N_PER_V; LIMBS],
            gravity_ground_m_s2: glam::DVec3::ZERO,
            direction: Some(ALONG_N),
            watch: false,
        })
        .expect("begins");
    let mut shown = Vec::new();
    for voltage_v in rows {
        let mut row = [f32::NAN; COLUMNS];
        chain.push(voltage_v, Beside::default(), &mut row);
        if row[MOTION.start].is_finite() {
            let felt = glam::DVec3::from_array([0, 1, 2].map(|k| f64::from(row[FELT.start + k])));
            let along = f64::from(row[ALONG.start]);
            assert!((felt.dot(ALONG_N) - along).abs() <= 1e-5 * felt.length().max(1e-3));
            shown.push(row[MOTION][..9].iter().map(|x| f64::from(*x)).collect());
        }
    }
    shown
}

fn largest(rows: &[Vec<f64>], others: &[Vec<f64>]) -> f64 {
    (0..9)
        .map(|axis| {
            let peak = rows.iter().map(|row| row[axis].abs()).fold(0.0, f64::max);
            let pairs = rows.iter().zip(others);
            pairs
                .map(|(a, b)| (a[axis] - b[axis]).abs())
                .fold(0.0, f64::max)
                / peak
        })
        .fold(0.0, f64::max)
}

#[test]
fn law_the_panel_decodes_as_the_command_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.parquet");
    let plain = calibration(folder.path(), 0.0, 0.0);
    let rows = recorded(&path, &plain.parameters().zero_drift_v);
    let without = by_the_panel(&plain, &rows);
    for (cross_talk, lag_us) in [(0.0, 0.0), (0.02, 0.0), (0.0, 300.0), (0.02, 300.0)] {
        let calibration = calibration(folder.path(), cross_talk, lag_us);
        let command = by_the_command(folder.path(), &calibration, &path);
        let panel = by_the_panel(&calibration, &rows);
        assert!(
            panel.len() + HELD >= command.len(),
            "{} of {}",
            panel.len(),
            command.len()
        );
        let apart = largest(&command[..panel.len()], &panel);
        assert!(
            apart < ROUNDING,
            "cross-talk {cross_talk}, {lag_us} µs: {apart:e} apart"
        );
        // What is undone is to be seen.
        let undone = largest(&command[..panel.len()], &without);
        assert!((undone > 1e-3) == (cross_talk + lag_us > 0.0), "{undone:e}");
    }
}
