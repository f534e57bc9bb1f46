//! Finds MuJoCo's library, or fetches it once with pip, and tells the linker and the dependents where it is.
//!
//! mujoco-rs links against a MuJoCo that is already there. The Python wheel of the same version carries exactly the
//! library needed; it is unpacked into the target folder, so that neither an environment variable nor a system-wide
//! installation is asked of anybody. Wheel and library are pinned by hash: the wheel is compared with it when it is
//! fetched, the library whenever this runs, but for one that the user names.
//! Without the feature `mujoco` nothing is looked for.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, exit};

#[path = "build/pinned.rs"]
mod pinned;

use pinned::{PLATFORMS, Pinned};

/// The file name that binaries ask the loader for: the library's own name carries its version.
const LIBRARY: &str = "libmujoco.so.3.17.0";
const FETCHED_DIR: &str = "mujoco-3.17.0";
const OWN_LINK_DIR: &str = "link";
const USER_VARIABLE: &str = "MUJOCO_DYNAMIC_LINK_DIR";

/// Copies the library out of the wheel; argument 1 is the wheel, 2 the file to write. Cargo is told to
/// watch that file, and takes one younger than the build script's run for a change: hence the date long gone.
const UNPACK: &str = "
import os, shutil, sys, zipfile
with zipfile.ZipFile(sys.argv[1]).open('mujoco/libmujoco.so.3.17.0') as library, open(sys.argv[2], 'wb') as out:
    shutil.copyfileobj(library, out)
os.utime(sys.argv[2], (315532800, 315532800))
";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-env-changed={USER_VARIABLE}");
    if env::var_os("CARGO_FEATURE_MUJOCO").is_none() {
        return;
    }
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let (dir, rpath) = match users_own(&package) {
        Some(dir) => {
            let rpath = format!("$ORIGIN:{}", dir.display());
            (dir, rpath)
        }
        None => {
            let dir = fetched();
            // Beside the binary first, so that the two can be copied; then relative to it (in <profile>/, or in
            // <profile>/deps/ and <profile>/examples/), so that a target folder can be moved; then where it was built.
            let rpath = format!(
                "$ORIGIN:$ORIGIN/../{FETCHED_DIR}:$ORIGIN/../../{FETCHED_DIR}:{}",
                dir.display()
            );
            (dir, rpath)
        }
    };
    println!("cargo::rerun-if-changed={}", dir.join(LIBRARY).display());
    println!("cargo::rustc-link-search=native={}", dir.display());
    // A link argument reaches only the package whose build script prints it. Dependents read it as
    // DEP_SIXAXIS_MUJOCO_RPATH and repeat it for their own binaries.
    println!("cargo::metadata=rpath={rpath}");
    println!("cargo::rustc-link-arg=-Wl,-rpath,{rpath}");
}

/// The folder that the user's own environment names, if it is not this package's.
fn users_own(package: &Path) -> Option<PathBuf> {
    let dir = PathBuf::from(env::var_os(USER_VARIABLE)?);
    let same = |a: &Path, b: &Path| {
        fs::canonicalize(a)
            .ok()
            .is_some_and(|a| Some(a) == fs::canonicalize(b).ok())
    };
    if same(&dir, &package.join(OWN_LINK_DIR)) {
        return None;
    }
    // Any libmujoco.so links; another version, or none to load, would show only when a binary is run.
    if !dir.join(LIBRARY).is_file() {
        stop(
            &format!(
                "{USER_VARIABLE} names {}, which holds no {LIBRARY}; unset it to have one fetched",
                dir.display()
            ),
            "",
        );
    }
    Some(dir)
}

