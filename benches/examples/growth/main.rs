//! How cost grows with samples, streams, trials and cases: processor time, wall time and peak memory of the library paths
//! behind `sixaxis decouple`, `calibrate` and `campaign run`, and of `push_record` and `push_lanes`. What the report's section on
//! speed draws.
//!
//! `cargo run --release -p sixaxis-benches -F studies --example growth` writes `target/growth/growth.json` in less than ten minutes on
//! a quiet machine, `--publish` `benches/results/growth.json`; 19 GB are needed on the disk for a while. `--quick` leaves out the sizes
//! that take long.
//!
//! Each measurement is a process of its own, because the peak memory of a process is that of everything it has ever done: this
//! program starts itself with the work's name. Inputs are made before, and are not measured.

mod given;
mod work;

use std::env;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::{Deserialize, Serialize};
use sixaxis_benches::machine::machine;
use sixaxis_benches::spread::spread;
use sixaxis_props::provenance::{date_utc, output, workspace};
use sixaxis_props::results::{Growth, GrowthCurve, GrowthPoint, Published, Work};

use given::{Given, LONG_SCHEME};

/// What a process says of itself.
#[derive(Serialize, Deserialize)]
pub struct Measured {
    /// Of all threads, s.
    pub processor_s: f64,
    /// From start to end, s.
    pub wall_s: f64,
    /// Largest so far.
    pub peak_memory_bytes: u64,
}

/// Sizes of one kind of work, and how many processes each gets.
type Sizes = &'static [(u64, usize)];

fn sizes(work: Work) -> Sizes {
    match work {
        Work::Decouple => &[
            (10_000, 5),
            (100_000, 5),
            (1_000_000, 5),
            (10_000_000, 3),
            // Minutes and 18 GB of files.
            (100_000_000, 1),
        ],
        Work::PushRecord => &[(10_000, 5), (100_000, 5), (1_000_000, 5), (10_000_000, 3)],
        Work::PushLanes => &[(1, 5), (10, 5), (100, 5), (1_000, 5), (10_000, 3)],
        // Three steps of as many trials, and three compound runs that no estimator is fitted to.
        Work::Calibrate => &[(9, 5), (30, 5), (99, 5), (300, 3), (999, 1)],
        Work::Campaign => &[(100, 3), (200, 3), (500, 1), (1_000, 1)],
    }
}

/// What `--quick` measures of it.
fn quick_sizes(work: Work) -> Sizes {
    &sizes(work)[..2]
}

/// One number of /proc/loadavg: the average over a minute.
fn load() -> Option<f64> {
    let text = fs::read_to_string("/proc/loadavg").ok()?;
    text.split(' ').next()?.parse().ok()
}

fn curve(work: Work, quick: bool, given: &Given) -> Result<GrowthCurve, Box<dyn Error>> {
    let sizes = if quick {
        quick_sizes(work)
    } else {
        sizes(work)
    };
    let mut points = Vec::new();
    for &(size, processes) in sizes {
        eprintln!("{work:?}, {size}");
        given.prepare(work, size)?;
        let mut all = Vec::new();
        for _ in 0..processes {
            let child = Command::new(env::current_exe()?)
                .arg(serde_json::to_string(&work)?)
                .arg(size.to_string())
                .arg(given.folder())
                .output()?;
            if !child.status.success() {
                return Err(String::from_utf8_lossy(&child.stderr).into());
            }
            all.push(serde_json::from_slice::<Measured>(&child.stdout)?);
        }
        given.clear(work)?;
        let of = |value: fn(&Measured) -> f64| spread(all.iter().map(value).collect(), 1.0);
        points.push(GrowthPoint {
            size,
            processes,
            processor_s: of(|m| m.processor_s),
            wall_s: of(|m| m.wall_s),
            peak_memory_bytes: all.iter().map(|m| m.peak_memory_bytes).max().unwrap_or(0),
        });
    }
    Ok(GrowthCurve { work, points })
}

fn publish(path: &Path, growth: &Growth) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(path.parent().unwrap_or(path))?;
    fs::write(path, serde_json::to_string_pretty(growth)? + "\n")?;
    println!("{}", path.display());
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    if let [work, size, folder] = &arguments[..] {
        let measured = work::measured(
            serde_json::from_str(work)?,
            size.parse()?,
            Path::new(folder),
        )?;
        println!("{}", serde_json::to_string(&measured)?);
        return Ok(());
    }
    let (mut quick, mut published) = (false, false);
    for argument in &arguments {
        match &argument[..] {
            "--quick" => quick = true,
            "--publish" => published = true,
            _ => return Err("arguments are --quick and --publish, both or none".into()),
        }
    }
    // Of what is measured, not of what is committed meanwhile.
    let commit = output("git", &["rev-parse", "HEAD"]).unwrap_or_else(|| "unknown".to_owned());
    let sources = [
        "diff",
        "--quiet",
        "HEAD",
        "--",
        "core",
        "lab",
        "benches/examples/growth",
    ];
    let changed_since_commit = output("git", &sources).is_none();
    let before = load();
    let target =
        workspace().join(env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()));
    let given = Given::new(&target.join("growth/work"))?;
    let curves: Result<Vec<_>, _> = Work::ALL
        .into_iter()
        .map(|work| curve(work, quick, &given))
        .collect();
    drop(given);
    let growth = Growth {
        date_utc: date_utc(),
        commit,
        changed_since_commit,
        command: Growth::MAKE.to_owned(),
        quick,
        machine: machine(),
        load: [before, load()],
        scheme: LONG_SCHEME,
        samples_per_stream: given::STREAM_SAMPLES,
        campaign_session: given::campaign_session(),
        curves: curves?,
    };
    let path: PathBuf = match published {
        true => workspace().join(Growth::FILE),
        false => target.join("growth/growth.json"),
    };
    publish(&path, &growth)
}
