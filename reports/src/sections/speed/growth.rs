//! How processor time and memory grow with samples, streams, trials and cases.

use sixaxis_page::number::{count, si, significant};
use sixaxis_page::{Axis, Cell, Figure, Table, Text};
use sixaxis_props::results::{Growth, GrowthCurve, GrowthPoint, Work};

/// Cases up to which the time of a campaign is carried on beyond what was measured.
pub const EXTRAPOLATED_CASES: f64 = 1e6;
/// Digits of a slope: more are noise.
const SLOPE_DECIMALS: usize = 2;
const BYTES_PER_MB: f64 = 1e6;
const S_PER_HOUR: f64 = 3600.0;

/// Palette indices: those of the same ways in the section's other figures.
const RECORD: usize = 1;
const LANES: usize = 2;
const FILE: usize = 3;
const CALIBRATION: usize = 4;

/// Values, figures and the table.
pub fn fill(text: Text, growth: &Growth) -> Text {
    let campaign = growth.of(Work::Campaign).and_then(GrowthCurve::power_law);
    let million_h = campaign.map(|law| law.at(EXTRAPOLATED_CASES) / S_PER_HOUR);
    let decouple = growth
        .of(Work::Decouple)
        .map_or(&[][..], |curve| &curve.points);
    let memory_mb: Vec<f64> = decouple.iter().map(memory_mb).collect();
    let most = memory_mb.iter().copied().fold(0.0, f64::max);
    text.value("growth", growth)
        .value("growth_scheme", growth.scheme.name())
        .value("million_h", million_h)
        .value("decouple_most_mb", most)
        .value("decouple_most_samples", decouple.last().map(|p| p.size))
        .figure(over(
            growth,
            "growth-samples",
            "samples",
            &[Work::Decouple, Work::PushRecord],
        ))
        .figure(memory(growth))
        .figure(over(
            growth,
            "growth-streams",
            "streams",
            &[Work::PushLanes],
        ))
        .figure(carried_on(
            over(
                growth,
                "growth-trials",
                "trials, or cases",
                &[Work::Calibrate, Work::Campaign],
            ),
            growth,
        ))
        .table("growth", table(growth))
}

/// What is done, and what it is drawn in.
fn named(work: Work) -> (&'static str, usize) {
    match work {
        Work::Decouple => ("`sixaxis decouple`", FILE),
        Work::PushRecord => ("`push_record` in memory", RECORD),
        Work::PushLanes => ("`push_lanes`", LANES),
        Work::Calibrate => ("`sixaxis calibrate`, by trials", CALIBRATION),
        Work::Campaign => ("`sixaxis campaign run`, by cases", FILE),
    }
}

fn slope(curve: &GrowthCurve) -> String {
    curve.power_law().map_or_else(String::new, |law| {
        format!("{:.*}", SLOPE_DECIMALS, law.exponent)
    })
}

/// Slope from the largest size but one to the largest, where caches and blocks no longer matter and fixed costs weigh nothing.
fn last_slope(curve: &GrowthCurve) -> String {
    let [.., before, last] = &curve.points[..] else {
        return String::new();
    };
    let ratio = last.processor_s.median / before.processor_s.median;
    let exponent = ratio.ln() / (last.size as f64 / before.size as f64).ln();
    format!("{exponent:.SLOPE_DECIMALS$}")
}

fn memory_mb(point: &GrowthPoint) -> f64 {
    point.peak_memory_bytes as f64 / BYTES_PER_MB
}

/// Processor time against size.
fn over(growth: &Growth, id: &str, size: &str, works: &[Work]) -> Figure {
    let time = Axis::log("processor time", "s");
    let figure = Figure::new(id, "", Axis::log(size, ""), time);
    let curves = works.iter().filter_map(|work| growth.of(*work));
    curves.fold(figure, |figure, curve| {
        let (name, colour) = named(curve.work);
        let label = format!("{name}, slope {}", slope(curve));
        let points = curve.points.iter();
        let points = points.map(|p| (p.size as f64, p.processor_s.median));
        figure.line_points(label, colour, points)
    })
}

/// Peak memory against samples.
fn memory(growth: &Growth) -> Figure {
    let (samples, memory) = (Axis::log("samples", ""), Axis::log("peak memory", "MB"));
    let figure = Figure::new("growth-memory", "", samples, memory);
    let curves = [Work::Decouple, Work::PushRecord].into_iter();
    let curves = curves.filter_map(|work| growth.of(work));
    curves.fold(figure, |figure, curve| {
        let (name, colour) = named(curve.work);
        let points = curve.points.iter().map(|p| (p.size as f64, memory_mb(p)));
        figure.line_points(name, colour, points)
    })
}

/// The campaign beyond what was measured, along its own line.
fn carried_on(figure: Figure, growth: &Growth) -> Figure {
    let last = |curve: &GrowthCurve| Some((curve.points.last()?.size as f64, curve.power_law()?));
    let Some((from, law)) = growth.of(Work::Campaign).and_then(last) else {
        return figure;
    };
    let ends = [from, EXTRAPOLATED_CASES].map(|cases| (cases, law.at(cases)));
    figure.dashed("cases, extrapolated", named(Work::Campaign).1, ends)
}

/// Each kind of work at its smallest and at its largest size.
fn table(growth: &Growth) -> Table {
    let curves = growth.curves.iter().filter_map(|curve| {
        let (first, last) = (curve.points.first()?, curve.points.last()?);
        Some((curve, first, last))
    });
    type Row<'a> = (&'a GrowthCurve, &'a GrowthPoint, &'a GrowthPoint);
    let time = |p: &GrowthPoint| {
        let [q1, q3] = [p.processor_s.q1, p.processor_s.q3].map(|q| si(q, 3, "s"));
        Cell::from(si(p.processor_s.median, 2, "s")).title(format!(
            "{} processes, quartiles {q1} and {q3}; {} from start to end",
            p.processes,
            si(p.wall_s.median, 2, "s"),
        ))
    };
    let each = |p: &GrowthPoint| si(p.processor_s.median / p.size as f64, 2, "s");
    Table::grouped("what is done")
        .rows(curves, |(curve, ..): &Row| named(curve.work).0.to_owned())
        .under("smallest")
        .col("size", |(_, first, _)| count(first.size))
        .col("processor time", |(_, first, _)| time(first))
        .col("of each", |(_, first, _)| each(first))
        .col(("memory", "MB"), |(_, first, _)| {
            significant(memory_mb(first), 2)
        })
        .under("largest")
        .col("size", |(.., last)| count(last.size))
        .col("processor time", |(.., last)| time(last))
        .col("of each", |(.., last)| each(last))
        .col(("memory", "MB"), |(.., last)| {
            significant(memory_mb(last), 2)
        })
        .under("")
        .col("slope", |(curve, ..)| slope(curve))
        .col("of the last two sizes", |(curve, ..)| last_slope(curve))
        .into()
}
