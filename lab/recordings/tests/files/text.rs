//! Files of text: those of other software, our own, ambiguous ones, damaged ones.

use crate::expected::{bits, check, damage, folder, rows, scratch};
use sixaxis_recordings::{Block, Channel, Error, Layout, create, open};

#[test]
fn ref_pandas_numpy_and_lvm_read_agree() {
    assert!(check("text") >= 25);
}

/// Opens a text and reads it all.
fn read(name: &str, text: &[u8]) -> Result<(Layout, Vec<Vec<f64>>), Error> {
    let path = scratch(&format!("text_{name}")).join("file.csv");
    std::fs::write(&path, text).unwrap();
    let mut source = open(&path)?;
    let columns = rows(source.as_mut(), 3)?;
    Ok((source.layout().clone(), columns))
}

#[test]
fn inv_dialects_are_told_apart() {
    for (name, text, format, columns) in [
        (
            "comma",
            "1,5\n2,5\n",
            "CSV (comma)",
            vec![vec![1.0, 2.0], vec![5.0, 5.0]],
        ),
        (
            "semicolon",
            "1,5;2\n",
            "CSV (semicolon, decimal comma)",
            vec![vec![1.5], vec![2.0]],
        ),
        (
            "blanks",
            " 1,5  2\n3 4\n",
            "CSV (blanks, decimal comma)",
            vec![vec![1.5, 3.0], vec![2.0, 4.0]],
        ),
        (
            "quoted",
            "\"u1\",\"u2\"\n\"0\",\"0,0042\"\n\"1,5\",\"-2,125\"\n",
            "CSV (comma, decimal comma)",
            vec![vec![0.0, 1.5], vec![0.0042, -2.125]],
        ),
        (
            "padded",
            "1, 2\n3, 4\n",
            "CSV (comma)",
            vec![vec![1.0, 3.0], vec![2.0, 4.0]],
        ),
        (
            "tab",
            "1\t2\r\n\r\n3\t4",
            "CSV (tab)",
            vec![vec![1.0, 3.0], vec![2.0, 4.0]],
        ),
        (
            "one",
            "1.5\n-inf\n",
            "CSV (one column)",
            vec![vec![1.5, f64::NEG_INFINITY]],
        ),
        (
            "point",
            "1.234;5\n",
            "CSV (semicolon)",
            vec![vec![1.234], vec![5.0]],
        ),
        ("names", "a;b\n", "CSV (semicolon)", vec![vec![], vec![]]),
    ] {
        let (layout, read) = read(name, text.as_bytes()).unwrap();
        assert_eq!(layout.format, format);
        assert_eq!(read, columns, "{name}");
    }
    // Whole numbers say nothing of the sign; the first one met does.
    let mut late = "1;2\n".repeat(200);
    late += "1,5;2\n";
    assert_eq!(read("late", late.as_bytes()).unwrap().1[0][200], 1.5);
    late += "1.5;2\n";
    let error = read("late", late.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("line 202, column 1"), "{error}");
}

#[test]
fn inv_what_is_not_understood_is_refused_with_its_place() {
    for (name, text, message) in [
        ("empty", &b""[..], "no line with numbers"),
        (
            "empty_cell",
            b"a,b\n1,2\n1,\n",
            "line 3, column 2: an empty cell",
        ),
        (
            "word",
            b"a,b\n1,2\n3,4\nx,5\n",
            "line 4, column 1: \"x\" is not a number",
        ),
        ("missing", b"a,b\nNA,NA\n1,2\n", "line 2, column 1"),
        (
            "first_row",
            b"1.5,x,2.5\n1,2,3\n4,5,6\n",
            "line 1, column 2",
        ),
        (
            "ragged",
            b"a,b\n1,2\n1,2\n1,2\n1,2,3\n",
            "line 5: 3 columns, 2 were expected",
        ),
        ("short", b"1;2\n1;2\n1;2\n1;2\n1\n", "line 5: 1 columns"),
        (
            "comma_twice",
            b"a,b\n1,5,2,5\n2,5,3,5\n",
            "save the file with semicolons",
        ),
        (
            "preamble",
            b"Recorder 7\na,b,c,d\n1,2,3,4\n2,3,4,5\n",
            "are to begin with #",
        ),
        (
            "thousands",
            b"a;b\n1.234,5;1\n2.345,5;2\n3,5;1\n",
            "line 2, column 1",
        ),
        (
            "quoted_thousands",
            b"a,b\n\"1,500\",2\n3,4\n",
            "line 2, column 1",
        ),
        (
            "open_quote",
            b"a,b\n1,2\n1,2\n1,2\n1,\"2\n",
            "line 5: a quote",
        ),
        ("utf16", b"\xff\xfe1\x00,\x002\x00", "UTF-16"),
        ("zeros", b"1,2\n\0\0\0\0", "byte 4: a zero byte"),
        (
            "rate",
            b"# sample_rate_hz = fast\n1,2\n",
            "line 1: sample_rate_hz",
        ),
        ("prose", b"Model: A\nDate: B\nSerial: C\n\n1,2\n", "line"),
    ] {
        let error = read(name, text).unwrap_err().to_string();
        assert!(error.contains(message), "{name}: {error}");
    }
    let wide = format!("{}1\n", "1,".repeat(4096));
    let error = read("wide", wide.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("4097 columns"), "{error}");
    let endless = vec![b'1'; 3 << 20];
    assert!(matches!(
        read("endless", &endless),
        Err(Error::Malformed { .. })
    ));
}

