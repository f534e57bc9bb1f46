//! Figures 7 and 10 again, time histories, and the order of the schemes.

use core::f64::consts::PI;

use sixaxis_reference::paper::THRESHOLD_FREQUENCY_HZ;
use sixaxis_reference::rig::run::Mode;

use crate::study::results::{Results, Search};
use sixaxis_calibration::page::labels::verdict;
use sixaxis_page::number::{fixed, scientific};
use sixaxis_page::{Axis, Block, Column, Figure, Mark, Panel, Row, Section, Series, Table};

/// Palette index of the neutral grey, for truth and theory.
const NEUTRAL: usize = 6;
/// Paper units: mm/s² and deg/s².
const MM_PER_M: f64 = 1e3;
const DEG_PER_RAD: f64 = 180.0 / PI;

/// Fig. 7.
pub fn thresholds(r: &Results) -> Section {
    let figure = |mode: Mode, id: &str, title: &str, unit: &str, factor: f64, printed: f64| {
        let mut figure = Figure::new(
            id,
            title,
            Axis::log("drive frequency", "Hz"),
            Axis::log("relative acceleration", unit),
        );
        for (colour, sweep) in r.thresholds.iter().filter(|s| s.mode == mode).enumerate() {
            figure = figure
                .series(Series::points(
                    format!("{} sensor, MuJoCo", sweep.sensor),
                    colour,
                    sweep
                        .points
                        .iter()
                        .map(|p| (p.frequency_hz, p.relative_acceleration * factor)),
                ))
                .series(Series::dashed(
                    format!("{} sensor, linear theory", sweep.sensor),
                    colour,
                    sweep
                        .points
                        .iter()
                        .zip(&sweep.theory)
                        .map(|(p, t)| (p.frequency_hz, t * factor)),
                ));
        }
        figure
            .mark(Mark::horizontal(0.01, "threshold"))
            .mark(Mark::vertical(printed, format!("paper {printed} Hz")))
            .mark(Mark::slope(1.6, 3e-5, 4.0, 0.25, "4"))
    };
    let rows = r.thresholds.iter().map(|s| {
        let factor = if s.mode == Mode::Angular {
            DEG_PER_RAD
        } else {
            MM_PER_M
        };
        let worst = s
            .points
            .iter()
            .zip(&s.theory)
            .map(|(p, t)| (p.relative_acceleration / t - 1.0).abs())
            .fold(0.0, f64::max);
        Row::new(
            format!(
                "{}, {}",
                s.sensor,
                if s.mode == Mode::Angular {
                    "angular"
                } else {
                    "linear"
                }
            ),
            [
                s.crossing_hz.map_or("none".to_owned(), |f| fixed(f, 3)),
                fixed(s.slope, 4),
                fixed(s.at_2_and_4_hz[0] * factor, 4),
                fixed(s.at_2_and_4_hz[1] * factor, 3),
                scientific(worst, 1),
            ],
        )
    });
    Section::new(
        "thresholds",
        "Fig. 7: threshold frequencies",
        "How the mass moves in the shell: amplitude of its relative acceleration in MuJoCo, with the slider's stroke of 186 mm \
         as linear amplitude along (1, 1, 2) and 100.04° as angular amplitude about z. Each point is one simulation.",
    )
    .block(Block::FigureGrid(vec![
        figure(
            Mode::Linear,
            "fig7-linear",
            "Linear",
            "mm/s²",
            MM_PER_M,
            THRESHOLD_FREQUENCY_HZ.0,
        ),
        figure(
            Mode::Angular,
            "fig7-angular",
            "Angular",
            "°/s²",
            DEG_PER_RAD,
            THRESHOLD_FREQUENCY_HZ.1,
        ),
    ]))
    .block(Block::Table(Table {
        caption: "Thresholds of 0.01 mm/s² and 0.01 °/s²".to_owned(),
        stub: "sensor and motion".to_owned(),
        columns: vec![
            Column::number("crossed at", "Hz"),
            Column::number("slope on log axes", ""),
            Column::number("at 2 Hz", "mm/s² or °/s²"),
            Column::number("at 4 Hz", "mm/s² or °/s²"),
            Column::number("largest departure from linear theory", ""),
        ],
        rows: rows.collect(),
        footnote: "The slider itself moves by half its stroke, which raises the linear threshold by a factor of 2^{1/4}.".to_owned(),
        ..Table::default()
    }))
}

/// What a search curve was made with.
fn search_label(search: &Search) -> String {
    match search.scale_error {
        Some(error) if error > 0.0 => format!("scale factors off by {}", scientific(error, 1)),
        _ => search.label.clone(),
    }
}

