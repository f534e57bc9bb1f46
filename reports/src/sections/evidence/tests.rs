//! What must hold for any rows: nothing vanishes, and NaN is never within a limit.

use super::cells::margin;
use super::*;
use sixaxis_page::{Block, Page, render};

fn row(suite: &str, quantity: &str, error: f64, limit: f64) -> Row {
    Row {
        commit: revision().to_owned(),
        suite: suite.to_owned(),
        case: "a case".to_owned(),
        quantity: quantity.to_owned(),
        unit: String::new(),
        truth: None,
        ours: None,
        error,
        reference_error: None,
        limit,
        reason: "measured".to_owned(),
        control: None,
    }
}

fn tables(section: &Section) -> Vec<&Table> {
    section
        .blocks
        .iter()
        .filter_map(|block| match block {
            Block::Table(table) => Some(table),
            _ => None,
        })
        .collect()
}

fn figures(section: &Section) -> Vec<&Figure> {
    section
        .blocks
        .iter()
        .filter_map(|block| match block {
            Block::Figure(figure) => Some(figure),
            _ => None,
        })
        .collect()
}

/// The section in a page, which also checks anchors and the shapes of tables.
fn html(section: &Section) -> String {
    let sections = vec![section.clone()];
    render(&Page {
        sections,
        ..Page::default()
    })
    .expect("renders")
}

#[test]
fn without_rows_there_is_a_note() {
    let section = section(&[], None).expect("a section");
    assert!(
        matches!(section.blocks.last(), Some(Block::Note(text)) if text.contains("cargo test --workspace"))
    );
    assert!(
        html(&super::section(&[], Some(&"line 7: <no row>")).expect("a section"))
            .contains("line 7: &lt;no row&gt;")
    );
}

#[test]
fn rows_of_other_code_are_counted_and_not_shown() {
    let others = Row {
        commit: "0123456789ab".to_owned(),
        ..row("s", "of another commit", 1.0, 1e-9)
    };
    let rows = [row("s", "of this commit", 1e-12, 1e-9), others];
    let section = section(&rows, None).expect("a section");
    assert!(section.lead.starts_with("One comparison, all within"));
    // Of one suite, which is the report's own.
    assert!(section.lead.contains("made for this report alone"));
    let html = html(&section);
    assert!(html.contains("1 rows are of other code (0123456789ab)"));
    assert!(!html.contains("of another commit"));
}

#[test]
fn the_loosest_limits_are_named_unless_they_are_asked_for() {
    let mut rows = vec![row("s", "near", 1e-10, 1e-9), row("s", "far", 1e-14, 1e-9)];
    rows.push(Row {
        reason: "required: somebody asks for it".to_owned(),
        ..row("s", "asked for", 1e-20, 1e-9)
    });
    let section = section(&rows, None).expect("a section");
    let tables = tables(&section);
    let names: Vec<_> = tables[1].rows.iter().map(|row| &row.header[..]).collect();
    assert_eq!(names, ["far", "near"]);
}

#[test]
fn nan_is_beyond_the_limit() {
    let limits = [1e-9, 0.0, f64::NAN, f64::INFINITY];
    for (error, limit) in [f64::NAN, f64::INFINITY]
        .into_iter()
        .flat_map(|e| limits.map(|l| (e, l)))
        .chain([(0.0, 0.0), (1.0, f64::NAN)])
    {
        let mut rows = vec![row("s", "fine", 1e-12, 1e-9); 3];
        rows.push(row("s", "lost", error, limit));
        rows.push(row("s", "lost", 1e-12, 1e-9));
        let section = section(&rows, None).expect("a section");
        assert!(section.lead.contains("**1 beyond**"), "{error} {limit}");
        let tables = tables(&section);
        assert_eq!(tables[0].rows.len(), 1, "{error} {limit}");
        assert_eq!(tables[0].rows[0].header, "lost");
        // It stands first, and its margin is bad.
        assert_eq!(tables[1].rows[0].header, "lost");
        let state = |i: usize| tables[1].rows[i].cells.first().map(|c| c.state);
        assert_eq!(state(0), Some(State::Bad), "{error} {limit}");
        assert_eq!(state(1), Some(State::Good));
        assert!(
            html(&section).contains("NaN or infinite, drawn at the right end"),
            "{error} {limit}"
        );
    }
}

#[test]
fn zeros_are_counted_and_drawn() {
    let mut rows = vec![row("s", "exact", 0.0, 1e-9); 4];
    rows.push(row("s", "near", 1e-10, 1e-9));
    let section = section(&rows, None).expect("a section");
    let Block::Figure(figure) = &section.blocks[0] else {
        panic!("no figure first");
    };
    assert!(figure.caption.starts_with("4 of 5 errors are exactly zero"));
    let (from, to) = figure.x.range.expect("fixed ends");
    assert!(from > 0.0 && from < 1.0 && to > 1.0);
    for (x, y) in figure
        .series
        .iter()
        .flat_map(|s| &s.points)
        .filter(|p| !p.0.is_nan())
    {
        assert!((from..=to).contains(x) && [0.0, 1.0].contains(y));
    }
    let cells = &tables(&section)[0].rows[1].cells;
    assert_eq!(cells[cells.len() - 2].text, "4");
    assert_eq!(cells[cells.len() - 1].text, "measured");
}

