//! NPY and NPZ: those of NumPy, our own, damaged ones.

use std::io::Write;

use crate::expected::{bits, check, damage, folder, rows, scratch};
use sixaxis_recordings::{Block, Channel, Error, Layout, create, open};

#[test]
fn ref_numpy_agrees() {
    assert!(check("numpy") >= 40);
}

fn recording() -> (Layout, Block) {
    let mut layout = Layout::default();
    for (name, unit) in [("t", Some("s")), ("group/u1", Some("µV")), ("u2", None)] {
        let mut channel = Channel::new(name, unit);
        channel.sample_rate_hz = Some(1000.0 / 3.0);
        layout.channels.push(channel);
    }
    layout.time = Some(0);
    layout.properties.insert("title".into(), "drop, µ".into());
    let mut block = Block::new(3);
    for column in 0..3_u32 {
        let value = |row: u32| {
            f64::from_bits(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(u64::from(row * 3 + column + 1)))
        };
        block.columns[column as usize] = (0..100_000).map(value).collect();
    }
    (layout, block)
}

#[test]
fn inv_what_is_written_reads_back_the_same() {
    let (layout, block) = recording();
    let twice: Vec<Vec<f64>> = block
        .columns
        .iter()
        .map(|c| [c.as_slice(), c].concat())
        .collect();
    for name in ["file.npy", "file.npz"] {
        let path = scratch("numpy_round").join(name);
        let mut sink = create(&path, &layout).unwrap();
        sink.write(&block).unwrap();
        assert!(!path.exists(), "not before it is complete");
        sink.write(&block).unwrap();
        assert!(sink.write(&Block::new(2)).is_err());
        sink.finish().unwrap();
        let mut source = open(&path).unwrap();
        for limit in [777, 1 << 17, usize::MAX] {
            source.select(&[0, 1, 2]).unwrap();
            assert_eq!(bits(&rows(source.as_mut(), limit).unwrap()), bits(&twice));
        }
        assert!(
            source
                .layout()
                .channels
                .iter()
                .all(|c| c.samples == Some(200_000))
        );
        if name == "file.npz" {
            let read = source.layout();
            for (ours, theirs) in read.channels.iter().zip(&layout.channels) {
                assert_eq!(
                    (&ours.name, &ours.unit, ours.sample_rate_hz),
                    (&theirs.name, &theirs.unit, theirs.sample_rate_hz)
                );
            }
            assert_eq!(
                (read.time, &read.properties["title"]),
                (Some(0), &layout.properties["title"])
            );
        }
        // Dropped without an end, a recording leaves the old file and nothing else.
        create(&path, &layout).unwrap().write(&block).unwrap();
        assert!(open(&path).is_ok());
        assert_eq!(
            std::fs::read_dir(path.parent().unwrap()).unwrap().count(),
            1
        );
    }
    for name in ["empty.npy", "empty.npz"] {
        let path = scratch("numpy_empty").join(name);
        create(&path, &layout).unwrap().finish().unwrap();
        assert_eq!(
            rows(open(&path).unwrap().as_mut(), 5).unwrap(),
            vec![Vec::<f64>::new(); 3]
        );
    }
}

#[test]
fn inv_damaged_files_end_in_an_error_or_in_numbers() {
    let bad = scratch("numpy_damage");
    for name in ["c_order.npy", "fortran_big.npy", "record.npy"] {
        damage(&folder("numpy").join(name), &bad.join(name));
    }
    for name in ["stored.npz", "deflated.npz"] {
        damage(&folder("numpy").join(name), &bad.join(name));
    }
}

#[test]
fn inv_a_flipped_sample_in_an_npz_is_noticed() {
    let bytes = std::fs::read(folder("numpy").join("stored.npz")).unwrap();
    let path = scratch("numpy_flip").join("file.npz");
    // The samples of the first member begin at a multiple of 64 behind its NumPy magic.
    let magic = bytes.windows(6).position(|w| w == b"\x93NUMPY").unwrap();
    let mut flipped = bytes.clone();
    flipped[magic + 128 + 9] ^= 1;
    std::fs::write(&path, &flipped).unwrap();
    let mut source = open(&path).unwrap();
    source.select(&[0]).unwrap();
    let error = rows(source.as_mut(), 5).unwrap_err().to_string();
    assert!(error.contains("member t: its checksum is wrong"), "{error}");
    // In Fortran order too, though its columns are read apart.
    let gyro = source.layout().position("gyro_2").unwrap();
    let name = bytes.windows(8).position(|w| w == b"gyro.npy").unwrap();
    let magic = name
        + bytes[name..]
            .windows(6)
            .position(|w| w == b"\x93NUMPY")
            .unwrap();
    let mut flipped = bytes.clone();
    flipped[magic + 128 + 9] ^= 1;
    std::fs::write(&path, &flipped).unwrap();
    let mut source = open(&path).unwrap();
    source.select(&[gyro]).unwrap();
    let error = rows(source.as_mut(), 5).unwrap_err().to_string();
    assert!(
        error.contains("member gyro: its checksum is wrong"),
        "{error}"
    );
}

#[test]
fn inv_lengths_must_agree() {
    let (layout, block) = recording();
    let path = scratch("numpy_lengths").join("file.npy");
    let mut sink = create(&path, &layout).unwrap();
    sink.write(&block).unwrap();
    sink.finish().unwrap();
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 8]).unwrap();
    assert!(matches!(open(&path), Err(Error::Malformed { .. })));
    std::fs::write(&path, [bytes.as_slice(), b"more"].concat()).unwrap();
    assert!(matches!(open(&path), Err(Error::Malformed { .. })));
}

/// Where a clock is missing, it is said that there was one and what to do.
#[test]
fn neg_a_clock_of_dates_is_told() {
    let path = scratch("numpy_dates").join("day.npz");
    let mut file = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
    for (member, from) in [("Time.npy", "dates.npy"), ("u1.npy", "vector.npy")] {
        let options = zip::write::SimpleFileOptions::default();
        file.start_file(member, options).unwrap();
        let bytes = std::fs::read(folder("numpy").join(from)).unwrap();
        file.write_all(&bytes).unwrap();
    }
    file.finish().unwrap();
    let source = open(&path).unwrap();
    let unread = source.layout().unread_clock();
    assert!(
        unread.starts_with(" (Time is not read: dates or spans; save seconds"),
        "{unread}"
    );
    assert_eq!(recording().0.unread_clock(), "");
}
