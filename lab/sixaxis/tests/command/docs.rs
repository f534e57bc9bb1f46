//! README and docs say what the program does: every command in them is run, every figure that was published is the published one.

use std::path::{Path, PathBuf};
use std::process::Command;

use sixaxis_recordings::session::SessionFile;

use crate::program::{Folder, stderr, stdout};

/// Long work in the docs, and the same in short for a test.
const SHORTER: [(&str, &str); 1] = [("--count 10000", "--count 3")];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &str) -> String {
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
            run += 1;
        }
    }
    // A change of the fences must not turn this into a test of nothing.
    assert!(run >= 12, "{run} commands found");
}

/// Cargo commands build or run for minutes; here only that what they name exists. `.ci/run` runs the main ones.
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

#[test]
fn the_grades_in_the_docs_are_the_published_ones() {
    let docs = on_one_line("docs/session.md");
    let published = published("blind");
    let share = |share: &serde_json::Value| {
        let number = |key: &str| share[key].as_f64().expect(key);
        let (count, of) = (number("count"), number("of"));
        let [low, high] = ["low_95", "high_95"].map(|key| 100.0 * number(key));
        format!("{count} of {of} ({low:.1} to {high:.1} %)")
    };
    let cell = |cell: serde_json::Value| {
        let rows = published["healthy"].as_array().expect("healthy rows");
        let row = rows.iter().find(|row| row["cell"] == cell).expect("a cell");
        share(&row["tally"]["good"])
    };
    for sentence in [
        format!("{} sessions", published["sessions"]),
        format!(
            "called good and are not: {}",
            share(&published["false_good"])
        ),
        format!("wrong cause: {}", share(&published["wrong_cause_of_named"])),
        format!("in the corner {}", cell("corner".into())),
        format!(
            "in the gentle room {}",
            cell(serde_json::json!({"room": "gentle"}))
        ),
        format!(
            "in the usual room {}",
            cell(serde_json::json!({"room": "usual"}))
        ),
    ] {
        assert!(docs.contains(&sentence), "{sentence}");
    }
}

#[test]
fn the_headline_of_the_readme_is_the_published_one() {
    let published = published("laboratories");
    let errors = |set: &str, treated: &str, against: &str| {
        let list = published[set][treated][against].as_array().expect(set);
        let percent = list.iter().map(|e| 100.0 * e.as_f64().expect("a number"));
        percent.collect::<Vec<f64>>()
    };
    // Nearest rank, as the report's table has it.
    let median_and_worst = |mut errors: Vec<f64>| {
        errors.sort_by(f64::total_cmp);
        let middle = errors.len().div_ceil(2) - 1;
        (errors[middle], errors[errors.len() - 1])
    };
    let instruments = |treated| errors("identified", treated, "instruments");
    let (open, corrected) = (instruments("open_loop"), instruments("corrected"));
    let of_class = corrected.iter().filter(|e| **e <= 1.0).count();
    let (seed_1, seed_1_corrected) = (open[0], corrected[0]);
    let count = open.len();
    let (median, worst) = median_and_worst(open);
    let (median_corrected, worst_corrected) = median_and_worst(corrected);
    let (before, _) = median_and_worst(errors("design", "open_loop", "instruments"));
    let readme = on_one_line("README.md");
    for sentence in [
        format!(
            "median {median:.1} %, worst {worst:.1} % of {count} laboratories (before identification {before:.0} %)"
        ),
        format!(
            "median {median_corrected:.1} %, worst {worst_corrected:.1} % when each run is corrected from rest to rest"
        ),
        format!("Seed 1 is a lucky one: {seed_1:.1} % and {seed_1_corrected:.2} %"),
        format!("{of_class} of {count} laboratories keep all 18 cells within 1 %"),
    ] {
        assert!(readme.contains(&sentence), "{sentence}");
    }
}

