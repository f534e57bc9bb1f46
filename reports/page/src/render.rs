//! From the page's description to one HTML document.

use super::figure::Figure;
use super::layout::Size;
use super::markup;
use super::page::{Block, Page};
use super::plot;
use anyhow::{Context, Result, ensure};
use minijinja::value::Serde;
use minijinja::{Environment, Value, context};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Numbers and ticks of charts, a script module: for a page that is not rendered here.
pub const AXIS_SCRIPT: &str = include_str!("axis.js");

/// The colours and fonts of all pages, light and dark, as CSS variables: for a page that is not rendered here.
///
/// # Errors
/// None that a caller could cause: the style sheet is part of the program.
pub fn theme() -> Result<String> {
    let sheet = include_str!("style.css");
    let tokens = sheet.split("\n*, ::before").next().unwrap_or(sheet);
    let mut env = Environment::new();
    env.add_template("theme.css", tokens)?;
    env.get_template("theme.css")?
        .render(context! {})
        .context("filling the theme")
}

/// A figure as the template needs it.
#[derive(Serialize)]
struct Drawing {
    /// For the width of the text; none for a figure of a grid.
    main: Option<String>,
    /// For a phone, or for one of several side by side.
    compact: String,
    legend: Vec<Entry>,
}

#[derive(Clone, PartialEq, Serialize)]
struct Entry {
    swatch: String,
    label: String,
}

/// Renders a page to a self-contained HTML document.
///
/// # Errors
/// If an anchor is missing, malformed or used twice.
pub fn render(page: &Page) -> Result<String> {
    let mut anchors = BTreeSet::new();
    let mut drawings = BTreeMap::new();
    for section in &page.sections {
        anchor(&mut anchors, &section.id)?;
        for block in &section.blocks {
            match block {
                Block::Figure(figure) => {
                    anchor(&mut anchors, &figure.id)?;
                    drawings.insert(figure.id.clone(), drawing(figure, true));
                }
                Block::FigureGrid(figures) => {
                    for figure in figures {
                        anchor(&mut anchors, &figure.id)?;
                        drawings.insert(figure.id.clone(), drawing(figure, false));
                    }
                }
                _ => {}
            }
        }
    }

    let mut env = Environment::new();
    env.add_filter("inline", |text: &str| {
        Value::from_safe_string(markup::html(text))
    });
    env.add_filter("prose", |text: &str| Value::from_safe_string(prose(text)));
    env.add_filter("plain", |text: &str| markup::plain(text));
    env.add_function("shared_legend", |ids: Vec<String>, drawings: Value| {
        let legend = |id: &String| {
            drawings
                .get_attr(id)
                .and_then(|d| d.get_attr("legend"))
                .ok()
        };
        let first = ids.first().and_then(legend);
        first.filter(|first| ids.iter().all(|id| legend(id).as_ref() == Some(first)))
    });
    env.add_template("page.html", include_str!("template.html"))?;
    env.add_template("style.css", include_str!("style.css"))?;
    env.add_template("script.js", include_str!("script.js"))?;
    env.add_template("axis.js", AXIS_SCRIPT)?;
    env.add_template("figure.js", include_str!("figure.js"))?;
    let html = env
        .get_template("page.html")?
        .render(context! { page => Serde(page), drawings => Serde(drawings) })
        .context("filling the page's template")?;
    Ok(html)
}

fn anchor(known: &mut BTreeSet<String>, id: &str) -> Result<()> {
    let fine = !id.is_empty() && id.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-');
    ensure!(
        fine,
        "the anchor {id:?} is not made of letters, digits and hyphens"
    );
    ensure!(
        known.insert(id.to_owned()),
        "the anchor {id:?} is used twice"
    );
    Ok(())
}

fn drawing(figure: &Figure, alone: bool) -> Drawing {
    let mut legend: Vec<Entry> = Vec::new();
    let below = figure.below.iter().flat_map(|panel| &panel.series);
    let all = figure.series.iter().chain(below);
    for series in all.filter(|s| !s.label.is_empty()) {
        let entry = Entry {
            swatch: plot::legend(series),
            label: series.label.clone(),
        };
        // A lower panel usually repeats the colours of the upper one.
        if !legend.contains(&entry) {
            legend.push(entry);
        }
    }
    Drawing {
        main: alone.then(|| plot::to_svg(figure, Size::STANDARD)),
        compact: plot::to_svg(figure, Size::COMPACT),
        legend,
    }
}

/// Paragraphs and lists.
fn prose(text: &str) -> String {
    let mut out = String::new();
    for block in text
        .split("\n\n")
        .map(str::trim)
        .filter(|block| !block.is_empty())
    {
        if block
            .lines()
            .all(|line| line.trim_start().starts_with("- "))
        {
            let items = block
                .lines()
                .filter_map(|line| line.trim_start().strip_prefix("- "));
            let items: String = items
                .map(|item| format!("<li>{}</li>\n", markup::html(item)))
                .collect();
            out += &format!("<ul>\n{items}</ul>\n");
        } else {
            out += &format!("<p>{}</p>\n", markup::html(block));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Basis, Claim, Section, Verdict};

    fn page(block: Block) -> Page {
        Page {
            title: "T & <T>".into(),
            sections: vec![Section::new("one", "One", "").block(block)],
            ..Page::default()
        }
    }

    #[test]
    fn a_page_fetches_nothing_and_escapes_everything() {
        let figure = Figure::new("f", "<f>", Axis::linear("x", "s"), Axis::log("y", "")).line(
            "a & b",
            0,
            [(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0)],
        );
        let html = render(&page(Block::Figure(figure))).expect("renders");
        assert!(html.contains("T &amp; &lt;T&gt;") && html.contains("a &amp; b"));
        // A figure that is enlarged refers to its own frame.
        let foreign = html.replace("url(#", "");
        for forbidden in [
            "<f>",
            "<T>",
            "src=",
            "@import",
            "import ",
            "url(",
            "href=\"http",
        ] {
            assert!(!foreign.contains(forbidden), "{forbidden}");
        }
        let namespaced = html.matches("http://www.w3.org/2000/svg").count();
        assert_eq!(
            html.matches("http").count(),
            namespaced + html.matches("http-equiv").count()
        );
    }

    #[test]
    fn verdicts_are_counted_in_words() {
        let claim = |verdict| Claim {
            claim: "c".into(),
            printed: "p".into(),
            measured: "m".into(),
            verdict,
            basis: Basis::Judged,
            reason: String::new(),
        };
        let claims = [
            Verdict::NotReproducible,
            Verdict::Reproduced,
            Verdict::NotReproducible,
        ];
        let ledger = Block::Ledger(claims.map(claim).to_vec());
        let html = render(&page(ledger)).expect("renders");
        assert!(html.contains("<b>1</b> reproduced</span>"));
        assert!(html.contains("<b>2</b> not reproducible</span>"));
        assert_eq!(html.matches("<small>judged</small>").count(), 3);
        assert!(!html.contains("inconsistent</span>"));
    }

    #[test]
    fn an_anchor_is_used_once() {
        let twice = Figure::new("one", "", Axis::default(), Axis::default());
        assert!(render(&page(Block::Figure(twice))).is_err());
        let once = Figure::new("two", "", Axis::default(), Axis::default());
        assert!(render(&page(Block::Figure(once))).is_ok());
    }
}