/// Fig. 10.
pub fn stiffness(r: &Results) -> Section {
    let figure = |id: &str, title: &str, as_printed: bool| {
        let mut figure = Figure::new(
            id,
            title,
            Axis::linear("$k/m$", "s⁻²"),
            Axis::log("mean |w*|", "rad/s"),
        )
        .mark(Mark::vertical(2.0e8, "truth"));
        for (colour, search) in r
            .searches
            .iter()
            .filter(|s| s.sign_as_printed == as_printed && s.scale_error.is_some())
            .enumerate()
        {
            figure = figure.series(Series::line(
                search_label(search),
                colour,
                search.curve.iter().copied(),
            ));
        }
        figure
    };
    let mut own = Figure::new(
        "fig10-four-steps",
        "With the four steps' own scale factors",
        Axis::linear("$k/m$", "s⁻²"),
        Axis::log("mean |w*|", "rad/s"),
    )
    .mark(Mark::vertical(2.0e8, "truth"));
    for (colour, search) in r
        .searches
        .iter()
        .filter(|s| s.scale_error.is_none())
        .enumerate()
    {
        own = own.series(Series::line(
            search_label(search),
            [0, 3][colour % 2],
            search.curve.iter().copied(),
        ));
    }
    let rows = r.searches.iter().map(|s| {
        Row::new(
            search_label(s),
            [
                if s.sign_as_printed {
                    "as printed"
                } else {
                    "corrected"
                }
                .to_owned(),
                fixed(s.grid_minimum_per_s2 / 1e8, 1),
                fixed(s.interpolated_per_s2 / 1e8, 4),
                verdict(&s.verdict),
            ],
        )
    });
    Section::new(
        "stiffness",
        "Fig. 10: the search for k/m",
        "Pure linear motion at 4 to 5 Hz has no rotation; step 4 takes the k/m for which the decoupled rate |w*| is smallest. With \
         compression shortening the limbs and true scale factors the minimum stands exactly on the true grid point. Scale \
         errors of a millionth already blur it, of a ten-thousandth drown it; the sign printed in eq. (2) has no minimum at all.",
    )
    .block(Block::FigureGrid(vec![
        figure("fig10-corrected", "Compression shortens", false),
        figure("fig10-printed", "Sign of eq. (2) as printed", true),
    ]))
    .block(Block::Figure(own))
    .block(Block::Table(Table {
        caption: "Where each curve is smallest".to_owned(),
        stub: "scale factors".to_owned(),
        columns: vec![
            Column::text("eq. (2)"),
            Column::number("grid minimum", "10⁸ s⁻²"),
            Column::number("between grid points", "10⁸ s⁻²"),
            Column::text("verdict"),
        ],
        rows: rows.collect(),
        ..Table::default()
    }))
}

/// Time histories.
pub fn histories(r: &Results) -> Section {
    const NAMES: [(&str, &str); 6] = [
        ("a-x", "Linear, x"),
        ("a-y", "Linear, y"),
        ("a-z", "Linear, z"),
        ("angular-x", "Angular, x"),
        ("angular-y", "Angular, y"),
        ("angular-z", "Angular, z"),
    ];
    let h = &r.history;
    let zip = |y: &[f64]| {
        h.time_s
            .iter()
            .copied()
            .zip(y.iter().copied())
            .collect::<Vec<_>>()
    };
    let figures = (0..6).map(|i| {
        let unit = if i < 3 { "m/s²" } else { "rad/s²" };
        let peak = h.truth[i].iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let relative = |e: &[f64]| {
            e.iter()
                .map(|x| (x / peak).abs().max(1e-9))
                .collect::<Vec<_>>()
        };
        Figure::new(
            format!("history-{}", NAMES[i].0),
            NAMES[i].1,
            Axis::linear("time", "s"),
            Axis::linear("acceleration", unit),
        )
        .series(Series::line("truth", NEUTRAL, zip(&h.truth[i])))
        .series(Series::dashed(
            "decoupled, laboratory errors",
            3,
            zip(&h.laboratory[i]),
        ))
        .below(Panel {
            y: Axis::log("|error| / peak", "").range(1e-9, 1e-1),
            series: vec![
                Series::line("", 3, zip(&relative(&h.error_laboratory[i]))),
                Series::line(
                    "error, noise-free",
                    0,
                    zip(&relative(&h.error_noise_free[i])),
                ),
            ],
            marks: vec![],
        })
    });
    Section::new(
        "histories",
        format!("Time histories at {} Hz", h.frequency_hz),
        "The run of Table 6 from rest to rest. Below each acceleration its error over the peak: with laboratory errors, and \
         noise-free with steps 2 to 4 repeated.",
    )
    .block(Block::FigureGrid(figures.collect()))
}

/// Order of the schemes.
pub fn orders(r: &Results) -> Section {
    let mut figure = Figure::new(
        "order-of-schemes",
        "Error of the rate against the sample rate",
        Axis::log("sample rate", "Hz"),
        Axis::log("largest error of w* over its peak", ""),
    );
    for (colour, order) in r.orders.iter().enumerate() {
        figure = figure.series(Series::line_points(
            order.scheme.name(),
            colour,
            order.points.iter().copied(),
        ));
    }
    let floor = r.orders.first().map_or(f64::NAN, |o| o.reference_error);
    let rows = r.orders.iter().map(|o| {
        let at = |rate: f64| {
            o.points
                .iter()
                .find(|(f, _)| *f == rate)
                .map_or(f64::NAN, |(_, e)| *e)
        };
        Row::new(
            o.scheme.name(),
            [
                o.theoretical.to_string(),
                o.measured.map_or("—".to_owned(), |m| fixed(m, 3)),
                scientific(at(1_000.0), 1),
                scientific(at(10_000.0), 1),
            ],
        )
    });
    Section::new(
        "orders",
        "Order of the integrators",
        format!(
            "The 5 Hz compound run on MuJoCo truth, decoupled with true parameters from 250 Hz to 20 kHz. Below {} of the peak \
             rate only the reference's own error is left, so slopes are fitted above ten times that and from 400 Hz on.",
            scientific(floor, 1)
        ),
    )
    .block(Block::Figure(figure.mark(Mark::horizontal(floor, "reference"))))
    .block(Block::Table(Table {
        caption: "Measured order".to_owned(),
        stub: "scheme".to_owned(),
        columns: vec![
            Column::number("theory", ""),
            Column::number("measured", ""),
            Column::number("error at 1 kHz", ""),
            Column::number("error at 10 kHz", ""),
        ],
        rows: rows.collect(),
        ..Table::default()
    }))
}
