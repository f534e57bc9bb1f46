//! Equal stiffness as a hypothesis.

use super::published::Published;
use sixaxis_page::number::{count, fixed, scientific};
use sixaxis_page::{Block, Column, Row, Table};

/// Text and table.
pub fn blocks(p: &Published) -> Vec<Block> {
    let mut text = format!(
        "Step 2, the balance of forces, finds scale factors whatever the limbs' stiffness; the coordination equations find them over \
         the stiffness. Where the two differ, limbs do. With scale factors by step 2 known to {} %,",
        100.0 * p.step_2_deviation
    );
    if let Some(none) = p.lengths.iter().max_by_key(|l| l.draws) {
        text += &format!(
            " equal stiffness is refused although it holds in {} % of {} records at a stated rate of {} %, and in {} % at {} %.",
            fixed(100.0 * none.refused_equal_stiffness[0], 2),
            count(none.draws - none.refused),
            100.0 * p.rates[0],
            fixed(100.0 * none.refused_equal_stiffness[1], 2),
            100.0 * p.rates[1],
        );
    }
    let rows = p.stiffness.iter().map(|s| {
        Row::new(
            format!("{} %", 100.0 * s.spread),
            [
                count(s.draws),
                fixed(100.0 * s.refused_at[0], 1),
                fixed(100.0 * s.refused_at[1], 1),
                scientific(s.rms_error_of_pair, 2),
                scientific(s.largest_error_of_pair, 2),
                fixed(100.0 * s.share_of_pairs_within_bar, 2),
            ],
        )
    });
    vec![
        Block::Heading("Are limbs equally stiff?".to_owned()),
        Block::Text(text),
        Block::Table(Table {
            caption: "Limbs whose stiffnesses scatter".to_owned(),
            stub: "spread of k".to_owned(),
            columns: vec![
                Column::number("records", "of 6 s"),
                Column::number("refused", format!("% at {} %", 100.0 * p.rates[0])),
                Column::number("refused", format!("% at {} %", 100.0 * p.rates[1])),
                Column::number("rms error", "of ln kᵢ/kⱼ"),
                Column::number("largest", "of ln kᵢ/kⱼ"),
                Column::number("pairs in bar", "%"),
            ],
            rows: rows.collect(),
            footnote: format!(
                "Bar: kᵢ/kⱼ to {} %, all 36 pairs of each record. Forces of unequal limbs are taken to first order.",
                100.0 * p.stiffness_bar
            ),
            ..Table::default()
        }),
    ]
}
