//! README and docs say what the program does: every `sixaxis` command in a block of `sh` is run, cargo commands name what there is, every path and link
//! exists, and figures that were published are the published ones.

#[cfg(feature = "harness")]
mod field;
mod figures;
mod speeds;

use std::path::{Path, PathBuf};
use std::process::Command;

use sixaxis_recordings::session::SessionFile;

use crate::program::{Folder, stderr, stdout};

/// Long work in the docs, and the same in short for a test.
const SHORTER: [(&str, &str); 1] = [("--count 10000", "--count 3")];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A file of the repository by its path from the root.
pub fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// README and every page of docs, by its path from the root.
fn pages() -> Vec<String> {
    let mut pages = vec!["README.md".to_owned()];
    for folder in ["docs", "docs/decisions"] {
        let files = std::fs::read_dir(root().join(folder)).expect(folder);
        let names = files.map(|file| {
            file.expect(folder)
                .file_name()
                .to_string_lossy()
                .into_owned()
        });
        pages.extend(
            names
                .filter(|name| name.ends_with(".md"))
                .map(|name| format!("{folder}/{name}")),
        );
    }
    pages.sort();
    pages
}

/// The command lines of a page's `sh` blocks, a continued line as one.
fn commands(page: &str) -> Vec<String> {
    let text = read(page).replace("\\\n", " ");
    let blocks = text
        .split("```sh\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next());
    blocks
        .flat_map(str::lines)
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_command_of_the_docs_runs() {
    let mut run = 0;
    for page in pages() {
        let folder = Folder::new(&page.replace(['/', '.'], "-"));
        for line in commands(&page) {
            if line.starts_with("cargo ") {
                assert_cargo_knows(&page, &line);
                continue;
            }
            let mut shell = SHORTER.iter().fold(line.clone(), |line, (long, short)| {
                line.replace(long, short)
            });
            // A page of its own folder has no published plan beside it.
            shell = shell.replace(
                "props/results/",
                &format!("{}/props/results/", root().display()),
            );
            let output = Command::new("bash")
                .args([
                    "-c",
                    &format!("sixaxis() {{ \"$SIXAXIS\" \"$@\"; }}; {shell}"),
                ])
                .env("SIXAXIS", env!("CARGO_BIN_EXE_sixaxis"))
                .current_dir(&*folder)
                .output()
                .expect("bash starts");
            let expected = line
                .split_once("# exit code ")
                .map_or(0, |(_, rest)| rest[..1].parse().expect("a digit"));
            assert_eq!(
                output.status.code(),
                Some(expected),
                "{page}: {line}\n{}{}",
                stdout(&output),
                stderr(&output)
            );
            // The page quotes what this one says.
            if line.starts_with("sixaxis self-calibrate") {
                let said = stdout(&output);
                let first = said.lines().next().unwrap_or_default();
                let quoted = on_one_line(&page).contains(first.trim_end_matches('.'));
                assert!(quoted && !first.is_empty(), "{page} has not: {first}");
            }
            if line.ends_with("--out open.csv") {
                let said = stderr(&output);
                let (before, _) = said.split_once(" s on the attitude").expect(&said);
                let (_, end_s) = before.rsplit_once("from ").expect(&said);
                let end_s: f64 = end_s.parse().expect("a time");
                let sentence = format!("Ground axes end at {end_s:.1} s without aids");
                assert!(
                    on_one_line(&page).contains(&sentence),
                    "{page} has not: {sentence}"
                );
            }
            run += 1;
        }
    }
    // A change of the fences must not turn this into a test of nothing.
    assert!(run >= 12, "{run} commands found");
}

/// Cargo commands build or run for minutes; here only that what they name exists.
fn assert_cargo_knows(page: &str, line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let after = |flag: &str| {
        words
            .iter()
            .position(|w| *w == flag)
            .map(|at| words[at + 1])
    };
    if let Some(example) = after("--example") {
        let package = after("-p")
            .expect("a package")
            .trim_start_matches("sixaxis-");
        let file = root().join(package).join("examples").join(example);
        assert!(
            file.with_extension("rs").is_file() || file.join("main.rs").is_file(),
            "{page}: {line}"
        );
    } else {
        let known = [
            "cargo run --release -- report",
            "cargo test --workspace",
            "cargo bench",
            "cargo build --release",
        ];
        assert!(
            known.iter().any(|known| line.starts_with(known)),
            "{page}: {line}"
        );
    }
}

#[test]
fn every_link_of_the_docs_leads_somewhere() {
    for page in pages() {
        let text = read(&page);
        let from = root().join(&page);
        for link in text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next())
        {
            let path = link.split('#').next().unwrap_or_default();
            assert!(from.with_file_name(path).exists(), "{page}: {link}");
        }
    }
}

/// A file or folder of the tree that a page names as code, such as `core/src/scheme.rs`.
#[test]
fn every_path_of_the_docs_exists() {
    let rooms = [
        "core/",
        "reference/",
        "props/",
        "benches/",
        "reports/",
        "lab/",
        "docs/",
        ".ci/",
    ];
    let mut found = 0;
    for page in pages().into_iter().chain(["CONTRIBUTING.md".to_owned()]) {
        for code in read(&page).split('`').skip(1).step_by(2) {
            // Recipes name a file to be written in capitals.
            let named = rooms.iter().any(|room| code.starts_with(room)) && !code.contains("FORMAT");
            if named && !code.contains(' ') {
                assert!(root().join(code).exists(), "{page}: {code}");
                found += 1;
            }
        }
    }
    assert!(found >= 40, "{found} paths found");
}

#[test]
fn the_session_in_the_docs_is_accepted() {
    let docs = read("docs/session.md");
    let text = docs
        .split("```toml\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .expect("a session file");
    let file = SessionFile::parse(Path::new("session.toml"), text.to_owned())
        .unwrap_or_else(|error| panic!("{error}"));
    // At rest, a linear trial and a tap.
    assert_eq!(file.session.recording.len(), 3);
}

/// Every module of a test binary of `props` is a suite with a truth of its own.
#[test]
fn every_suite_stands_in_the_docs() {
    let docs = read("docs/evidence.md");
    let rows = docs.lines().filter(|line| line.starts_with("| `"));
    let rows: Vec<&str> = rows.filter_map(|line| line.split('|').nth(1)).collect();
    for folder in ["laws", "reference", "sessions"] {
        let main = read(&format!("props/tests/{folder}/main.rs"));
        let modules = main
            .lines()
            .filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
        for suite in modules {
            let named = rows.iter().any(|row| row.contains(&format!("`{suite}`")));
            assert!(
                named || suite == "fast_ways",
                "docs/evidence.md has not the suite {suite}"
            );
        }
    }
}

/// A page on one line, so that a sentence is found wherever it is broken.
fn on_one_line(page: &str) -> String {
    read(page).split_whitespace().collect::<Vec<_>>().join(" ")
}

fn published(name: &str) -> serde_json::Value {
    json(&format!("props/results/{name}.json"))["result"].take()
}

fn json(path: &str) -> serde_json::Value {
    serde_json::from_str(&read(path)).expect("JSON")
}
