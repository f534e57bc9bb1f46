//! Every building block of the report once, with synthetic data: a page for the eye.
//!
//! ```sh
//! cargo run -p sixaxis-reports --example gallery -- gallery.html
//! ```
//!
//! None of the numbers is a result.

use sixaxis_reports::view::number::{MISSING, fixed, percent, scientific, significant};
use sixaxis_reports::view::{
    Axis, Block, Cell, Claim, Column, Figure, HeadCell, Kind, Mark, Page, Panel, Row, Section,
    Series, State, Table, Tile, Verdict, render, write_atomically,
};
use std::f64::consts::TAU;
use std::path::PathBuf;

fn main() -> anyhow::Result<()> {
    let path = std::env::args_os()
        .nth(1)
        .map_or_else(|| "gallery.html".into(), PathBuf::from);
    let html = render(&page())?;
    write_atomically(&path, html.as_bytes())?;
    println!("{} ({} kB)", path.display(), html.len() / 1024);
    Ok(())
}

fn page() -> Page {
    let facts = [
        ("data", "synthetic: none of these numbers is a result"),
        ("commit", "0123456789ab"),
        ("MuJoCo", "3.3.0, step 1 µs, implicit fast"),
        ("seed", "20 131 021"),
        ("machine", "8 cores, 16 GB"),
        ("took", "41 s"),
    ];
    Page {
        title: "Six axes of acceleration from nine limb forces".into(),
        subtitle: "How well the mathematics of a parallel six-axis accelerometer recovers its \
                   parameters and its motion, against a simulated truth."
            .into(),
        facts: facts
            .map(|(name, value)| (name.to_owned(), value.to_owned()))
            .to_vec(),
        tiles: vec![
            Tile::new(
                "Largest error after identification",
                percent(0.0312, 3),
                "bar 7.48 %",
                State::Good,
            ),
            Tile::new(
                "Linear threshold frequency",
                "2.296 Hz",
                "printed 2.3 Hz",
                State::Good,
            ),
            Tile::new(
                "Parameters within 1 %",
                "21 of 25",
                "with laboratory errors",
                State::Warn,
            ),
            Tile::new(
                "$k/m$ from mean |w*|, noise on",
                "10.0×10⁸ s⁻²",
                "truth 3.1×10⁸ s⁻²",
                State::Bad,
            ),
            Tile::new(
                "Reference's own error",
                scientific(3.2e-8, 2),
                "from halving the step",
                State::Neutral,
            ),
        ],
        sections: vec![
            sensor(),
            parameters(),
            thresholds(),
            stiffness(),
            motion(),
            integrators(),
            ledger(),
            corners(),
        ],
    }
}

fn sensor() -> Section {
    Section::new(
        "sensor",
        "What is measured",
        "A cubic mass hangs on nine limbs that are spring and force cell at once; nine forces per \
         mass $f_{i}/m$ give six accelerations and three checks.",
    )
    .block(Block::Text(
        "The chain is voltage, force per mass, limb length, pose, acceleration. Limb lengths follow \
         from $l_{i}$ = $L$ − ($f_{i}/m$)/($k/m$); displacements are of the order of 10⁻⁷ m, so the \
         closed form uses $δl$ (2 $L$ + $δl$) and never the difference of two squares.\n\n\
         Three things are compared:\n\n\
         - the **parameters** that the four identification steps find,\n\
         - the **motion** that the decoupler returns, `limb_force_per_mass_m_s2` by sample,\n\
         - the **claims** of the paper, one by one."
            .into(),
    ))
    .block(Block::Note(
        "Equation (2) is used with a minus sign. With the printed plus sign the search in step 4 \
         has no minimum at the true stiffness."
            .into(),
    ))
}

