//! Tells this package's binaries where MuJoCo's library is; see reference/build.rs.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let Ok(rpath) = std::env::var("DEP_SIXAXIS_MUJOCO_RPATH") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{rpath}");
    }
}
