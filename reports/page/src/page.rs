//! The description of a page: what the reader meets, in order.
//!
//! All texts are inline text as defined in [`super::markup`]: plain characters plus a few marks,
//! escaped before they reach the page. There is no way to pass raw HTML.

use super::figure::Figure;
use super::table::Table;
use serde::Serialize;

/// A judgement that colours a tile or a cell. The page always adds a word or a sign to the colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// No judgement.
    #[default]
    Neutral,
    /// The bar is met.
    Good,
    /// Met with reservations.
    Warn,
    /// The bar is missed.
    Bad,
}

/// One key figure at the top of the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tile {
    /// What it is, a few words.
    pub label: String,
    /// The figure itself, with its unit.
    pub value: String,
    /// The bar it is held against, or a remark.
    pub note: String,
    /// Whether the bar is met.
    pub state: State,
}

impl Tile {
    /// A tile.
    pub fn new(
        label: impl Into<String>,
        value: impl Into<String>,
        note: impl Into<String>,
        state: State,
    ) -> Self {
        Self {
            label: label.into(),
            value: value.into(),
            note: note.into(),
            state,
        }
    }
}

/// A whole page.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Page {
    /// Headline.
    pub title: String,
    /// One sentence under it.
    pub subtitle: String,
    /// How the numbers came about: commit, versions, seed, machine. Printed in the footer.
    pub facts: Vec<(String, String)>,
    /// Key figures.
    pub tiles: Vec<Tile>,
    /// Body.
    pub sections: Vec<Section>,
}

impl Page {
    /// All figures of the page, in order.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.sections
            .iter()
            .flat_map(|section| &section.blocks)
            .flat_map(|block| match block {
                Block::Figure(figure) => core::slice::from_ref(figure),
                Block::FigureGrid(figures) => figures.as_slice(),
                _ => &[],
            })
    }
}

/// One section of the body.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Section {
    /// Anchor, unique on its page: letters, digits and hyphens.
    pub id: String,
    /// Heading.
    pub title: String,
    /// One paragraph that says what the section shows; may be empty.
    pub lead: String,
    /// What follows.
    pub blocks: Vec<Block>,
}

impl Section {
    /// A section without blocks yet.
    pub fn new(id: impl Into<String>, title: impl Into<String>, lead: impl Into<String>) -> Self {
        Self {
            id: id.into(),
            title: title.into(),
            lead: lead.into(),
            blocks: Vec::new(),
        }
    }

    /// Adds a block.
    #[must_use]
    pub fn block(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }
}

/// One building block of a section.
#[expect(
    clippy::large_enum_variant,
    reason = "a page holds a few dozen; boxes would only be in the way"
)]
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", content = "body", rename_all = "snake_case")]
pub enum Block {
    /// A smaller heading.
    Heading(String),
    /// Paragraphs; an empty line separates them, lines starting with `- ` make a list.
    Text(String),
    /// A table.
    Table(Table),
    /// One figure.
    Figure(Figure),
    /// Small figures side by side; if all have the same legend, it is printed once.
    FigureGrid(Vec<Figure>),
    /// Claims and what became of them.
    Ledger(Vec<Claim>),
    /// A remark set apart from the text.
    Note(String),
    /// A text as it stands, folded away.
    Listing(Listing),
}

/// A text as it stands, line by line and without inline marks, folded away until it is asked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Listing {
    /// What it is; always shown.
    pub caption: String,
    /// The text.
    pub text: String,
}

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Holds as printed.
    Reproduced,
    /// Holds once a stated error is mended.
    ReproducedWithCorrection,
    /// Holds under one reading of what is not printed.
    Compatible,
    /// Contradicts something else that is printed, or the mathematics.
    Inconsistent,
    /// Cannot be checked or does not follow from what is printed.
    NotReproducible,
}

/// What decides a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// A number, which could have come out otherwise.
    Measured,
    /// An argument: the verdict stands in the text, whatever is measured.
    Judged,
}

/// One row of a ledger.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claim {
    /// What is claimed, with its place in the source.
    pub claim: String,
    /// The printed value.
    pub printed: String,
    /// The value found here.
    pub measured: String,
    /// What became of it.
    pub verdict: Verdict,
    /// Whether a measured number decides that; if not, the reason does.
    pub basis: Basis,
    /// Why.
    pub reason: String,
}