#[test]
fn inv_text_may_stand_in_a_channel_that_is_not_selected() {
    let path = scratch("text_dates").join("file.csv");
    std::fs::write(&path, "when,u\nMonday,1.5\nTuesday,2.5\n").unwrap();
    let mut source = open(&path).unwrap();
    assert!(source.read(&mut Block::default(), 1).is_err());
    assert!(
        source.read(&mut Block::default(), 1).is_err(),
        "not past the row that failed"
    );
    source.select(&[1]).unwrap();
    assert_eq!(rows(source.as_mut(), 10).unwrap(), [[1.5, 2.5]]);
}

#[test]
fn inv_names_are_unique() {
    let (layout, _) = read("names_twice", b"u,u,,u_2,u\n1,2,3,4,5\n").unwrap();
    let names: Vec<&str> = layout.channels.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["u_1", "u_3", "column_3", "u_2", "u_4"]);
    // Which of them would be meant, nobody says.
    assert_eq!(layout.position("u"), None);
    let (layout, _) = read("times_twice", b"time,u,time,v\n1,2,3,4\n").unwrap();
    assert_eq!(
        (layout.time, &layout.channels[0].name[..]),
        (Some(0), "time")
    );
}

fn awkward() -> (Layout, Block) {
    let mut layout = Layout::default();
    for (name, unit) in [
        ("1", None),
        ("f (x)", None),
        ("a,\"b\"; c", Some("m/s^2")),
        ("# n", None),
        ("-", Some("°")),
    ] {
        let mut channel = Channel::new(name, unit);
        channel.sample_rate_hz = Some(1000.0 / 3.0);
        layout.channels.push(channel);
    }
    layout
        .properties
        .insert("title".into(), "drop: 3 = µ".into());
    let value = |row: u32, column: u32| {
        f64::from_bits(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(u64::from(row * 5 + column + 1)))
    };
    let mut block = Block::new(5);
    for column in 0..5 {
        block.columns[column as usize] = (0..2000).map(|row| value(row, column)).collect();
    }
    block.columns[0][..6].copy_from_slice(&[
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -0.0,
        5e-324,
        f64::MAX,
    ]);
    (layout, block)
}

#[test]
fn inv_what_is_written_reads_back_the_same() {
    let (layout, block) = awkward();
    for name in ["file.csv", "file.csv.gz"] {
        let path = scratch("text_round").join(name);
        let mut sink = create(&path, &layout).unwrap();
        sink.write(&block).unwrap();
        assert!(!path.exists(), "not before it is complete");
        sink.write(&block).unwrap();
        assert!(sink.write(&Block::new(2)).is_err());
        sink.finish().unwrap();
        let mut source = open(&path).unwrap();
        let mut read = source.layout().clone();
        assert_eq!(
            read.properties.remove("sample_rate_hz").unwrap(),
            (1000.0_f64 / 3.0).to_string()
        );
        assert_eq!(
            (&read.channels, &read.properties),
            (&layout.channels, &layout.properties)
        );
        let twice: Vec<Vec<f64>> = block
            .columns
            .iter()
            .map(|c| [c.as_slice(), c].concat())
            .collect();
        assert_eq!(bits(&rows(source.as_mut(), 333).unwrap()), bits(&twice));
        // Dropped without an end, a recording leaves the old file and nothing else.
        create(&path, &layout).unwrap().write(&block).unwrap();
        assert_eq!(
            rows(open(&path).unwrap().as_mut(), 9999).unwrap()[0].len(),
            4000
        );
        assert_eq!(
            std::fs::read_dir(path.parent().unwrap()).unwrap().count(),
            1
        );
    }
    // No rows at all.
    let path = scratch("text_no_rows").join("file.csv");
    create(&path, &layout).unwrap().finish().unwrap();
    assert_eq!(open(&path).unwrap().layout().channels, layout.channels);
}

#[test]
fn inv_damaged_files_end_in_an_error_or_in_numbers() {
    let bad = scratch("text_damage");
    for name in ["pandas_german.csv", "units.csv", "comma.lvm", "quoted.csv"] {
        damage(&folder("text").join(name), &bad.join(name));
    }
    // A gzip stream has a checksum: nothing but flips in its header's time and flags may pass.
    let accepted = damage(
        &folder("text").join("members.csv.gz"),
        &bad.join("members.csv.gz"),
    );
    assert!(accepted <= 14, "{accepted}");
}

