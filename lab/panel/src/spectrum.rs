//! Spectra of the nine channels, on a thread of its own.

use std::sync::Arc;
use std::time::Duration;

use serde::Serialize;
use sixaxis_core::dsp::spectrum::welch;

use crate::board::{Board, Post, locked};
use crate::columns::VOLTAGE;

/// Samples that a spectrum is of, and of a segment.
const SAMPLES: usize = 16_384;
const SEGMENT: usize = 2_048;
/// Time between two spectra.
const EVERY: Duration = Duration::from_millis(500);
/// Lines that are sent: several of a spectrum become the largest of them, on a logarithmic axis.
const LINES: usize = 200;

/// Amplitude densities.
#[derive(Serialize)]
struct Spectra {
    frequencies_hz: Vec<f32>,
    /// V/√Hz, one list a channel.
    densities: Vec<Vec<f32>>,
}

/// Works until the instrument is shut down.
pub fn run(board: &Arc<Board>) {
    while !board.is_over() {
        std::thread::sleep(EVERY);
        if let Some(spectra) = of_now(board)
            && let Ok(text) = serde_json::to_string(&serde_json::json!({ "spectrum": spectra }))
        {
            board.post(Post::Spectrum, text);
        }
    }
}

fn of_now(board: &Board) -> Option<Spectra> {
    let history = locked(&board.history);
    let rate = history.sample_rate_hz;
    let series: Vec<Vec<f64>> = VOLTAGE.map(|k| history.last(k, SAMPLES)).collect();
    drop(history);
    let mut spectra = Spectra {
        frequencies_hz: Vec::new(),
        densities: Vec::new(),
    };
    let first_hz = rate / SEGMENT as f64;
    let edges: Vec<f64> = (0..=LINES)
        .map(|k| first_hz * (0.5 * rate / first_hz).powf(k as f64 / LINES as f64))
        .collect();
    for channel in &series {
        // A channel with NaN has no spectrum.
        let spectrum = welch(channel, SEGMENT, rate).ok();
        let mut densities = Vec::new();
        let mut frequencies = Vec::new();
        if let Some(spectrum) = spectrum {
            for edge in edges.windows(2) {
                let inside = spectrum.frequencies_hz.iter().zip(&spectrum.densities);
                let inside = inside.filter(|(hz, _)| edge[0] <= **hz && **hz < edge[1]);
                if let Some((hz, density)) = inside.max_by(|a, b| a.1.total_cmp(b.1)) {
                    frequencies.push(*hz as f32);
                    densities.push(density.sqrt() as f32);
                }
            }
        }
        // All channels have one grid, but for that of the largest line within an edge: the first channel's stands for it.
        if spectra.frequencies_hz.is_empty() {
            spectra.frequencies_hz = frequencies;
        }
        spectra.densities.push(densities);
    }
    (!spectra.frequencies_hz.is_empty()).then_some(spectra)
}
