//! False alarms of `sixaxis decouple --watch`, end to end, on healthy laboratories:
//! `cargo run --release -p sixaxis-props --example watch`.
//!
//! Prints the alarms of each corner and course of motion, and with `--publish` writes what README and the report show.

use std::process::ExitCode;

use rayon::prelude::*;
use sixaxis_calibration::report::Grade;
use sixaxis_props::faults::FALSE_ALARMS_PER_HOUR;
use sixaxis_props::faults::laboratories::{
    Corner, Course, RECORDING_S, RIG_HZ, Recording, STIFFNESS_SPREAD, WEDGE_ERROR_DEG, plan, watch,
};
use sixaxis_props::faults::watched::Watched;
use sixaxis_props::publication::{Seeds, run};
use sixaxis_props::results::{WatchedCorner, WatchedLaboratories};

/// Seeds below were looked at while the study was written, or are those of an earlier publication.
const REPORTED_FROM: u64 = 30_000_000;
/// Laboratories: 14 minutes each, 45 hours for each corner.
const LABORATORIES: u64 = 192;

fn main() -> ExitCode {
    run(Seeds::alone(REPORTED_FROM, LABORATORIES), study)
}

fn study(first: u64, count: u64) -> Result<WatchedLaboratories, String> {
    let folder = std::env::temp_dir().join(format!("sixaxis-watch-{}", std::process::id()));
    let played: Result<Vec<(bool, Grade, Vec<Recording>)>, String> = (0..2 * count)
        .into_par_iter()
        .map(|case| {
            let equal_limbs = case >= count;
            let (grade, recordings) = watch(first + case % count, equal_limbs, &folder)?;
            Ok((equal_limbs, grade, recordings))
        })
        .collect();
    let _ = std::fs::remove_dir(&folder);
    let played = played?;
    let sample_rate_hz = plan(first, false).sample_rate_hz;
    let mut corners = Vec::new();
    for (equal_limbs, true_parameters) in
        [(false, false), (false, true), (true, false), (true, true)]
    {
        let corner = Corner {
            equal_limbs,
            true_parameters,
        };
        let of_corner = played.iter().filter(|(equal, ..)| *equal == equal_limbs);
        let grades: Vec<Grade> = of_corner.clone().map(|(_, grade, _)| *grade).collect();
        let recordings: Vec<&Recording> = of_corner
            .flat_map(|(.., recordings)| recordings)
            .filter(|recording| recording.corner == corner)
            .collect();
        let counted = |course| Watched::of(course, &recordings, sample_rate_hz);
        let counted = WatchedCorner {
            corner,
            grades: WatchedCorner::grades(&grades),
            total: counted(None),
            courses: Course::ALL.map(|course| counted(Some(course))).to_vec(),
        };
        println!("{corner:?}, grades {:?}", counted.grades);
        for line in core::iter::once(&counted.total).chain(&counted.courses) {
            let [low, high] = line.per_alarm_hour_95();
            println!(
                "  {:<9} {:6.2} h {:6} alarms, {:8.2} an hour unflagged [{:.2}, {:.2}], in {} of {} recordings and {} of {} laboratories, flagged {:.4}: {:?}",
                line.course.map_or("all".to_owned(), |c| format!("{c:?}")),
                line.hours,
                line.alarms,
                line.per_alarm_hour(),
                low,
                high,
                line.recordings_with_alarm,
                line.recordings,
                line.sessions_with_alarm,
                line.sessions,
                line.flagged_share,
                line.said
            );
        }
        corners.push(counted);
    }
    Ok(WatchedLaboratories {
        first_seed: first,
        laboratories: count,
        sample_rate_hz,
        false_alarms_per_hour: FALSE_ALARMS_PER_HOUR,
        recording_s: RECORDING_S,
        rig_hz: RIG_HZ,
        wedge_error_deg: WEDGE_ERROR_DEG,
        stiffness_spread: STIFFNESS_SPREAD,
        corners,
    })
}
