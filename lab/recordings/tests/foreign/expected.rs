//! What other software reads from a file, against what is read here.

#![allow(dead_code, reason = "each format uses its own share")]

use std::path::{Path, PathBuf};

use serde_json::Value;
use sixaxis_recordings::{Block, Result, Source, open};

/// Folder of the foreign files of a format.
pub fn folder(format: &str) -> PathBuf {
    match std::env::var_os("SIXAXIS_FOREIGN_FILES") {
        Some(root) => PathBuf::from(root).join(format),
        None => PathBuf::from(env!("CARGO_MANIFEST_DIR"))
            .join("tests/foreign/files")
            .join(format),
    }
}

/// All rows of the selected channels, in blocks of at most so many.
pub fn rows(source: &mut dyn Source, limit: usize) -> Result<Vec<Vec<f64>>> {
    let (mut block, mut all) = (Block::default(), Vec::new());
    loop {
        let count = source.read(&mut block, limit)?;
        assert!(count <= limit, "more rows than asked for");
        all.resize_with(block.columns.len(), Vec::new);
        for (all, column) in all.iter_mut().zip(&block.columns) {
            assert_eq!(column.len(), count, "columns of one length");
            all.extend(column);
        }
        if count == 0 {
            return Ok(all);
        }
    }
}

/// Bits, but one for all that are not numbers.
pub fn bits(columns: &[Vec<f64>]) -> Vec<Vec<u64>> {
    let bit = |v: &f64| {
        if v.is_nan() {
            f64::NAN.to_bits()
        } else {
            v.to_bits()
        }
    };
    columns
        .iter()
        .map(|c| c.iter().map(bit).collect())
        .collect()
}

fn strings(value: &Value) -> Vec<Option<&str>> {
    value
        .as_array()
        .into_iter()
        .flatten()
        .map(Value::as_str)
        .collect()
}

/// Checks every file of a folder; returns how many there are.
pub fn check(format: &str) -> usize {
    let folder = folder(format);
    let text = std::fs::read_to_string(folder.join("expected.json")).unwrap();
    let expected: Value = serde_json::from_str(&text).unwrap();
    let files = expected.as_object().unwrap();
    for (name, said) in files {
        match said["refused"].as_str() {
            Some(message) => refused(&folder.join(name), message),
            None => one(&folder.join(name), said),
        }
    }
    files.len()
}

fn refused(path: &Path, message: &str) {
    let error = open(path)
        .and_then(|mut source| rows(source.as_mut(), 5))
        .unwrap_err();
    assert!(error.to_string().contains(message), "{error}");
}

fn one(path: &Path, said: &Value) {
    let mut source = open(path).unwrap();
    let layout = source.layout().clone();
    let shown = path.display();
    let names: Vec<Option<&str>> = layout
        .channels
        .iter()
        .map(|c| Some(c.name.as_str()))
        .collect();
    assert_eq!(names, strings(&said["names"]), "{shown}");
    if said["units"].is_array() {
        let units: Vec<Option<&str>> = layout.channels.iter().map(|c| c.unit.as_deref()).collect();
        assert_eq!(units, strings(&said["units"]), "{shown}");
    }
    if let Some(properties) = said["properties"].as_object() {
        let ours: Vec<_> = layout
            .properties
            .iter()
            .map(|(k, v)| (k.as_str(), Some(v.as_str())))
            .collect();
        let theirs: Vec<_> = properties
            .iter()
            .map(|(k, v)| (k.as_str(), v.as_str()))
            .collect();
        assert_eq!(ours, theirs, "{shown}");
    }
    let rate = said["rate"].as_f64();
    for (at, channel) in layout.channels.iter().enumerate() {
        if rate.is_some() && layout.time != Some(at) {
            assert_eq!(channel.sample_rate_hz, rate, "{shown}");
        }
    }
    let theirs: Vec<Vec<f64>> = said["columns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|column| {
            strings(column)
                .into_iter()
                .map(|v| v.unwrap().parse().unwrap())
                .collect()
        })
        .collect();
    let all: Vec<usize> = (0..names.len()).collect();
    for limit in [1, 7, 1000, usize::MAX] {
        source.select(&all).unwrap();
        let ours = rows(source.as_mut(), limit).unwrap();
        assert_eq!(bits(&ours), bits(&theirs), "{shown}, limit {limit}");
    }
    // Backwards and the first once more, from the beginning although something has been read.
    let selection: Vec<usize> = all.iter().rev().copied().chain([0]).collect();
    source.read(&mut Block::default(), 1).unwrap();
    source.select(&selection).unwrap();
    let wanted: Vec<Vec<f64>> = selection.iter().map(|&c| theirs[c].clone()).collect();
    assert_eq!(
        bits(&rows(source.as_mut(), 5).unwrap()),
        bits(&wanted),
        "{shown}"
    );
    assert!(source.select(&[names.len()]).is_err());
}

/// Cuts a file at every byte (every seventh beyond the first 400) and flips bytes there; whatever opens must end, with columns of one length. Returns how many of the
/// damaged files were read without an error.
pub fn damage(good: &Path, bad: &Path) -> usize {
    let bytes = std::fs::read(good).unwrap();
    let places: Vec<usize> = (0..bytes.len())
        .filter(|at| *at < 400 || at % 7 == 0)
        .collect();
    let mut accepted = 0;
    let mut attempt = |bytes: &[u8]| {
        std::fs::write(bad, bytes).unwrap();
        let read = open(bad).and_then(|mut source| rows(source.as_mut(), 100));
        accepted += usize::from(read.is_ok());
    };
    for &end in &places {
        attempt(&bytes[..end]);
    }
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for &at in &places {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let mut flipped = bytes.clone();
        flipped[at] ^= (state >> 56) as u8 | 1;
        attempt(&flipped);
    }
    std::fs::remove_file(bad).unwrap();
    accepted
}

/// Hands out pieces of a file from its beginning, then copies in which one to three bytes are other ones.
pub fn corrupted(good: &[u8], mut attempt: impl FnMut(&[u8])) {
    for length in (0..good.len()).step_by(1 + good.len() / 200) {
        attempt(&good[..length]);
    }
    let mut state = 1u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    for _ in 0..600 {
        let mut bytes = good.to_vec();
        for _ in 0..1 + random() % 3 {
            let at = random() % bytes.len();
            bytes[at] = match random() % 3 {
                0 => bytes[at] ^ (1 << (random() % 8)),
                1 => 0xff,
                _ => random() as u8,
            };
        }
        attempt(&bytes);
    }
}

/// A folder of its own for a test.
pub fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}
