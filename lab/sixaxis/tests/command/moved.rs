//! A binary that was copied elsewhere takes the library that lies beside it.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::program::{Folder, stdout};

/// The library that the loader takes for a binary, by the loader's own account.
fn library_of(binary: &Path) -> String {
    let output = Command::new(binary)
        .env("LD_TRACE_LOADED_OBJECTS", "1")
        .env_remove("LD_LIBRARY_PATH")
        .output();
    let listed = stdout(&output.expect("it starts"));
    let line = listed.lines().find(|line| line.contains("libmujoco"));
    let path = line.and_then(|line| line.split_whitespace().nth(2));
    path.unwrap_or_else(|| panic!("{listed}")).to_owned()
}

#[test]
fn inv_the_library_beside_the_binary_comes_first() {
    let folder = Folder::new("moved");
    let binary = Path::new(env!("CARGO_BIN_EXE_sixaxis"));
    let library = library_of(binary);
    let copied = folder.join("sixaxis");
    fs::copy(binary, &copied).expect("copies");
    // Alone it still finds the one of the build, while that is there.
    assert_ne!(Path::new(&library_of(&copied)).parent(), Some(&*folder));
    let beside = folder.join(Path::new(&library).file_name().expect("a name"));
    fs::copy(&library, &beside).expect("copies");
    assert_eq!(Path::new(&library_of(&copied)), beside);
    let version = Command::new(&copied)
        .arg("--version")
        .env_remove("LD_LIBRARY_PATH")
        .output();
    assert!(version.expect("it starts").status.success());
}
