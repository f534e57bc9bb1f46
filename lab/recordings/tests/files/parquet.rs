//! Parquet: files of pyarrow and pandas, our own, and broken ones.

use std::fs;
use std::path::{Path, PathBuf};

use crate::expected::{bits, corrupted, folder, rows};
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use sixaxis_recordings::error::{Error, Place};
use sixaxis_recordings::{Block, Channel, Layout, create, open, parquet};

fn own(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("parquet");
    fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

fn expected(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let headings: Vec<_> = lines
        .next()
        .unwrap()
        .split(',')
        .map(str::to_owned)
        .collect();
    let mut columns = vec![Vec::new(); headings.len()];
    for line in lines {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            column.push(cell.parse().unwrap());
        }
    }
    (headings, columns)
}

#[test]
fn ref_what_pyarrow_reads_is_read() {
    let mut compared = 0;
    for entry in fs::read_dir(folder("parquet")).unwrap() {
        let table = entry.unwrap().path();
        if table.extension().is_none_or(|e| e != "csv") {
            continue;
        }
        let path = table.with_extension("parquet");
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let (headings, columns) = expected(&table);
        let mut source = open(&path).unwrap_or_else(|e| panic!("{e}"));
        let channels = &source.layout().channels;
        assert_eq!(channels.len(), headings.len(), "{name}");
        for (channel, heading) in channels.iter().zip(&headings) {
            let written = Channel::from_heading(heading);
            assert_eq!(channel.name, written.name, "{name}");
            if written.unit.is_some() && written.name != "stamp" {
                assert_eq!(channel.unit, written.unit, "{name}");
            }
            assert_eq!(channel.samples, Some(columns[0].len() as u64), "{name}");
        }
        for limit in [1, 7, 1000, usize::MAX] {
            let read = rows(source.as_mut(), limit).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(bits(&read), bits(&columns), "{name}");
            let all: Vec<_> = (0..columns.len()).collect();
            source.select(&all).unwrap();
        }
        // The last channel alone, then the first twice over.
        let last = columns.len() - 1;
        source.select(&[last]).unwrap();
        let read = rows(source.as_mut(), 13).unwrap();
        assert_eq!(bits(&read), bits(&columns[last..]), "{name}");
        source.select(&[0, last, 0]).unwrap();
        let read = rows(source.as_mut(), 13).unwrap();
        assert_eq!(bits(&read[2..]), bits(&columns[..1]), "{name}");
        compared += 1;
    }
    assert!(compared >= 15, "{compared} files compared");
}

#[test]
fn what_the_metadata_say_is_in_the_layout() {
    let source = open(&folder("parquet").join("described.parquet")).unwrap();
    let layout = source.layout();
    assert_eq!(layout.time, Some(0));
    assert_eq!(layout.channels[1].heading(), "u1 [mV]");
    for name in ["f", "f (x)", "f ()", "f []"] {
        let channel = Channel::new(name, None);
        assert_eq!(Channel::from_heading(&channel.heading()), channel);
    }
    assert_eq!(layout.channels[2].unit.as_deref(), Some("V"));
    assert_eq!(layout.channels[1].sample_rate_hz, Some(1000.0));
    assert_eq!(layout.channels[3].sample_rate_hz, Some(500.0));
    assert_eq!(layout.properties["title"], "Näherung");
    assert_eq!(layout.properties.len(), 1, "{:?}", layout.properties);

    let source = open(&folder("parquet").join("stamps.parquet")).unwrap();
    assert!(
        source
            .layout()
            .channels
            .iter()
            .all(|c| c.unit.as_deref() == Some("s"))
    );
    let began = |name: &str| &source.layout().properties[&format!("{name}/first_timestamp")];
    for name in ["stamp_ms", "stamp_us", "stamp_ns"] {
        assert_eq!(began(name), "2026-03-01T12:00:00.000000000");
    }
    assert_eq!(began("stamp_utc"), "2026-03-01T12:00:00.000000000Z");
    assert_eq!(source.layout().properties.len(), 4);

    let source = open(&folder("parquet").join("durations.parquet")).unwrap();
    let units: Vec<_> = source
        .layout()
        .channels
        .iter()
        .map(|c| c.unit.as_deref())
        .collect();
    assert_eq!(
        units,
        [
            Some("s"),
            Some("s"),
            Some("s"),
            Some("s"),
            Some("s"),
            Some("N")
        ]
    );

    let source = open(&folder("parquet").join("mixed.parquet")).unwrap();
    let left_out = &source.layout().properties[parquet::LEFT_OUT];
    for name in ["list", "point.x", "text", "price", "day"] {
        assert!(left_out.contains(name), "{left_out}");
    }
}

