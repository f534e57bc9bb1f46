//! Files that appear whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use sixaxis_recordings::draft::{Draft, write_atomically};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn entries(folder: &Path) -> usize {
    fs::read_dir(folder).expect("lists").count()
}

#[test]
fn inv_a_draft_is_seen_only_when_it_is_kept() {
    let folder = folder("draft_kept").join("deep");
    let path = folder.join("page.html");
    write_atomically(&path, b"old and long").expect("writes");
    write_atomically(&path, b"new").expect("replaces");
    assert_eq!(fs::read(&path).expect("reads"), b"new");
    assert_eq!(entries(&folder), 1);
    // Two at once, as of two threads or two machines, do not share a draft; a dropped one leaves nothing.
    let (first, file) = Draft::create(&path).expect("creates");
    let (second, _) = Draft::create(&path).expect("creates another");
    assert_eq!(entries(&folder), 3);
    first.keep(&file).expect("keeps");
    drop(second);
    assert_eq!(entries(&folder), 1);
    assert_eq!(fs::read(&path).expect("reads"), b"");
    assert!(write_atomically(Path::new("/"), b"").is_err());
}

#[cfg(unix)]
#[test]
fn inv_a_kept_draft_is_as_readable_as_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder("draft_mode");
    let path = folder.join("kept");
    write_atomically(&path, b"1").expect("writes");
    fs::write(folder.join("plain"), b"1").expect("writes");
    let mode = |name: &str| {
        let metadata = fs::metadata(folder.join(name)).expect("is there");
        metadata.permissions().mode()
    };
    assert_eq!(mode("kept"), mode("plain"));
}