#[test]
fn inv_time_stamps_of_a_calendar_are_seconds_since_the_first() {
    for (name, text, names, seconds, first) in [
        (
            "iso",
            "when,u\n2024-05-31T23:59:59.999,1.5\n2024-06-01T00:00:00.001,2.5\n",
            &["when", "u"][..],
            0.002,
            "2024-05-31T23:59:59.999",
        ),
        (
            "german",
            "Zeit;u\n31.05.2024 23:59:59,999;1,5\n01.06.2024 00:00:00,001;2,5\n",
            &["Zeit", "u"],
            0.002,
            "31.05.2024 23:59:59,999",
        ),
        (
            "apart",
            "Datum;Zeit;u\n31.05.2024;23:59:59;1,5\n01.06.2024;00:00:01;2,5\n",
            &["Zeit", "u"],
            2.0,
            "31.05.2024 23:59:59",
        ),
        (
            "blanks",
            "2024-05-31 23:59:59.5 1.5\n2024-06-01 00:00:00.0 2.5\n",
            &["column_2", "column_3"],
            0.5,
            "2024-05-31 23:59:59.5",
        ),
        (
            "of_the_day",
            "t\tu\n10:00:00.25\t1.5\n10:00:01\t2.5\n",
            &["t", "u"],
            0.75,
            "10:00:00.25",
        ),
        (
            "zones",
            "u,stamp\n1.5,2024-10-27T02:59:59+02:00\n2.5,2024-10-27T02:00:00+01:00\n",
            &["u", "stamp"],
            1.0,
            "2024-10-27T02:59:59+02:00",
        ),
    ] {
        let (layout, columns) = read(&format!("stamps_{name}"), text.as_bytes()).unwrap();
        let found: Vec<&str> = layout.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(found, names, "{name}");
        let time = layout.time.expect("time stamps");
        assert_eq!(columns[time], [0.0, seconds], "{name}");
        assert_eq!(columns[1 - time], [1.5, 2.5], "{name}");
        assert_eq!(layout.channels[time].unit.as_deref(), Some("s"));
        let property = format!("{}/first_timestamp", names[time]);
        assert_eq!(layout.properties[&property], first, "{name}");
    }
    let broken =
        b"t,u\n2024-05-31T23:59:58,1\n2024-05-31T23:59:59,2\nlater,3\n2024-06-01T00:00:01,4\n";
    let error = read("stamps_broken", broken).unwrap_err().to_string();
    assert!(
        error.ends_with("line 4, column 1: \"later\" is no time stamp as in the first row"),
        "{error}"
    );
}

#[test]
fn inv_a_last_line_that_breaks_off_is_left_out_and_said() {
    let whole = "a,b,c\n1,2,3\n4,5,6\n7,8,9";
    let (layout, columns) = read("cut_not", whole.as_bytes()).unwrap();
    assert_eq!((layout.cut, columns[0].len()), (None, 3));
    for fewer in 2..=3 {
        let text = &whole[..whole.len() - fewer];
        let (layout, columns) = read("cut", text.as_bytes()).unwrap();
        let cut = layout.cut.expect("it is said");
        assert!(cut.starts_with("its last line breaks off after"), "{cut}");
        assert!(
            cut.ends_with(&format!("{:?}", text.lines().last().unwrap())),
            "{cut}"
        );
        assert_eq!(columns, [[1.0, 4.0], [2.0, 5.0], [3.0, 6.0]]);
    }
    // With a line's end, somebody meant it.
    assert!(read("cut_meant", b"a,b,c\n1,2,3\n4,5,6\n7,8\n").is_err());
    let error = read("cut_cell", b"a,b,c\n1,2,3\n4,5,6\n7,8,")
        .unwrap_err()
        .to_string();
    assert!(error.contains("line 4, column 3: an empty cell"), "{error}");
    assert!(error.contains("was it cut short?"), "{error}");
}

#[test]
fn inv_a_footer_is_told_from_a_broken_row() {
    let rows = format!("a,b\n{}", "1,2\n".repeat(8));
    for (name, text, footer) in [
        ("words", "end,of,file\n", true),
        ("two_lines", "\nMeasured by,Ada\nChecked,Grace\n", true),
        ("between", "end,of,file\n5,6\n", false),
        ("empty_cell", "5,\n", false),
    ] {
        let error = read(
            &format!("footer_{name}"),
            format!("{rows}{text}").as_bytes(),
        )
        .unwrap_err()
        .to_string();
        let line = if name == "two_lines" { 11 } else { 10 };
        assert!(error.contains(&format!("line {line}")), "{error}");
        let said = error.contains(&format!("if line {line} begins a footer"));
        assert_eq!(said, footer, "{error}");
    }
}
