//! A picture: what a browser draws, as one binary message.
//!
//! Little-endian; the head, then column numbers, then for each column smallest and largest sample of each bin, f32.
//!
//! | bytes | what |
//! |---|---|
//! | 0 | u32 number of the picture, u32 columns, u32 bins, u32 pictures dropped so far |
//! | 16 | f64 time of the first bin, f64 time of a bin, f64 time now, s |
//! | 40 | f32 latency, ms; f32 pictures a second; u32 number of the source; u32 whether the truth is known |
//! | 56 | f32 attitude, true attitude (w, x, y, z), position of the mass, m, rotation, rad |
//! | 112 | u32 column numbers |

use crate::board::{Board, Live, locked};
use crate::control::View;
use crate::pyramid::Grid;

/// Bytes before the column numbers.
pub const HEAD: usize = 112;

/// What a client knows of its own pictures.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pace {
    /// Number of the picture.
    pub number: u32,
    /// Dropped so far.
    pub dropped: u32,
    /// From the arrival of the newest sample to the answer that a picture with it was drawn, ms: the median of late.
    pub latency_ms: f32,
    /// Pictures drawn a second.
    pub per_second: f32,
}

/// What a view shows.
#[derive(Debug, Clone)]
pub struct Seen {
    /// Where the bins are.
    pub grid: Grid,
    /// Samples per second, and samples so far.
    sample_rate_hz: f64,
    count: u64,
    /// Column after column, smallest and largest sample of each bin.
    pub values: Vec<f32>,
}

impl Seen {
    /// Reads a view; the history is locked meanwhile.
    pub fn of(board: &Board, view: &View) -> Self {
        let history = locked(&board.history);
        let (rate, count) = (history.sample_rate_hz, history.count());
        let last = match view.end_s {
            Some(end_s) => (end_s * rate).max(0.0) as u64,
            None => count,
        };
        let span = (view.span_s * rate).max(1.0) as u64;
        let grid = Grid::covering(last.saturating_sub(span), last, usize::from(view.points));
        let mut values = Vec::with_capacity(2 * grid.bins * view.columns.len());
        for column in &view.columns {
            history.draw(*column, &grid, &mut values);
        }
        Self {
            grid,
            sample_rate_hz: rate,
            count,
            values,
        }
    }

    /// Time of the first sample of each bin, s.
    pub fn times_s(&self) -> impl Iterator<Item = f64> {
        let Grid { first, step, bins } = self.grid;
        (0..bins as u64).map(move |bin| (first + bin * step) as f64 / self.sample_rate_hz)
    }
}

/// Draws a view. Nothing is locked while it is sent.
pub fn draw(board: &Board, view: &View, pace: &Pace) -> (Vec<u8>, Live) {
    let live = *locked(&board.live);
    let Seen {
        grid,
        sample_rate_hz: rate,
        count,
        values,
    } = Seen::of(board, view);
    let mut bytes = Vec::with_capacity(HEAD + 4 * (view.columns.len() + values.len()));
    let words = |bytes: &mut Vec<u8>, words: &[u32]| {
        words.iter().for_each(|w| bytes.extend(w.to_le_bytes()))
    };
    words(
        &mut bytes,
        &[
            pace.number,
            view.columns.len() as u32,
            grid.bins as u32,
            pace.dropped,
        ],
    );
    for time_s in [
        grid.first as f64 / rate,
        grid.step as f64 / rate,
        count as f64 / rate,
    ] {
        bytes.extend(time_s.to_le_bytes());
    }
    bytes.extend(pace.latency_ms.to_le_bytes());
    bytes.extend(pace.per_second.to_le_bytes());
    words(
        &mut bytes,
        &[
            board.source() as u32,
            u32::from(live.true_attitude.is_some()),
        ],
    );
    let pose = live
        .attitude
        .into_iter()
        .chain(live.true_attitude.unwrap_or_default());
    for value in pose.chain(live.position_m).chain(live.rotation_rad) {
        bytes.extend((value as f32).to_le_bytes());
    }
    for column in &view.columns {
        bytes.extend((*column as u32).to_le_bytes());
    }
    for value in values {
        bytes.extend(value.to_le_bytes());
    }
    (bytes, live)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::COLUMNS;

    #[test]
    fn law_a_picture_is_as_long_as_it_says() {
        let board = Board::default();
        let view = View {
            columns: vec![0, COLUMNS - 1],
            span_s: 1.0,
            end_s: None,
            points: 100,
        };
        for k in 0..2_500_u32 {
            board
                .history
                .lock()
                .expect("whole")
                .push(&[k as f32; COLUMNS]);
        }
        let (bytes, _) = draw(&board, &view, &Pace::default());
        let word = |at: usize| {
            u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize
        };
        let (columns, bins) = (word(4), word(8));
        assert_eq!((columns, bins), (2, 100));
        assert_eq!(bytes.len(), HEAD + 4 * columns + 8 * columns * bins);
        let last = f32::from_le_bytes(bytes[bytes.len() - 4..].try_into().expect("four bytes"));
        assert_eq!(last, 2_499.0);
    }
}
