//! Parts: what is written is read, and nothing else is.

mod common;

use std::fs;

use common::{made_up, provenance};
use sixaxis_campaign::error::Error;
use sixaxis_campaign::part::{self, Part};

const CASES: core::ops::Range<u64> = 1..31;

/// Every how many bytes a file is damaged, or cut off: a number that shares no factor with the layout.
const STRIDE: usize = 211;

/// Values, all of which the checksum holds, fill more than this share of a file.
const VALUES_SHARE: f64 = 0.5;

fn rows() -> Vec<sixaxis_campaign::row::Row> {
    CASES.map(|seed| made_up(seed, 1.0)).collect()
}

#[test]
fn inv_a_part_is_read_as_it_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let written = Part {
        provenance: provenance(1..101),
        rows: rows(),
    };
    let path =
        part::write(folder.path(), &written.provenance, &written.rows).expect("it is written");
    assert_eq!(part::read(&path).expect("it is read"), written);
    let again = tempfile::tempdir().expect("a folder");
    let second =
        part::write(again.path(), &written.provenance, &written.rows).expect("it is written");
    assert_eq!(
        fs::read(&path).expect("it is there"),
        fs::read(second).expect("it is there"),
        "the same rows give the same bytes"
    );
}

#[test]
fn prop_a_damaged_part_is_refused_or_unharmed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = part::write(folder.path(), &provenance(1..101), &rows()).expect("it is written");
    let whole = fs::read(&path).expect("it is there");
    let mut refused = 0;
    for at in (0..whole.len()).step_by(STRIDE) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        fs::write(&path, &bytes).expect("it can be written");
        match part::read(&path) {
            // Some bytes say nothing: padding, offsets that nobody follows, a digit of the seeds that were asked for.
            Ok(read) => assert_eq!(read.rows, rows(), "byte {at}"),
            Err(Error::Damaged { path: named, .. }) => {
                assert_eq!(named, path);
                refused += 1;
            }
            Err(other) => panic!("byte {at}: {other}"),
        }
    }
    assert!(
        refused as f64 > VALUES_SHARE * (whole.len() / STRIDE) as f64,
        "{refused} were refused"
    );
    for length in (0..whole.len()).step_by(STRIDE) {
        fs::write(&path, &whole[..length]).expect("it can be written");
        assert!(
            matches!(part::read(&path), Err(Error::Damaged { .. })),
            "cut off at {length}"
        );
    }
}

#[test]
fn prop_a_part_under_another_name_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = part::write(folder.path(), &provenance(1..101), &rows()).expect("it is written");
    let other = folder.path().join(part::file_name(&(2..32)));
    fs::rename(&path, &other).expect("it can be renamed");
    assert!(matches!(part::read(&other), Err(Error::Damaged { .. })));
}
