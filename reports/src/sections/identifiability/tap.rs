//! k/m from taps on the shell.

use sixaxis_page::number::{count, fixed, percent, scientific};
use sixaxis_page::{Table, Text};
use sixaxis_props::results::Taps;

use crate::sections::stiffness_text;
use crate::study::results::identifiability::KnownTap;

/// Values and table.
pub fn fill(text: Text, taps: &Taps, here: &KnownTap) -> Text {
    text.value("taps", taps)
        .value("one_tap", one(here))
        .table("taps", table(taps))
}

/// What the tap on the study's own sensor came to.
fn one(tap: &KnownTap) -> String {
    let k = |per_s2: f64| stiffness_text(per_s2, 4);
    match (&tap.found_per_s2, &tap.refused) {
        (Some((found, (low, high))), _) => format!(
            "One tap on this study's sensor, recorded with the laboratory's chain, gives k/m = ({} ± {}) × 10⁸ s⁻², truth {}.",
            k(*found),
            k(0.5 * (high - low)),
            k(tap.truth_per_s2),
        ),
        (None, cause) => format!(
            "The one tap on this study's sensor says nothing: {}.",
            cause.as_deref().unwrap_or("no cause given")
        ),
    }
}

fn table(taps: &Taps) -> Table {
    Table::of("damping of critical", &taps.tallies, |t| {
        percent(t.damping_ratio, 2)
    })
    .col("taps", |t| count(t.taps))
    .col("refused", |t| count(t.refused))
    .col(("rms error", "of ln k/m"), |t| {
        scientific(t.rms_error_ln, 2)
    })
    .col(("deviation", "over bound"), |t| {
        fixed(t.deviation_over_bound, 2)
    })
    .col(("bias", "over bound"), |t| fixed(t.bias_over_bound, 2))
    .col(("coverage of 95 %", "%"), |t| {
        fixed(100.0 * t.coverage_95, 1)
    })
    .into()
}
