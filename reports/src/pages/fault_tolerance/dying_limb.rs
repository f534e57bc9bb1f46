//! A limb that dies in mid-motion, as MuJoCo's truth sees it.

use super::published::{DyingLimb, MAKE_DYING_LIMB};
use sixaxis_page::number::{fixed, scientific};
use sixaxis_page::{Axis, Block, Figure, Mark, Series};

/// Palette index of the neutral grey.
const NEUTRAL: usize = 6;

/// Text and figures.
pub fn blocks(d: &DyingLimb) -> Vec<Block> {
    let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
    let milliseconds = |samples: u64| fixed(1e3 * samples as f64 / d.sample_rate_hz, 1);
    vec![
        Block::Heading("A limb dies in mid-motion".to_owned()),
        Block::Text(format!(
            "Six-axis motion in MuJoCo, {} kHz, noise 60 dB below full scale. At {} s limb {} falls to its zero. Its class is known \
             {} ms later; after {} ms the monitor says “{}”, and the rows since before the failure are decoded anew without the limb. \
             At the end the attitude is {} rad from the truth; without any failure it would be {} rad, with the dead limb decoded on \
             {} rad ({MAKE_DYING_LIMB}).",
            fixed(d.sample_rate_hz / 1e3, 0),
            fixed(d.died_at_s, 1),
            d.limb,
            milliseconds(d.isolated_after_samples),
            milliseconds(d.switched_after_samples),
            d.verdict,
            scientific(last(&d.watched_rad), 2),
            scientific(last(&d.never_failed_rad), 2),
            scientific(last(&d.nine_rad), 2),
        )),
        Block::Figure(statistic(d)),
        Block::FigureGrid(vec![acceleration(d), attitude(d)]),
    ]
}

fn over_time<'a>(d: &'a DyingLimb, values: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
    d.time_s.iter().copied().zip(values.iter().copied())
}

fn died(d: &DyingLimb) -> Mark {
    Mark::vertical(d.died_at_s, format!("limb {} dies", d.limb))
}

fn statistic(d: &DyingLimb) -> Figure {
    Figure::new(
        "dying-limb-statistic",
        "What the parity rows leave",
        Axis::linear("time", "s"),
        Axis::log("largest squared whitened residual", ""),
    )
    .series(Series::line("", 0, over_time(d, &d.statistic)))
    .mark(Mark::horizontal(d.threshold, "threshold of one sample"))
    .mark(died(d))
}

fn acceleration(d: &DyingLimb) -> Figure {
    Figure::new(
        "dying-limb-acceleration",
        "Acceleration along x",
        Axis::linear("time", "s"),
        Axis::linear("acceleration", "m/s²"),
    )
    .series(Series::line("all nine", 3, over_time(d, &d.nine_m_s2)))
    .series(Series::line(
        "the limb given up",
        0,
        over_time(d, &d.watched_m_s2),
    ))
    .series(Series::dashed(
        "truth",
        NEUTRAL,
        over_time(d, &d.truth_m_s2),
    ))
    .mark(died(d))
    .caption("With the limb given up, the line lies on the truth.")
}

fn attitude(d: &DyingLimb) -> Figure {
    Figure::new(
        "dying-limb-attitude",
        "Error of the attitude",
        Axis::linear("time", "s"),
        Axis::log("rotation from the truth", "rad").range(1e-5, 10.0),
    )
    .series(Series::line("all nine", 3, over_time(d, &d.nine_rad)))
    .series(Series::line(
        "the limb given up",
        0,
        over_time(d, &d.watched_rad),
    ))
    .series(Series::dashed(
        "no failure",
        NEUTRAL,
        over_time(d, &d.never_failed_rad),
    ))
    .mark(died(d))
    .caption(
        "The attitude is integrated without a reference, from a rate that the first samples' noise makes wrong: all three drift alike until the limb dies.",
    )
}
