//! The wheel and the library in it, pinned by SHA-256: what is fetched is compared with these; a library that the user names is not.

use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// What is taken for one platform.
pub struct Pinned {
    /// What Cargo calls the platform: operating system, environment, architecture.
    pub target: [&'static str; 3],
    /// What pip calls it.
    pub wheel_platform: &'static str,
    /// SHA-256 of the wheel, as the package index publishes it.
    pub wheel: &'static str,
    /// SHA-256 of `mujoco/libmujoco.so.3.17.0` in that wheel.
    pub library: &'static str,
}

/// Every platform that there is a library for.
pub const PLATFORMS: [Pinned; 2] = [
    Pinned {
        target: ["linux", "gnu", "x86_64"],
        wheel_platform: "manylinux_2_28_x86_64",
        wheel: "d66928d86a2d1b601bbaa4dc11db50214d17d5301bb8afd84721313b67ff0874",
        library: "23496b023ee80fb61ab71167e94bc649f9941710fde96b18bb8204fb332523ad",
    },
    Pinned {
        target: ["linux", "gnu", "aarch64"],
        wheel_platform: "manylinux_2_28_aarch64",
        wheel: "91a70ed9979c383ff1f5c03f25cc2e1280a8254c1a8e558d5dd7f4184f01efc9",
        library: "e2edd0204fb9229f75f332a4fcd1a32345bb9f90651dc0fddfa20ec0670db789",
    },
];

/// Refuses a file that is not, bit for bit, the one that is meant; the error names file, both sums, and `remedy`.
pub fn verify(file: &Path, expected_sha256: &str, remedy: &str) -> Result<(), String> {
    let bytes =
        fs::read(file).map_err(|error| format!("{} cannot be read: {error}", file.display()))?;
    let sum = Sha256::digest(bytes);
    let found: String = sum.iter().map(|byte| format!("{byte:02x}")).collect();
    if found == expected_sha256 {
        return Ok(());
    }
    Err(format!(
        "{} is not the file that is pinned: its SHA-256 is\n{found}, expected was\n{expected_sha256}; {remedy}",
        file.display()
    ))
}

/// The one wheel in a folder, once it is known to be the pinned one.
pub fn wheel(folder: &Path, expected_sha256: &str) -> Result<PathBuf, String> {
    let listed = fs::read_dir(folder)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
        .map_err(|error| format!("{} cannot be read: {error}", folder.display()));
    let files: Vec<PathBuf> = listed?;
    let [wheel] = files.as_slice() else {
        return Err(format!(
            "{} holds {} files where one wheel was expected; delete the folder and build again",
            folder.display(),
            files.len()
        ));
    };
    verify(wheel, expected_sha256, "delete it and build again")?;
    Ok(wheel.clone())
}
