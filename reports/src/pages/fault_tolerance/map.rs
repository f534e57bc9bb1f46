//! All 129 sets: what can be done without, at what cost in noise, and what is lost.

use super::sets::{FailedLimbs, MAKE, Set};
use sixaxis_page::number::count;
use sixaxis_page::{Block, Cell, Column, Row, State, Table};

/// Growth of noise from which a set is marked.
const DEAR: f64 = 2.0;
const LIMBS: usize = 9;

/// Text and maps.
pub fn blocks(published: &FailedLimbs) -> Vec<Block> {
    let lost = published.sets.len() - published.survivable;
    vec![
        Block::Heading(format!(
            "{} of {}",
            published.survivable,
            published.sets.len()
        )),
        Block::Text(format!(
            "Of {} sets of one to three limbs {} leave six axes, decided in whole numbers; {lost} do not, and the decoder refuses them, \
             naming the load that it would lose. Doing without limbs costs noise. Of the six accelerations one suffers most; printed \
             is by how much its white noise grows, in closed form: {MAKE}.",
            count(published.sets.len() as u64),
            count(published.survivable as u64),
        )),
        Block::Table(pairs(published)),
        Block::Table(triples(published)),
    ]
}

fn cell(set: Option<&Set>) -> Cell {
    let Some(set) = set else {
        return Cell::from("");
    };
    match (set.largest(), &set.lost) {
        (Some(grows), _) => {
            let state = if grows > DEAR {
                State::Warn
            } else {
                State::Good
            };
            Cell::from(format!("{grows:.2}"))
                .title(format!("without {}", set.name()))
                .state(state)
        }
        (None, Some(load)) => Cell::from("lost")
            .title(format!("without {}: {load}", set.name()))
            .state(State::Bad),
        (None, None) => Cell::from(""),
    }
}

fn columns(first: usize) -> Vec<Column> {
    (first..=LIMBS)
        .map(|limb| Column::number(limb.to_string(), ""))
        .collect()
}

fn pairs(published: &FailedLimbs) -> Table {
    let rows = (1..=LIMBS).map(|a| {
        let cells = (1..=LIMBS).map(|b| {
            let set = if a == b {
                published.set(&[a])
            } else {
                published.set(&[a.min(b), a.max(b)])
            };
            cell(set)
        });
        Row::new(a.to_string(), cells)
    });
    let lost: Vec<String> = published
        .sets
        .iter()
        .filter(|set| set.failed.len() == 2)
        .filter_map(|set| Some(format!("{}: {}", set.name(), set.lost.as_ref()?)))
        .collect();
    Table {
        caption: "Growth of noise without one limb (diagonal) and without two".to_owned(),
        stub: "limb".to_owned(),
        columns: columns(1),
        rows: rows.collect(),
        footnote: format!(
            "Lost pairs and what the other seven show nothing of: {}.",
            lost.join("; ")
        ),
        ..Table::default()
    }
}

fn triples(published: &FailedLimbs) -> Table {
    let mut rows = Vec::new();
    for a in 1..=LIMBS {
        for b in a + 1..LIMBS {
            let cells = (3..=LIMBS).map(|c| cell(published.set(&[a, b, c])));
            rows.push(Row::new(format!("{a}, {b}"), cells));
        }
    }
    Table {
        caption: "Growth of noise without three".to_owned(),
        stub: "limbs".to_owned(),
        columns: columns(3),
        rows,
        footnote: "Rows are the two limbs with the lower numbers, columns the third. Point at a lost set for its load.".to_owned(),
        ..Table::default()
    }
}
