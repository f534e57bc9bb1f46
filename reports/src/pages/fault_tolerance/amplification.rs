//! What the survivable sets do to the error: noise in closed form against measured, and laboratory errors.

use super::sets::{FailedLimbs, Set};
use sixaxis_page::number::{count, fixed, scientific};
use sixaxis_page::{Axis, Block, Figure, Mark, Series};

/// The bar on the error with laboratory errors, over the healthy decoder's.
const BAR: f64 = 2.0;

/// Text and figures.
pub fn blocks(published: &FailedLimbs) -> Vec<Block> {
    let healthy = &published.healthy_largest_error;
    let range = |pick: fn(f64, f64) -> f64| {
        100.0 * healthy.iter().copied().reduce(pick).unwrap_or(f64::NAN)
    };
    let worst = |of: fn(&Set) -> Option<f64>| {
        let ratios = published.sets.iter().filter_map(of);
        ratios.fold(f64::NAN, f64::max)
    };
    vec![
        Block::Heading("What it costs".to_owned()),
        Block::Text(format!(
            "Without noise a set adds at most {} of full scale to the error on a motion about all six axes. Laboratory errors do more. In \
             {} campaigns, each with its own standards and noise, the 5 Hz compound run comes out with a largest error of {:.1} to {:.1} % \
             of full scale with nine limbs, its drift not taken off. Twice that or less keep {} of {} sets in the median over the \
             campaigns ({} by the root mean square), the worst has {} times as much: what a lost limb would have said is made \
             up from scale factors that contradict each other. Moved so that they obey the coordination equations on the run itself, \
             they leave {} sets within twice ({} by the root mean square) and the worst at {} times.",
            scientific(published.largest_noise_free_excess, 1),
            count(published.seeds),
            range(f64::min),
            range(f64::max),
            published.within_twice,
            published.survivable,
            published.within_twice_rms,
            fixed(worst(|s| s.error_ratio), 1),
            published.within_twice_consistent,
            published.within_twice_rms_consistent,
            fixed(worst(|s| s.error_ratio_consistent), 2),
        )),
        Block::FigureGrid(vec![noise(published), errors(published)]),
    ]
}

fn survivable(published: &FailedLimbs, size: usize) -> impl Iterator<Item = &Set> {
    published
        .sets
        .iter()
        .filter(move |set| set.failed.len() == size && set.lost.is_none())
}

const SIZES: [(&str, usize, usize); 3] = [("one limb", 1, 0), ("two", 2, 1), ("three", 3, 3)];

fn noise(published: &FailedLimbs) -> Figure {
    let mut figure = Figure::new(
        "failed-limbs-noise",
        "Noise of each acceleration over the healthy decoder's",
        Axis::linear("closed form", ""),
        Axis::linear("measured", ""),
    )
    .caption(format!(
        "Six points a set, {} samples at rest.",
        count(published.noise_samples)
    ));
    for (name, size, colour) in SIZES {
        let points: Vec<(f64, f64)> = survivable(published, size)
            .filter_map(|set| Some((set.amplification?, set.amplification_measured?)))
            .flat_map(|(closed, measured)| closed.into_iter().zip(measured))
            .collect();
        figure = figure.series(Series::points(name, colour, points));
    }
    figure
}

fn errors(published: &FailedLimbs) -> Figure {
    let points = |of: fn(&Set) -> Option<f64>| {
        published
            .sets
            .iter()
            .filter_map(|set| Some((set.largest()?, of(set)?)))
            .collect::<Vec<_>>()
    };
    Figure::new(
        "failed-limbs-errors",
        "Largest error with laboratory errors over the healthy decoder's",
        Axis::linear("growth of noise", ""),
        Axis::linear("growth of the error", ""),
    )
    .series(Series::points(
        "as calibrated",
        3,
        points(|s| s.error_ratio),
    ))
    .series(Series::points(
        "consistent scale factors",
        0,
        points(|s| s.error_ratio_consistent),
    ))
    .mark(Mark::horizontal(BAR, "twice"))
    .caption("One point a survivable set, the median over the campaigns.")
}