/// The library in the target folder, fetched if it is not there yet.
fn fetched() -> PathBuf {
    let pinned = platform();
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    // OUT_DIR is <target>/<profile>/build/<package>/out: one library serves all profiles.
    let target = out.ancestors().nth(4).unwrap_or(&out);
    let dir = target.join(FETCHED_DIR);
    let library = dir.join(LIBRARY);
    if library.exists() {
        let remedy = "delete it, and the next build fetches it anew";
        checked(pinned::verify(&library, pinned.library, remedy));
        return dir;
    }
    let python = python_with_pip();
    let wheels = out.join("wheel");
    // What a killed build left.
    let _ = fs::remove_dir_all(&wheels);
    let requirement = out.join("wheel.txt");
    let line = format!("mujoco==3.17.0 --hash=sha256:{}\n", pinned.wheel);
    written(&requirement, fs::write(&requirement, line));
    run(
        Command::new(python)
            .args(["-m", "pip", "download", "--quiet"])
            .args(["--disable-pip-version-check", "--no-deps"])
            .args(["--only-binary=:all:", "--require-hashes"])
            // One wheel for all, whatever Python the user has: only the library inside is used.
            .args(["--python-version", "3.11", "--implementation", "cp"])
            .args(["--abi", "cp311", "--platform", pinned.wheel_platform])
            .arg("--requirement")
            .arg(&requirement)
            .arg("--dest")
            .arg(&wheels),
        &format!("`{python} -m pip download` of the pinned wheel failed"),
    );
    let wheel = checked(pinned::wheel(&wheels, pinned.wheel));
    // Written aside and moved into place, so that a build killed half-way leaves no broken library behind, and two at
    // once do not write into each other's.
    let unfinished = out.join(LIBRARY);
    run(
        Command::new(python)
            .args(["-c", UNPACK])
            .arg(&wheel)
            .arg(&unfinished),
        "the downloaded wheel could not be unpacked",
    );
    checked(pinned::verify(
        &unfinished,
        pinned.library,
        "the disk, or Python's zipfile, has changed it: build again",
    ));
    written(
        &library,
        fs::create_dir_all(&dir).and_then(|()| fs::rename(&unfinished, &library)),
    );
    // 26 MB that nobody needs again; not worth failing over.
    let _ = fs::remove_dir_all(&wheels);
    dir
}

fn written(file: &Path, result: std::io::Result<()>) {
    if let Err(error) = result {
        stop(
            &format!("{} could not be written", file.display()),
            &error.to_string(),
        );
    }
}

/// The value, or the end of the build with what is not as pinned.
fn checked<T>(result: Result<T, String>) -> T {
    result.unwrap_or_else(|cause| {
        for line in cause.lines() {
            println!("cargo::error={line}");
        }
        exit(0)
    })
}

/// What is pinned for the platform that is built for.
fn platform() -> &'static Pinned {
    let target = ["OS", "ENV", "ARCH"]
        .map(|name| env::var(format!("CARGO_CFG_TARGET_{name}")).unwrap_or_default());
    PLATFORMS
        .iter()
        .find(|pinned| pinned.target[..] == target)
        .unwrap_or_else(|| {
            let [os, env, arch] = target;
            let only = "only for linux gnu x86_64 and aarch64";
            stop(
                &format!("no library is pinned for {os} {env} {arch}, {only}"),
                "",
            )
        })
}

/// The first Python that has pip: some systems keep the two in separate packages.
fn python_with_pip() -> &'static str {
    let mut tried = String::new();
    for python in ["python3", "python"] {
        let answer = match Command::new(python)
            .args(["-m", "pip", "--version"])
            .output()
        {
            Ok(output) if output.status.success() => return python,
            Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_owned(),
            Err(error) => error.to_string(),
        };
        tried += &format!("{python} -m pip: {answer}\n");
    }
    stop("no Python 3 with pip was found to fetch it with", &tried)
}

fn run(command: &mut Command, failure: &str) {
    match command.output() {
        Ok(output) if output.status.success() => {}
        Ok(output) => {
            // pip says at every retry what it says at the last.
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.rfind("WARNING: Retrying").unwrap_or(0);
            stop(failure, &said[last..]);
        }
        Err(error) => stop(failure, &error.to_string()),
    }
}

/// Ends the build. Cargo shows errors reported like this by themselves; a failing exit code would have it print the
/// whole output of this script around them.
fn stop(cause: &str, details: &str) -> ! {
    println!("cargo::error=the MuJoCo 3.17.0 library is missing: {cause}");
    for line in details.lines().filter(|line| !line.trim().is_empty()) {
        println!("cargo::error=    {line}");
    }
    for line in [
        "Python 3 with pip and a package index in reach is enough for the build to fetch it. Without, name a MuJoCo",
        "3.17.0 that you have, by the folder that holds its libmujoco.so and libmujoco.so.3.17.0:",
    ] {
        println!("cargo::error={line}");
    }
    println!("cargo::error=    {USER_VARIABLE}=/path/to/mujoco-3.17.0/lib cargo build --release");
    exit(0)
}
