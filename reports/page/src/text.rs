//! The text of a section in a file of its own: Markdown with places for values, figures and tables.
//!
//! | written | becomes |
//! |---|---|
//! | `# Title`, then a paragraph | the section's title and its lead |
//! | `## Words` | a smaller heading |
//! | `> words` | a note |
//! | `- words` | an item of a list |
//! | `[id] Words` | the figure or table of that name, with these words as title or caption |
//! | `: words` in the lines below | the figure's caption or the table's footnote |
//! | `{{ share|percent(2) }}` | a value, by minijinja, with the filters of [`super::number`] |
//!
//! Empty lines part paragraphs; figures of one paragraph stand side by side. A value that is missing, a figure that has no
//! place and a place that has no figure are errors: nothing vanishes without a word.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail, ensure};
use minijinja::value::Serde;
use minijinja::{Environment, Error, ErrorKind, UndefinedBehavior, Value};
use serde::Serialize;

use super::figure::Figure;
use super::number;
use super::page::{Basis, Block, Claim, Section, Verdict};
use super::table::Table;

/// A section's text with what stands in it.
pub struct Text {
    source: &'static str,
    values: BTreeMap<String, Value>,
    /// Figures and tables, by the names of their places.
    placed: BTreeMap<String, Block>,
}

impl Text {
    /// The text as its file has it.
    pub fn new(source: &'static str) -> Self {
        Self {
            source,
            values: BTreeMap::new(),
            placed: BTreeMap::new(),
        }
    }

    /// Gives a value, or a whole tree of them, its name in the text.
    #[must_use]
    pub fn value(mut self, name: &str, value: impl Serialize) -> Self {
        self.values.insert(name.to_owned(), Serde(value).into());
        self
    }

    /// Gives each field of a structure its own name in the text.
    #[must_use]
    pub fn values(mut self, fields: impl Serialize) -> Self {
        let fields: Value = Serde(fields).into();
        for name in fields.try_iter().into_iter().flatten() {
            if let Ok(value) = fields.get_item(&name) {
                self.values.insert(name.to_string(), value);
            }
        }
        self
    }

    /// Adds a figure, whose place bears its anchor.
    #[must_use]
    pub fn figure(mut self, figure: Figure) -> Self {
        self.placed.insert(figure.id.clone(), Block::Figure(figure));
        self
    }

    /// Adds a table for the place of that name.
    #[must_use]
    pub fn table(mut self, id: &str, table: impl Into<Table>) -> Self {
        self.placed
            .insert(id.to_owned(), Block::Table(table.into()));
        self
    }

    /// The section.
    ///
    /// # Errors
    /// If the text asks for a value or a figure that is not there, or leaves a figure or table out.
    pub fn section(mut self, id: &str) -> Result<Section> {
        let text = self.filled().with_context(|| format!("text {id:?}"))?;
        let mut section = Section::new(id, "", "");
        for (number, paragraph) in paragraphs(&text).enumerate() {
            if let Some(title) = paragraph.strip_prefix("# ") {
                section.title = title.to_owned();
            } else if number == 1 && !section.title.is_empty() && !marked(paragraph) {
                section.lead = joined(paragraph);
            } else {
                let block = self.block(paragraph);
                section
                    .blocks
                    .push(block.with_context(|| format!("text {id:?}"))?);
            }
        }
        if let Some(left) = self.placed.keys().next() {
            bail!("text {id:?} has no place for {left:?}");
        }
        Ok(section)
    }

