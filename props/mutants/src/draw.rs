//! Which mutants are tried: a sample of every module, by a seed that nobody chooses.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::sites::{self, Mutant};

/// One crate, what of it is mutated, and how many mutants are wanted.
pub struct Crate {
    /// Package.
    pub package: &'static str,
    /// Its lib.rs, below the workspace.
    pub library: &'static str,
    /// How the instrumented code calls the switch.
    pub switch: &'static str,
    /// Files and folders below src; empty for all.
    pub parts: &'static [&'static str],
    /// Viable mutants wanted.
    pub wanted: usize,
}

/// What is mutated.
pub const CRATES: [Crate; 2] = [
    Crate {
        package: "sixaxis-core",
        library: "core/src/lib.rs",
        switch: "crate::mutant::on",
        parts: &[],
        wanted: 420,
    },
    Crate {
        package: "sixaxis-calibration",
        library: "lab/calibration/src/lib.rs",
        switch: "sixaxis_core::mutant::on",
        // What judges: from parameters and intervals to findings and a grade.
        parts: &[
            "diagnosis",
            "finding",
            "grade",
            "interval",
            "propagation",
            "steps",
            "joint",
            "gain_prior",
            "response",
        ],
        wanted: 120,
    },
];

/// Fewest of a module, if it has as many.
const FEWEST: usize = 10;
/// A folder's part with fewer sites than this is counted with its neighbours.
const SMALL: usize = 150;
/// Drawn for each that is wanted: some do not compile.
const SPARE: f64 = 1.6;

/// A mutant that no suite may let pass, in every build to try the trial itself: the sign of (2).
const FATAL: (&str, &str) = ("core/src/paper/limb_law.rs", "- to nothing");

/// A module of a crate.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Module {
    /// Package and path.
    pub name: String,
    /// All mutants that the sources have.
    pub all: usize,
    /// Of them in constants and statics, which are never drawn.
    pub constants: usize,
    /// Viable ones wanted.
    pub wanted: usize,
}

/// A drawn mutant.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Drawn {
    /// What turns it on; from one.
    pub id: u32,
    /// Place in [`Draw::modules`].
    pub module: usize,
    /// The change.
    pub mutant: Mutant,
}

/// The sample, in the order in which it is tried, which is itself drawn: any first part of it is a sample, too.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Draw {
    /// The commit that seeds it.
    pub seed: String,
    /// All modules.
    pub modules: Vec<Module>,
    /// More than are wanted, and as the last the fatal one.
    pub drawn: Vec<Drawn>,
}

impl Draw {
    /// Without the fatal one.
    pub fn sample(&self) -> &[Drawn] {
        &self.drawn[..self.drawn.len() - 1]
    }

    /// The mutant that must be caught.
    pub fn fatal(&self) -> &Drawn {
        &self.drawn[self.drawn.len() - 1]
    }
}

/// Draws. `share` scales the numbers wanted.
pub fn draw(root: &Path, seed: Option<String>, share: f64) -> Draw {
    let seed = seed.unwrap_or_else(|| last_commit(root));
    let mut modules = Vec::new();
    let mut drawn = Vec::new();
    let mut fatal = None;
    for of in &CRATES {
        let library = Path::new(of.library);
        let source = library.parent().unwrap_or(library);
        let mut by_module: BTreeMap<String, Vec<Mutant>> = BTreeMap::new();
        for mutant in sites::of_crate(root, library) {
            if mutant.file == Path::new(FATAL.0) && mutant.what == FATAL.1 {
                fatal = Some(mutant.clone());
            }
            let below = mutant.file.strip_prefix(source).unwrap_or(&mutant.file);
            let path = below.with_extension("");
            let mut parts = path.iter().map(|p| p.to_string_lossy().into_owned());
            let first = parts.next().unwrap_or_default();
            if of.parts.is_empty() || of.parts.contains(&&*first) {
                let second = parts.next().filter(|p| p != "mod");
                let name = second.map_or(first.clone(), |second| format!("{first}/{second}"));
                by_module.entry(name).or_default().push(mutant);
            }
        }
        let by_module = merged(by_module, of.parts.is_empty());
        let total: usize = by_module.values().map(|m| tryable(m).count()).sum();
        let wanted = of.wanted as f64 * share;
        for (name, mutants) in by_module {
            let all = mutants.len();
            let mut able: Vec<&Mutant> = tryable(&mutants).collect();
            able.sort_by_key(|m| key(&seed, &m.name()));
            let proportional = (wanted * able.len() as f64 / total as f64).round() as usize;
            let wanted = proportional.max(FEWEST).min(able.len());
            let count = (wanted as f64 * SPARE).ceil() as usize + 4;
            let module = modules.len();
            drawn.extend(able.into_iter().take(count).map(|mutant| Drawn {
                id: 0,
                module,
                mutant: mutant.clone(),
            }));
            modules.push(Module {
                name: format!("{} {name}", of.package),
                all,
                constants: all - tryable(&mutants).count(),
                wanted,
            });
        }
    }
    drawn.sort_by_key(|d| key(&seed, &d.mutant.name()));
    drawn.push(Drawn {
        id: 0,
        module: 0,
        mutant: fatal.expect("the fatal mutant is where it was"),
    });
    for (id, drawn) in (1..).zip(&mut drawn) {
        drawn.id = id;
    }
    Draw {
        seed,
        modules,
        drawn,
    }
}

fn tryable(mutants: &[Mutant]) -> impl Iterator<Item = &Mutant> {
    mutants.iter().filter(|m| !m.constant)
}

/// Small parts of a folder together, with the file of the same name; and small files at the head of a whole crate.
fn merged(by_module: BTreeMap<String, Vec<Mutant>>, whole: bool) -> BTreeMap<String, Vec<Mutant>> {
    let folder_of = |name: &str| name.split('/').next().unwrap_or_default().to_owned();
    let parts: Vec<String> = by_module
        .keys()
        .filter(|n| n.contains('/'))
        .cloned()
        .collect();
    let mut out: BTreeMap<String, Vec<Mutant>> = BTreeMap::new();
    for (name, mutants) in by_module {
        let folder = folder_of(&name);
        let name = if mutants.len() >= SMALL {
            name
        } else if parts.iter().any(|part| folder_of(part) == folder) {
            format!("{folder}, rest")
        } else if whole {
            "files at its head".to_owned()
        } else {
            name
        };
        out.entry(name).or_default().extend(mutants);
    }
    out
}

/// The last commit that changed what is mutated.
fn last_commit(root: &Path) -> String {
    let folders = CRATES.iter().map(|c| c.library.trim_end_matches("/lib.rs"));
    let git = Command::new("git")
        .current_dir(root)
        .args(["log", "-1", "--format=%H", "--"])
        .args(folders)
        .output()
        .expect("git runs");
    String::from_utf8_lossy(&git.stdout).trim().to_owned()
}

/// A number that depends on every letter: FNV-1a, then the finish of SplitMix64.
fn key(seed: &str, name: &str) -> u64 {
    let mut x = 0xcbf2_9ce4_8422_2325_u64;
    for byte in seed.bytes().chain(name.bytes()) {
        x = (x ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
