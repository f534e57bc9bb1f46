//! The forbidden arrows of `docs/architecture.md`, over the manifests, over what cargo resolves and over imports.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Arrows that no table may allow; the folder of nothing stands for any crate.
const FORBIDDEN: [(&str, &str); 5] = [
    ("reference", "core"),
    ("reference", "lab/calibration"),
    ("lab/recordings", "lab/calibration"),
    ("reports/page", ""),
    ("", "lab/sixaxis"),
];

/// Modules of core that `core/src/error.rs` may import: plain data that import no feature themselves.
const DATA: [&str; 4] = ["geometry", "limb_set", "parameter", "unobservable"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Each crate by its folder, with all that it may import of ours: the table of `docs/architecture.md`.
fn allowed() -> BTreeMap<String, BTreeSet<String>> {
    let text = fs::read_to_string(root().join("docs/architecture.md")).expect("text");
    let (_, table) = text.split_once("imports of ours |").expect("the table");
    let rows = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let mut found: BTreeMap<String, BTreeSet<String>> = rows
        .map(|row| {
            let cells: Vec<&str> = row.split('|').map(str::trim).collect();
            let imports = cells[3].split('`').skip(1).step_by(2).map(str::to_owned);
            (cells[1].trim_matches('`').to_owned(), imports.collect())
        })
        .collect();
    // The command may import all.
    let all = found.keys().cloned().collect();
    found.insert("lab/sixaxis".to_owned(), all);
    found
}

fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .current_dir(root())
        .output()
        .expect("cargo runs");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).expect("text")
}

/// Dependencies of each crate on others of ours, by folder; those of tests, benches and examples are left out.
fn manifests() -> BTreeMap<String, BTreeSet<String>> {
    let text = cargo(&[
        "metadata",
        "--format-version",
        "1",
        "--no-deps",
        "--offline",
    ]);
    let metadata: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let text = |value: &serde_json::Value| value.as_str().expect("text").to_owned();
    let root = PathBuf::from(text(&metadata["workspace_root"]));
    let folder = |path: &Path| {
        let inside = path.strip_prefix(&root).expect("inside the workspace");
        inside.display().to_string()
    };
    let mut found = BTreeMap::new();
    for package in metadata["packages"].as_array().expect("packages") {
        let manifest = PathBuf::from(text(&package["manifest_path"]));
        let dependencies = package["dependencies"].as_array().expect("dependencies");
        let ours = dependencies
            .iter()
            .filter(|dependency| dependency["kind"] != "dev")
            .filter_map(|dependency| Some(folder(Path::new(dependency["path"].as_str()?))));
        found.insert(
            folder(manifest.parent().expect("a folder")),
            ours.collect::<BTreeSet<_>>(),
        );
    }
    found
}

/// All Rust sources below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

/// The identifier by which others import the crate in a folder.
fn identifier(folder: &str) -> String {
    match folder.rsplit('/').next() {
        Some("sixaxis") => "sixaxis".to_owned(),
        name => format!("sixaxis_{}", name.unwrap_or_default()),
    }
}

#[test]
fn inv_the_table_allows_no_forbidden_arrow() {
    for (name, imports) in allowed() {
        for other in imports.iter().filter(|other| **other != name) {
            let forbidden = FORBIDDEN.iter().find(|(from, to)| {
                (from.is_empty() || *from == name) && (to.is_empty() || to == other)
            });
            assert_eq!(forbidden, None, "{name} -> {other}");
        }
    }
}

#[test]
fn inv_manifests_hold_no_other_arrow() {
    let (manifests, allowed) = (manifests(), allowed());
    assert!(
        manifests.keys().eq(allowed.keys()),
        "docs/architecture.md: {:?} is not {:?}",
        allowed.keys(),
        manifests.keys()
    );
    for (name, imports) in manifests {
        for other in imports {
            assert!(
                allowed[&name].contains(&other),
                "{name}/Cargo.toml: forbidden arrow to {other}"
            );
        }
    }
}

#[test]
fn inv_sources_hold_no_other_arrow() {
    let allowed = allowed();
    for (name, imports) in &allowed {
        let files = sources(&root().join(name).join("src"));
        assert!(!files.is_empty(), "{name} has sources");
        for file in files {
            let text = fs::read_to_string(&file).expect("text");
            for (number, line) in text.lines().enumerate() {
                let code = line.split("//").next().unwrap_or_default();
                for other in allowed.keys().filter(|other| *other != name) {
                    let import = identifier(other) + "::";
                    let imported = code.match_indices(&import).any(|(at, _)| {
                        !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_')
                    });
                    assert!(
                        !imported || imports.contains(other),
                        "{}:{}: forbidden arrow to {other}: {line}",
                        file.display(),
                        number + 1
                    );
                }
            }
        }
    }
}

#[test]
fn inv_errors_import_no_feature() {
    let text = fs::read_to_string(root().join("core/src/error.rs")).expect("text");
    let imports: Vec<&str> = text
        .lines()
        .filter_map(|line| line.split("//").next()?.split_once("crate::"))
        .map(|(_, path)| path.split(':').next().unwrap_or_default())
        .collect();
    assert!(!imports.is_empty(), "imports are found");
    for module in imports {
        assert!(DATA.contains(&module), "core/src/error.rs imports {module}");
    }
}

#[test]
fn inv_only_the_harness_links_mujoco_and_proptest() {
    let linked = |package: &str, crates: [&str; 2]| {
        let arguments = [
            "tree",
            "--offline",
            "--prefix",
            "none",
            "-e",
            "normal",
            "-p",
            package,
        ];
        let tree = cargo(&arguments);
        crates.map(|name| {
            tree.lines()
                .any(|line| line.starts_with(&format!("{name} ")))
        })
    };
    let forbidden = ["mujoco-rs", "proptest"];
    for package in ["sixaxis-recordings", "sixaxis-calibration", "sixaxis-page"] {
        assert_eq!(linked(package, forbidden), [false, false], "{package}");
    }
    // The report needs MuJoCo; what is linked is seen.
    for package in ["sixaxis-reports", "sixaxis"] {
        assert_eq!(linked(package, forbidden), [true, false], "{package}");
    }
}
