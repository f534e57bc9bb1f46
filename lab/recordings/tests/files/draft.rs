//! Files that appear whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::process::Command;
use std::time::{Duration, SystemTime};

use sixaxis_recordings::draft::{Draft, write_atomically};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("makes a folder");
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
    for nowhere in [Path::new("/"), &folder, &path.join("page.html")] {
        assert!(write_atomically(nowhere, b"").is_err());
    }
    assert_eq!(entries(&folder), 1);
}

#[test]
fn inv_what_a_killed_run_left_is_cleared_away() {
    let folder = folder("draft_left");
    let path = folder.join("page.html");
    let old = SystemTime::now() - Duration::from_secs(3600);
    let made = |name: &str| {
        let file = fs::File::create(folder.join(name)).expect("creates");
        file.set_modified(old).expect("dates");
        file
    };
    for name in [
        ".page.html.Ab12Cd.part",
        ".page.html.kept.part",
        ".other.Ab12Cd.part",
    ] {
        made(name);
    }
    fs::write(folder.join(".page.html.Ef34Gh.part"), b"young").expect("writes");
    let held = made(".page.html.Ij56Kl.part");
    held.lock().expect("locks");
    write_atomically(&path, b"1").expect("writes");
    assert!(!folder.join(".page.html.Ab12Cd.part").exists());
    assert_eq!(entries(&folder), 5);
}

#[cfg(unix)]
#[test]
fn inv_links_are_followed_and_pipes_are_written_into() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = folder("draft_links");
    let (link, file) = (folder.join("link"), folder.join("file"));
    symlink("second", &link).expect("links");
    symlink("file", folder.join("second")).expect("links");
    for bytes in [&b"first"[..], b"second"] {
        write_atomically(&link, bytes).expect("writes");
        assert_eq!(fs::read(&file).expect("reads"), bytes);
    }
    let kind = fs::symlink_metadata(&link).expect("is there").file_type();
    assert!(kind.is_symlink());
    symlink("round", folder.join("round")).expect("links");
    assert!(write_atomically(&folder.join("round"), b"").is_err());

    let pipe = folder.join("pipe");
    let made = Command::new("mkfifo").arg(&pipe).status().expect("runs");
    assert!(made.success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read(pipe).expect("reads")
    });
    write_atomically(&pipe, b"through").expect("writes");
    assert_eq!(reader.join().expect("ends"), b"through");
    let kind = fs::symlink_metadata(&pipe).expect("is there").file_type();
    assert!(kind.is_fifo());
    write_atomically(Path::new("/dev/null"), b"nothing").expect("writes");
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
