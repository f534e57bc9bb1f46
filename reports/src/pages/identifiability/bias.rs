//! What step 2's neglect does.

use crate::study::results::identifiability::{Bias, Identifiability, Records};
use sixaxis_page::number::{fixed, scientific};
use sixaxis_page::{Axis, Block, Column, Figure, Mark, Row, Series, Table};

/// Unit of the tables and figures, s^-2.
const UNIT_PER_S2: f64 = 1e8;

fn name(records: Records) -> &'static str {
    match records {
        Records::WholeRuns => "whole runs",
        Records::EvenTurns => "turns at full speed",
    }
}

/// Figure and tables.
pub fn blocks(study: &Identifiability) -> Vec<Block> {
    let Some(first) = study.biases.first() else {
        return Vec::new();
    };
    let mut figure = Figure::new(
        "bias-curves",
        "Step 4 with the scale factors of step 2",
        Axis::linear("$k/m$", "s⁻²"),
        Axis::log("mean |w*|", "rad/s"),
    )
    .mark(Mark::vertical(2.0e8, "truth"));
    for (bias, colour) in study.biases.iter().zip([0, 3]) {
        let label = name(bias.records);
        figure = figure
            .series(Series::line(
                format!("{label}, measured"),
                colour,
                bias.curve_measured.iter().copied(),
            ))
            .series(Series::dashed(
                format!("{label}, first-order theory"),
                colour + 1,
                bias.curve_predicted.iter().copied(),
            ));
    }
    vec![
        Block::Heading("What step 2's neglect does".to_owned()),
        Block::Text(
            "Step 2 takes the limbs as rigid. To first order in 1/(k/m) it then errs by shares of s that follow from two terms: the \
             acceleration of the mass in the shell, w² G over k/m where G is the inverse of JᵀJ, and the tilt of limbs that carry gravity, which is \
             the larger one. No residual shows them, because nine scale factors fit them exactly at one frequency. In step 4 the \
             same shares leave a torque that competes with what the limbs' compliance does to the torque balance."
                .to_owned(),
        ),
        Block::Table(shares(first)),
        Block::Figure(figure),
        Block::Table(shifts(study)),
    ]
}

fn shares(bias: &Bias) -> Table {
    let ppm = |share: f64| fixed(share * 1e6, 3);
    let rows = (0..bias.scale_error_measured.len()).map(|i| {
        Row::new(
            format!("s{}", i + 1),
            [
                ppm(bias.scale_error_measured[i]),
                ppm(bias.scale_error_predicted[i]),
                ppm(bias.scale_error_without_gravity[i]),
            ],
        )
    });
    Table {
        caption: "Relative error of step 2's scale factors, noise-free".to_owned(),
        stub: "factor".to_owned(),
        columns: vec![
            Column::number("measured", "10⁻⁶"),
            Column::number("first-order theory", "10⁻⁶"),
            Column::number("of it without gravity", "10⁻⁶").quiet(),
        ],
        rows: rows.collect(),
        footnote: String::new(),
        ..Table::default()
    }
}

fn shifts(study: &Identifiability) -> Table {
    let k = |k: f64| fixed(k / UNIT_PER_S2, 5);
    let pair = |(low, high): (f64, f64)| format!("{} to {}", k(low), k(high));
    let rows = study.biases.iter().map(|b| {
        Row::new(
            name(b.records),
            [
                scientific(b.torque_of_compliance / b.torque_of_a_limb, 2),
                scientific(b.torque_of_scale_error / b.torque_of_a_limb, 2),
                k(b.stiffness_measured_per_s2),
                k(b.stiffness_predicted_per_s2),
                pair(b.single_trial_measured_per_s2),
                pair(b.single_trial_predicted_per_s2),
            ],
        )
    });
    Table {
        caption: "Torques in step 4 and where its minimum goes; truth 2 × 10⁸ s⁻²".to_owned(),
        stub: "records".to_owned(),
        columns: vec![
            Column::number("torque of the compliance", "of n a"),
            Column::number("torque of step 2's error", "of n a"),
            Column::number("k/m measured", "10⁸ s⁻²"),
            Column::number("first-order theory", "10⁸ s⁻²"),
            Column::number("each trial alone, measured", "10⁸ s⁻²"),
            Column::number("each trial alone, theory", "10⁸ s⁻²"),
        ],
        rows: rows.collect(),
        footnote: "Torques are root mean squares over step 4's records, over half edge times acceleration.".to_owned(),
        ..Table::default()
    }
}
