//! Tells this package's binaries where MuJoCo's library is (see reference/build.rs), and its library where the rows of
//! evidence go.

use std::path::PathBuf;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // OUT_DIR is <target>/<profile>/build/<package>/out: debug and release write to one folder.
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default());
    let target = out.ancestors().nth(4).unwrap_or(&out);
    println!(
        "cargo::rustc-env=SIXAXIS_EVIDENCE_DIR={}",
        target.join("evidence").display()
    );
    if let Ok(rpath) = std::env::var("DEP_SIXAXIS_MUJOCO_RPATH") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{rpath}");
    }
}
