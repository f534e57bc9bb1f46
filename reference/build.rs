//! Finds MuJoCo's library, or fetches it once with pip, and tells the linker and the dependents where it is.
//!
//! mujoco-rs links against a MuJoCo that is already there. The Python wheel of the same version carries exactly the
//! library needed; it is pinned by hash and unpacked into the target folder, so that neither an environment variable
//! nor a system-wide installation is asked of anybody.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, exit};

const LIBRARY: &str = "libmujoco.so.3.17.0";
const OWN_LINK_DIR: &str = "link";
const USER_VARIABLE: &str = "MUJOCO_DYNAMIC_LINK_DIR";

/// Copies the library out of the wheel; argument 1 is the folder of the wheel, 2 the file to write.
const UNPACK: &str = "
import glob, shutil, sys, zipfile
wheel = zipfile.ZipFile(glob.glob(sys.argv[1] + '/mujoco-*.whl')[0])
with wheel.open('mujoco/libmujoco.so.3.17.0') as library, open(sys.argv[2], 'wb') as out:
    shutil.copyfileobj(library, out)
";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=mujoco-wheel.txt");
    println!("cargo::rerun-if-env-changed={USER_VARIABLE}");
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let library_dir = match users_own(&package) {
        Some(dir) => dir,
        None => fetched(&package),
    };
    println!("cargo::rustc-link-search=native={}", library_dir.display());
    // Where binaries look for the library at run time. Dependents read it as DEP_SIXAXIS_MUJOCO_LIBRARY_DIR and pass
    // it on, because a link argument reaches only the package whose build script prints it.
    println!("cargo::metadata=library_dir={}", library_dir.display());
    println!("cargo::rustc-link-arg=-Wl,-rpath,{}", library_dir.display());
}

/// The folder that the user's own environment names, if it is not this package's.
fn users_own(package: &Path) -> Option<PathBuf> {
    let dir = PathBuf::from(env::var_os(USER_VARIABLE)?);
    let same = |a: &Path, b: &Path| {
        fs::canonicalize(a)
            .ok()
            .is_some_and(|a| Some(a) == fs::canonicalize(b).ok())
    };
    (!same(&dir, &package.join(OWN_LINK_DIR))).then_some(dir)
}

/// The library in the target folder, fetched if it is not there yet.
fn fetched(package: &Path) -> PathBuf {
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    // OUT_DIR is <target>/<profile>/build/<package>/out: one library serves all profiles.
    let target = out.ancestors().nth(4).unwrap_or(&out);
    let dir = target.join("mujoco-3.17.0");
    let library = dir.join(LIBRARY);
    if library.is_file() {
        return dir;
    }
    let platform = match (
        env::var("CARGO_CFG_TARGET_OS").as_deref(),
        env::var("CARGO_CFG_TARGET_ARCH").as_deref(),
    ) {
        (Ok("linux"), Ok("x86_64")) => "manylinux_2_28_x86_64",
        (Ok("linux"), Ok("aarch64")) => "manylinux_2_28_aarch64",
        (os, arch) => stop(&format!(
            "no MuJoCo library is pinned for {} on {}",
            os.unwrap_or("an unknown system"),
            arch.unwrap_or("an unknown processor")
        )),
    };
    let python = ["python3", "python"]
        .into_iter()
        .find(|python| {
            Command::new(python)
                .arg("--version")
                .output()
                .is_ok_and(|output| output.status.success())
        })
        .unwrap_or_else(|| stop("no Python 3 was found (tried python3 and python)"));

    let wheels = out.join("wheel");
    run(
        Command::new(python)
            .args([
                "-m",
                "pip",
                "download",
                "--quiet",
                "--disable-pip-version-check",
            ])
            .args(["--no-deps", "--only-binary=:all:", "--require-hashes"])
            .args(["--platform", platform])
            // One wheel for all, whatever Python the user has: only the library inside is used.
            .args([
                "--python-version",
                "3.11",
                "--implementation",
                "cp",
                "--abi",
                "cp311",
            ])
            .arg("--requirement")
            .arg(package.join("mujoco-wheel.txt"))
            .arg("--dest")
            .arg(&wheels),
        "pip could not download the pinned wheel (no pip, no network, or a file with another hash)",
    );
    // Written aside and moved into place, so that a build killed half-way leaves no broken library behind.
    let unfinished = out.join(LIBRARY);
    run(
        Command::new(python)
            .args(["-c", UNPACK])
            .arg(&wheels)
            .arg(&unfinished),
        "the wheel could not be unpacked",
    );
    if let Err(error) = fs::create_dir_all(&dir).and_then(|()| fs::rename(&unfinished, &library)) {
        stop(&format!(
            "{} could not be written: {error}",
            library.display()
        ));
    }
    // 26 MB that nobody needs again; not worth failing over.
    let _ = fs::remove_dir_all(&wheels);
    dir
}

fn run(command: &mut Command, failure: &str) {
    match command.output() {
        Ok(output) if output.status.success() => {}
        Ok(output) => stop(&format!(
            "{failure}\n\n{}",
            String::from_utf8_lossy(&output.stderr).trim()
        )),
        Err(error) => stop(&format!("{failure}: {error}")),
    }
}

fn stop(cause: &str) -> ! {
    eprintln!(
        "\nsixaxis needs the MuJoCo 3.17.0 library and could not get it: {cause}\n\n\
         Either make `python3 -m pip download mujoco==3.17.0` work, or point the build at a MuJoCo 3.17.0 that you have:\n\
         \n    {USER_VARIABLE}=/path/to/mujoco-3.17.0/lib cargo build --release\n\n\
         (the folder must hold libmujoco.so).\n"
    );
    exit(1)
}
