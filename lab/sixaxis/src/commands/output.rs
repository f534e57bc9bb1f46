//! Where a command writes: never over what it reads, one run in a folder at a time, and no folder made in silence.

use std::fs::{self, File};
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};

use super::common::tell;

pub fn same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

/// Endings of pages.
pub const PAGE: &[&str] = &["html", "htm"];
/// Endings of results for scripts.
pub const JSON: &[&str] = &["json"];

/// Refuses an output that is named as another kind of file: a shell's list of files may have given an option the first of them.
pub fn check_ending(option: &str, output: &Path, endings: &[&str]) -> Result<()> {
    let ending = output.extension().unwrap_or_default();
    let named = endings
        .iter()
        .any(|known| ending.eq_ignore_ascii_case(known));
    // Into a device or a FIFO anything may be written.
    let special = output.metadata().is_ok_and(|data| !data.is_file());
    ensure!(
        named || special,
        "{option}: {} is no name for what is written there, which ends in .{}",
        output.display(),
        endings.join(" or .")
    );
    Ok(())
}

/// Refuses outputs, each with its option, that are one file, or that would replace an input. Says which folders will be made for the
/// others.
pub fn check_outputs<'a>(
    outputs: &[(&str, &Path)],
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<()> {
    for (at, (option, output)) in outputs.iter().enumerate() {
        for (other, earlier) in &outputs[..at] {
            ensure!(
                !same_file(output, earlier),
                "{other} and {option} are the same file, {}",
                output.display()
            );
        }
    }
    for input in inputs {
        for (option, output) in outputs {
            ensure!(
                !same_file(output, input),
                "{option}: {} is read and would be written over; name another file",
                output.display()
            );
        }
    }
    let mut said = Vec::new();
    for (option, output) in outputs {
        if let Some(folder) = missing_folder(output).filter(|folder| !said.contains(folder)) {
            say_made(option, folder);
            said.push(folder);
        }
    }
    Ok(())
}

/// The folder that a path is to stand in, if it is not there.
fn missing_folder(path: &Path) -> Option<&Path> {
    path.parent()
        .filter(|folder| !folder.as_os_str().is_empty() && !folder.exists())
}

/// A missing folder is made, as a slip of the pen may be.
fn say_made(option: &str, folder: &Path) {
    let folder = folder.display();
    tell(
        "note",
        &format!("{option}: the folder {folder} is not there and will be made"),
    );
}

/// Makes an output folder, and says so where even the folder that it is to stand in is missing.
pub fn make_folder(folder: &Path) -> Result<()> {
    if let Some(missing) = missing_folder(folder) {
        say_made("--out", missing);
    }
    fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the output folder {}", folder.display()))
}

/// As [`make_folder`], for this run alone until what is returned is dropped or the process ends, however it ends.
pub fn claim_folder(folder: &Path) -> Result<Option<File>> {
    make_folder(folder)?;
    // The folder itself is locked: no file of ours is left in it. Where a file system knows no such lock, nothing is refused.
    let Ok(opened) = File::open(folder) else {
        return Ok(None);
    };
    match opened.try_lock() {
        Ok(()) => Ok(Some(opened)),
        Err(fs::TryLockError::WouldBlock) => bail!(
            "{}: another run is writing into this folder; wait for it, or name another",
            folder.display()
        ),
        Err(fs::TryLockError::Error(_)) => Ok(None),
    }
}

/// Says that a result that was not written is there all the same, from before.
pub fn mention_earlier(output: &Path) {
    if output.is_file() {
        let output = output.display();
        tell(
            "warning",
            &format!("{output} is from before: this run has left it as it is"),
        );
    }
}