#[test]
fn the_figures_from_the_field_are_the_published_ones() {
    let docs = on_one_line("docs/field.md");
    let (tumbles, sets, detection) = (
        published("self_calibration"),
        published("failed_limbs"),
        published("detection"),
    );
    let minute = |pace: &str| {
        let lengths = tumbles["lengths"].as_array().expect("lengths");
        let found = lengths
            .iter()
            .find(|l| l["pace"] == pace && l["duration_s"] == 60.0)
            .expect(pace);
        ["rms_error", "largest_error"].map(|key| 100.0 * found[key].as_f64().expect(key))
    };
    let ([rms, worst], [shaken_rms, shaken_worst]) = (minute("brisk"), minute("shaken"));
    let coverage = tumbles["lengths"][0]["coverage_95_by_limb"]
        .as_array()
        .expect("nine");
    let coverage = coverage
        .iter()
        .map(|c| 100.0 * c.as_f64().expect("a share"));
    let (low, high) = coverage.fold((f64::MAX, 0.0), |(a, b), c| (c.min(a), c.max(b)));
    let ratios = |key: &str| {
        let all = sets["sets"].as_array().expect("sets").iter();
        all.filter_map(|set| set[key].as_f64()).fold(0.0, f64::max)
    };
    let whole = |key: &str| sets[key].as_u64().expect(key);
    let isolated = detection["classes"]
        .as_array()
        .expect("classes")
        .iter()
        .map(|class| {
            let of = |key: &str| class["isolated"][key].as_f64().expect(key);
            of("right") / (of("right") + of("wrong") + of("open"))
        })
        .fold(1.0, f64::min);
    for sentence in [
        format!("determines a ratio to {rms:.3} % rms, the worst of 120 records to {worst:.3} %"),
        format!("shaken, to {shaken_rms:.3} % and {shaken_worst:.3} %"),
        format!("hold {low:.1} to {high:.1} % of the truths, limb by limb"),
        format!("{} can be excluded", whole("survivable")),
        format!("{} sets stay within twice", whole("within_twice")),
        format!("the worst at {:.1} times", ratios("error_ratio")),
        format!(
            "all {} do, the worst at {:.2} times",
            whole("within_twice_consistent"),
            ratios("error_ratio_consistent")
        ),
        format!(
            "isolated in {:.1} % of the cases to its group",
            100.0 * isolated
        ),
    ] {
        assert!(docs.contains(&sentence), "{sentence}");
    }
}

/// Peers by their names in the published file and in the table of docs/speed.md.
const PEERS: [(&str, &str); 8] = [
    (
        "closed_form",
        "the same formulas in plain C++, `g++ -O3 -march=native`",
    ),
    ("closed_form_fast_math", "the same with `-ffast-math`"),
    ("numba_lean", "the same in numba, nothing allocated"),
    ("jax_scan", "the same in JAX, `lax.scan`, jitted"),
    (
        "numpy_vectorised",
        "the same in NumPy, vectorised over the record",
    ),
    (
        "eigen",
        "the equations as printed in C++ with Eigen, pose by Gauss-Newton",
    ),
    (
        "mujoco_inverse",
        "MuJoCo's inverse dynamics of one body, state and limb forces given",
    ),
    ("pinocchio_rnea", "Pinocchio's, likewise"),
];

/// Two significant digits, thousands set off.
fn two_digits(value: f64) -> String {
    let text = format!("{value:.1e}");
    let (_, exponent) = text.split_once('e').expect("a power of ten");
    let exponent: usize = exponent.parse().unwrap_or(0);
    let rounded: f64 = text.parse().expect("a number");
    let decimals = if rounded < 1.0 {
        2
    } else {
        1_usize.saturating_sub(exponent)
    };
    let digits = format!("{rounded:.decimals$}");
    match digits.len() {
        4.. if rounded >= 1e3 => {
            let (thousands, rest) = digits.split_at(digits.len() - 3);
            format!("{thousands},{rest}")
        }
        _ => digits,
    }
}

