//! What each motion leaves open.

use super::published::Published;
use sixaxis_page::number::count;
use sixaxis_page::{Block, Column, Row, Table};

/// Table.
pub fn blocks(p: &Published) -> Vec<Block> {
    let rows = p.motions.iter().map(|m| {
        Row::new(
            m.motion.clone(),
            [
                count(8 - m.directions),
                m.open.clone().unwrap_or_else(|| "nothing".to_owned()),
            ],
        )
    });
    vec![Block::Table(Table {
        caption: "Which motion tells what".to_owned(),
        stub: "motion".to_owned(),
        columns: vec![
            Column::number("ratios told", "of 8"),
            Column::text("left open"),
        ],
        rows: rows.collect(),
        footnote: "20 s with noise. A ratio counts as open where its standard deviation is above a per cent, or where it shows by \
                   less than a thousandth of the forces; `sixaxis self-calibrate` then names it and says nothing else."
            .to_owned(),
        ..Table::default()
    })]
}
