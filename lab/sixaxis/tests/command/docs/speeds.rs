//! Published speeds and counts of instructions, as README and docs have them.

use super::{json, on_one_line, read};

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