    /// The claims of a ledger: `[id] Claim`, then lines `= printed` and `= found here`, then the reason. `verdict` judges by id.
    ///
    /// # Errors
    /// If the text asks for a value that is not there, or if a claim has no verdict or not both values.
    pub fn claims(self, verdict: impl Fn(&str) -> Option<(Verdict, Basis)>) -> Result<Vec<Claim>> {
        let text = self.filled().context("text of the claims")?;
        let entries = paragraphs(&text).map(|paragraph| {
            let [entry] = &entries(paragraph)[..] else {
                bail!("one claim a paragraph, not {paragraph:?}");
            };
            let [printed, measured] = &entry.cells[..] else {
                bail!("claim {:?} wants two values", entry.id);
            };
            let (verdict, basis) = verdict(entry.id)
                .with_context(|| format!("claim {:?} has no verdict", entry.id))?;
            Ok(Claim {
                claim: entry.words.clone(),
                printed: printed.clone(),
                measured: measured.clone(),
                verdict,
                basis,
                reason: entry.remark.clone(),
            })
        });
        entries.collect()
    }

    fn filled(&self) -> Result<String> {
        let filled = environment().render_str(self.source, &self.values);
        filled.map_err(|error| anyhow::anyhow!("{error:#}"))
    }

    fn block(&mut self, paragraph: &str) -> Result<Block> {
        if let Some(heading) = paragraph.strip_prefix("## ") {
            return Ok(Block::Heading(heading.to_owned()));
        }
        if paragraph.starts_with("> ") {
            let lines: Vec<&str> = paragraph
                .lines()
                .map(|line| line.trim_start_matches('>').trim())
                .collect();
            return Ok(Block::Note(lines.join(" ")));
        }
        if !paragraph.starts_with('[') {
            return Ok(Block::Text(joined(paragraph)));
        }
        let mut figures = Vec::new();
        for Entry {
            id, words, remark, ..
        } in entries(paragraph)
        {
            match self.placed.remove(id) {
                Some(Block::Figure(figure)) => figures.push(Figure {
                    title: words,
                    caption: remark,
                    ..figure
                }),
                Some(Block::Table(table)) => {
                    ensure!(figures.is_empty(), "{id:?} is a table among figures");
                    return Ok(Block::Table(Table {
                        caption: words,
                        footnote: remark,
                        ..table
                    }));
                }
                _ => bail!("there is nothing for the place {id:?}"),
            }
        }
        Ok(match <[Figure; 1]>::try_from(figures) {
            Ok([figure]) => Block::Figure(figure),
            Err(figures) => Block::FigureGrid(figures),
        })
    }
}

fn paragraphs(text: &str) -> impl Iterator<Item = &str> {
    text.split("\n\n")
        .map(str::trim)
        .filter(|paragraph| !paragraph.is_empty())
}

/// Whether a paragraph is something else than words.
fn marked(paragraph: &str) -> bool {
    ["#", ">", "[", "- "]
        .iter()
        .any(|mark| paragraph.starts_with(mark))
}

/// A paragraph or a list, each sentence or item on one line.
fn joined(paragraph: &str) -> String {
    let mut out = String::new();
    for line in paragraph.lines().map(str::trim) {
        if !out.is_empty() {
            out.push(if line.starts_with("- ") { '\n' } else { ' ' });
        }
        out += line;
    }
    out
}

/// What stands at one place: its name, its words, its values, its remark.
#[derive(Default)]
struct Entry<'a> {
    id: &'a str,
    words: String,
    cells: Vec<String>,
    remark: String,
}

fn entries(paragraph: &str) -> Vec<Entry<'_>> {
    let mut found: Vec<Entry<'_>> = Vec::new();
    for line in paragraph.lines().map(str::trim) {
        let named = line.strip_prefix('[').and_then(|line| line.split_once(']'));
        if let Some((id, words)) = named {
            found.push(Entry {
                id,
                words: words.trim().to_owned(),
                ..Entry::default()
            });
        } else if let Some(entry) = found.last_mut() {
            if let Some(cell) = line.strip_prefix("= ") {
                entry.cells.push(cell.to_owned());
            } else if let Some(remark) = line.strip_prefix(": ") {
                entry.remark = remark.to_owned();
            } else {
                // A long remark goes on, or else the words do.
                let text = if entry.remark.is_empty() {
                    &mut entry.words
                } else {
                    &mut entry.remark
                };
                *text += " ";
                *text += line;
            }
        }
    }
    found
}