#[test]
fn what_is_not_understood_is_refused_with_advice() {
    let mut source = open(&folder("parquet").join("holes.parquet")).unwrap();
    match rows(source.as_mut(), 7).unwrap_err() {
        Error::Malformed { place, cause, .. } => {
            assert_eq!(place, Place::Sample(73));
            assert!(cause.contains("\"u2\""), "{cause}");
        }
        other => panic!("{other}"),
    }
    // What was read of the other channel must not come out against the wrong rows.
    assert!(source.read(&mut Block::default(), 7).is_err());
    source.select(&[0]).unwrap();
    assert_eq!(rows(source.as_mut(), 7).unwrap()[0].len(), 100);

    let mut source = open(&folder("parquet").join("codec_brotli.parquet")).unwrap();
    match rows(source.as_mut(), 7).unwrap_err() {
        Error::Unsupported {
            feature, advice, ..
        } => {
            assert!(
                feature.contains("BROTLI") && advice.contains("snappy"),
                "{feature}; {advice}"
            );
        }
        other => panic!("{other}"),
    }
    let text_only = open(&folder("parquet").join("no_numbers.parquet"))
        .err()
        .unwrap();
    assert!(
        matches!(text_only, Error::Unsupported { .. }),
        "{text_only}"
    );
    assert!(matches!(
        source.select(&[4]).unwrap_err(),
        Error::NoSuchChannel { .. }
    ));
}

fn example() -> (Layout, Vec<Vec<f64>>) {
    let rows = 140_000;
    let mut layout = Layout::default();
    for (name, unit) in [
        ("u1", Some("mV")),
        ("odd (name)", Some("m/s^2")),
        ("n (raw)", None),
    ] {
        layout.channels.push(Channel {
            sample_rate_hz: Some(2560.0),
            samples: Some(rows as u64),
            ..Channel::new(name, unit)
        });
    }
    layout.channels[2].start_offset_s = 0.25;
    layout.properties.insert("author".into(), "Łukasz".into());
    let mut columns = vec![Vec::new(); 3];
    for i in 0..rows {
        columns[0].push((i as f64 * 0.1).sin());
        columns[1].push(f64::from_bits(
            (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15),
        ));
        columns[2].push(i as f64);
    }
    columns[0][5] = f64::NAN;
    columns[0][6] = -0.0;
    (layout, columns)
}

fn write(path: &Path, layout: &Layout, columns: &[Vec<f64>], piece: usize) {
    let mut sink = create(path, layout).unwrap();
    let rows = columns[0].len();
    for from in (0..rows).step_by(piece) {
        let to = rows.min(from + piece);
        sink.write(&Block {
            columns: columns.iter().map(|c| c[from..to].to_vec()).collect(),
        })
        .unwrap();
    }
    sink.finish().unwrap();
}

#[test]
fn inv_what_is_written_is_read() {
    let (layout, columns) = example();
    let path = own("round.parquet");
    for piece in [1 << 20, 999] {
        write(&path, &layout, &columns, piece);
        let mut source = open(&path).unwrap();
        assert_eq!(source.layout().channels, layout.channels);
        assert_eq!(source.layout().properties, layout.properties);
        let read = rows(source.as_mut(), 10_000).unwrap();
        for (read, written) in read.iter().zip(&columns) {
            assert!(
                read.iter()
                    .map(|v| v.to_bits())
                    .eq(written.iter().map(|v| v.to_bits()))
            );
        }
    }
}

