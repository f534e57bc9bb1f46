//! The joint fit beside the four steps, and what it found of instruments and wedges.

use crate::calibrate::CalibratedSession;
use crate::calibrate::contradiction;
use crate::joint::JointReport;
use crate::joint::nuisances::WedgeFound;
use crate::report::Estimator;
use crate::report::ParameterReport;

use super::parameters::with_half_width;
use crate::page::labels::{by_kind, direction, with_interval};
use sixaxis_core::identify::joint::Known;
use sixaxis_page::number::{MISSING, fixed, percent, significant};
use sixaxis_page::{Block, Cell, Section, Table};

/// The section; empty where the four steps could not be done.
pub fn section(calibrated: &CalibratedSession) -> Section {
    let section = Section::new(
        "joint",
        "All trials at once",
        "The joint fit: maximum likelihood over all 25 parameters together with the motions, the gyroscope, the amplifiers and the \
         wedges, where the four steps take the standards and the wedges for right. Limbs that are not equally stiff, cross-talk, a centre off the \
         axis and an axis off the plumb line are unknowns, too; noise is taken for white.",
    );
    match &calibrated.joint {
        None => section,
        Some(Err(cause)) => section.block(Block::Note(format!("It cannot be had: {cause}."))),
        Some(Ok(joint)) => fitted(section, calibrated, joint),
    }
}

fn fitted(mut section: Section, calibrated: &CalibratedSession, joint: &JointReport) -> Section {
    let misfit = &joint.misfit;
    section = section.block(Block::Note(match contradiction(misfit) {
        Some(words) => format!("Against it: {words}."),
        None => format!(
            "Nothing contradicts it: its squares per degree of freedom are {}, where noise alone leaves at most {}{}.",
            fixed(misfit.per_degree, 3),
            fixed(misfit.limit(), 3),
            misfit.too_few().map_or(String::new(), |words| format!("; {words}"))
        ),
    }));
    section
        .block(Block::Table(beside(calibrated, joint)))
        .block(Block::Table(nuisances(joint)))
}

fn beside(calibrated: &CalibratedSession, joint: &JointReport) -> Table {
    let reports = joint.parameter_reports(&calibrated.four_steps);
    let all = |p: &ParameterReport| format!("{} {}", p.estimate, p.unit);
    let pairs = reports.iter().zip(&calibrated.four_steps);
    let whose = if calibrated.calibration.is_none() {
        "No calibration was written."
    } else if calibrated.estimator == Estimator::FourSteps {
        "The calibration has the four steps' parameters; with `--estimator joint` it has these."
    } else {
        "The calibration has the joint fit's parameters."
    };
    by_kind(pairs, |(joint, _)| joint.parameter)
        .col("joint fit", |((joint, _), per_si)| {
            Cell::from(with_half_width(joint, *per_si).0).title(all(joint))
        })
        .col("±\u{a0}95\u{a0}%", |((joint, _), per_si)| {
            with_half_width(joint, *per_si).1
        })
        .col("four steps", |((_, steps), per_si)| {
            Cell::from(with_half_width(steps, *per_si).0).title(all(steps))
        })
        .col("±\u{a0}95\u{a0}%", |((_, steps), per_si)| {
            with_half_width(steps, *per_si).1
        })
        .col("apart", |((joint, steps), _)| apart(joint, steps))
        .text("joint fit limited by", |((joint, _), _)| joint.dominated_by.clone())
        .caption("The joint fit beside the four steps")
        .footnote(format!(
            "Apart: the difference over the wider half width; above 1 is marked. What both owe to the accelerometer's gain does not \
             part them. The four steps' half widths are here without what the joint fit says otherwise. {whose}"
        ))
        .into()
}

fn apart(joint: &ParameterReport, steps: &ParameterReport) -> Cell {
    let (Some(x), Some(y)) = (joint.half_width_95, steps.half_width_95) else {
        return Cell::from(MISSING);
    };
    let apart = (joint.estimate - steps.estimate).abs() / x.max(y);
    Cell::from(fixed(apart, 2)).warn_unless(apart <= 1.0)
}

/// What the fit found of an instrument or a wedge: value, deviation, remark.
type Told = [String; 3];

fn told(found: Known, factor: f64, unit: &str, remark: impl Into<String>) -> Told {
    let (value, deviation) = with_interval(factor * found.value, factor * found.deviation);
    [
        format!("{value}\u{a0}{unit}"),
        format!("{deviation}\u{a0}{unit}"),
        remark.into(),
    ]
}