fn parameters() -> Section {
    let mut rows = Vec::new();
    let groups: [(&str, &str, usize, &[f64]); 4] = [
        (
            "Zero drift",
            "d",
            9,
            &[-12.3, 16.8, -15.5, -10.1, -4.7, -16.6, -11.7, -8.3, -10.9],
        ),
        (
            "Scale per mass",
            "s",
            9,
            &[
                5.0892, 3.5501, 6.1199, 3.2308, 4.8763, 7.0909, 3.6896, 3.1624, 3.1838,
            ],
        ),
        (
            "Inertia per mass",
            "I",
            6,
            &[191.0846, 236.49, 326.5389, 0.0804, -0.3794, 1.5799],
        ),
        ("Stiffness per mass", "k", 1, &[2.0e8]),
    ];
    for (name, symbol, count, printed) in groups {
        rows.push(Row::group(match symbol {
            "d" => format!("{name} (mV)"),
            "s" => format!("{name} (1/kg)"),
            "I" => format!("{name} (mm²)"),
            _ => format!("{name} (s⁻²)"),
        }));
        for (i, value) in printed.iter().enumerate() {
            let header = match symbol {
                "d" => format!("$d_{{{}}}$", i + 1),
                "s" => format!("$s_{{{}}}/m$", i + 1),
                "I" => format!("$I_{{{}}}/m$", i + 1),
                _ => "$k/m$".to_owned(),
            };
            let clean = 1.5e-7 * (1.0 + i as f64);
            let noisy =
                8e-4 * (1.0 + (i as f64 * 1.7).sin().abs()) * if count == 6 { 9.0 } else { 1.0 };
            let (noisy_state, noisy_text) = match symbol {
                "k" => (State::Bad, percent(4.0, 2)),
                _ if noisy > 0.01 => (State::Warn, percent(noisy, 2)),
                _ => (State::Neutral, percent(noisy, 2)),
            };
            rows.push(Row::new(
                header,
                [
                    Cell::from(significant(*value, 4)),
                    Cell::from(significant(value * (1.0 + clean), 6))
                        .title(format!("{:e}", value * (1.0 + clean))),
                    Cell::from(scientific(clean, 2)),
                    Cell::from(significant(value * (1.0 + noisy), 4)),
                    Cell::from(noisy_text).state(noisy_state),
                    if symbol == "k" {
                        Cell::from(MISSING)
                    } else {
                        Cell::from(percent(noisy * 0.9, 2))
                    },
                ],
            ));
        }
    }
    Section::new(
        "parameters",
        "The 25 parameters",
        "Each step is fed with the results of the steps before it, once without noise and once with \
         the errors of a laboratory.",
    )
    .block(Block::Table(Table {
        caption: "Identified parameters".into(),
        stub: "parameter".into(),
        head: vec![vec![
            HeadCell::new("paper", 1),
            HeadCell::new("noise-free", 2),
            HeadCell::new("with laboratory errors", 3),
        ]],
        columns: vec![
            Column::number("value", ""),
            Column::number("value", ""),
            Column::number("rel. error", ""),
            Column::number("value", ""),
            Column::number("rel. error", ""),
            Column::number("predicted", "1 σ"),
        ],
        rows,
        footnote: "Laboratory errors: gain 1 %, noise 0.1 % of full scale, rate gyroscope with 10 Hz \
                   bandwidth. Seed and bounds are in the footer."
            .into(),
    }))
}

fn thresholds() -> Section {
    let fourth = |factor: f64| {
        (0..60).map(move |i| {
            let f = 0.1 * 50f64.powf(f64::from(i) / 59.0);
            (f, factor * f.powi(4))
        })
    };
    let measured = (0..14).map(|i| {
        let f = 0.1 * 50f64.powf(f64::from(i) / 13.0);
        (
            f,
            1e-2 * (f / 2.296).powi(4) * (1.0 + 0.05 * f64::from(i).sin()) + 3e-8,
        )
    });
    Section::new(
        "thresholds",
        "Where relative motion can be neglected",
        "At fixed stroke the relative acceleration grows as the fourth power of the frequency.",
    )
    .block(Block::Figure(
        Figure::new(
            "fig-threshold",
            "Relative linear acceleration against frequency, stroke 186 mm",
            Axis::log("frequency", "Hz"),
            Axis::log("relative acceleration", "mm/s²"),
        )
        .caption("Markers: harmonic fitted to the simulated motion. Line: linear theory, 2.296 Hz at the threshold.")
        .series(Series::line("linear theory", 0, fourth(1e-2 / 2.296f64.powi(4))))
        .series(Series::points("MuJoCo", 1, measured))
        .mark(Mark::horizontal(0.01, "threshold 0.01 mm/s²"))
        .mark(Mark::horizontal(3e-8, "step error"))
        .mark(Mark::vertical(2.3, "paper 2.3 Hz"))
        .mark(Mark::slope(0.6, 4e-6, 4.0, 0.3, "4"))
        .wide(),
    ))
}

