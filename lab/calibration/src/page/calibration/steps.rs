//! Condition numbers and residuals of steps 2 and 3, and the curve of step 4.

use crate::calibrate::CalibratedSession;
use crate::steps::FourSteps;
use sixaxis_recordings::session::Role;

use crate::page::labels::verdict;
use sixaxis_page::number::{MISSING, count, fixed, scientific, significant};
use sixaxis_page::{Axis, Block, Figure, Section, Table};

/// The section.
pub fn section(calibrated: &CalibratedSession) -> Section {
    let mut section = Section::new(
        "steps",
        "Steps 2 to 4",
        "Whether the motions told the unknowns apart, and why stiffness over mass is determined or not.",
    );
    let Some(steps) = &calibrated.steps else {
        return section;
    };
    section = section.block(Block::Table(table(calibrated, steps)));
    if let Some((gain, error)) = steps.rate_over_reading {
        section = section.block(Block::Note(format!(
            "Step 3 found the standard gyroscope's gain along with the inertias: the true rate is {} ± {} (95 %) of its reading. It \
             does so by the centrifugal torques, which grow with the square of the rate.",
            fixed(gain, 5),
            fixed(1.96 * error, 5)
        )));
    }
    match &steps.stiffness {
        None => section.block(Block::Note(
            "Step 4 was not done: there is no recording of role `high_frequency_linear`. Decoupling does not need it: the design's \
             $k$/$m$ stands in."
                .to_owned(),
        )),
        Some(_) => section
            .block(Block::Figure(curve(steps)))
            .block(Block::Text(explanation(calibrated, steps))),
    }
}

/// One step's row.
struct Told {
    name: &'static str,
    role: Role,
    rows: String,
    condition: String,
    residual: String,
    verdict: String,
}

fn table(calibrated: &CalibratedSession, steps: &FourSteps) -> Table {
    let scale = &steps.scale.estimate;
    let inertia = &steps.inertia.estimate;
    let stiffness = steps.stiffness.as_ref().map(|stiffness| Told {
        name: "4:\u{a0}stiffness",
        role: Role::HighFrequencyLinear,
        rows: format!("{} candidates", steps.curve.len()),
        condition: MISSING.to_owned(),
        residual: format!("{}\u{a0}rad/s", significant(stiffness.smallest_rad_s, 2)),
        verdict: verdict(&stiffness.verdict),
    });
    let told = [
        Told {
            name: "2:\u{a0}scale\u{a0}factors",
            role: Role::Linear,
            rows: count(scale.rows as u64),
            condition: significant(scale.condition, 3),
            residual: format!("{}\u{a0}m/s²", significant(scale.residual_rms, 2)),
            verdict: verdict(&steps.scale.verdict),
        },
        Told {
            name: "3:\u{a0}inertias",
            role: Role::Angular,
            rows: count(inertia.rows as u64),
            condition: significant(inertia.condition, 3),
            residual: format!("{}\u{a0}m²/s²", scientific(inertia.residual_rms, 2)),
            verdict: verdict(&steps.inertia.verdict),
        },
    ];
    Table::of("step", told.into_iter().chain(stiffness), |step| step.name.to_owned())
        .col("trials", |step| {
            let trials = calibrated.trials.iter();
            trials.filter(|t| t.role == step.role).count().to_string()
        })
        .col("rows", |step| step.rows.clone())
        .col("condition number", |step| step.condition.clone())
        .col("residual, r.m.s.", |step| step.residual.clone())
        .text("determined", |step| step.verdict.clone())
        .caption("The steps")
        .footnote(
            "The condition number is how much better the best told combination of unknowns is told than the worst: 1 is ideal, \
             up to about 10 is sound, and from 100 on a direction is as good as left out, so that errors of the data show in \
             the estimates many times over. Trials on more wedges lower it. Of step 4 the residual is the curve's minimum.",
        )
        .into()
}

/// k/m in 10^8 1/s^2, so that the axis has short numbers.
const E8: f64 = 1e-8;

fn curve(steps: &FourSteps) -> Figure {
    let found = steps
        .stiffness
        .as_ref()
        .map_or(f64::NAN, |s| s.grid_minimum_per_s2);
    let largest = steps
        .curve
        .iter()
        .map(|(_, w)| *w)
        .fold(f64::MIN_POSITIVE, f64::max);
    Figure::new(
        "step-4",
        "Step 4: the search for stiffness over mass",
        Axis::linear("$k$/$m$", "10⁸ 1/s²"),
        // From zero: a curve that is flat is to look flat.
        Axis::linear("mean |w*|", "rad/s").range(0.0, 1.08 * largest),
    )
    .line(
        "",
        0,
        steps.curve.iter().map(|(k, w)| (k * E8, *w)),
    )
    .vertical(
        steps.design_stiffness_per_mass_per_s2 * E8,
        "design",
    )
    .vertical(found * E8, "minimum")
    .caption("Mean rotation rate that is decoupled from purely linear trials, for each candidate. A rotation that is not there should vanish at the true value: a sharp dip that nearly reaches zero determines it.")
}

fn explanation(calibrated: &CalibratedSession, steps: &FourSteps) -> String {
    let Some(stiffness) = &steps.stiffness else {
        return String::new();
    };
    let ratio = stiffness.smallest_rad_s / stiffness.largest_rad_s;
    let reached = format!(
        "The smallest mean rate on the grid is {} rad/s, {} of the largest.",
        significant(stiffness.smallest_rad_s, 2),
        if ratio.is_finite() {
            sixaxis_page::number::percent(ratio, 3)
        } else {
            MISSING.to_owned()
        }
    );
    let by_taps = calibrated.taps.stiffness.is_some();
    if !by_taps && calibrated.stiffness().is_some_and(|p| p.determined) {
        return format!("{reached} The dip is deep enough: $k$/$m$ is determined.");
    }
    format!(
        "{reached} The rate that is left comes from errors of the scale factors, which make a rotation of their own out of linear motion. \
         Compliance of the limbs changes the torques by some millionths, so the scale factors would have to be right against each other to \
         some hundred-thousandths before the curve says anything about $k$/$m$. Wedges and noise leave them more. It does no harm: at the rig's frequencies \
         decoupled accelerations change by about as little, and {} is used.",
        if by_taps {
            "the value from the taps"
        } else {
            "the design's value"
        }
    )
}
