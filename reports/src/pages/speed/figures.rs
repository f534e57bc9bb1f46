//! How the core's time depends on scheme and sample rate, on the length of a record, on the number of streams.

use super::snapshot::{Length, LengthPoint, Point, Spread, Streams, StreamsPoint, WorkPrecision};
use sixaxis_page::number::{count, scientific, significant};
use sixaxis_page::{Axis, Block, Figure, Mark, Series};

const US_PER_S: f64 = 1e6;
const BYTES_PER_MB: f64 = 1e6;
/// Room above the largest time of an axis that begins at zero.
const HEADROOM: f64 = 1.1;
/// A share of the width left beside the outermost points of a logarithmic axis, as a ratio.
const BESIDE: f64 = 1.4;
/// Errors reach from a little under the reference's own to a little over the largest.
const AROUND: f64 = 2.0;

/// Palette indices of the ways through the core.
const PUSH: usize = 0;
const RECORD: usize = 1;
const LANES: usize = 2;
const THREADS: usize = 3;

/// Error against work, sample by sample and as a record, on the same axes.
pub fn work_precision(w: &WorkPrecision) -> Block {
    // Time, s per s, and error at a sample rate.
    type Way = fn(&Point) -> (f64, f64);
    let push: Way = |p| (p.push_s_per_s.median, p.push_error);
    let record: Way = |p| (p.record_s_per_s.median, p.record_error);
    let all = || {
        let points = w.curves.iter().flat_map(|curve| &curve.points);
        points.flat_map(move |p| [push(p), record(p)])
    };
    let (fastest, slowest) = ends(all().map(|(time, _)| time * US_PER_S));
    let (_, worst) = ends(all().map(|(_, error)| error));
    let figure = |id: &str, title: &str, way: Way| {
        let mut figure = Figure::new(
            id,
            title,
            Axis::log("time per second of signal", "µs").range(fastest / BESIDE, slowest * BESIDE),
            Axis::log("largest error / peak", "").range(w.reference_error / AROUND, worst * AROUND),
        );
        for (colour, curve) in w.curves.iter().enumerate() {
            let points = curve.points.iter().map(way);
            figure = figure.series(Series::line_points(
                curve.scheme.name(),
                colour,
                points.map(|(time, error)| (time * US_PER_S, error)),
            ));
        }
        figure.mark(Mark::horizontal(w.reference_error, "reference"))
    };
    Block::FigureGrid(vec![
        figure("speed-work-push", "Sample by sample", push),
        figure("speed-work-record", "As a record", record),
    ])
}

/// What to see in [`work_precision`].
pub fn work_precision_text(w: &WorkPrecision) -> String {
    let rates = || w.curves.iter().flat_map(|curve| &curve.points);
    let (lowest, highest) = ends(rates().map(|p| p.sample_rate_hz));
    let best = rates().map(|p| p.push_error).fold(f64::INFINITY, f64::min);
    format!(
        "Each point is a sample rate, from {} Hz on the left to {} Hz on the right, each twice the one before: every other sample \
         of one simulation of the 5 Hz compound run. The error is that of the linear acceleration against MuJoCo's truth, \
         with true parameters and without noise. At equal time the lower curve is the better \
         one. The schemes of fourth order end at {}, whatever the rate; halving MuJoCo's step moves that by {}, marked as \
         reference.",
        significant(lowest, 3),
        count(highest as u64),
        scientific(best, 2),
        scientific(w.reference_error, 1),
    )
}

/// Time against length and against the number of streams.
pub fn scaling(l: &Length, s: &Streams) -> Block {
    let medians = l.streamed.iter().chain(&l.held);
    let medians = medians.flat_map(|p| [p.push_ns.median, p.record_ns.median]);
    let of_streams = s.points.iter().flat_map(|p| [p.push_ns, p.record_ns]);
    let (_, slowest) = ends(medians.chain(of_streams.map(|spread| spread.median)));
    let time = |label: &str| Axis::linear(label, "ns").range(0.0, slowest * HEADROOM);
    let samples = |points: &[LengthPoint], way: fn(&LengthPoint) -> Spread| -> Vec<(f64, f64)> {
        let points = points.iter();
        points.map(|p| (p.samples as f64, way(p).median)).collect()
    };
    let length = Figure::new(
        "speed-length",
        "Length of the record",
        Axis::log("samples", ""),
        time("time per sample"),
    )
    .series(Series::line_points(
        "`push`, as samples arrive",
        PUSH,
        samples(&l.streamed, |p| p.push_ns),
    ))
    .series(Series::dashed(
        "`push`, all in memory",
        PUSH,
        samples(&l.held, |p| p.push_ns),
    ))
    .series(Series::line_points(
        "`push_record`, as samples arrive",
        RECORD,
        samples(&l.streamed, |p| p.record_ns),
    ))
    .series(Series::dashed(
        "`push_record`, all in memory",
        RECORD,
        samples(&l.held, |p| p.record_ns),
    ));
    let mut streams = Figure::new(
        "speed-streams",
        "Number of streams",
        Axis::log("streams", ""),
        time("time per sample and stream"),
    );
    type Way = fn(&StreamsPoint) -> Option<Spread>;
    let ways: [(String, usize, Way); 4] = [
        ("`push`, one stream after the other".to_owned(), PUSH, |p| {
            Some(p.push_ns)
        }),
        (
            "`push_record`, one after the other".to_owned(),
            RECORD,
            |p| Some(p.record_ns),
        ),
        ("`push_lanes`, eight at once".to_owned(), LANES, |p| {
            p.lanes_ns
        }),
        (
            format!("`push_lanes` on {} threads", s.threads),
            THREADS,
            |p| p.lanes_threads_ns,
        ),
    ];
    for (label, colour, way) in ways {
        let points = s.points.iter();
        let points = points.filter_map(|p| Some((p.streams as f64, way(p)?.median)));
        streams = streams.series(Series::line_points(label, colour, points));
    }
    Block::FigureGrid(vec![length, streams])
}

/// What to see in [`scaling`].
pub fn scaling_text(l: &Length, s: &Streams) -> String {
    let longest = l.streamed.iter().map(|p| p.samples).max().unwrap_or(0);
    let memory = match (l.peak_memory_before_bytes, l.peak_memory_after_bytes) {
        (Some(before), Some(after)) => format!(
            ": peak memory was {} MB before the first sample and {} MB after {}",
            significant(before as f64 / BYTES_PER_MB, 3),
            significant(after as f64 / BYTES_PER_MB, 3),
            scientific(longest as f64, 1),
        ),
        _ => String::new(),
    };
    format!(
        "Left: {}, the 5 Hz run at 10 kHz over and over. Samples that arrive, in pieces of {}, need no more memory the more there are{memory}. A \
         recording that is all in memory outgrows the caches. What does not fill a block of a \
         record goes sample by sample. Right: {}; streams have {} samples each and memory of their own; threads share out eights of them, and the machine \
         gave {} threads {} cores' worth.",
        l.scheme.name(),
        count(l.streamed_piece_samples as u64),
        s.scheme.name(),
        count(s.samples_per_stream as u64),
        s.threads,
        significant(s.cores_given, 2),
    )
}

/// Smallest and largest.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| {
        (low.min(v), high.max(v))
    })
}
