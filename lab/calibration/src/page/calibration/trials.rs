//! Every trial as it came out.

use crate::calibrate::CalibratedSession;
use crate::diagnosis::odd_trial;
use crate::grade::COORDINATION_LIMIT;
use crate::report::TrialReport;
use sixaxis_recordings::session::{Limits, Role, SessionFile};

use crate::page::labels::{
    self, direction, file_name, largest, share, share_beside, stated, unbroken,
};
use sixaxis_page::number::{MISSING, fixed, percent, significant};
use sixaxis_page::{Axis, Block, Cell, Figure, Section, State, Table};

const ROLES: [Role; 4] = [
    Role::Linear,
    Role::Angular,
    Role::HighFrequencyLinear,
    Role::Validation,
];

/// Use of the converter's range below which its steps begin to matter.
const POOR_RANGE: f64 = 0.02;

/// The section.
pub fn section(file: &SessionFile, calibrated: &CalibratedSession) -> Section {
    let section = Section::new(
        "trials",
        "The trials",
        "How well each trial agrees with the others and with the mathematics. A number that is beyond its acceptance limit is marked.",
    );
    if calibrated.trials.is_empty() {
        return section;
    }
    section
        .block(Block::Figure(figure(&file.session.limits, calibrated)))
        .block(Block::Table(table(file, calibrated)))
        .block(Block::Text(
            [
                "- **Departure**: how far the nine channels are from what all trials together expect of this motion, over the \
                 trial's own size. Half a degree of a wedge makes about 1\u{a0}%.",
                "- **Residual**: what the motion, an offset, a trend and a lag together do not explain of the voltages: noise and vibration.",
                "- **Lag**: time by which the standard instrument is behind the sensor after its own lag has been undone.",
                "- **Prediction**: of linear and angular trials the hold-out error: the step is fitted without this trial and has to \
                 predict it, which is the honest test of a fit. Of validation runs the largest error of the six decoupled \
                 accelerations over their peaks.",
                "- **Whiteness**: correlation of neighbouring residuals of the step's equation. 0 is noise; near 1 something \
                 systematic is left, such as a wedge's angle, and the noise alone would promise too narrow an interval.",
                "- **Coordination**: the largest residual of the three equations that nine limbs of equal stiffness obey and no step \
                 uses: an independent check.",
            ]
            .join("\n"),
        ))
}

/// What was found about a recording itself.
fn found(calibrated: &CalibratedSession, name: &str) -> Option<&'static str> {
    calibrated
        .findings
        .iter()
        .find(|f| f.recordings.iter().any(|r| r == name))
        .map(|f| f.cause.name())
}

/// A row: a recording's name, and its trial unless it could not be used.
type Listed<'a> = (String, Option<&'a TrialReport>);

