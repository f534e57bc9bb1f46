//! What step 2's neglect of the limbs' compliance does to its scale factors and to step 4.

use sixaxis_page::number::{fixed, scientific};
use sixaxis_page::{Table, Text};

use super::RECORDS;
use crate::sections::stiffness::curves;
use crate::sections::stiffness_text;
use crate::study::results::identifiability::{Bias, Identifiability};

/// Figure and tables.
pub fn fill(text: Text, study: &Identifiability) -> Text {
    let mut figure = curves("bias-curves");
    for (bias, colour) in study.biases.iter().zip([0, 3]) {
        let measured = bias.curve_measured.iter().copied();
        let predicted = bias.curve_predicted.iter().copied();
        let name = name(bias);
        figure = figure
            .line(format!("{name}, measured"), colour, measured)
            .dashed(format!("{name}, first-order theory"), colour + 1, predicted);
    }
    text.figure(figure)
        .table("bias-shares", shares(study))
        .table("bias-shifts", shifts(study))
}

fn name(bias: &Bias) -> &'static str {
    let mut all = RECORDS.iter();
    all.find(|(records, ..)| *records == bias.records)
        .map_or("", |(_, _, name)| name)
}

fn shares(study: &Identifiability) -> Table {
    let millionths = |share: f64| fixed(share * 1e6, 3);
    let factors = study.biases.first().into_iter();
    let factors =
        factors.flat_map(|bias| (0..bias.scale_error_measured.len()).map(move |i| (bias, i)));
    Table::of("factor", factors, |(_, i)| format!("s{}", i + 1))
        .col(("measured", "10⁻⁶"), |(bias, i)| {
            millionths(bias.scale_error_measured[*i])
        })
        .col(("first-order theory", "10⁻⁶"), |(bias, i)| {
            millionths(bias.scale_error_predicted[*i])
        })
        .quiet(("of it without gravity", "10⁻⁶"), |(bias, i)| {
            millionths(bias.scale_error_without_gravity[*i])
        })
        .into()
}

fn shifts(study: &Identifiability) -> Table {
    let k = |k: f64| stiffness_text(k, 5);
    let ends = |(low, high): (f64, f64)| format!("{} to {}", k(low), k(high));
    Table::of("records", &study.biases, |b| name(b).to_owned())
        .col(("torque of the compliance", "of n a"), |b| {
            scientific(b.torque_of_compliance / b.torque_of_a_limb, 2)
        })
        .col(("torque of step 2's error", "of n a"), |b| {
            scientific(b.torque_of_scale_error / b.torque_of_a_limb, 2)
        })
        .col(("k/m measured", "10⁸ s⁻²"), |b| {
            k(b.stiffness_measured_per_s2)
        })
        .col(("first-order theory", "10⁸ s⁻²"), |b| {
            k(b.stiffness_predicted_per_s2)
        })
        .col(("each trial alone, measured", "10⁸ s⁻²"), |b| {
            ends(b.single_trial_measured_per_s2)
        })
        .col(("each trial alone, theory", "10⁸ s⁻²"), |b| {
            ends(b.single_trial_predicted_per_s2)
        })
        .into()
}