fn nuisances(joint: &JointReport) -> Table {
    let found = joint.nuisances();
    let certificate = if found.accelerometer_gain_is_told {
        "told by gravity that turns".to_owned()
    } else {
        let limit = percent(joint.gain.limit, 2);
        format!("its certificate, ±\u{a0}{limit}, is all that is known")
    };
    let accelerometer = told(found.accelerometer_gain, 100.0, "%", certificate);
    let instruments = [
        Some(("accelerometer reads too much by", accelerometer)),
        found.gyroscope_gain.map(|gain| {
            let told = told(gain, 100.0, "%", "");
            ("gyroscope reads too much by", told)
        }),
        found.gyroscope_lag_s.map(|lag| {
            let hz = 1.0 / (core::f64::consts::TAU * lag.value);
            let bandwidth = format!("a bandwidth of {}\u{a0}Hz", fixed(hz, 2));
            ("gyroscope lags by", told(lag, 1e3, "ms", bandwidth))
        }),
        found
            .amplifier_corner_hz
            .map(|corner| ("corner of the amplifiers", told(corner, 1.0, "Hz", ""))),
    ];
    let instruments = instruments.into_iter().flatten();
    let wedges = found
        .wedges
        .iter()
        .map(|w| (direction(w.nominal), wedge(w)));
    let room = [
        (
            "limbs' stiffnesses differ by",
            100.0 * found.room.stiffness_spread,
            "%",
            "standard deviation",
        ),
        (
            "channels side by side show of each other",
            100.0 * found.room.cross_talk_beside_spread,
            "%",
            "standard deviation; undone before decoupling",
        ),
        (
            "channels apart show of each other",
            100.0 * found.room.cross_talk_apart_spread,
            "%",
            "the same",
        ),
        (
            "sensitivities move by",
            100.0 * found.room.sensitivity_spread,
            "%",
            "standard deviation, from trial to trial",
        ),
        (
            "centre off the axis by",
            1e3 * found.room.centre_off_axis_m,
            "mm",
            "at most",
        ),
        (
            "axis off the plumb line, or the level, by",
            found.room.off_plumb_deg,
            "°",
            "at most",
        ),
    ];
    let room = room.map(|(name, value, unit, remark)| {
        let value = format!("{}\u{a0}{unit}", significant(value, 2));
        (
            name.to_owned(),
            [value, MISSING.to_owned(), remark.to_owned()],
        )
    });
    let mass_centre = found.room.mass_centre_m.into_iter().flat_map(|place| {
        ["x", "y", "z"].into_iter().zip(place).map(|(axis, along)| {
            let name = format!("mass's centre from the cube's along {axis}");
            let remark = "taken into account when decoupling";
            (name, told(along, 1e3, "mm", remark))
        })
    });
    let rod_mass = found.room.rod_mass.into_iter().map(|rods| {
        let name = "half a limb's mass over the seismic mass".to_owned();
        (
            name,
            told(rods, 100.0, "%", "taken into account when decoupling"),
        )
    });
    let of_the_mass = mass_centre.chain(rod_mass);
    Table::grouped("instrument, room or wedge")
        .group(
            "Instruments",
            instruments.map(|(name, told)| (name.to_owned(), told)),
            |(name, _)| name.clone(),
        )
        .group("Room", of_the_mass.chain(room), |(name, _)| name.clone())
        .group(
            "Wedges: angles by which they miss",
            wedges,
            |(name, _)| name.clone(),
        )
        .col("found", |(_, told)| told[0].clone())
        .col("±\u{a0}one s.d.", |(_, told)| told[1].clone())
        .text("remark", |(_, told)| told[2].clone())
        .caption("What instruments, room and wedges turned out to be")
        .footnote(
            "Certificates and the workshop's tolerance are part of what is known here; where trials say nothing, they stand as \
             they were. A wedge's two angles lead along two directions square to its own.",
        )
        .into()
}

fn wedge(wedge: &WedgeFound) -> Told {
    let Some([a, b]) = wedge.angles_deg else {
        let right = "the session says that it is right".to_owned();
        return [MISSING.to_owned(), MISSING.to_owned(), right];
    };
    let [a, b] = [a, b].map(|f| with_interval(f.value, f.deviation));
    [
        format!("{}°, {}°", a.0, b.0),
        format!("{}°, {}°", a.1, b.1),
        String::new(),
    ]
}
