//! docs/exit-codes.md: each row is run, and every code that a command's help names has one.

use std::collections::BTreeSet;
use std::process::Command;

use crate::docs::read;
use crate::program::{Folder, done, stderr, stdout};

/// Commands, code and example of each row.
fn rows(page: &str) -> Vec<(Vec<String>, i32, String)> {
    let cells = page
        .lines()
        .map(|line| line.split('|').map(str::trim).collect());
    let rows = cells.filter_map(|cells: Vec<&str>| match cells[..] {
        ["", commands, code, _, example, ""] => {
            let commands = commands
                .split(", ")
                .map(|name| name.trim_matches('`').to_owned());
            let example = example.strip_prefix('`')?.strip_suffix('`')?;
            Some((commands.collect(), code.parse().ok()?, example.to_owned()))
        }
        _ => None,
    });
    rows.collect()
}

#[test]
fn inv_each_row_of_the_table_of_exit_codes_is_true() {
    let folder = Folder::new("exit_codes");
    let rows = rows(&read("docs/exit-codes.md"));
    for (commands, code, example) in &rows {
        let output = Command::new("bash")
            .args([
                "-c",
                &format!("sixaxis() {{ \"$SIXAXIS\" \"$@\"; }}; {example}"),
            ])
            .env("SIXAXIS", env!("CARGO_BIN_EXE_sixaxis"))
            .current_dir(&*folder)
            .output()
            .expect("bash starts");
        let words = format!("{example}\n{}{}", stdout(&output), stderr(&output));
        assert_eq!(output.status.code(), Some(*code), "{words}");
        let named = |name: &String| name == "all" || example.contains(&format!("sixaxis {name}"));
        assert!(commands.iter().all(named), "{commands:?}: {example}");
    }
    // What the help states of codes, digit by digit, has its row.
    let mut stated = 0;
    for command in [
        "inspect",
        "calibrate",
        "self-calibrate",
        "campaign run",
        "campaign summary",
    ] {
        let mut arguments: Vec<&str> = command.split(' ').collect();
        arguments.push("--help");
        let help = stdout(&done(&arguments));
        let codes = help.split("Exit codes: ").nth(1).expect("codes");
        let is_code = |word: &&str| word.len() == 1 && word.as_bytes()[0].is_ascii_digit();
        let codes: BTreeSet<&str> = codes.split_whitespace().filter(is_code).collect();
        stated += codes.len();
        for code in codes {
            let has = |(commands, of, _): &&(Vec<String>, i32, String)| {
                of.to_string() == code && commands.iter().any(|c| c == command || c == "all")
            };
            assert!(rows.iter().any(|row| has(&row)), "{command}: {code}");
        }
    }
    assert!(rows.len() >= 28 && stated >= 15, "{} {stated}", rows.len());
}