#[test]
fn every_quantity_has_its_row() {
    let rows: Vec<Row> = (0..300)
        .map(|i| {
            let name = format!(
                "quantity {} with a rather long name, as tests have them",
                i % 30
            );
            row("long_suite", &name, 1e-15 * f64::from(i + 1).powi(3), 1e-6)
        })
        .collect();
    let section = section(&rows, None).expect("a section");
    assert!(
        section
            .lead
            .starts_with("300 comparisons of one suite, all within")
    );
    let table = tables(&section)[0];
    assert_eq!(table.rows.len(), 30);
    let html = html(&section);
    for i in 0..30 {
        assert!(html.contains(&format!("quantity {i} with")));
    }
}

#[test]
fn margins_are_judged_and_never_rounded_up_to_the_limit() {
    let judged = |share: f64| {
        let cell = margin(share);
        (cell.text, cell.state)
    };
    assert_eq!(judged(1.0 / 7.0), ("7.0×".to_owned(), State::Good));
    assert_eq!(judged(0.67), ("1.4×".to_owned(), State::Warn));
    assert_eq!(judged(1.001), ("0.99×".to_owned(), State::Bad));
    assert_eq!(judged(0.0), ("> 10⁶×".to_owned(), State::Good));
    assert_eq!(judged(1e3), ("< 0.01×".to_owned(), State::Bad));
    assert_eq!(judged(f64::INFINITY), ("none".to_owned(), State::Bad));
    assert_eq!(judged(f64::NAN).1, State::Bad);
}

#[test]
fn random_motions_come_first_and_once() {
    let mut rows = vec![row("a", "something", 1e-3, 1.0)];
    for i in 1..=200 {
        let mut of_motion = row(
            "b",
            "rate, random motion",
            1e-9 * f64::from(i) * f64::from(i),
            1e-4,
        );
        of_motion.reference_error = Some(1e-9);
        rows.push(of_motion);
    }
    rows[7].error = f64::NAN;
    rows[9].error = 0.0;
    let section = section(&rows, None).expect("a section");
    let [figure, ..] = &figures(&section)[..] else {
        panic!("no figure");
    };
    assert!(
        figure
            .caption
            .contains("**1 of 200 errors are NaN or infinite**")
    );
    let curve = &figure.series[0].points;
    assert_eq!(curve.first().map(|p| p.1), Some(0.5));
    assert_eq!(curve.last().map(|p| p.1), Some(99.5));
    // Beyond the limit, the motions, suite a, the loosest, what is published; no table for suite b, which holds nothing else.
    assert_eq!(tables(&section).len(), 5);
    assert!(!html(&section).contains("Errors of the suite b"));
}

#[test]
fn suites_with_the_same_letters_have_anchors_of_their_own() {
    let rows = ["a_b", "a-b", "a b", "ä"].map(|suite| row(suite, "q", 1e-3, 1.0));
    assert_eq!(
        html(&section(&rows, None).expect("a section"))
            .matches("<p class=\"figure-title\"")
            .count(),
        4
    );
}

#[test]
fn a_control_that_does_not_fail_is_beyond() {
    let control = |error: f64| Row {
        control: Some(100.0),
        ..row("s", "swapped", error, 1e-9)
    };
    let sound = row("s", "sound", 1e-12, 1e-9);
    let section_of = |error| {
        let rows = [sound.clone(), control(error), control(1e-3)];
        section(&rows, None).expect("a section")
    };
    let good = section_of(1e-6);
    assert!(good.lead.contains("2 negative controls") && good.lead.contains("all within"));
    let [errors, controls, _loosest, _published] = tables(&good)[..] else {
        panic!("errors and controls")
    };
    // No control passes for a comparison.
    assert_eq!((errors.rows.len(), controls.rows.len()), (1, 1));
    assert_eq!(controls.rows[0].cells[4].state, State::Good);
    for bad in [1e-8, 0.0, f64::NAN] {
        let section = section_of(bad);
        assert!(
            section
                .lead
                .contains("**1 of 2 negative controls do not fail**"),
            "{bad}"
        );
        let [beyond, _errors, controls, ..] = tables(&section)[..] else {
            panic!("a table of what is beyond")
        };
        assert_eq!(beyond.rows[0].header, "swapped");
        assert_eq!(controls.rows[0].cells[4].state, State::Bad, "{bad}");
    }
}
