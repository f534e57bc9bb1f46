//! Tells this package's binaries where MuJoCo's library is (see reference/build.rs), and its library where the rows of
//! evidence go.

use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=tests");
    // OUT_DIR is <target>/<profile>/build/<package>/out: debug and release write to one folder.
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default());
    let target = out.ancestors().nth(4).unwrap_or(&out);
    let evidence = target.join("evidence");
    println!(
        "cargo::rustc-env=SIXAXIS_EVIDENCE_DIR={}",
        evidence.display()
    );
    forget_suites_that_are_gone(&evidence);
    if let Ok(rpath) = std::env::var("DEP_SIXAXIS_MUJOCO_RPATH") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{rpath}");
    }
}

/// Rows of a suite, `tests/<program>/<suite>.rs`, that was renamed or removed would stand in the report for ever.
fn forget_suites_that_are_gone(evidence: &Path) {
    let (Ok(files), Ok(programs)) = (std::fs::read_dir(evidence), std::fs::read_dir("tests"))
    else {
        return;
    };
    let programs: Vec<PathBuf> = programs
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    for file in files.filter_map(Result::ok).map(|entry| entry.path()) {
        let suite = Path::new(file.file_name().unwrap_or_default()).with_extension("rs");
        if !programs
            .iter()
            .any(|program| program.join(&suite).is_file())
        {
            // Not worth a failed build.
            let _ = std::fs::remove_file(file);
        }
    }
}
