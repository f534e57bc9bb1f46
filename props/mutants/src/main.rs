//! Mutation testing of core and of what judges in lab/calibration.
//!
//! cargo-mutants builds the workspace again for every mutant. Here a sample is drawn first (`draw`), all of it is written into a
//! copy of the workspace behind one switch (`rewrite`), and the copy is built once (`tree`). Each test then runs once
//! without a mutant and says which mutants it comes by (`suites`); a mutant is tried with these only, until one fails
//! (`trial`). Mutants in constants cannot be switched and are counted as not tried.
//!
//! `.ci/mutants [draw|build|run] [--share X] [--jobs N] [--longest S] [--budget S] [--seed COMMIT]
//! [--again]`: `draw` lists the sample, `build` stops
//! after the build, `run` does everything and goes on where an earlier run stopped; `--again` tries survivors once more; `--seed`
//! repeats an earlier sample; `--longest` leaves out tests of more processor time, s, and `--budget` bounds what a mutant may cost.

mod cfg;
mod draw;
mod operators;
mod report;
mod rewrite;
mod sites;
mod suites;
mod tree;
mod trial;

use std::fs;
use std::path::Path;
use std::process::exit;

use draw::Drawn;
use suites::Test;

struct Options {
    command: String,
    share: f64,
    jobs: usize,
    longest_s: f64,
    budget_s: f64,
    again: bool,
    seed: Option<String>,
}

fn options() -> Option<Options> {
    let mut options = Options {
        command: "run".into(),
        share: 1.0,
        jobs: 2,
        longest_s: 60.0,
        budget_s: 300.0,
        again: false,
        seed: None,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "draw" | "build" | "run" => options.command = word,
            "--share" => options.share = words.next()?.parse().ok()?,
            "--jobs" => options.jobs = words.next()?.parse().ok()?,
            "--longest" => options.longest_s = words.next()?.parse().ok()?,
            "--budget" => options.budget_s = words.next()?.parse().ok()?,
            "--seed" => options.seed = Some(words.next()?),
            "--again" => options.again = true,
            _ => return None,
        }
    }
    Some(options)
}

fn main() {
    let Some(options) = options() else {
        eprintln!(
            "usage: .ci/mutants [draw|build|run] [--share X] [--jobs N] [--longest S] [--budget S] [--seed COMMIT] [--again]"
        );
        exit(2)
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .expect("the workspace lies two folders up");
    let out = root.join("target/mutation");
    fs::create_dir_all(&out).unwrap_or_else(|e| panic!("{}: {e}", out.display()));
    let draw = draw::draw(root, options.seed.clone(), options.share);
    if options.command == "draw" {
        for module in &draw.modules {
            println!("{module:?}");
        }
        for one in &draw.drawn {
            println!("{}", one.mutant.name());
        }
        return;
    }
    let built = tree::build(root, &out, &draw);
    if options.command == "build" {
        return;
    }
    let tests = suites::trace(&out, &built.programs, options.jobs, options.longest_s);
    for test in tests.iter().filter(|t| !t.passes) {
        println!("left out after {:.0} s: {}", test.cost_s, test.label);
    }
    let broken = |t: &&Test| !t.passes && t.cost_s < 0.9 * options.longest_s;
    if let Some(test) = tests.iter().find(broken) {
        eprintln!("{} fails without a mutant", test.label);
        exit(1);
    }
    let passing: Vec<Test> = tests.iter().filter(|t| t.passes).cloned().collect();

    let mut left: Vec<usize> = draw.modules.iter().map(|m| m.wanted).collect();
    let mut wanted: Vec<&Drawn> = Vec::new();
    for one in draw
        .sample()
        .iter()
        .filter(|d| built.viable.contains(&d.id))
    {
        if left[one.module] > 0 {
            left[one.module] -= 1;
            wanted.push(one);
        }
    }
    let mut results = trial::known(&out);
    let fatal = trial::run_one(&out, draw.fatal(), &passing);
    if fatal.caught_by.is_none() {
        eprintln!("{} survives: the trial sees nothing", fatal.mutant);
        exit(1);
    }
    if options.again {
        results.retain(|_, r| r.caught_by.is_some());
    }
    trial::run(
        &out,
        &wanted,
        &passing,
        options.jobs,
        options.budget_s,
        &mut results,
    );
    let text = report::report(&report::Run {
        draw: &draw,
        wanted: &wanted,
        results: &results,
        viable_share: built.viable.len() as f64 / draw.drawn.len() as f64,
        needed_const: built.needed_const.len(),
        tests: &tests,
    });
    fs::write(out.join("report.md"), &text).unwrap_or_else(|e| panic!("report.md: {e}"));
    print!("{text}");
}
