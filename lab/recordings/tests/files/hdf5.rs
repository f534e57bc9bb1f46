//! HDF5: files of h5py, and damaged ones.

use crate::expected::{check, damage, folder, rows, scratch};
use sixaxis_recordings::open;

#[test]
fn ref_h5py_agrees() {
    assert!(check("hdf5") >= 5);
}

#[test]
fn inv_damaged_files_end_in_an_error_or_in_numbers() {
    let bad = scratch("hdf5_damage");
    for name in ["holes.h5", "lzf.h5", "twelve_bits.h5"] {
        damage(&folder("hdf5").join(name), &bad.join(name));
    }
}

/// Dimensions of a file's only dataset, as its description has them: 90 samples, and as many at most.
fn dimensions(bytes: &[u8]) -> usize {
    let twice = [90_u64.to_le_bytes(), 90_u64.to_le_bytes()].concat();
    bytes.windows(16).position(|w| w == twice).unwrap()
}

/// Samples that were never written take no room, so a few bytes could announce any number of them.
#[test]
fn inv_a_small_file_is_no_endless_recording() {
    let bytes = std::fs::read(folder("hdf5").join("holes.h5")).unwrap();
    let at = dimensions(&bytes);
    let path = scratch("hdf5_endless").join("file.h5");
    for (samples, accepted) in [
        (90_u64, true),
        (1 << 16, true),
        (1 << 40, false),
        (1 << 61, false),
        (u64::MAX, false),
    ] {
        let mut long = bytes.clone();
        for place in [at, at + 8] {
            long[place..place + 8].copy_from_slice(&samples.to_le_bytes());
        }
        std::fs::write(&path, &long).unwrap();
        let read = open(&path).and_then(|mut source| rows(source.as_mut(), 1000));
        assert_eq!(read.is_ok(), accepted, "{samples}: {:?}", read.err());
    }
}
