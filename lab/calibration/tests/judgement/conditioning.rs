//! One list of conditioning stages: the code runs them in its order, and the page says what the code runs.

use std::path::Path;

use glam::DVec3;
use sixaxis_calibration::conditioning::{Conditioning, Stage};
use sixaxis_calibration::page::calibration::page;
use sixaxis_calibration::trial::Trial;

use sixaxis_core::dsp::continued::zero_phase;
use sixaxis_core::dsp::delay::delayed;
use sixaxis_core::dsp::lag::undo_high_pass;
use sixaxis_core::dsp::{butterworth, detrend, outlier};
use sixaxis_core::{Gains, LIMBS};
use sixaxis_page::{Block, Figure, Section};
use sixaxis_recordings::session::{Role, SessionFile};

const RATE_HZ: f64 = 500.0;
const SAMPLES: usize = 4000;
/// Corner of the amplifiers, Hz.
const CORNER_HZ: f64 = 0.05;
/// Rest before and after the run, samples.
const REST: usize = 250;
/// A wild sample: where, and by how much, V.
const SPIKE: (usize, f64) = (1500, 5.0);

/// Every stage on.
const SESSION: &str = r#"title = "every stage"
[sensor]
serial = "7"
limb_length_mm = 25.5
half_edge_mm = 21.0
full_scale_v = 10.0
gain_n_per_v = 10.0
[sensor.design]
scale_per_mass_per_kg = 5.3476
inertia_per_mass_mm2 = [238.76, 250.71, 252.588, 0.0512, -0.0295, 0.5544]
stiffness_per_mass_per_s2 = 3.1e8
[accelerometer]
class_percent = 1.0
[gyroscope]
class_percent = 1.0
bandwidth_hz = 10.0
[channels]
limbs_unit = "V"
[preprocessing]
outliers = { half_width = 7, sigmas = 8.0 }
amplifier_high_pass_hz = 0.05
detrend = { rest_s = 0.5 }
low_pass = { order = 4, times_drive = 4.0, plus_hz = 8.0 }
[[recording]]
file = "linear-01.csv"
role = "linear"
direction = [1, 0, 0]
frequency_hz = 1.0
"#;

fn session() -> SessionFile {
    SessionFile::parse(Path::new("day/session.toml"), SESSION.to_owned()).expect("it can be parsed")
}

/// A run between two rests, with a drift, an offset and a wild sample in one limb.
fn trial() -> Trial {
    let wave = |k: usize, phase: f64| {
        let t = k as f64 / RATE_HZ;
        let window = if (REST..SAMPLES - REST).contains(&k) {
            1.0
        } else {
            0.0
        };
        window * (core::f64::consts::TAU * t + phase).sin()
    };
    let voltage_v = (0..SAMPLES)
        .map(|k| {
            core::array::from_fn(|limb| {
                let spike = if (limb, k) == (0, SPIKE.0) {
                    SPIKE.1
                } else {
                    0.0
                };
                0.3 + 1e-5 * k as f64 + wave(k, limb as f64) + spike
            })
        })
        .collect();
    Trial {
        name: "linear-01.csv".to_owned(),
        role: Role::Linear,
        sample_rate_hz: RATE_HZ,
        gains: Gains::uniform(10.0),
        full_scale_v: 10.0,
        voltage_v,
        accelerometer_m_s2: (0..SAMPLES).map(|k| 0.1 + wave(k, 0.5)).collect(),
        gyroscope_rad_s: (0..SAMPLES).map(|k| 0.01 + wave(k, 0.7)).collect(),
        limbs_band_hz: f64::INFINITY,
        standards_band_hz: f64::INFINITY,
        direction_ground: DVec3::X,
        gravity_ground_m_s2: DVec3::new(-9.80665, 0.0, 0.0),
        frequency_hz: 1.0,
    }
}

/// White noise that was read between its samples keeps its density below, and near half the sample rate it has less.
#[test]
fn stat_noise_of_channels_read_between_samples_is_the_converters() {
    const RATE_HZ: f64 = 1000.0;
    let mut state = 20_261_128_u64;
    let mut noise = || {
        let mut unit = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        2e-3 * ((0..12).map(|_| unit()).sum::<f64>() - 6.0)
    };
    let motion = |k: usize| (core::f64::consts::TAU * 3.0 * k as f64 / RATE_HZ).sin();
    let channel: Vec<f64> = (0..20_000).map(|k| motion(k) + noise()).collect();
    let (between, _) = delayed(&channel, 0.45 / RATE_HZ, RATE_HZ).expect("a record");
    let mut trial = Trial {
        sample_rate_hz: RATE_HZ,
        voltage_v: between.iter().map(|u| [*u; LIMBS]).collect(),
        ..trial()
    };
    let told = |trial: &Trial| trial.noise_v(3).expect("long enough") / 2e-3;
    assert!(told(&trial) < 0.7, "{}", told(&trial));
    trial.limbs_band_hz = 0.2 * RATE_HZ;
    assert!((told(&trial) - 1.0).abs() < 0.05, "{}", told(&trial));
}

