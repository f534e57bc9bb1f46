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
pub(super) fn two_digits(value: f64) -> String {
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
fn the_counts_in_the_docs_are_the_published_ones() {
    let docs = on_one_line("docs/speed.md");
    let counts = json("benches/instructions.json");
    let count = |name: &str| counts["per_sample"][name].as_f64().expect(name).round();
    let growth = json("benches/results/growth.json");
    let curves = growth["curves"].as_array().expect("curves").iter();
    let points = curves
        .filter(|curve| curve["work"] == "decouple")
        .flat_map(|curve| curve["points"].as_array().expect("points"));
    let memory_mb = points
        .filter(|point| point["size"].as_f64() >= Some(1e6))
        .map(|point| point["peak_memory_bytes"].as_f64().expect("bytes") / 1e6);
    let (least, most) = memory_mb.fold((f64::INFINITY, 0.0_f64), |(least, most), mb| {
        (least.min(mb), most.max(mb))
    });
    let (push, record, lanes) = (count("push/full/heun"), count("record"), count("lanes"));
    let plain = count("plain/push/full/heun");
    for sentence in [
        format!(
            "`push` takes {push}, since it works on three components in one register, `push_record` {record} and a stream in lanes {lanes}"
        ),
        format!("`push` takes {plain} instructions there"),
        format!("Of the {} instructions more", plain - push),
        format!(
            "{push} on x86-64-v3, {} with one to three limbs excluded",
            count("push/full/heun/without/1")
        ),
        format!("Memory: {least:.0} to {most:.0} MB from 10⁶ to 10⁸ samples"),
    ] {
        assert!(
            docs.contains(&sentence),
            "docs/speed.md has not: {sentence}"
        );
    }
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
            "takes {} instructions a sample; in a build for any x86-64, which finds wider registers at run time, it takes {}.",
            count("push/full/heun"),
            count("plain/push/full/heun"),
        ),
        format!(
            "`push` is {push} times as fast as the same formulas in plain C++ with `-ffast-math` in the same run, which sees one sample of one \
             stream at a time; `push_record`, which sees a record, {record} times and each of eight lanes {lanes} times"
        ),
        format!(
            "`push` took {} instructions a sample in f64 (Cortex-M7) and {} in f32 (Cortex-M4F)",
            cells[2], cells[4]
        ),
    ] {
        assert!(readme.contains(&sentence), "README has not: {sentence}");
    }
}
