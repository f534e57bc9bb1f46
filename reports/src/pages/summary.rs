//! Key figures, the bars, and how good the reference is.

use sixaxis_core::Scheme;
use sixaxis_reference::rig::run::Mode;

use crate::study::bars::worst;
use crate::study::results::{ParameterSet, Results, Standard};
use sixaxis_page::number::{fixed, percent, scientific, significant};
use sixaxis_page::{Block, Cell, Column, Row, Section, State, Table, Tile};

fn state(met: bool) -> State {
    if met { State::Good } else { State::Bad }
}

/// The tiles at the top.
pub fn tiles(r: &Results) -> Vec<Tile> {
    let crossing = |mode| {
        r.thresholds
            .iter()
            .find(|s| s.sensor == "design" && s.mode == mode)
            .and_then(|s| s.crossing_hz)
            .unwrap_or(f64::NAN)
    };
    let substepped = Scheme::HeunSubstepped;
    let repeated = worst(
        &r.compound_noise_free,
        ParameterSet::Repeated,
        substepped,
        Standard::Truth,
    );
    let four_steps = worst(
        &r.compound_noise_free,
        ParameterSet::Identified,
        substepped,
        Standard::Truth,
    );
    let laboratory = worst(
        &r.compound_laboratory,
        ParameterSet::Identified,
        substepped,
        Standard::Instruments,
    );
    vec![
        Tile::new(
            "Error with laboratory errors",
            percent(laboratory, 2),
            "largest of 18 cells, as the paper compares; the paper: 7.479 %, the bar: 1 %",
            state(laboratory <= 0.01),
        ),
        Tile::new(
            "The same without errors",
            scientific(four_steps, 2),
            "four steps as printed, against truth; the bar: 10⁻⁵",
            state(four_steps <= 1e-5),
        ),
        Tile::new(
            "Steps 2 to 4 repeated",
            scientific(repeated, 2),
            "the limbs' compliance kept; the bar: 10⁻⁵",
            state(repeated <= 1e-5),
        ),
        Tile::new(
            "Threshold frequencies",
            format!(
                "{} / {} Hz",
                fixed(crossing(Mode::Linear), 2),
                fixed(crossing(Mode::Angular), 2)
            ),
            "linear / angular; the paper reads 2.3 and 2.5 Hz off Fig. 7",
            State::Neutral,
        ),
        Tile::new(
            "k/m found by step 4",
            format!(
                "{} × 10⁸ s⁻²",
                fixed(r.noise_free.found.stiffness_per_mass_per_s2 / 1e8, 1)
            ),
            if r.laboratory.stiffness_verdict.is_determined() {
                "without errors; truth 2.0".to_owned()
            } else {
                "without errors; truth 2.0. With laboratory errors: not determined".to_owned()
            },
            State::Neutral,
        ),
        Tile::new(
            "Bars met",
            format!(
                "{} of {}",
                r.bars.iter().filter(|b| b.met).count(),
                r.bars.len()
            ),
            "each with its measured value below",
            State::Neutral,
        ),
    ]
}

/// The table of bars.
pub fn bars(r: &Results) -> Section {
    let rows = r.bars.iter().map(|bar| {
        let with_unit = |value: f64| {
            let text = if value == 0.0 {
                "0".to_owned()
            } else {
                scientific(value, 2)
            };
            if bar.unit.is_empty() {
                text
            } else {
                format!("{text} {}", bar.unit)
            }
        };
        Row::new(
            bar.name.clone(),
            [
                Cell::from(with_unit(bar.value))
                    .title(bar.value.to_string())
                    .state(state(bar.met)),
                Cell::from(with_unit(bar.limit)),
                Cell::from(bar.note.clone()),
            ],
        )
    });
    let quick = if r.quick {
        " This is a quick look with three trials a step on the three axes alone: the laboratory's figures need the full campaign."
    } else {
        ""
    };
    Section::new(
        "bars",
        "What was promised, what was measured",
        format!(
            "Errors are the largest over the whole run, run-up included, over that axis' own peak. \
             A bar that is missed says so; the reason is in the claims ledger.{quick}"
        ),
    )
    .block(Block::Table(Table {
        caption: "Bars of this study".to_owned(),
        stub: "Quantity".to_owned(),
        columns: vec![
            Column::number("measured", ""),
            Column::number("limit", ""),
            Column::text("remark"),
        ],
        rows: rows.collect(),
        ..Table::default()
    }))
}

/// How good MuJoCo is as a truth.
pub fn reference(r: &Results) -> Section {
    let mut section = Section::new(
        "reference",
        "The reference's own error",
        format!(
            "Shell and mass are two free bodies joined by nine tendons; the shell is driven exactly, and truth is read from \
             the simulator's state. The Runge-Kutta step is {} µs in the calibration runs and {} µs in the compound runs. \
             Beside each comparison stands what halving that step changes.",
            significant(r.reference.campaign_step_s * 1e6, 3),
            significant(r.reference.compound_step_s * 1e6, 3),
        ),
    );
    section = section.block(Block::Text(format!(
        "Hung at rest under gravity, MuJoCo's limbs shorten by up to {} nm; an independent Newton solve agrees within {} of that.",
        significant(r.reference.static_elongation_m * 1e9, 3),
        scientific(r.reference.static_elongation_relative, 2),
    )));
    for set in &r.reference.modes {
        let rows = (0..6).map(|i| {
            Row::new(
                format!("{}", i + 1),
                [
                    fixed(set.predicted_hz[i], 3),
                    fixed(set.measured_hz[i], 3),
                    scientific(set.measured_hz[i] / set.predicted_hz[i] - 1.0, 2),
                ],
            )
        });
        section = section.block(Block::Table(Table {
            caption: format!("Natural modes of the {} sensor", set.sensor),
            stub: "mode".to_owned(),
            columns: vec![
                Column::number("eigenvalue solution", "Hz"),
                Column::number("MuJoCo ring-down", "Hz"),
                Column::number("relative difference", ""),
            ],
            rows: rows.collect(),
            ..Table::default()
        }));
    }
    section
}
