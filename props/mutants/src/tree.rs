//! A copy of the workspace with the sample in it, built once.

use std::collections::{BTreeMap, BTreeSet};
use std::env;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::draw::{CRATES, Draw, Drawn};
use crate::rewrite::{self, Written};

/// Packages whose tests are run.
const TESTED: [&str; 4] = [
    "sixaxis-core",
    "sixaxis-calibration",
    "sixaxis-campaign",
    "sixaxis-props",
];

/// Lints that refuse a program which surely overflows or panics: that is for the tests to find.
const LINTS: &str = "[workspace.lints.rust]\narithmetic_overflow = \"allow\"\nunconditional_panic = \"allow\"\n\
                     unconditional_recursion = \"allow\"";

/// Where mujoco-rs looks for its library.
const LINKS: &str = "MUJOCO_DYNAMIC_LINK_DIR";

/// In the list of what earlier builds refused, before mutants in functions that must stay constant.
const CONST: &str = "const: ";

/// A test program.
pub struct Program {
    /// Where it lies.
    pub path: PathBuf,
    /// Where it runs: its package.
    pub folder: PathBuf,
    /// Package and target.
    pub name: String,
}

/// What is left of a draw, and what it is tried with.
pub struct Built {
    /// Mutants that compile.
    pub viable: BTreeSet<u32>,
    /// Mutants in functions that a constant needs.
    pub needed_const: BTreeSet<u32>,
    /// Test programs.
    pub programs: Vec<Program>,
}

/// Copies, writes the mutants in, builds, drops what does not compile, and builds again until all does.
pub fn build(root: &Path, out: &Path, draw: &Draw) -> Built {
    let tree = out.join("tree");
    let list = out.join("refused.txt");
    let known = fs::read_to_string(&list).unwrap_or_default();
    let mut known: BTreeSet<String> = known.lines().map(ToOwned::to_owned).collect();
    let named = |known: &BTreeSet<String>, prefix: &str| -> BTreeSet<u32> {
        let is = |d: &&Drawn| known.contains(&format!("{prefix}{}", d.mutant.name()));
        draw.drawn.iter().filter(is).map(|d| d.id).collect()
    };
    let lost = named(&known, "");
    let mut needed_const = named(&known, CONST);
    let mut kept: BTreeSet<u32> = draw.drawn.iter().map(|d| d.id).collect();
    kept.retain(|id| !lost.contains(id) && !needed_const.contains(id));
    for round in 1.. {
        let written = write(root, &tree, draw, &kept);
        let (messages, success) = cargo(root, &tree, out);
        let (lost, constant) = refused(&messages, &written, draw, &kept);
        println!(
            "build {round}: {} mutants in it, {} do not compile, {} are needed by constants",
            kept.len(),
            lost.len(),
            constant.len()
        );
        if success {
            let programs = programs(&messages);
            return Built {
                viable: kept,
                needed_const,
                programs,
            };
        }
        if lost.is_empty() && constant.is_empty() {
            for message in errors(&messages) {
                eprintln!("{}", message["rendered"].as_str().unwrap_or_default());
            }
            panic!("the copy does not compile, and no mutant is to blame");
        }
        kept.retain(|id| !lost.contains(id) && !constant.contains(id));
        for one in &draw.drawn {
            if constant.contains(&one.id) {
                known.insert(format!("{CONST}{}", one.mutant.name()));
            } else if lost.contains(&one.id) {
                known.insert(one.mutant.name());
            }
        }
        let lines: Vec<&str> = known.iter().map(String::as_str).collect();
        put(&list, lines.join("\n").as_bytes());
        needed_const.extend(constant);
    }
    unreachable!("rounds are counted without end");
}

/// Writes the copy; files that are as they should be stay untouched, so that cargo finds them so.
fn write(
    root: &Path,
    tree: &Path,
    draw: &Draw,
    kept: &BTreeSet<u32>,
) -> BTreeMap<PathBuf, Written> {
    let mut by_file: BTreeMap<&Path, Vec<&Drawn>> = BTreeMap::new();
    for one in draw.drawn.iter().filter(|d| kept.contains(&d.id)) {
        by_file.entry(&one.mutant.file).or_default().push(one);
    }
    let listed = Command::new("git")
        .current_dir(root)
        .args([
            "ls-files",
            "--cached",
            "--others",
            "--exclude-standard",
            "-z",
        ])
        .output()
        .expect("git runs");
    let mut changed = BTreeMap::new();
    for name in String::from_utf8_lossy(&listed.stdout).split_terminator('\0') {
        let file = Path::new(name);
        // Deleted, and not committed yet.
        let Ok(mut bytes) = fs::read(root.join(file)) else {
            continue;
        };
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        if let Some(drawn) = by_file.get(file) {
            let of = CRATES
                .iter()
                .find(|c| file.starts_with(Path::new(c.library).parent().unwrap_or(file)))
                .expect("a mutant lies in a crate");
            let written = rewrite::file(&text(&bytes), drawn, of.switch);
            bytes = written.text.clone().into_bytes();
            changed.insert(file.to_owned(), written);
        }
        if name == "Cargo.toml" {
            bytes = text(&bytes)
                .replace("[workspace.lints.rust]", LINTS)
                .into_bytes();
        }
        if name == CRATES[0].library {
            bytes.extend_from_slice(b"\n#[doc(hidden)]\npub mod mutant;\n");
        }
        put(&tree.join(file), &bytes);
    }
    let size = draw.drawn.len() + 1;
    let switch = format!(
        "{}\nconst MUTANTS: usize = {size};\n",
        include_str!("switch.rs")
    );
    put(&tree.join("core/src/mutant.rs"), switch.as_bytes());
    changed
}

