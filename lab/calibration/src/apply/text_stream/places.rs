//! Where a line of a stream has its columns, by their names or by their order, and what it has there.

use anyhow::{Result, ensure};
use sixaxis_core::{LIMBS, LimbSet};
use sixaxis_recordings::channel::time_channel;
use sixaxis_recordings::ingest::find::{self, Column};
use sixaxis_recordings::session::Channels;
use sixaxis_recordings::{Channel, Layout};

use crate::apply::Row;

/// Name of the stream in messages.
pub(super) const PLACE: &str = "standard input";

/// Where things stand in a line: limbs whose channels are not read nowhere.
pub(super) struct Places {
    limbs: [Option<Column>; LIMBS],
    pub(super) names: [String; LIMBS],
    pub(super) time: Option<Column>,
    columns: usize,
}

impl Places {
    /// As a line of headings says.
    pub(super) fn by_name(cells: &[&str], stated: &Channels, excluded: LimbSet) -> Result<Self> {
        let channels: Vec<Channel> = cells
            .iter()
            .map(|cell| stated.in_volts(Channel::from_heading(cell.trim_matches('"'))))
            .collect();
        let time = match &stated.time {
            Some(name) => channels.iter().position(|c| c.name == *name),
            None => time_channel(&channels),
        };
        let layout = Layout {
            channels,
            time,
            ..Layout::default()
        };
        let time = find::time(PLACE.as_ref(), &layout, None)?;
        Self::of(&layout, time, cells.len(), stated, excluded)
    }

    /// As a line of numbers, one a limb, has them.
    pub(super) fn by_order(cells: &[&str], stated: &Channels, excluded: LimbSet) -> Result<Self> {
        let columns = cells.len();
        ensure!(
            !cells.iter().any(|cell| cell.contains(';')),
            "numbers have decimal points in a stream, and commas or semicolons between them, not both: is this one with decimal commas?"
        );
        ensure!(
            columns == LIMBS,
            "{columns} numbers, {LIMBS} were expected; where there are more, begin with a line of headings"
        );
        let layout = Layout {
            channels: stated
                .limbs
                .iter()
                .map(|name| stated.in_volts(Channel::new(name.clone(), None)))
                .collect(),
            ..Layout::default()
        };
        Self::of(&layout, None, columns, stated, excluded)
    }

    fn of(
        layout: &Layout,
        time: Option<Column>,
        columns: usize,
        stated: &Channels,
        excluded: LimbSet,
    ) -> Result<Self> {
        let mut limbs = [const { None }; LIMBS];
        for (limb, column) in limbs.iter_mut().enumerate() {
            if !excluded.contains(limb) {
                *column = Some(find::limb(PLACE.as_ref(), layout, stated, limb)?);
            }
        }
        Ok(Self {
            limbs,
            names: stated.limbs.clone(),
            time,
            columns,
        })
    }

    /// Voltages of a line. Excluded limbs' cells are not parsed and read 0. With `watched`, a cell that is not a
    /// finite number becomes NaN, which the fault monitor takes for a failure, instead of an error.
    pub(super) fn read(&self, cells: &[&str], watched: bool) -> Result<Row, String> {
        if cells.len() != self.columns {
            return Err(format!(
                "{} columns, {} were expected",
                cells.len(),
                self.columns
            ));
        }
        let number = |name: &str, index: usize| -> Result<f64, String> {
            match cells[index].parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                Ok(value) => Err(format!("{name}: {value} is not a finite number")),
                Err(_) => {
                    let shown: String = cells[index].chars().take(40).collect();
                    Err(format!("{name}: {shown:?} is not a number"))
                }
            }
        };
        let mut row = [0.0; LIMBS];
        for (value, limb) in row.iter_mut().zip(&self.limbs) {
            let Some(limb) = limb else {
                continue;
            };
            *value = limb.size_si
                * match number(&limb.name, limb.index) {
                    Err(_) if watched => f64::NAN,
                    read => read?,
                };
        }
        Ok(row)
    }
}

/// Cells of a line: between commas, else between semicolons, else between tabs, else between blanks.
pub(super) fn split(text: &str) -> Vec<&str> {
    for separator in [',', ';', '\t'] {
        if text.contains(separator) {
            return text.split(separator).map(str::trim).collect();
        }
    }
    text.split_whitespace().collect()
}
