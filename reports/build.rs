//! Tells this package's binaries where MuJoCo's library is; see reference/build.rs.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // The folder beside the build profiles first, so that a target folder can be moved; then where it was built.
    for depth in ["..", "../.."] {
        println!("cargo::rustc-link-arg=-Wl,-rpath,$ORIGIN/{depth}/mujoco-3.17.0");
    }
    if let Ok(dir) = std::env::var("DEP_SIXAXIS_MUJOCO_LIBRARY_DIR") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{dir}");
    }
}