fn put(path: &Path, bytes: &[u8]) {
    if fs::read(path).is_ok_and(|old| old == bytes) {
        return;
    }
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    }
    fs::write(path, bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
}

fn cargo(root: &Path, tree: &Path, out: &Path) -> (Vec<Value>, bool) {
    let mut command = Command::new("cargo");
    // Cargo, which started this program, names the workspace's own folder of links here; the copy has one of its own, and takes any
    // other for its user's.
    if env::var_os(LINKS).is_some_and(|dir| Path::new(&dir) == root.join("reference/link")) {
        command.env_remove(LINKS);
    }
    let output = command
        .current_dir(tree)
        .args(["test", "--release", "--no-run", "--lib", "--tests"])
        .args(["--no-fail-fast", "--message-format=json"])
        .args(TESTED.iter().flat_map(|name| ["-p", name]))
        .env("CARGO_TARGET_DIR", out.join("target"))
        .stderr(Stdio::inherit())
        .output()
        .expect("cargo runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let messages = text.lines().filter_map(|l| serde_json::from_str(l).ok());
    (messages.collect(), output.status.success())
}

fn errors(messages: &[Value]) -> impl Iterator<Item = &Value> {
    messages
        .iter()
        .filter(|m| m["reason"] == "compiler-message")
        .map(|m| &m["message"])
        .filter(|m| m["level"] == "error")
}

/// Whom the errors accuse: mutants that do not compile, and mutants in functions that must stay constant.
fn refused(
    messages: &[Value],
    written: &BTreeMap<PathBuf, Written>,
    draw: &Draw,
    kept: &BTreeSet<u32>,
) -> (BTreeSet<u32>, BTreeSet<u32>) {
    let (mut lost, mut constant) = (BTreeSet::new(), BTreeSet::new());
    for error in errors(messages) {
        let text = error["message"].as_str().unwrap_or_default();
        if text.starts_with("cannot call non-const")
            && let Some(path) = text.split('`').nth(1)
        {
            let name = path.rsplit("::").next().unwrap_or(path);
            let called = |one: &&Drawn| {
                let function = &one.mutant.function;
                one.mutant.const_fn.is_some() && function.rsplit("::").next() == Some(name)
            };
            let ids = draw.drawn.iter().filter(called).map(|one| one.id);
            constant.extend(ids.filter(|id| kept.contains(id)));
            continue;
        }
        for span in error["spans"].as_array().into_iter().flatten() {
            let bytes = |field: &str| span[field].as_u64().unwrap_or_default() as usize;
            let range = bytes("byte_start")..bytes("byte_end");
            let name = span["file_name"].as_str().unwrap_or_default();
            if let Some(file) = written.get(Path::new(name)) {
                lost.extend(accused(file, &range, span["is_primary"] == true));
            }
        }
    }
    (lost, constant)
}

/// Mutants whose own text the range touches; failing those and at an error's own place, those of the smallest expression around it.
fn accused(file: &Written, range: &Range<usize>, primary: bool) -> Vec<u32> {
    let touches = |other: &Range<usize>| other.start <= range.start && range.end <= other.end;
    let own: Vec<u32> = file
        .branches
        .iter()
        .filter(|(_, branch)| touches(branch))
        .map(|(id, _)| *id)
        .collect();
    if !own.is_empty() || !primary {
        return own;
    }
    let around = file.sites.iter().filter(|(_, site)| touches(site));
    around
        .min_by_key(|(_, site)| site.len())
        .map(|(ids, _)| ids.clone())
        .unwrap_or_default()
}

fn programs(messages: &[Value]) -> Vec<Program> {
    let mut programs: Vec<Program> = messages
        .iter()
        .filter(|m| m["reason"] == "compiler-artifact" && m["profile"]["test"] == true)
        .filter_map(|m| {
            let manifest = Path::new(m["manifest_path"].as_str()?);
            let folder = manifest.parent()?.to_owned();
            let package = folder.file_name()?.to_string_lossy().into_owned();
            Some(Program {
                path: m["executable"].as_str()?.into(),
                name: format!("{package}/{}", m["target"]["name"].as_str()?),
                folder,
            })
        })
        .collect();
    programs.sort_by(|a, b| a.name.cmp(&b.name));
    programs
}
