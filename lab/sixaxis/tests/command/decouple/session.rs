//! A simulated and calibrated session, made once, and its recordings as columns.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::report::Grade;
use sixaxis_recordings::{Block, Channel, Layout, create, open};

use crate::program::{Folder, run, simulated, stderr, text};

/// Names of the limbs in a simulated session.
pub const LIMBS: [&str; 9] = ["u1", "u2", "u3", "u4", "u5", "u6", "u7", "u8", "u9"];
/// Columns of the accelerations in a result.
pub const ACCELERATIONS: [&str; 6] = ["ax", "ay", "az", "alpha_x", "alpha_y", "alpha_z"];

/// The session's folder.
pub fn session() -> &'static Path {
    static SESSION: OnceLock<Folder> = OnceLock::new();
    SESSION.get_or_init(|| {
        let (folder, _) = simulated("decouple-session", "--seed 3");
        let path = folder.join("calibration.json");
        let toml = folder.join("session.toml");
        let calibrated = run(&["calibrate", text(&toml), "--out", text(&path)]);
        assert!(
            matches!(calibrated.status.code(), Some(0 | 3)),
            "{}",
            stderr(&calibrated)
        );
        // What the verdict does is tested by itself; here it is good.
        let mut calibration = Calibration::read(&path).expect("a calibration");
        calibration.verdict = Grade::Good;
        calibration.write(&path).expect("writes");
        folder
    })
}

pub fn calibration() -> String {
    text(&session().join("calibration.json")).to_owned()
}

/// Recording of a compound run, whatever its format.
pub fn compound() -> PathBuf {
    let entries = std::fs::read_dir(session()).expect("lists");
    entries
        .map(|entry| entry.expect("an entry").path())
        .find(|path| path.file_stem().is_some_and(|stem| stem == "compound-03"))
        .expect("the session has it")
}

/// A recording is decoupled in blocks, a stream and a watched recording sample by sample: products are fused and turns bracketed
/// otherwise. Largest difference of a column over its peak, measured 6e-14 on these runs.
pub const BLOCKS_AND_SAMPLES: f64 = 1e-12;

/// Largest difference of two tables' columns over the column's peak; infinite where one has more than the other.
pub fn apart(found: &[Vec<f64>], expected: &[Vec<f64>]) -> f64 {
    if found.len() != expected.len() {
        return f64::INFINITY;
    }
    let column = |(found, expected): (&Vec<f64>, &Vec<f64>)| {
        if found.len() != expected.len() {
            return f64::INFINITY;
        }
        let peak = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let pairs = found.iter().zip(expected);
        let apart = pairs.map(|(x, y)| match (x - y).abs() {
            finite if finite.is_finite() => finite,
            _ => f64::INFINITY,
        });
        apart.fold(0.0, f64::max) / peak
    };
    let columns = found.iter().zip(expected).map(column);
    columns.fold(0.0, f64::max)
}

/// Columns of a file by their names, and its rate.
pub fn columns(path: &Path, names: &[&str]) -> (Vec<Vec<f64>>, Option<f64>) {
    let mut source = open(path).expect("opens");
    let layout = source.layout().clone();
    let indices: Vec<usize> = names
        .iter()
        .map(|name| {
            let by_group = |c: &Channel| c.name.rsplit('/').next() == Some(name);
            layout
                .channels
                .iter()
                .position(by_group)
                .expect("a channel")
        })
        .collect();
    source.select(&indices).expect("selects");
    let mut all = vec![Vec::new(); names.len()];
    let mut block = Block::default();
    while source.read(&mut block, 1000).expect("reads") > 0 {
        for (all, column) in all.iter_mut().zip(&block.columns) {
            all.extend_from_slice(column);
        }
    }
    (all, layout.channels[indices[0]].sample_rate_hz)
}

pub fn write(path: &Path, names: &[&str], unit: &str, columns: &[Vec<f64>], rate_hz: f64) {
    let channels = names.iter().map(|name| Channel {
        sample_rate_hz: Some(rate_hz),
        ..Channel::new(*name, Some(unit))
    });
    let layout = Layout {
        channels: channels.collect(),
        ..Layout::default()
    };
    let mut sink = create(path, &layout).expect("creates");
    sink.write(&Block {
        columns: columns.to_vec(),
    })
    .expect("writes");
    sink.finish().expect("finishes");
}

/// Voltages of the compound run and its rate.
pub fn voltages() -> (Vec<Vec<f64>>, f64) {
    let (columns, rate) = columns(&compound(), &LIMBS);
    (columns, rate.expect("a rate"))
}
