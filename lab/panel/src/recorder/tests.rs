//! Recordings are finished, cut off and recovered.

use super::*;
use sixaxis_recordings::open;

const COLUMNS: [(&str, &str); 2] = [("u1", "V"), ("u2", "V")];

fn read_back(path: &Path) -> Vec<Vec<f64>> {
    let mut source = open(path).expect("opens");
    let (mut block, mut all) = (Block::default(), vec![Vec::new(); 2]);
    while source.read(&mut block, 1000).expect("reads") > 0 {
        for (all, column) in all.iter_mut().zip(&block.columns) {
            all.extend_from_slice(column);
        }
    }
    all
}

#[test]
fn law_what_is_recorded_reads_back_bit_for_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut rows: Vec<f64> = (0..20_000).map(|k| (f64::from(k) * 0.1).sin()).collect();
    rows[40..44].copy_from_slice(&[-0.0, f64::MIN_POSITIVE / 3.0, f64::MAX, f64::NAN]);
    for format in [FileFormat::Tdms, FileFormat::Parquet, FileFormat::Csv] {
        let head = head(&COLUMNS, 1000.0, format);
        let mut recorder =
            Recorder::start(folder.path(), format.extension(), head.clone()).expect("starts");
        rows.chunks(140)
            .for_each(|part| recorder.push(part.to_vec()));
        let again = Recorder::start(folder.path(), format.extension(), head).err();
        let said = again.expect("the name is taken").to_string();
        assert!(said.ends_with(EXISTS), "{said}");
        recorder.wait();
        let progress = recorder.progress();
        assert_eq!(
            (progress.on_disk, progress.failed, progress.lost),
            (10_000, None, 0)
        );
        let path = folder.path().join(format!("{0}.{0}", format.extension()));
        let back = read_back(&path);
        let back = back[0].iter().zip(&back[1]).flat_map(|(a, b)| [a, b]);
        assert!(
            back.map(|v| v.to_bits())
                .eq(rows.iter().map(|v| v.to_bits())),
            "{path:?}"
        );
        assert!(!path.with_extension(ENDING).exists());
    }
}

/// A disk that takes nothing: one piece waits, and the rows of all that come after it until *Stop* are counted.
#[test]
fn rows_that_the_disk_is_too_slow_for_are_counted() {
    let (rows, _received) = sync_channel(1);
    let mut recorder = Recorder {
        rows: Some(rows),
        columns: 2,
        loses: false,
        progress: Arc::default(),
        thread: None,
    };
    for piece in [10, 20, 30] {
        recorder.push(vec![0.0; piece]);
    }
    recorder.stop();
    recorder.push(vec![0.0; 40]);
    let progress = recorder.progress();
    assert_eq!(progress.lost, 25);
    let said = progress.failed.expect("it is said");
    assert!(said.contains("25 rows"), "{said}");
}

#[test]
fn law_a_journal_that_was_cut_is_finished_up_to_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bytes = head_bytes(&head(&COLUMNS, 1000.0, FileFormat::Csv));
    bytes.extend(
        [1.0_f64, 2.0, 3.0, 4.0, 5.0]
            .iter()
            .flat_map(|v| v.to_le_bytes()),
    );
    std::fs::write(folder.path().join("a.journal"), &bytes[..bytes.len() - 3]).expect("writes");
    std::fs::write(folder.path().join("b.journal"), "nothing").expect("writes");
    let said = recover(folder.path());
    assert_eq!(said.len(), 2, "{said:?}");
    assert_eq!(
        read_back(&folder.path().join("a.csv")),
        [[1.0, 3.0], [2.0, 4.0]]
    );
    assert!(folder.path().join("b.journal").exists());
}