fn environment() -> Environment<'static> {
    let mut env = Environment::new();
    env.set_undefined_behavior(UndefinedBehavior::SemiStrict);
    type Printed = fn(f64, usize) -> String;
    let printers: [(&str, Printed); 5] = [
        ("significant", number::significant),
        ("scientific", number::scientific),
        ("fixed", number::fixed),
        ("percent", number::percent),
        ("ppm", number::ppm),
    ];
    for (name, printed) in printers {
        env.add_filter(name, move |value: &Value, digits: usize| {
            Ok::<_, Error>(printed(number_of(value)?, digits))
        });
    }
    env.add_filter("count", |value: u64| number::count(value));
    env
}

/// What was not measured prints as a dash.
fn number_of(value: &Value) -> Result<f64, Error> {
    if value.is_none() {
        return Ok(f64::NAN);
    }
    f64::try_from(value.clone())
        .map_err(|_| Error::new(ErrorKind::InvalidOperation, format!("{value} is no number")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Axis;

    fn text(source: &'static str) -> Text {
        let figure = |id| Figure::new(id, "", Axis::default(), Axis::default());
        let table = Table::of("n", [1], ToString::to_string);
        Text::new(source)
            .value("share", 0.123_456)
            .value("none", None::<f64>)
            .figure(figure("a"))
            .figure(figure("b"))
            .table("t", table)
    }

    const WHOLE: &str = "# Title\n\nLead, on\ntwo lines: {{ share|percent(2) }}.\n\n## Part\n\n> Note\n> it.\n\n- one\n- two,\n  \
        long {{ none|fixed(1) }}\n\n[a] First\n: Said\nof it.\n[b] Second\n\n[t] Caption\n: Foot.\n";

    #[test]
    fn everything_finds_its_place() {
        let section = text(WHOLE).section("s").expect("a section");
        assert_eq!(section.title, "Title");
        assert_eq!(section.lead, "Lead, on two lines: 12\u{a0}%.");
        let [
            Block::Heading(part),
            Block::Note(note),
            Block::Text(list),
            Block::FigureGrid(figures),
            Block::Table(table),
        ] = &section.blocks[..]
        else {
            panic!("{:?}", section.blocks);
        };
        assert_eq!((&part[..], &note[..]), ("Part", "Note it."));
        assert_eq!(list, "- one\n- two, long —");
        assert_eq!(figures[0].caption, "Said of it.");
        assert_eq!(
            (&figures[1].title[..], &figures[1].caption[..]),
            ("Second", "")
        );
        assert_eq!(
            (&table.caption[..], &table.footnote[..]),
            ("Caption", "Foot.")
        );
    }

    #[test]
    fn what_is_missing_is_an_error() {
        for wrong in [
            "# T\n\nL\n\n[a] A\n\n[b] B\n",
            "# T\n\nL\n\n[a] A\n\n[b] B\n\n[t] C\n\n[u] D\n",
            "# T\n\n{{ nothing|fixed(1) }}\n\n[a] A\n\n[b] B\n\n[t] C\n",
            "# T\n\nL\n\n[a] A\n[t] C\n[b] B\n",
        ] {
            assert!(text(wrong).section("s").is_err(), "{wrong}");
        }
    }

    #[test]
    fn claims_are_judged_by_name() {
        let source = "[one] Eq. (1)\n= 2.3 Hz\n= {{ share|fixed(2) }} Hz\n: because\nof it\n\n[two] Eq. (2)\n= a\n= b\n";
        let of =
            |id: &str| (id == "one" || id == "two").then_some((Verdict::Reproduced, Basis::Judged));
        let claims = Text::new(source)
            .value("share", 0.25)
            .claims(of)
            .expect("two");
        assert_eq!(claims[0].measured, "0.25 Hz");
        assert_eq!(claims[0].reason, "because of it");
        assert_eq!(claims[1].reason, "");
        assert!(
            Text::new(source)
                .value("share", 1)
                .claims(|_| None)
                .is_err()
        );
    }
}
