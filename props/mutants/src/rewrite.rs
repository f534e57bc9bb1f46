//! A source file with its mutants in it, each behind a switch.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::draw::Drawn;

/// Where mutants lie in what was written.
pub struct Written {
    /// The file.
    pub text: String,
    /// Bytes of what a mutant put in.
    pub branches: Vec<(u32, Range<usize>)>,
    /// Bytes of an expression with all its mutants.
    pub sites: Vec<(Vec<u32>, Range<usize>)>,
}

/// What happens at a range of the source.
enum Change<'a> {
    /// Mutants of one expression, or returns put in where the range is empty.
    Mutants(Vec<&'a Drawn>),
    /// A `const` that goes.
    Dropped,
}

/// One file with all of `drawn`, which are of that file.
pub fn file(source: &str, drawn: &[&Drawn], switch: &str) -> Written {
    let mut changes: BTreeMap<(usize, Reverse<usize>), Change> = BTreeMap::new();
    let mut dropped = BTreeSet::new();
    for &one in drawn {
        let site = &one.mutant.site;
        let change = changes
            .entry((site.start, Reverse(site.end)))
            .or_insert_with(|| Change::Mutants(Vec::new()));
        if let Change::Mutants(list) = change {
            list.push(one);
        }
        dropped.extend(one.mutant.const_fn.as_ref().map(|r| (r.start, r.end)));
    }
    for (start, end) in dropped {
        changes.insert((start, Reverse(end)), Change::Dropped);
    }
    let changes: Vec<(Range<usize>, Change)> = changes
        .into_iter()
        .map(|((start, Reverse(end)), change)| (start..end, change))
        .collect();
    let mut writer = Writer {
        source,
        switch,
        out: Written {
            text: String::with_capacity(2 * source.len()),
            branches: Vec::new(),
            sites: Vec::new(),
        },
    };
    writer.range(0..source.len(), &changes);
    writer.out
}

struct Writer<'a> {
    source: &'a str,
    switch: &'a str,
    out: Written,
}

impl Writer<'_> {
    /// `range` with the changes in it, which are in order, outer before inner.
    fn range(&mut self, range: Range<usize>, mut changes: &[(Range<usize>, Change)]) {
        let mut at = range.start;
        while let Some((site, change)) = changes.first() {
            self.out.text.push_str(&self.source[at..site.start]);
            let inner = changes[1..]
                .iter()
                .take_while(|(other, _)| other.start < site.end)
                .count();
            match change {
                Change::Dropped => {}
                Change::Mutants(mutants) => {
                    self.mutants(site.clone(), mutants, &changes[1..=inner]);
                }
            }
            at = site.end;
            changes = &changes[1 + inner..];
        }
        self.out.text.push_str(&self.source[at..range.end]);
    }

    fn mutants(
        &mut self,
        site: Range<usize>,
        mutants: &[&Drawn],
        inner: &[(Range<usize>, Change)],
    ) {
        let begin = self.out.text.len();
        let returns = site.is_empty();
        self.out.text.push_str(if returns { " " } else { "(" });
        for one in mutants {
            let from = self.out.text.len();
            let edit = &one.mutant.edit;
            self.out
                .text
                .push_str(&format!("if {}({}) {{ ", self.switch, one.id));
            self.out.text.push_str(&self.source[site.start..edit.start]);
            self.out.text.push_str(&one.mutant.text);
            self.out.text.push_str(&self.source[edit.end..site.end]);
            self.out.branches.push((one.id, from..self.out.text.len()));
            self.out
                .text
                .push_str(if returns { " } " } else { " } else " });
        }
        if !returns {
            self.out.text.push_str("{ ");
            self.range(site, inner);
            self.out.text.push_str(" })");
        }
        let ids = mutants.iter().map(|one| one.id).collect();
        self.out.sites.push((ids, begin..self.out.text.len()));
    }
}
