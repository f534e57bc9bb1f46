//! How the core's time depends on scheme and sample rate, on the length of a record, on the number of streams.

use sixaxis_page::{Axis, Figure, Text};

use sixaxis_props::results::{
    CoreSpeed, Length, LengthPoint, Spread, Streams, StreamsPoint, WorkPrecision,
    WorkPrecisionPoint,
};

const US_PER_S: f64 = 1e6;
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

/// Values and figures.
pub fn fill(text: Text, speed: &CoreSpeed) -> Text {
    let (w, length, streams) = (&speed.work_precision, &speed.length, &speed.streams);
    let points = || w.curves.iter().flat_map(|curve| &curve.points);
    let smallest = points().map(|p| p.push_error).fold(f64::INFINITY, f64::min);
    let (lowest, highest) = ends(points().map(|p| p.sample_rate_hz));
    let both = || points().flat_map(|p| [push(p), record(p)]);
    let (fastest, slowest) = ends(both().map(|(time, _)| time));
    let (_, worst) = ends(both().map(|(_, error)| error));
    let time =
        Axis::log("time per second of signal", "µs").range(fastest / BESIDE, slowest * BESIDE);
    let error =
        Axis::log("largest error / peak", "").range(w.reference_error / AROUND, worst * AROUND);
    let held = length.streamed.iter().chain(&length.held);
    let held = held.flat_map(|p| [p.push_ns, p.record_ns]);
    let of_streams = streams.points.iter().flat_map(|p| [p.push_ns, p.record_ns]);
    let (_, slowest_ns) = ends(held.chain(of_streams).map(|spread| spread.median));
    let ns = |label: &str| Axis::linear(label, "ns").range(0.0, slowest_ns * HEADROOM);
    text.value("rates_hz", (lowest, highest as u64))
        .value("smallest_error", smallest)
        .value("length_scheme", length.scheme.name())
        .value("streams_scheme", streams.scheme.name())
        .value("longest", length.streamed.iter().map(|p| p.samples).max())
        .figure(work_precision(
            Figure::new("speed-work-push", "", time.clone(), error.clone()),
            w,
            push,
        ))
        .figure(work_precision(
            Figure::new("speed-work-record", "", time, error),
            w,
            record,
        ))
        .figure(over_length(length, ns("time per sample")))
        .figure(over_streams(streams, ns("time per sample and stream")))
}

/// Time, µs per s, and error at a sample rate, sample by sample.
fn push(p: &WorkPrecisionPoint) -> (f64, f64) {
    (p.push_s_per_s.median * US_PER_S, p.push_error)
}

/// The same as a record.
fn record(p: &WorkPrecisionPoint) -> (f64, f64) {
    (p.record_s_per_s.median * US_PER_S, p.record_error)
}

/// Error against work.
fn work_precision(
    figure: Figure,
    w: &WorkPrecision,
    way: fn(&WorkPrecisionPoint) -> (f64, f64),
) -> Figure {
    let figure = figure.horizontal(w.reference_error, "reference");
    let curves = w.curves.iter().enumerate();
    curves.fold(figure, |figure, (colour, curve)| {
        let points = curve.points.iter().map(way);
        figure.line_points(curve.scheme.name(), colour, points)
    })
}

/// Time against the length of a record.
fn over_length(l: &Length, time: Axis) -> Figure {
    let samples = |points: &[LengthPoint], way: fn(&LengthPoint) -> Spread| -> Vec<(f64, f64)> {
        let points = points.iter();
        points.map(|p| (p.samples as f64, way(p).median)).collect()
    };
    Figure::new("speed-length", "", Axis::log("samples", ""), time)
        .line_points(
            "`push`, as samples arrive",
            PUSH,
            samples(&l.streamed, |p| p.push_ns),
        )
        .dashed(
            "`push`, all in memory",
            PUSH,
            samples(&l.held, |p| p.push_ns),
        )
        .line_points(
            "`push_record`, as samples arrive",
            RECORD,
            samples(&l.streamed, |p| p.record_ns),
        )
        .dashed(
            "`push_record`, all in memory",
            RECORD,
            samples(&l.held, |p| p.record_ns),
        )
}

/// Time against the number of streams.
fn over_streams(s: &Streams, time: Axis) -> Figure {
    type Way = fn(&StreamsPoint) -> Option<Spread>;
    let on_threads = format!("`push_lanes` on {} threads", s.threads);
    let ways: [(&str, usize, Way); 4] = [
        ("`push`, one stream after the other", PUSH, |p| {
            Some(p.push_ns)
        }),
        ("`push_record`, one after the other", RECORD, |p| {
            Some(p.record_ns)
        }),
        ("`push_lanes`, eight at once", LANES, |p| p.lanes_ns),
        (&on_threads, THREADS, |p| p.lanes_threads_ns),
    ];
    let figure = Figure::new("speed-streams", "", Axis::log("streams", ""), time);
    ways.into_iter()
        .fold(figure, |figure, (label, colour, way)| {
            let points = s.points.iter();
            let points = points.filter_map(|p| Some((p.streams as f64, way(p)?.median)));
            figure.line_points(label, colour, points)
        })
}

/// Smallest and largest.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| {
        (low.min(v), high.max(v))
    })
}
