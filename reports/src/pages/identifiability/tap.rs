//! k/m from blows on the shell.

use super::published::{MAKE_TAPS, Taps};
use crate::study::results::identifiability::KnownTap;
use sixaxis_page::number::{count, fixed, percent, scientific};
use sixaxis_page::{Block, Column, Row, Table};

/// Unit of k/m, s^-2.
const UNIT_PER_S2: f64 = 1e8;

/// Text and table.
pub fn blocks(taps: &Taps, here: &KnownTap) -> Vec<Block> {
    vec![
        Block::Heading("Tap the shell".to_owned()),
        Block::Text(format!(
            "A blow on the shell, held by the rig, rings the mass on its limbs at kilohertz, where k/m is all that matters: the \
             free decay of six modes is fitted with I/m and gains as uncertain as steps 2 and 3 leave them. {} Below, taps on random \
             sensors played in MuJoCo, noise {} of the peak, {} kHz ({MAKE_TAPS}).",
            one(here),
            percent(taps.noise_over_peak, 1),
            fixed(taps.sample_rate_hz / 1e3, 0),
        )),
        Block::Table(table(taps)),
    ]
}

/// What the tap on the study's own sensor came to.
pub fn one(tap: &KnownTap) -> String {
    match (&tap.found_per_s2, &tap.refused) {
        (Some((found, (low, high))), _) => format!(
            "One tap on this study's sensor, recorded with the laboratory's chain, gives k/m = ({} ± {}) × 10⁸ s⁻², truth {}.",
            fixed(found / UNIT_PER_S2, 4),
            fixed(0.5 * (high - low) / UNIT_PER_S2, 4),
            fixed(tap.truth_per_s2 / UNIT_PER_S2, 4),
        ),
        (None, cause) => format!(
            "The one tap on this study's sensor says nothing: {}.",
            cause.as_deref().unwrap_or("no cause given")
        ),
    }
}

fn table(taps: &Taps) -> Table {
    let rows = taps.tallies.iter().map(|t| {
        Row::new(
            percent(t.damping_ratio, 2),
            [
                count(t.taps),
                count(t.refused),
                scientific(t.rms_error_ln, 2),
                fixed(t.deviation_over_bound, 2),
                fixed(t.bias_over_bound, 2),
                fixed(100.0 * t.coverage_95, 1),
            ],
        )
    });
    Table {
        caption: "ln(k/m) from one tap each".to_owned(),
        stub: "damping of critical".to_owned(),
        columns: vec![
            Column::number("taps", ""),
            Column::number("refused", ""),
            Column::number("rms error", "of ln k/m"),
            Column::number("deviation", "over bound"),
            Column::number("bias", "over bound"),
            Column::number("coverage of 95 %", "%"),
        ],
        rows: rows.collect(),
        footnote: "The bound is the Cramér-Rao bound of each tap, damping, I/m, gains and the shell's blow unknown with k/m. Of a \
                   hundred taps the coverage scatters by 2 %."
            .to_owned(),
        ..Table::default()
    }
}
