//! The MuJoCo library that the build found or fetched is loaded, and is the one that the bindings were made for.

use std::fs;
use std::path::{Path, PathBuf};

use sixaxis_reference::mujoco::version;

#[allow(dead_code, reason = "of the build script, which uses all of it")]
#[path = "../build/pinned.rs"]
mod pinned;

use pinned::{PLATFORMS, Pinned, verify, wheel};

/// The library that this process has loaded.
fn loaded() -> PathBuf {
    let maps = fs::read_to_string("/proc/self/maps").expect("Linux");
    let path = maps.lines().find_map(|line| {
        let path = &line[line.find('/')?..];
        path.contains("libmujoco.so").then(|| PathBuf::from(path))
    });
    path.expect("the library is loaded")
}

fn here() -> &'static Pinned {
    let arch = std::env::consts::ARCH;
    let here = PLATFORMS.iter().find(|pinned| pinned.target[2] == arch);
    here.expect("a platform that the build script takes")
}

#[test]
fn the_library_in_use_is_the_pinned_one() {
    assert_eq!(version(), "3.17.0");
    mujoco_rs::util::assert_mujoco_version();
    let library = loaded();
    // A library of the user's own is the user's own choice.
    if library
        .parent()
        .is_some_and(|dir| dir.ends_with("mujoco-3.17.0"))
    {
        verify(&library, here().library, "").expect("bit for bit");
    }
}

/// One bit more or less, and it is not used.
#[test]
fn neg_a_changed_library_or_wheel_is_refused() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pinned");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    let changed = folder.join("mujoco-3.17.0-planted.whl");
    let mut bytes = fs::read(loaded()).expect("reads");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&changed, bytes).expect("writes");
    for refused in [
        verify(&changed, here().library, "delete it"),
        wheel(&folder, here().wheel).map(|_| ()),
    ] {
        let words = refused.expect_err("changed");
        for said in [
            changed.to_str().expect("UTF-8"),
            "expected was",
            "delete it",
        ] {
            assert!(words.contains(said), "{words}");
        }
    }
    // A second file beside the wheel: which of them pip has brought is not known.
    fs::write(folder.join("mujoco-3.17.0.whl"), "").expect("writes");
    let words = wheel(&folder, here().wheel).expect_err("two files");
    assert!(words.contains("2 files"), "{words}");
    fs::remove_dir_all(&folder).expect("removed");
}