#[test]
fn the_speeds_in_the_docs_are_the_published_ones() {
    for (value, words) in [
        (0.984, "0.98"),
        (1.04, "1.0"),
        (9.96, "10"),
        (27.6, "28"),
        (2328.0, "2,300"),
    ] {
        assert_eq!(two_digits(value), words);
    }
    let docs = read("docs/speed.md");
    let published = json("benches/results/speed.json");
    let peers = published["peers"]["peers"].as_array().expect("peers");
    let ratios = |name: &str| {
        let peer = peers.iter().find(|peer| peer["name"] == name).expect(name);
        ["push", "record", "lanes"]
            .map(|base| two_digits(peer["ratio_to"][base]["median"].as_f64().expect(base)))
    };
    let rows = PEERS.map(|(name, words)| format!("| {words} | {} |", ratios(name).join(" | ")));
    let missing: Vec<_> = rows.iter().filter(|row| !docs.contains(*row)).collect();
    assert!(
        missing.is_empty(),
        "docs/speed.md has not\n{}",
        rows.join("\n")
    );

    let text = |value: &serde_json::Value| value.as_str().expect("text").to_owned();
    let run = &published["peers"];
    let measured = format!(
        "{}, commit {}, {}",
        text(&run["machine"]["cpu"]),
        &text(&run["commit"])[..9],
        &text(&run["date_utc"])[..10],
    );
    assert!(
        on_one_line("docs/speed.md").contains(&measured),
        "docs/speed.md: {measured}"
    );
}

#[test]
fn the_speeds_in_the_readme_are_the_published_ones() {
    let readme = on_one_line("README.md");
    let instructions = json("benches/instructions.json");
    let speed = json("benches/results/speed.json");
    let peers = speed["peers"]["peers"].as_array().expect("peers");
    let fast = peers
        .iter()
        .find(|peer| peer["name"] == "closed_form_fast_math")
        .expect("closed_form_fast_math");
    let [push, record, lanes] = ["push", "record", "lanes"]
        .map(|base| two_digits(fast["ratio_to"][base]["median"].as_f64().expect(base)));
    let count = |name: &str| {
        instructions["per_sample"][name]
            .as_f64()
            .expect(name)
            .round()
    };
    let page = read("docs/microcontroller.md");
    let row = page
        .lines()
        .find(|line| line.starts_with("| instructions a sample"))
        .expect("a row");
    let cells: Vec<_> = row.split('|').map(str::trim).collect();
    for sentence in [
        format!(
            "takes {} instructions a sample, a build for any x86-64, which finds wider registers at run time, {}.",
            count("push/full/heun"),
            count("plain/push/full/heun"),
        ),
        format!(
            "it is {push} times as fast as the same formulas in plain C++ with `-ffast-math` in the same run, whole recordings {record}, lanes \
             {lanes} times"
        ),
        format!(
            "`push` takes {} instructions a sample in f64 (Cortex-M7) and {} in f32 (Cortex-M4F)",
            cells[2], cells[4]
        ),
    ] {
        assert!(readme.contains(&sentence), "README has not: {sentence}");
    }
}

#[test]
fn the_false_alarms_in_the_docs_are_the_published_ones() {
    let field = on_one_line("docs/field.md");
    let published = published("watch");
    let corners = published["corners"].as_array().expect("corners");
    let corner = |equal_limbs: bool| {
        let wanted = serde_json::json!({"equal_limbs": equal_limbs, "true_parameters": false});
        corners
            .iter()
            .find(|c| c["corner"] == wanted)
            .expect("a corner")
    };
    let per_hour = |line: &serde_json::Value| line["per_hour"].as_f64().expect("a rate");
    let course = |name: &str| {
        let all = corner(false)["courses"].as_array().expect("courses");
        per_hour(all.iter().find(|line| line["course"] == name).expect(name))
    };
    let sentence = format!(
        "{:.0} an hour with limbs unequal by 0.2 %, of which {:.1} at rest and up to {:.0} in a brisk tumble; {:.1} an hour with equal limbs",
        per_hour(&corner(false)["total"]),
        course("rest"),
        course("brisk"),
        per_hour(&corner(true)["total"]),
    );
    assert!(field.contains(&sentence), "{sentence}");
}