fn stiffness() -> Section {
    let curve = |scale: f64, floor: f64| {
        (0..=90).map(move |i| {
            let k = 1e8 + 1e7 * f64::from(i);
            let miss = (scale / k - 1.0).abs();
            (k, (miss * miss * 1e-3 + floor * floor).sqrt() * 1e-3)
        })
    };
    Section::new(
        "stiffness",
        "Stiffness from the mean rate",
        "Step 4 looks for the $k/m$ with the smallest mean |w*| on a grid.",
    )
    .block(Block::Figure(
        Figure::new(
            "fig-stiffness",
            "Mean |w*| over $k/m$",
            Axis::linear("$k/m$", "s⁻²"),
            Axis::log("mean |w*|", "rad/s"),
        )
        .caption(
            "A scale error of 10⁻⁶ already moves the minimum; 10⁻⁴ sends it to an end of the grid.",
        )
        .series(Series::line("noise-free", 2, curve(3.1e8, 1e-6)))
        .series(Series::dashed("scale error 10⁻⁶", 1, curve(2.2e8, 1e-3)))
        .series(Series::dashed(
            "scale error 10⁻⁴",
            3,
            (0..=90).map(|i| {
                (
                    1e8 + 1e7 * f64::from(i),
                    4e-5 * (1.0 - 0.004 * f64::from(i)),
                )
            }),
        ))
        .mark(Mark::vertical(3.1e8, "truth"))
        .mark(Mark::vertical(2.0e8, "paper")),
    ))
}

fn motion() -> Section {
    let names = ["a_{x}", "a_{y}", "a_{z}", "α_{x}", "α_{y}", "α_{z}"];
    let titles = [
        "along x", "along y", "along z", "about x", "about y", "about z",
    ];
    let figures = names.iter().enumerate().map(|(axis, name)| {
        let (peak, unit) = if axis < 3 {
            ([74.9, 37.5, 37.5][axis], "m/s²")
        } else {
            (1400.0 / (axis - 2) as f64, "rad/s²")
        };
        let truth = move |t: f64| {
            peak * (1.0 - (-4.0 * t).exp()) * (TAU * 5.0 * t + 0.4 * axis as f64).sin()
        };
        let error = move |t: f64| {
            peak * 2e-4
                * ((TAU * 5.0 * t).cos() + 0.3 * (TAU * 2700.0 * t).sin() * (t * 37.0).sin())
        };
        let times = || (0..=20_000).map(|i| f64::from(i) * 5e-5);
        Figure::new(
            format!("fig-motion-{axis}"),
            titles[axis],
            Axis::linear("time", "s"),
            Axis::linear(format!("${name}$"), unit),
        )
        .series(Series::line("truth", 6, times().map(|t| (t, truth(t)))))
        .series(Series::dashed(
            "decoupled",
            0,
            times().map(|t| (t, truth(t) + error(t))),
        ))
        .below(Panel {
            y: Axis::linear("error", unit),
            series: vec![Series::line("error", 1, times().map(|t| (t, error(t))))],
            marks: vec![],
        })
    });
    Section::new(
        "motion",
        "Compound motion at 5 Hz",
        "Six accelerations over one second; below each its error.",
    )
    .block(Block::FigureGrid(figures.collect()))
}

