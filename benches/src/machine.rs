//! What was measured on, and of what.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

use sixaxis_props::results::Machine;

/// Logical cores, 1 where that is not known.
#[must_use]
pub fn logical_cores() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// The value of a line of a file of `name: value` lines, if there is such a file.
#[must_use]
pub fn line_of(path: &str, name: &str) -> Option<String> {
    let text = fs::read_to_string(path).ok()?;
    let line = text.lines().find(|line| line.starts_with(name))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The largest memory that this process has had so far (resident set, `VmHWM`); none where the system does not say.
#[must_use]
pub fn peak_memory_bytes() -> Option<u64> {
    let value = line_of("/proc/self/status", "VmHWM")?;
    let kib: u64 = value.strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kib)
}

/// Processor time of all threads of this process so far, s, in steps of 10 ms (`utime` and `stime`); none where the system
/// does not say.
#[must_use]
pub fn processor_s() -> Option<f64> {
    // What the clock of /proc ticks at, whatever the kernel's own does.
    const TICKS_PER_S: f64 = 100.0;
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // The program's name, in brackets, may have spaces in it.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<u64>().ok();
    Some((ticks()? + ticks()?) as f64 / TICKS_PER_S)
}

/// What a command prints in the workspace, if there is such a command and it succeeds.
#[must_use]
pub fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(workspace())
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// This machine.
#[must_use]
pub fn machine() -> Machine {
    let mut compiled_for = Vec::new();
    let mut processor_has = Vec::new();
    macro_rules! features {
        ($($name:tt),*) => {$(
            if cfg!(target_feature = $name) {
                compiled_for.push($name.to_owned());
            }
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!($name) {
                processor_has.push($name.to_owned());
            }
        )*};
    }
    features!("avx", "avx2", "fma", "avx512f");
    let unknown = || "unknown".to_owned();
    Machine {
        cpu: line_of("/proc/cpuinfo", "model name").unwrap_or_else(unknown),
        logical_cores: logical_cores(),
        system: format!("{} {}", env::consts::OS, env::consts::ARCH),
        rustc: output("rustc", &["-V"]).unwrap_or_else(unknown),
        compiled_for,
        processor_has,
    }
}

/// The time now as `2026-01-31T23:59:59Z`.
#[must_use]
pub fn date_utc() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let seconds = since.map_or(0, |time| time.as_secs());
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Days into the calendar, with years that begin in March so that the leap day is the last.
    let day = days + 719_468;
    let (era, of_era) = (day / 146_097, day % 146_097);
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (hour, minute) = (second / 3_600, second / 60 % 60);
    format!(
        "{year}-{month:02}-{day:02}T{hour:02}:{minute:02}:{:02}Z",
        second % 60
    )
}

/// The workspace's folder.
#[must_use]
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
