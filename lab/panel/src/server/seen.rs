//! What a browser sees, as a Parquet file: a row a bin, its time, smallest and largest sample of each column.

use anyhow::{Context, Result, bail};
use sixaxis_recordings::{Block, Channel, Layout, create};

use super::request::Request;
use crate::board::Board;
use crate::columns::described;
use crate::control::{Message, View};
use crate::picture::Seen;

/// The view that a request asks for, in the bounds of those that come over the WebSocket.
fn view(request: &Request) -> Result<View> {
    let part = |name: &str| request.query(name).with_context(|| format!("no {name}"));
    let message = format!(
        r#"{{"do":"view","columns":[{}],"span_s":{},"end_s":{},"points":{}}}"#,
        part("columns")?,
        part("span_s")?,
        part("end_s")?,
        part("points")?
    );
    match Message::parse(&message)? {
        Message::View(view) if !view.columns.is_empty() => Ok(view),
        _ => bail!("no column is asked for"),
    }
}

/// The file.
///
/// # Errors
/// A view out of bounds; a disk that is full.
pub fn parquet(board: &Board, request: &Request) -> Result<Vec<u8>> {
    let view = view(request)?;
    let seen = Seen::of(board, &view);
    let names = described();
    let mut channels = vec![Channel::new("time".to_owned(), Some("s"))];
    let mut columns = vec![seen.times_s().collect::<Vec<f64>>()];
    let bins = seen.grid.bins;
    for (k, column) in view.columns.iter().enumerate() {
        let own = &seen.values[2 * bins * k..2 * bins * (k + 1)];
        for (side, which) in ["smallest", "largest"].into_iter().enumerate() {
            let name = format!("{which} {}", names[*column].name);
            channels.push(Channel::new(name, Some(names[*column].unit)));
            columns.push(
                own.iter()
                    .skip(side)
                    .step_by(2)
                    .map(|x| f64::from(*x))
                    .collect(),
            );
        }
    }
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("seen.parquet");
    let layout = Layout {
        channels,
        ..Layout::default()
    };
    let mut sink = create(&path, &layout)?;
    sink.write(&Block { columns })?;
    sink.finish()?;
    Ok(std::fs::read(&path)?)
}