fn integrators() -> Section {
    let schemes: [(&str, f64, i32); 5] = [
        ("Euler", 3.0, 1),
        ("improved Euler", 20.0, 2),
        ("Adams–Bashforth 2", 45.0, 2),
        ("Adams–Bashforth 4", 4e3, 4),
        ("Runge–Kutta 4", 4e2, 4),
    ];
    let mut figure = Figure::new(
        "fig-order",
        "Error after one second against sample rate",
        Axis::log("sample rate", "Hz"),
        Axis::log("relative error of w*", ""),
    )
    .caption("Each scheme falls with its order until rounding, at 10⁻¹³, stops it.")
    .mark(Mark::horizontal(2e-7, "reference-limited below"))
    .mark(Mark::slope(700.0, 5e-5, -4.0, 0.35, "−4"));
    for (i, (name, factor, order)) in schemes.into_iter().enumerate() {
        figure = figure.series(Series::line_points(
            name,
            i,
            [250.0, 500.0, 1e3, 2e3, 5e3, 1e4, 2e4].map(|rate: f64| {
                (
                    rate,
                    factor * 1e2f64.powi(order - 1) * (1.0 / rate).powi(order) * 3.0 + 1e-13,
                )
            }),
        ));
    }
    Section::new(
        "integrators",
        "Five integrators",
        "The open-loop rate is integrated sample by sample; five schemes on the same record.",
    )
    .block(Block::Figure(figure))
    .block(Block::Heading("Cost beside accuracy".into()))
    .block(Block::Table(Table {
        caption: "One second of compound motion at 5 Hz".into(),
        stub: "scheme".into(),
        columns: vec![
            Column::number("order", "found"),
            Column::number("error at 1 kHz", ""),
            Column::number("error at 20 kHz", ""),
            Column::number("evaluations", "per sample"),
            Column::text("remark"),
        ],
        rows: schemes
            .iter()
            .map(|(name, factor, order)| {
                Row::new(
                    *name,
                    [
                        Cell::from(fixed(f64::from(*order) - 0.02, 2)).state(State::Good),
                        Cell::from(scientific(
                            factor * 1e2f64.powi(order - 1) * 1e3f64.powi(-order),
                            2,
                        )),
                        Cell::from(scientific(
                            factor * 1e2f64.powi(order - 1) * 2e4f64.powi(-order),
                            2,
                        )),
                        Cell::from(if *name == "Runge–Kutta 4" { "4" } else { "1" }),
                        Cell::from(if *name == "improved Euler" {
                            "the authors' choice"
                        } else {
                            ""
                        }),
                    ],
                )
            })
            .collect(),
        ..Table::default()
    }))
}

fn ledger() -> Section {
    use Verdict::{Inconsistent, NotReproducible, Reproduced, ReproducedWithCorrection};
    let claim = |claim: &str, printed: &str, measured: &str, verdict, reason: &str| Claim {
        claim: claim.into(),
        printed: printed.into(),
        measured: measured.into(),
        verdict,
        reason: reason.into(),
    };
    Section::new(
        "ledger",
        "Claims ledger",
        "What the paper prints, what was found, and what became of it.",
    )
    .block(Block::Ledger(vec![
        claim(
            "Linear threshold frequency (Fig. 7)",
            "2.3 Hz",
            "2.296 Hz",
            Reproduced,
            "With the stroke, not half of it, as amplitude.",
        ),
        claim(
            "Angular threshold frequency (Fig. 7)",
            "2.5 Hz",
            "2.517 Hz",
            Reproduced,
            "Amplitude 100.04°.",
        ),
        claim(
            "Limb length from force, eq. (2)",
            "$L$ + …",
            "$L$ − …",
            ReproducedWithCorrection,
            "With the directions of (5) the force is positive in compression.",
        ),
        claim(
            "18 target accelerations (Tables 4–6)",
            "18 values",
            "18 of 18",
            Reproduced,
            "",
        ),
        claim(
            "Angular targets at 5 Hz (Table 6)",
            "0 617.40 °/s²",
            "80 617.40 °/s²",
            ReproducedWithCorrection,
            "The scan lost a leading digit; the other two directions restore it.",
        ),
        claim(
            "Errors before identification at 5 Hz",
            "60 / 76 / 55 %",
            "18 / 49 / 36 %",
            Inconsistent,
            "They do not follow from Tables 1–3 with equal stiffness.",
        ),
        claim(
            "Largest error after identification",
            "7.479 %",
            "3.12 %",
            Reproduced,
            "",
        ),
        claim(
            "Stiffness per mass (Fig. 10)",
            "2.0×10⁸ s⁻²",
            "2.1×10⁸ s⁻²",
            Reproduced,
            "A bias of step 2, not the stiffness: the design value is 3.1×10⁸ s⁻².",
        ),
        claim(
            "Six natural frequencies",
            MISSING,
            "2726 … 6674 Hz",
            NotReproducible,
            "The paper prints none.",
        ),
        claim(
            "Decodable sets of failed limbs (sequel)",
            "93",
            "93",
            Reproduced,
            "9 single, 33 double, 51 triple.",
        ),
    ]))
}

