//! The command's name, its help, completions and manual pages.

use std::collections::BTreeSet;

use crate::program::{Folder, code, done, run, stderr, stdout};

#[test]
fn inv_it_is_called_sixaxis() {
    let version = stdout(&done(&["--version"]));
    assert_eq!(version, format!("sixaxis {}\n", env!("CARGO_PKG_VERSION")));
    let bare = stdout(&done(&[]));
    assert!(bare.contains("Usage: sixaxis"), "{bare}");
    for shell in ["bash", "zsh", "fish"] {
        assert!(stdout(&done(&["completions", shell])).contains("self-calibrate"));
    }
}

/// Names of the subcommands in a help text.
fn subcommands(help: &str) -> BTreeSet<String> {
    let list = help.split("Commands:\n").nth(1).expect("a list");
    let lines = list.lines().take_while(|line| !line.is_empty());
    let names = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.filter_map(|line| line.split_whitespace().next());
    names.filter(|n| *n != "help").map(str::to_owned).collect()
}

#[test]
fn inv_each_subcommand_has_a_manual_page() {
    let folder = Folder::new("man");
    let printed = stdout(&done(&["man", "--out", &folder.file("pages")]));
    let listed: BTreeSet<&str> = printed.lines().collect();
    let mut expected = vec![("sixaxis".to_owned(), Vec::new())];
    for name in subcommands(&stdout(&done(&["--help"]))) {
        expected.push((format!("sixaxis-{name}"), vec![name]));
    }
    for name in subcommands(&stdout(&done(&["campaign", "--help"]))) {
        expected.push((
            format!("sixaxis-campaign-{name}"),
            vec!["campaign".to_owned(), name],
        ));
    }
    assert!(
        expected.len() >= 10 && expected.len() == listed.len(),
        "{listed:?}"
    );
    for (name, words) in &expected {
        let path = folder.join("pages").join(format!("{name}.1"));
        assert!(listed.contains(path.to_str().expect("UTF-8")), "{name}");
        let page = std::fs::read_to_string(&path).expect("a page");
        assert!(
            page.contains(&format!(".TH {} 1", name.to_uppercase())),
            "{name}: {page:.200}"
        );
        let called = ["sixaxis"]
            .into_iter()
            .chain(words.iter().map(String::as_str));
        let called = called.collect::<Vec<_>>().join(" ").replace('-', "\\-");
        assert!(
            page.contains(&format!("\\fB{called}\\fR")),
            "{called}: {page:.900}"
        );
        let alone: Vec<&str> = std::iter::once("man")
            .chain(words.iter().map(String::as_str))
            .collect();
        assert_eq!(stdout(&done(&alone)), page, "{name}");
    }
    let unknown = run(&["man", "nothing"]);
    assert_eq!(code(&unknown), 1);
    assert!(stderr(&unknown).contains("no subcommand \"nothing\""));
}