fn table(file: &SessionFile, calibrated: &CalibratedSession) -> Table {
    let limits = &file.session.limits;
    let mut table = Table::grouped("recording");
    for role in ROLES {
        let trials = calibrated.trials.iter().filter(|t| t.role == role);
        let mut listed: Vec<Listed> = trials.map(|t| (t.name.clone(), Some(t))).collect();
        let entries = file
            .session
            .recording
            .iter()
            .filter(|entry| entry.role == role);
        let missing: Vec<String> = entries
            .map(|entry| entry.file.display().to_string())
            .filter(|name| listed.iter().all(|(listed, _)| listed != name))
            .collect();
        listed.extend(missing.into_iter().map(|name| (name, None)));
        if !listed.is_empty() {
            table = table.group(labels::role(role), listed, |(name, _)| unbroken(name));
        }
    }
    // Where nothing was found there is nothing to tell in its column.
    if calibrated.findings.iter().any(|f| !f.recordings.is_empty()) {
        table = table.text("found", |(name, trial)| {
            let found = found(calibrated, name).or(trial.is_none().then_some("not used"));
            found.map_or(Cell::from(""), |words| Cell::from(words).state(State::Bad))
        });
    }
    let of = |listed: &Listed, get: &dyn Fn(&TrialReport) -> Cell| {
        listed.1.map_or(Cell::from(MISSING), get)
    };
    table
        .under("motion")
        .col(("frequency", "Hz"), |l| {
            of(l, &|t| significant(t.frequency_hz, 3).into())
        })
        .col("direction", |l| of(l, &|t| direction(t.direction).into()))
        .under("recording")
        .col("range used", |l| {
            of(l, &|t| {
                let range = t.largest_over_full_scale;
                Cell::from(percent(range, 2)).warn_unless(range >= POOR_RANGE)
            })
        })
        .under("agreement with the others")
        .col("departure", |l| {
            of(l, &|t| within(t.departure, odd_trial::NOTICED))
        })
        .col("residual", |l| of(l, &|t| share(t.residual).into()))
        .col(("lag", "ms"), |l| {
            of(l, &|t| Cell::or_dash(t.lag_s.map(|s| fixed(1e3 * s, 2))))
        })
        .col("predic\u{ad}tion", |l| {
            of(l, &|t| match worst(t.validation.as_ref().map(|v| &v[..])) {
                None => within(t.hold_out, limits.hold_out_percent / 100.0),
                validation => within(validation, limits.validation_percent / 100.0),
            })
        })
        .under("independent checks")
        .col("whiteness", |l| {
            of(l, &|t| Cell::or_dash(t.residual_correlation.map(|r| fixed(r, 2))))
        })
        .col("coordi\u{ad}nation", |l| {
            of(l, &|t| {
                within(worst(t.coordination.as_ref().map(|c| &c[..])), COORDINATION_LIMIT)
            })
        })
        .caption("All trials")
        .footnote(format!(
            "Acceptance limits: departure {}, hold-out {}, coordination {}, validation {}. Range used is the largest voltage over the \
             converter's limit; a small share wastes resolution. Directions are those of travel and axis in the sensor's axes at rest.",
            stated(odd_trial::NOTICED),
            stated(limits.hold_out_percent / 100.0),
            stated(COORDINATION_LIMIT),
            stated(limits.validation_percent / 100.0),
        ))
        .into()
}

/// A share, marked where it is beyond its limit.
fn within(value: Option<f64>, limit: f64) -> Cell {
    // NaN is marked, too.
    Cell::from(share_beside(value, limit)).warn_unless(value.is_none_or(|value| value <= limit))
}

fn worst(values: Option<&[f64]>) -> Option<f64> {
    largest(values?.iter().map(|x| (*x, ()))).map(|(worst, ())| worst)
}

fn figure(limits: &Limits, calibrated: &CalibratedSession) -> Figure {
    let trials = &calibrated.trials;
    let series = |get: &dyn Fn(&TrialReport) -> Option<f64>| -> Vec<(f64, f64)> {
        trials
            .iter()
            .enumerate()
            .filter_map(|(row, trial)| Some((100.0 * get(trial)?, row as f64)))
            .collect()
    };
    Figure::new(
        "trial-errors",
        "Departure, hold-out error and validation error by trial",
        Axis::log("share of the trial's own size", "%"),
        Axis::names("trial", trials.iter().map(|t| file_name(&t.name))),
    )
    .points("departure from the others", 0, series(&|t| t.departure))
    .points("hold-out error", 1, series(&|t| t.hold_out))
    .points(
        "validation error, largest of six",
        2,
        series(&|t| largest(t.validation?.into_iter().map(|e| (e, ()))).map(|(e, ())| e)),
    )
    .vertical(100.0 * odd_trial::NOTICED, "departure noticed")
    .vertical(limits.hold_out_percent, "hold-out limit")
    .vertical(limits.validation_percent, "validation limit")
    .caption("A trial that stands apart to the right does not fit in with the others. Its neighbours usually suffer with it: a fit that contains a bad trial predicts the good ones worse.")
}
