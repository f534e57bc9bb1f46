//! What was measured on, and of what.

use std::env;
use std::fs;
use std::thread;

use sixaxis_props::provenance::output;
use sixaxis_props::results::Machine;

/// Logical cores, 1 where that is not known.
pub fn logical_cores() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// The value of a line of a file of `name: value` lines, if there is such a file.
pub fn line_of(path: &str, name: &str) -> Option<String> {
    let text = fs::read_to_string(path).ok()?;
    let line = text.lines().find(|line| line.starts_with(name))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The largest memory that this process has had so far (resident set, `VmHWM`); none where the system does not say.
pub fn peak_memory_bytes() -> Option<u64> {
    let value = line_of("/proc/self/status", "VmHWM")?;
    let kib: u64 = value.strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kib)
}

/// Processor time of all threads of this process so far, s, in steps of 10 ms (`utime` and `stime`); none where the system
/// does not say.
pub fn processor_s() -> Option<f64> {
    // What the clock of /proc ticks at, whatever the kernel's own does.
    const TICKS_PER_S: f64 = 100.0;
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    // The program's name, in brackets, may have spaces in it.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<u64>().ok();
    Some((ticks()? + ticks()?) as f64 / TICKS_PER_S)
}

/// This machine.
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
