//! The table of modules, and who survives.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::draw::{Draw, Drawn};
use crate::suites::Test;
use crate::trial::Result;

/// What a run is about.
pub struct Run<'a> {
    /// The sample.
    pub draw: &'a Draw,
    /// Its mutants that were to be tried.
    pub wanted: &'a [&'a Drawn],
    /// What became of them; those without an entry were not tried.
    pub results: &'a BTreeMap<String, Result>,
    /// Share of what was drawn that compiles.
    pub viable_share: f64,
    /// Mutants dropped because constants need their functions.
    pub needed_const: usize,
    /// The tests.
    pub tests: &'a [Test],
}

#[derive(Default, Clone, Copy)]
struct Count {
    tried: usize,
    caught: usize,
    open: usize,
    cost_s: f64,
}

impl Count {
    fn add(&mut self, result: &Result) {
        self.tried += 1;
        self.caught += usize::from(result.caught_by.is_some());
        self.open += usize::from(!result.complete);
        self.cost_s += result.cost_s;
    }

    fn share(self) -> f64 {
        100.0 * self.caught as f64 / self.tried as f64
    }
}

/// In Markdown.
pub fn report(run: &Run) -> String {
    let mut by_module = vec![Count::default(); run.draw.modules.len()];
    let mut survivors = Vec::new();
    for &one in run.wanted {
        if let Some(result) = run.results.get(&one.mutant.name()) {
            by_module[one.module].add(result);
            if result.caught_by.is_none() {
                survivors.push((one, result));
            }
        }
    }
    let mut text = String::new();
    let line = &mut text;
    let _ = writeln!(line, "Seed {}.\n", run.draw.seed);
    let _ = writeln!(
        line,
        "| crate and module | mutants, all | in constants | tried | caught | survive | open | caught, % | s each |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|--:|"
    );
    let mut crates: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, module) in run.draw.modules.iter().enumerate() {
        let package = module.name.split(' ').next().unwrap_or_default();
        crates.entry(package).or_default().push(i);
        row(
            line,
            &module.name,
            module.all,
            module.constants,
            by_module[i],
        );
    }
    let mut expected_s = 0.0;
    for (package, modules) in crates {
        let sum = |f: &dyn Fn(usize) -> usize| modules.iter().map(|&i| f(i)).sum::<usize>();
        let all = sum(&|i| run.draw.modules[i].all);
        let constants = sum(&|i| run.draw.modules[i].constants);
        let mut count = Count::default();
        let (mut weighted, mut weight) = (0.0, 0.0);
        for &i in &modules {
            let (module, of) = (&run.draw.modules[i], by_module[i]);
            count.tried += of.tried;
            count.caught += of.caught;
            count.open += of.open;
            count.cost_s += of.cost_s;
            let able = (module.all - module.constants) as f64;
            if of.tried > 0 {
                weighted += able * of.share();
                weight += able;
                expected_s += able * run.viable_share * of.cost_s / of.tried as f64;
            }
        }
        row(line, &format!("**{package}**"), all, constants, count);
        let _ = writeln!(
            line,
            "| {package}, modules by their size | | | | | | | {:.1} | |",
            weighted / weight
        );
    }
    let slow = run.tests.iter().filter(|t| !t.passes).count();
    let _ = writeln!(
        line,
        "\n{} tests, {:.0} s of processor time without a mutant; {slow} are left out. {:.0} % of what is drawn compiles; {} drawn \
         ones lie in functions that constants need. Expected for all mutants outside constants: {:.1} h on two processors.\n",
        run.tests.len() - slow,
        run.tests
            .iter()
            .filter(|t| t.passes)
            .map(|t| t.cost_s)
            .sum::<f64>(),
        100.0 * run.viable_share,
        run.needed_const,
        expected_s / 7200.0,
    );
    survivors.sort_by_key(|(one, _)| (&one.mutant.file, one.mutant.line));
    for (one, result) in survivors {
        let _ = writeln!(
            line,
            "- {}`{}`: {} tests of {} that come by",
            if result.complete { "" } else { "open: " },
            one.mutant.name(),
            result.passed.len(),
            result.reached_by
        );
    }
    text
}

fn row(out: &mut String, name: &str, all: usize, constants: usize, count: Count) {
    let Count {
        tried,
        caught,
        open,
        ..
    } = count;
    let _ = writeln!(
        out,
        "| {name} | {all} | {constants} | {tried} | {caught} | {} | {open} | {:.1} | {:.1} |",
        tried - caught - open,
        count.share(),
        count.cost_s / tried as f64
    );
}
