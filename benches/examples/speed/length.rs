//! Time per sample against the length of a record, and the memory it takes.

use std::hint::black_box;

use sixaxis_core::Scheme;
use sixaxis_props::problem::recorded::Recorded;
use sixaxis_props::results::{Length, LengthPoint};

use crate::comparison::{judge_record, pieces};
use crate::timing::{
    Effort, Progress, Voltages, push_all, record_all, repeated, rounded, spread, time,
};
use sixaxis_benches::machine::peak_memory_bytes;

/// Scheme of the longest records. Heun's error of the rate adds up from one repetition of the run to the next and runs
/// away after 1.3e7 samples, twenty minutes of being shaken at 5 Hz without a rest; this one's error stays small.
pub const LONG_SCHEME: Scheme = Scheme::AdamsMoulton4;

pub fn length(recorded: &Recorded, scheme: Scheme, effort: &Effort, progress: &Progress) -> Length {
    let block = &recorded.recording.voltage_v[..];
    let ready = &recorded.decoupler(scheme);
    let point = |samples: usize, held: Option<&[Voltages]>| {
        // One piece if the recording is held, many if it arrives.
        let (block, what) = match held {
            Some(whole) => (whole, format!("{samples} samples in memory")),
            None => (block, format!("{samples} samples as they arrive")),
        };
        progress.say(&format!("{what}: comparing"));
        let difference = judge_record(&what, ready, pieces(block, samples), samples);
        let given = || pieces(black_box(block), samples);
        let mut jobs = [
            repeated(|| push_all(black_box(ready), given())),
            repeated(|| record_all(black_box(ready), given())),
        ];
        let mut times = time(&what, &mut jobs, effort, progress).into_iter();
        let mut next = || spread(times.next().unwrap_or_default(), 1e9 / samples as f64);
        LengthPoint {
            samples,
            push_ns: next(),
            record_ns: next(),
            difference: rounded(difference),
        }
    };
    let peak_memory_before_bytes = peak_memory_bytes();
    let streamed = effort.streamed.iter().map(|n| point(*n, None)).collect();
    let peak_memory_after_bytes = peak_memory_bytes();
    let held = effort.held.iter().map(|&samples| {
        let whole: Vec<Voltages> = pieces(block, samples).flatten().copied().collect();
        point(samples, Some(&whole))
    });
    Length {
        scheme,
        streamed_piece_samples: block.len(),
        streamed,
        held: held.collect(),
        peak_memory_before_bytes,
        peak_memory_after_bytes,
    }
}