fn mean(series: &[f64]) -> f64 {
    series.iter().sum::<f64>() / series.len() as f64
}

/// One limb's voltage through the given stages of `core`, in the given order.
fn by_hand(order: &[Stage], series: &[f64]) -> Vec<f64> {
    let mut series = series.to_vec();
    for stage in order {
        match stage {
            Stage::Outliers => {
                outlier::hampel(&mut series, 7, 8.0).expect("it can be tested");
            }
            Stage::HighPass => {
                let rest = mean(&series[..16]);
                let change: Vec<f64> = series.iter().map(|u| u - rest).collect();
                let undone = undo_high_pass(&change, CORNER_HZ, RATE_HZ).expect("it is undone");
                series = undone.iter().map(|u| u + rest).collect();
            }
            Stage::Trend => {
                let level = mean(&series[..REST]);
                detrend::rest_to_rest_trend(&mut series, REST).expect("it rests");
                series.iter_mut().for_each(|u| *u += level);
            }
            Stage::LowPass => {
                let sections = butterworth::low_pass(4, 12.0, RATE_HZ).expect("a filter");
                zero_phase(&sections, &mut series).expect("it is long enough");
            }
            other => panic!("{other:?} changes no limb"),
        }
    }
    series
}

#[test]
fn inv_limbs_pass_the_stages_in_the_listed_order() {
    let order = [
        Stage::Outliers,
        Stage::HighPass,
        Stage::Trend,
        Stage::LowPass,
    ];
    let trial = trial();
    let conditioned = Conditioning::of(&session().session)
        .condition(&trial)
        .expect("it is conditioned");
    let limb: Vec<f64> = trial.voltage_v.iter().map(|row| row[0]).collect();
    let ours: Vec<f64> = conditioned.voltage_v.iter().map(|row| row[0]).collect();
    assert_eq!(ours, by_hand(&order, &limb));
    // Every neighbouring pair exchanged gives something else.
    for pair in 0..order.len() - 1 {
        let mut other = order;
        other.swap(pair, pair + 1);
        assert_ne!(ours, by_hand(&other, &limb), "{other:?}");
    }
}

/// The page's section on conditioning.
fn section() -> Section {
    let file = session();
    let trial = trial();
    let conditioned = Conditioning::of(&file.session)
        .condition(&trial)
        .expect("it is conditioned");
    page(
        &file,
        &crate::bare::calibrated(vec![(trial, Some(conditioned))]),
    )
    .sections
    .into_iter()
    .find(|section| section.id == "preprocessing")
    .expect("the page has it")
}

#[test]
fn regress_the_page_lists_the_stages_in_their_order() {
    let rows: Vec<String> = section()
        .blocks
        .into_iter()
        .find_map(|block| match block {
            Block::Table(table) => Some(table.rows.into_iter().map(|row| row.header).collect()),
            _ => None,
        })
        .expect("a table of the stages");
    assert_eq!(rows, Stage::ORDER.map(|stage| stage.name().to_owned()));
}

#[test]
fn regress_before_and_after_are_those_of_one_stage() {
    let figures: Vec<Figure> = section()
        .blocks
        .into_iter()
        .find_map(|block| match block {
            Block::FigureGrid(figures) => Some(figures),
            _ => None,
        })
        .expect("figures of the stages");
    let curve = |id: &str, which: usize| -> Vec<f64> {
        let figure = figures.iter().find(|f| f.id == id).expect(id);
        figure.series[which].points.iter().map(|p| p.1).collect()
    };
    let limb: Vec<f64> = trial().voltage_v.iter().map(|row| row[0]).collect();
    let order = [
        Stage::Outliers,
        Stage::HighPass,
        Stage::Trend,
        Stage::LowPass,
    ];
    for (index, id) in ["outliers", "high-pass", "detrend", "low-pass"]
        .iter()
        .enumerate()
    {
        let id = format!("stage-{id}");
        assert_eq!(
            curve(&id, 0),
            by_hand(&order[..index], &limb),
            "{id}, before"
        );
        assert_eq!(
            curve(&id, 1),
            by_hand(&order[..=index], &limb),
            "{id}, after"
        );
    }
}