#[test]
fn a_file_not_finished_leaves_no_trace() {
    let (layout, columns) = example();
    let path = own("unfinished/file.parquet");
    let _ = fs::remove_dir_all(path.parent().unwrap());
    let mut sink = create(&path, &layout).unwrap();
    sink.write(&Block {
        columns: columns.clone(),
    })
    .unwrap();
    let ragged = Block {
        columns: vec![vec![1.0], vec![], vec![1.0]],
    };
    let error = sink.write(&ragged).unwrap_err();
    assert!(matches!(error, Error::Malformed { .. }), "{error}");
    drop(sink);
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 0);
}

/// Reads a broken file to its end. Either is refused, or gives columns of the length that its layout announces.
fn survive(path: &Path, bytes: &[u8]) {
    fs::write(path, bytes).unwrap();
    let Ok(mut source) = open(path) else {
        return;
    };
    if let Ok(columns) = rows(source.as_mut(), 64) {
        for (column, channel) in columns.iter().zip(&source.layout().channels) {
            assert_eq!(Some(column.len() as u64), channel.samples);
        }
    }
}

#[test]
fn broken_files_are_survived() {
    let path = own("broken.parquet");
    for name in [
        "codec_snappy",
        "codec_zstd",
        "codec_gzip",
        "codec_lz4",
        "pages_v2_zstd",
        "numbers",
        "encodings",
        "stamps",
    ] {
        let good = fs::read(folder("parquet").join(name).with_extension("parquet")).unwrap();
        corrupted(&good, |bytes| survive(&path, bytes));
    }
}

/// Names of the columns in the file, and what is read of a copy of it without the metadata.
fn copied(channels: &[(&str, Option<&str>)]) -> (Vec<String>, Vec<Channel>) {
    let written = channels
        .iter()
        .map(|(name, unit)| Channel::new(*name, *unit));
    let layout = Layout {
        channels: written.collect(),
        ..Layout::default()
    };
    let path = own("names.parquet");
    write(&path, &layout, &vec![vec![1.0]; channels.len()], 1);
    let read = open(&path).unwrap().layout().channels.clone();
    let read = read.iter().map(|c| (c.name.as_str(), c.unit.as_deref()));
    assert_eq!(read.collect::<Vec<_>>(), channels);
    let file = SerializedFileReader::new(fs::File::open(&path).unwrap()).unwrap();
    let schema = file.metadata().file_metadata().schema_descr();
    let columns = schema.columns().iter();
    let names: Vec<String> = columns.map(|c| c.name().to_owned()).collect();
    let bare = Layout {
        channels: names
            .iter()
            .map(|name| Channel::new(name.clone(), None))
            .collect(),
        ..Layout::default()
    };
    // A column called by its bare name needs no heading in the metadata.
    write(&path, &bare, &vec![vec![1.0]; channels.len()], 1);
    (names, open(&path).unwrap().layout().channels.clone())
}

#[test]
fn inv_columns_are_called_without_blanks_and_brackets() {
    let channels = [
        ("time", Some("s")),
        ("ax", Some("m/s^2")),
        ("alpha_x", Some("rad/s^2")),
        ("wx", Some("rad/s")),
        ("qw", Some("1")),
        ("rig/u 1", Some("mV")),
        ("rig_u_1", Some("mV")),
        ("(x)", Some("°/s")),
        ("1", None),
        ("-", None),
    ];
    let (names, copied) = copied(&channels);
    assert_eq!(
        names,
        [
            "time_s",
            "ax_m_s2",
            "alpha_x_rad_s2",
            "wx_rad_s",
            "qw",
            "rig_u_1_mV",
            "rig_u_1_mV_2",
            "x_deg_s",
            "column_1",
            "column_10",
        ]
    );
    let units: Vec<Option<&str>> = copied.iter().map(|c| c.unit.as_deref()).collect();
    assert_eq!(
        units[..5],
        [
            Some("s"),
            Some("m/s^2"),
            Some("rad/s^2"),
            Some("rad/s"),
            None
        ]
    );
    let layout = Layout {
        channels: copied,
        ..Layout::default()
    };
    for (at, name) in ["time", "ax", "alpha_x", "wx", "qw"]
        .into_iter()
        .enumerate()
    {
        assert_eq!(layout.position(name), Some(at), "{name}");
    }
}
