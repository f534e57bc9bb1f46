//! Fig. 10: the curves that step 4 seeks the minimum of.

use anyhow::Result;
use sixaxis_calibration::page::labels::verdict;
use sixaxis_page::number::scientific;
use sixaxis_page::{Axis, Figure, Section, Table, Text};

use super::stiffness_text;
use crate::study::results::{Results, Search};

/// The section.
///
/// # Errors
/// If the text does not fit the results.
pub fn section(r: &Results) -> Result<Section> {
    let put_in = |as_printed: bool| {
        let all = r.searches.iter();
        all.filter(move |s| s.scale_error.is_some() && s.sign_as_printed == as_printed)
            .zip(0..)
    };
    let own = r.searches.iter().filter(|s| s.scale_error.is_none());
    Text::new(include_str!("stiffness.md"))
        .figure(figure("fig10-corrected", put_in(false)))
        .figure(figure("fig10-printed", put_in(true)))
        .figure(figure("fig10-four-steps", own.zip([0, 3])))
        .table("minima", table(r))
        .section("stiffness")
}

/// What a search curve was made with.
fn label(search: &Search) -> String {
    match search.scale_error {
        Some(error) if error > 0.0 => format!("scale factors off by {}", scientific(error, 1)),
        _ => search.label.clone(),
    }
}

fn figure<'a>(id: &str, searches: impl Iterator<Item = (&'a Search, usize)>) -> Figure {
    let figure = curves(id);
    searches.fold(figure, |figure, (search, colour)| {
        figure.line(label(search), colour, search.curve.iter().copied())
    })
}

/// Axes of a curve of step 4, the true k/m marked.
pub fn curves(id: &str) -> Figure {
    Figure::new(
        id,
        "",
        Axis::linear("$k/m$", "s⁻²"),
        Axis::log("mean |w*|", "rad/s"),
    )
    .vertical(2.0e8, "truth")
}

fn table(r: &Results) -> Table {
    Table::of("scale factors", &r.searches, |s| label(s))
        .text("eq. (2)", |s| match s.sign_as_printed {
            true => "as printed",
            false => "corrected",
        })
        .col(("grid minimum", "10⁸ s⁻²"), |s| {
            stiffness_text(s.grid_minimum_per_s2, 1)
        })
        .col(("between grid points", "10⁸ s⁻²"), |s| {
            stiffness_text(s.interpolated_per_s2, 4)
        })
        .text("verdict", |s| verdict(&s.verdict))
        .into()
}