/// What must not break the page.
fn corners() -> Section {
    let noise = (0..400_000).scan(1u64, |state, i| {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        let uniform = (*state >> 33) as f64 / f64::from(1u32 << 31) - 0.5;
        Some((
            f64::from(i) * 2e-5,
            if (150_000..180_000).contains(&i) {
                f64::NAN
            } else {
                uniform * 3e-6
            },
        ))
    });
    Section::new(
        "corners",
        "Corner cases",
        "Long records, gaps, no data, flat data, clipped data.",
    )
    .block(Block::FigureGrid(vec![
        Figure::new(
            "fig-noise",
            "400 000 samples with a gap",
            Axis::linear("time", "s"),
            Axis::linear("noise", "V"),
        )
        .series(Series::line("channel 3", 5, noise)),
        Figure::new(
            "fig-none",
            "No data at all",
            Axis::linear("time", "s"),
            Axis::log("error", ""),
        ),
        Figure::new(
            "fig-flat",
            "Flat and clipped",
            Axis::linear("time", "s").range(0.0, 1.0),
            Axis::linear("value", "mV").range(-1.0, 1.0),
        )
        .series(Series::line("flat", 0, [(0.0, 0.25), (2.0, 0.25)]))
        .series(Series::line(
            "clipped",
            1,
            (0..200).map(|i| (f64::from(i) / 199.0, 1.6 * (f64::from(i) / 9.0).sin())),
        )),
    ]))
    .block(Block::Figure(
        Figure::new(
            "fig-palette",
            "The palette",
            Axis::linear("index", ""),
            Axis::linear("value", ""),
        )
        .series(Series::new(
            "0",
            0,
            Kind::LinePoints,
            (0..9).map(|i| (f64::from(i), 0.0)),
        ))
        .series(Series::new(
            "1",
            1,
            Kind::LinePoints,
            (0..9).map(|i| (f64::from(i), 1.0)),
        ))
        .series(Series::new(
            "2",
            2,
            Kind::LinePoints,
            (0..9).map(|i| (f64::from(i), 2.0)),
        ))
        .series(Series::new(
            "3",
            3,
            Kind::LinePoints,
            (0..9).map(|i| (f64::from(i), 3.0)),
        ))
        .series(Series::new(
            "4",
            4,
            Kind::LinePoints,
            (0..9).map(|i| (f64::from(i), 4.0)),
        ))
        .series(Series::new(
            "5",
            5,
            Kind::LinePoints,
            (0..9).map(|i| (f64::from(i), 5.0)),
        ))
        .series(Series::new(
            "6",
            6,
            Kind::LinePoints,
            (0..9).map(|i| (f64::from(i), 6.0)),
        ))
        .series(Series::new(
            "7",
            7,
            Kind::LinePoints,
            (0..9).map(|i| (f64::from(i), 7.0)),
        )),
    ))
}
