//! TDMS: files of other software, hostile files, and the way there and back.

use std::fs;
use std::path::{Path, PathBuf};

use crate::expected::{folder, rows};
use sixaxis_recordings::ingest::columns::Columns;
use sixaxis_recordings::ingest::find::Column;
use sixaxis_recordings::inspect::inspect;
use sixaxis_recordings::{Block, Channel, Error, Layout, Source, create, open};

/// Each limit for one read; block sizes must not change the values.
const LIMITS: [usize; 4] = [1, 7, 1000, usize::MAX];
/// npTDMS gives the step, the rate is its reciprocal: two roundings.
const RATE_TOLERANCE: f64 = 2.0 * f64::EPSILON;

fn scratch(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("sixaxis_tdms_{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

fn foreign(name: &str) -> Box<dyn Source> {
    open(&folder("tdms").join(name)).unwrap()
}

fn read_all(source: &mut dyn Source, channels: &[usize], limit: usize) -> Vec<Vec<f64>> {
    source.select(channels).unwrap();
    let all = rows(source, limit).unwrap();
    assert_eq!(all.len(), channels.len());
    all
}

/// Bit for bit, any NaN being as good as another.
fn same(a: &[f64], b: &[f64]) -> bool {
    let pairs = a.iter().zip(b);
    a.len() == b.len()
        && pairs.fold(true, |ok, (a, b)| {
            ok && (a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
        })
}

/// A channel as npTDMS has it.
struct Expected {
    name: String,
    unit: Option<String>,
    rate: Option<f64>,
    offset: f64,
    values: Vec<f64>,
}

fn expected(path: &Path) -> Vec<Expected> {
    let text = fs::read_to_string(path).unwrap();
    let filled = |field: &str| (field != "-").then(|| field.to_owned());
    text.lines()
        .map(|line| {
            let fields: Vec<&str> = line.split('\t').collect();
            let [name, unit, rate, offset, values] = fields[..] else {
                panic!("{line}")
            };
            Expected {
                name: name.to_owned(),
                unit: filled(unit),
                rate: filled(rate).map(|rate| rate.parse().unwrap()),
                offset: offset.parse().unwrap(),
                values: filled(values)
                    .map(|values| values.split(' ').map(|v| v.parse().unwrap()).collect())
                    .unwrap_or_default(),
            }
        })
        .collect()
}

#[test]
fn ref_nptdms_reads_the_same() {
    let mut files = 0;
    for entry in fs::read_dir(folder("tdms")).unwrap() {
        let path = entry.unwrap().path();
        if path
            .extension()
            .is_none_or(|extension| extension != "expected")
        {
            continue;
        }
        files += 1;
        let mut source = open(&path.with_extension("tdms")).unwrap();
        let layout = source.layout().clone();
        let expected = expected(&path);
        if path.file_stem().unwrap() != "refused" {
            let names = |names: &mut Vec<String>| names.sort();
            let mut read: Vec<String> = layout.channels.iter().map(|c| c.name.clone()).collect();
            let mut known: Vec<String> = expected.iter().map(|e| e.name.clone()).collect();
            names(&mut read);
            names(&mut known);
            assert_eq!(read, known, "{}", path.display());
        }
        for known in &expected {
            let at = layout.position(&known.name).unwrap();
            let channel = &layout.channels[at];
            let context = format!("{} {}", path.display(), known.name);
            assert_eq!(channel.unit, known.unit, "{context}");
            assert_eq!(
                channel.samples,
                Some(known.values.len() as u64),
                "{context}"
            );
            assert_eq!(channel.start_offset_s, known.offset, "{context}");
            assert_eq!(
                channel.sample_rate_hz.is_some(),
                known.rate.is_some(),
                "{context}"
            );
            if let (Some(read), Some(known)) = (channel.sample_rate_hz, known.rate) {
                assert!(
                    (read / known - 1.0).abs() <= RATE_TOLERANCE,
                    "{context}: {read} {known}"
                );
            }
            for limit in LIMITS {
                let read = read_all(&mut *source, &[at], limit);
                assert!(
                    same(&read[0], &known.values),
                    "{context}: {:?} {:?}",
                    read[0],
                    known.values
                );
            }
            // With all channels of the same length, last one first, and one of them twice.
            let length = |at: usize| layout.channels[at].samples;
            let mut together: Vec<&Expected> = expected
                .iter()
                .filter(|e| e.values.len() == known.values.len())
                .collect();
            together.reverse();
            together.push(known);
            let selection: Vec<usize> = together
                .iter()
                .map(|e| layout.position(&e.name).unwrap())
                .collect();
            assert!(selection.iter().all(|&other| length(other) == length(at)));
            for limit in LIMITS {
                let read = read_all(&mut *source, &selection, limit);
                for (read, known) in read.iter().zip(&together) {
                    assert!(same(read, &known.values), "{context} with {}", known.name);
                }
            }
        }
    }
    assert!(files >= 19, "{files} files");
}

#[test]
fn ref_what_was_cut_off_is_said() {
    for (name, incomplete) in [
        ("interleaved.tdms", false),
        ("interleaved_cut.tdms", true),
        ("cut_in_last_channel.tdms", true),
        ("cut_in_first_channel.tdms", true),
        ("cut_in_lead_in.tdms", true),
        ("cut_in_metadata.tdms", true),
        ("length_unknown.tdms", true),
        ("short_last_chunk.tdms", false),
    ] {
        let source = foreign(name);
        let said = source.layout().properties.get("incomplete_last_segment");
        assert_eq!(
            said.map(String::as_str),
            incomplete.then_some("true"),
            "{name}"
        );
    }
}

#[test]
fn ref_properties_of_file_group_and_channel() {
    let source = foreign("written_by_nptdms.tdms");
    let layout = source.layout();
    assert_eq!(layout.format, "TDMS");
    for (name, value) in [
        ("title", "Bench 2, slow"),
        ("serial", "17"),
        ("gain", "0.1"),
        ("it's a 'group'/room", "B 12"),
        ("channels_left_out", "notes/texts (text)"),
        // npTDMS cuts the binary fraction of the microseconds.
        ("wf_start_time", "2024-02-29T12:34:56.789011999Z"),
    ] {
        assert_eq!(
            layout.properties.get(name).map(String::as_str),
            Some(value),
            "{name}"
        );
    }
    let source = foreign("types_big_endian.tdms");
    let properties = &source.layout().properties;
    assert_eq!(properties["start"], "2024-05-31T11:33:20.500000000Z");
    assert_eq!(properties["types/84/first_timestamp"], properties["start"]);
    assert_eq!(source.layout().time, source.layout().position("types/84"));
}

#[test]
fn ref_scales_not_understood_are_never_raw_counts() {
    let mut source = foreign("refused.tdms");
    let layout = source.layout().clone();
    let mut block = Block::default();
    for (name, words) in [
        ("g/temperature", "RTD"),
        ("g/circle", "chain"),
        ("g/no_intercept", "NI_Scale[0]_Linear_Y_Intercept"),
        ("g/unknown", "Novel"),
    ] {
        let error = source
            .select(&[layout.position(name).unwrap()])
            .unwrap_err();
        assert!(matches!(error, Error::Unsupported { .. }), "{error}");
        assert!(
            error.to_string().contains(words) && error.to_string().contains(name),
            "{error}"
        );
        assert!(layout.properties["channels_not_readable"].contains(name));
    }
    let error = source.read(&mut block, 10).unwrap_err();
    assert!(matches!(error, Error::Unsupported { .. }), "{error}");
}

#[test]
fn inv_selections_that_do_not_fit_are_refused() {
    let mut source = foreign("object_lists.tdms");
    let layout = source.layout().clone();
    let at = |name| layout.position(name).unwrap();
    let error = source.select(&[at("g/a"), at("g/b")]).unwrap_err();
    assert!(matches!(error, Error::LengthMismatch { .. }), "{error}");
    let error = source.select(&[99]).unwrap_err();
    assert!(matches!(error, Error::NoSuchChannel { .. }), "{error}");
    assert!(source.read(&mut Block::default(), 1).is_err());
}

/// Reads whatever can be read; every answer must have the right shape.
fn survive(path: &Path) {
    let Ok(mut source) = open(path) else { return };
    let layout = source.layout().clone();
    let mut block = Block::default();
    for at in 0..layout.channels.len().min(20) {
        if source.select(&[at]).is_err() {
            continue;
        }
        let samples = layout.channels[at].samples.unwrap();
        assert!(samples <= fs::metadata(path).unwrap().len());
        let mut read = 0;
        while let Ok(rows) = source.read(&mut block, 100) {
            assert!(rows <= 100 && block.columns.len() == 1 && block.columns[0].len() == rows);
            read += rows as u64;
            if rows == 0 {
                assert_eq!(read, samples);
                break;
            }
        }
    }
    let all: Vec<usize> = (0..layout.channels.len()).collect();
    if source.select(&all).is_ok() {
        while source.read(&mut block, 50).is_ok_and(|rows| rows > 0) {}
    }
}

const HOSTILE: [&str; 9] = [
    "written_by_nptdms.tdms",
    "interleaved.tdms",
    "types_big_endian.tdms",
    "object_lists.tdms",
    "cut_in_last_channel.tdms",
    "short_last_chunk.tdms",
    "scales.tdms",
    "daqmx_two_devices.tdms",
    "daqmx_lines.tdms",
];

#[test]
fn inv_cut_files_never_panic() {
    for name in HOSTILE {
        let bytes = fs::read(folder("tdms").join(name)).unwrap();
        let path = scratch(&format!("cut_{name}"));
        for length in (0..bytes.len()).step_by(bytes.len() / 700 + 1) {
            fs::write(&path, &bytes[..length]).unwrap();
            survive(&path);
        }
        fs::remove_file(path).unwrap();
    }
}

#[test]
fn inv_flipped_bytes_never_panic() {
    // xorshift, so that a failure comes again.
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    for name in HOSTILE {
        let good = fs::read(folder("tdms").join(name)).unwrap();
        let path = scratch(&format!("flipped_{name}"));
        for _ in 0..700 {
            let mut bytes = good.clone();
            for _ in 0..=random() % 3 {
                let at = (random() % good.len() as u64) as usize;
                bytes[at] = match random() % 4 {
                    0 => 0xFF,
                    1 => 0,
                    2 => 0x80,
                    _ => bytes[at] ^ (1 << (random() % 8)),
                };
            }
            fs::write(&path, &bytes).unwrap();
            survive(&path);
        }
        fs::remove_file(path).unwrap();
    }
}

/// A program that draws by `wf_start_offset` puts the first row where its time stamp is.
#[test]
fn inv_the_first_time_stamp_is_where_channels_begin() {
    let path = scratch("late.tdms");
    let mut layout = channels();
    layout.channels[1].sample_rate_hz = Some(49.0);
    layout.time = Some(2);
    let mut sink = create(&path, &layout).unwrap();
    let columns = vec![vec![1.0, 2.0], vec![3.0, 4.0], vec![12.5, 12.6]];
    sink.write(&Block { columns }).unwrap();
    sink.finish().unwrap();
    let read = open(&path).unwrap().layout().clone();
    let offsets = read.channels.iter().map(|c| c.start_offset_s);
    assert_eq!(offsets.collect::<Vec<_>>(), [0.125, 12.5, 0.0]);
    fs::remove_file(path).unwrap();
}

/// More rows than one segment takes.
const ROWS: usize = 150_001;

fn channels() -> Layout {
    let mut voltage = Channel::new("strain gauges/u1", Some("mV/V"));
    voltage.sample_rate_hz = Some(49.0);
    voltage.start_offset_s = 0.125;
    let mut layout = Layout {
        channels: vec![
            voltage,
            Channel::new("it's/a/b", None),
            Channel::new("recording/time", Some("s")),
        ],
        ..Layout::default()
    };
    layout.properties.insert("title".into(), "Ü 1".into());
    layout.properties.insert(
        "wf_start_time".into(),
        "2026-01-31T23:59:59.000000001Z".into(),
    );
    layout
}

fn columns(from: usize, to: usize) -> Block {
    let column = |f: &dyn Fn(f64) -> f64| (from..to).map(|i| f(i as f64)).collect();
    Block {
        columns: vec![
            column(&|i| (0.1 * i).sin()),
            column(&|i| 1.0 / i - i),
            column(&|i| 1e-4 * i),
        ],
    }
}

#[test]
fn inv_what_is_written_is_read() {
    let path = scratch("round.tdms");
    let layout = channels();
    for rows in [0, 1, 65_536, 131_072, ROWS] {
        let mut sink = create(&path, &layout).unwrap();
        let mut done = 0;
        for step in [1, 65_535, 10, 70_000, ROWS].into_iter().cycle() {
            let end = rows.min(done + step);
            sink.write(&columns(done, end)).unwrap();
            done = end;
            if done == rows {
                break;
            }
        }
        assert!(sink.write(&Block::new(2)).is_err());
        sink.finish().unwrap();
        let mut source = open(&path).unwrap();
        let read = source.layout().clone();
        for (read, written) in read.channels.iter().zip(&layout.channels) {
            assert_eq!(read.samples, Some(rows as u64));
            assert_eq!((&read.name, &read.unit), (&written.name, &written.unit));
            assert_eq!(
                (read.sample_rate_hz, read.start_offset_s),
                (written.sample_rate_hz, written.start_offset_s)
            );
        }
        assert_eq!(read.time, Some(2));
        assert_eq!(read.properties["title"], "Ü 1");
        assert_eq!(
            read.properties["wf_start_time"],
            "2026-01-31T23:59:59.000000001Z"
        );
        assert!(!read.properties.contains_key("incomplete_last_segment"));
        let known = columns(0, rows);
        for (read, known) in read_all(&mut *source, &[0, 1, 2], 4096)
            .iter()
            .zip(&known.columns)
        {
            assert!(same(read, known), "{rows} rows");
        }
    }
    fs::remove_file(path).unwrap();
}

#[test]
fn inv_a_recording_given_up_leaves_no_trace() {
    let path = scratch("given_up/x.tdms");
    let mut sink = create(&path, &channels()).unwrap();
    sink.write(&columns(0, 10)).unwrap();
    drop(sink);
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 0);
}

#[test]
fn inv_equal_names_are_refused() {
    let mut layout = channels();
    layout.channels.push(Channel::new("time", None));
    let error = create(&scratch("equal.tdms"), &layout).err().unwrap();
    assert!(matches!(error, Error::Unsupported { .. }), "{error}");
}

/// A file of one channel that begins at a time, counting up from a number in steps of one.
fn counting(name: &str, start: &str, first: usize, rows: usize) -> Vec<u8> {
    let path = scratch("counting.tdms");
    let mut layout = Layout {
        channels: vec![Channel {
            sample_rate_hz: Some(1000.0),
            ..Channel::new(name, Some("V"))
        }],
        ..Layout::default()
    };
    layout
        .properties
        .insert("wf_start_time".into(), start.into());
    let mut sink = create(&path, &layout).unwrap();
    let column = (first..first + rows).map(|i| i as f64).collect();
    sink.write(&Block {
        columns: vec![column],
    })
    .unwrap();
    sink.finish().unwrap();
    let bytes = fs::read(&path).unwrap();
    fs::remove_file(path).unwrap();
    bytes
}

/// Two groups that begin at different times, of different lengths, as `calibrate` and `decouple` read them.
fn side_by_side(early: &str, late: &str) -> Result<Vec<Vec<f64>>, Error> {
    let path = scratch(&format!("starts_{}.tdms", late.replace(':', "-")));
    // Segments of one file follow those of another.
    let mut bytes = counting("a/u", early, 0, 150_000);
    bytes.extend(counting("b/v", late, 70_300, 60_000));
    fs::write(&path, bytes).unwrap();
    let source = open(&path).unwrap();
    let wanted = [0, 1].map(|at| Column::new(source.layout(), at, 1.0));
    let read = || {
        let mut columns = Columns::new(&path, source, wanted.to_vec(), None, None)?;
        let mut all = vec![Vec::new(); 2];
        while columns.read(4096)? > 0 {
            for (k, all) in all.iter_mut().enumerate() {
                all.extend_from_slice(columns.column(k));
            }
        }
        Ok(all)
    };
    let read = read();
    let inspection = inspect(&path, None, &mut |_, _| {}).unwrap();
    let samples: Vec<u64> = inspection.groups.iter().map(|g| g.samples).collect();
    assert_eq!(
        samples,
        [150_000, 60_000],
        "what is in the file is shown whole"
    );
    fs::remove_file(path).unwrap();
    read
}

#[test]
fn inv_groups_are_aligned_by_their_start_times() {
    let early = "2026-01-31T10:00:00.000000000Z";
    let read = side_by_side(early, "2026-01-31T10:01:10.300000000Z").unwrap();
    assert_eq!(read[0].len(), 60_000);
    assert_eq!(read[0], read[1]);
    assert_eq!(read[0][0], 70_300.0);
    let error = side_by_side(early, "2026-01-31T10:01:10.300400000Z").unwrap_err();
    let said = error.to_string();
    for words in [
        "\"a/u\" begins 70.3004 s before \"b/v\"",
        "no whole number of samples",
    ] {
        assert!(said.contains(words), "{said}");
    }
    let error = side_by_side(early, "2026-01-31T11:00:00.000000000Z").unwrap_err();
    assert!(error.to_string().contains("ends before"), "{error}");
}

#[test]
fn inv_a_cut_file_is_read_and_said_to_be_cut() {
    let bytes = counting("a/u", "2026-01-31T10:00:00.000000000Z", 0, 1000);
    let path = scratch("cut.tdms");
    for (length, cut) in [(bytes.len(), false), (bytes.len() - 4001, true)] {
        fs::write(&path, &bytes[..length]).unwrap();
        let mut source = open(&path).unwrap();
        assert_eq!(source.layout().cut.is_some(), cut);
        let samples = read_all(&mut *source, &[0], 4096)[0].len();
        assert_eq!(samples, if cut { 499 } else { 1000 });
        let inspection = inspect(&path, None, &mut |_, _| {}).unwrap();
        let noticed = inspection.facts.iter().any(|fact| fact.kind == "cut");
        assert_eq!(noticed, cut);
    }
    fs::remove_file(path).unwrap();
}
