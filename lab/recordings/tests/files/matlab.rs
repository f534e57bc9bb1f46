//! MATLAB: files of SciPy, hdf5storage and h5py, and broken ones.

use std::fs;
use std::path::Path;

use crate::expected::{bits, corrupted, folder, rows};
use sixaxis_recordings::error::Error;
use sixaxis_recordings::{Block, matlab, open};

/// Channels and properties that a file is to have.
type Expected = (Vec<(String, Vec<f64>)>, Vec<(String, String)>);

fn expected(path: &Path) -> Expected {
    let (mut channels, mut properties) = (Vec::new(), Vec::new());
    for line in fs::read_to_string(path).unwrap().lines() {
        let (name, values) = line.split_once(',').unwrap();
        match name.strip_prefix('#') {
            Some(name) => properties.push((name.to_owned(), values.to_owned())),
            None => channels.push((
                name.to_owned(),
                values.split(',').map(|v| v.parse().unwrap()).collect(),
            )),
        }
    }
    (channels, properties)
}

#[test]
fn ref_what_scipy_and_h5py_read_is_read() {
    let mut compared = 0;
    for entry in fs::read_dir(folder("matlab")).unwrap() {
        let table = entry.unwrap().path();
        if table.extension().is_none_or(|e| e != "csv") {
            continue;
        }
        let path = table.with_extension("mat");
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let (channels, properties) = expected(&table);
        let mut source = open(&path).unwrap_or_else(|e| panic!("{e}"));
        let layout = source.layout().clone();
        let names: Vec<_> = layout.channels.iter().map(|c| c.name.as_str()).collect();
        let wanted: Vec<_> = channels.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, wanted, "{name}");
        for (key, value) in &properties {
            assert_eq!(layout.properties.get(key), Some(value), "{name}, {key}");
        }
        let extra = usize::from(layout.properties.contains_key(matlab::LEFT_OUT));
        assert_eq!(layout.properties.len(), properties.len() + extra, "{name}");
        for limit in [1, 7, 1000, usize::MAX] {
            for (index, (channel, values)) in channels.iter().enumerate() {
                assert_eq!(layout.channels[index].samples, Some(values.len() as u64));
                // Beside another of its length, as recordings are read.
                let other = channels
                    .iter()
                    .position(|(_, v)| v.len() == values.len())
                    .unwrap();
                source.select(&[other, index]).unwrap();
                let read = rows(source.as_mut(), limit).unwrap_or_else(|e| panic!("{e}"));
                let values = std::slice::from_ref(values);
                assert_eq!(bits(&read[1..]), bits(values), "{name}, {channel}");
            }
        }
        compared += 1;
    }
    assert!(compared >= 7, "{compared} files compared");
}

#[test]
fn what_the_variables_say_is_in_the_layout() {
    for (file, format) in [("v7.mat", "MATLAB 5"), ("v73_packed.mat", "MATLAB 7.3")] {
        let mut source = open(&folder("matlab").join(file)).unwrap();
        let layout = source.layout();
        assert_eq!(layout.format, format);
        let time = layout.time.unwrap();
        assert_eq!(layout.channels[time].name, "t");
        assert_eq!(layout.channels[time].sample_rate_hz, Some(1000.0));
        let of_struct = layout
            .channels
            .iter()
            .find(|c| c.name.starts_with("data.u"))
            .unwrap();
        assert!(
            matches!(of_struct.sample_rate_hz, Some(512.0 | 250.5)),
            "{of_struct:?}"
        );
        let left_out = &layout.properties[matlab::LEFT_OUT];
        assert!(
            left_out.contains("square (") && left_out.contains("(cell)"),
            "{left_out}"
        );
        // Channels of several lengths: each can be read, not all side by side.
        assert!(matches!(
            source.read(&mut Block::default(), 1).unwrap_err(),
            Error::LengthMismatch { .. }
        ));
        assert!(matches!(
            source.select(&[999]).unwrap_err(),
            Error::NoSuchChannel { .. }
        ));
    }
}

#[test]
fn what_is_not_understood_is_refused_with_advice() {
    for (file, feature, advice) in [
        ("cells_only.mat", "c (cell)", "-struct"),
        ("v4.mat", "version 4", "-v7"),
    ] {
        let error = open(&folder("matlab").join(file)).err().unwrap();
        let text = error.to_string();
        assert!(matches!(error, Error::Unsupported { .. }), "{text}");
        assert!(text.contains(feature) && text.contains(advice), "{text}");
    }
}

/// Reads a broken file to its end. Either is refused, or gives channels of the length that its layout announces.
fn survive(path: &Path, bytes: &[u8]) {
    fs::write(path, bytes).unwrap();
    let Ok(mut source) = open(path) else {
        return;
    };
    let channels = source.layout().channels.clone();
    for (index, channel) in channels.iter().enumerate().take(40) {
        source.select(&[index]).unwrap();
        if let Ok(columns) = rows(source.as_mut(), 64) {
            assert_eq!(Some(columns[0].len() as u64), channel.samples);
        }
    }
}

#[test]
fn broken_files_are_survived() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("broken.mat");
    for name in [
        "v6",
        "v7",
        "big_endian",
        "v73_plain",
        "v73_packed",
        "v73_tree",
        "hdf5storage",
        "latest",
    ] {
        let good = fs::read(folder("matlab").join(name).with_extension("mat")).unwrap();
        corrupted(&good, |bytes| survive(&path, bytes));
    }
}
