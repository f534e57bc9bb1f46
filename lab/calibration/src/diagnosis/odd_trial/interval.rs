//! A part of a trial that is another's than the rest: a cable that was loose, a standard that read nothing for a while, a spike. The rest of
//! the run agrees with the other trials sample by sample, which no factor, exchange or direction does.

use sixaxis_core::LIMBS;

use crate::diagnosis::table::Table;
use crate::diagnosis::trial_case::TrialCase;
use crate::finding::{Cause, Finding};
use crate::series::median;

/// Parts of a run that are judged by themselves.
const PARTS: usize = 64;
/// What is left over in a part, relative to the motion where it is largest, from which the part does not follow it: one silent limb of
/// little load leaves 4 to 7 %.
const DEPARTS: f64 = 0.03;
/// What is left over in all other parts, relative to their motion, within which they follow it: a wedge that is off by a degree leaves as
/// much everywhere, and is no matter of a part.
const FOLLOWS: f64 = 0.02;
/// Share of what is left over in it that is one channel's if the others follow.
const OF_ONE: f64 = 0.8;
/// Size of a standard's reading, relative to its root mean square in the rest of the run, from which it reads something.
const READS: f64 = 0.1;
/// Share of the part in which it does not, from which it reads nothing: the rest is a filter's tail, or before and after.
const MOSTLY: f64 = 0.5;

/// What the standards make one expect of a channel, and what it shows beyond that, at each sample, m/s^2.
struct Course {
    channel: usize,
    expected: Vec<f64>,
    beyond: Vec<f64>,
}

impl Course {
    fn of(table: &Table, case: &TrialCase<'_>, channel: usize) -> Option<Self> {
        let expected = table.force_per_mass_m_s2(channel, case.trial, case.conditioned)?;
        let scale = table.mass_over_scale_kg[channel];
        let mut beyond: Vec<f64> = (case.force_n.iter().zip(&expected))
            .map(|(force_n, expected)| force_n[channel] / scale - expected)
            .collect();
        // The zero is that of most of the run.
        let zero = median(beyond.iter().copied())?;
        for x in &mut beyond {
            *x -= zero;
        }
        Some(Self {
            channel,
            expected,
            beyond,
        })
    }
}

fn squares(series: &[f64]) -> f64 {
    series.iter().map(|x| x * x).sum()
}

/// The part that does not follow the motion, if there is one and all others do.
pub(super) fn examine(table: &Table, case: &TrialCase<'_>) -> Option<Finding> {
    let counts = (0..LIMBS).filter(|i| !case.ignored[*i] && !table.silent[*i]);
    let courses: Vec<Course> = counts
        .map(|channel| Course::of(table, case, channel))
        .collect::<Option<_>>()?;
    let samples = case.force_n.len();
    let length = samples.div_ceil(PARTS).max(1);
    // Squares in each part, all channels together.
    let of_parts = |value: fn(&Course, usize) -> f64| -> Vec<f64> {
        let parts = (0..samples).step_by(length);
        let sum = |from: usize| -> f64 {
            let to = samples.min(from + length);
            let all = courses
                .iter()
                .flat_map(|course| (from..to).map(move |at| value(course, at)));
            all.map(|x| x * x).sum()
        };
        parts.map(sum).collect()
    };
    let expected = of_parts(|course, at| course.expected[at]);
    let shown = of_parts(|course, at| course.expected[at] + course.beyond[at]);
    let left = of_parts(|course, at| course.beyond[at]);
    // A jump of the standard or of a channel is no motion: the others do not show it.
    let motion: Vec<f64> = (expected.iter().zip(&shown))
        .map(|(a, b)| a.min(*b))
        .collect();
    let most_motion = motion.iter().copied().fold(0.0, f64::max);
    let departs = |part: &usize| left[*part] > DEPARTS * DEPARTS * most_motion;
    let first = (0..left.len()).find(departs)?;
    let last = (0..left.len()).rfind(departs)?;
    let (from, to) = (first * length, ((last + 1) * length).min(samples));
    let total = |of: &[f64]| of.iter().sum::<f64>();
    let inside = total(&left[first..=last]);
    let motion_outside = total(&motion[..first]) + total(&motion[last + 1..]);
    let left_outside = total(&left[..first]) + total(&left[last + 1..]);
    // Of what moves: a rest follows anything.
    if left_outside >= FOLLOWS * FOLLOWS * motion_outside {
        return None;
    }
    let most = courses
        .iter()
        .max_by(|a, b| squares(&a.beyond[from..to]).total_cmp(&squares(&b.beyond[from..to])))?;
    let alone = squares(&most.beyond[from..to]) > OF_ONE * inside;
    let seconds = |sample: usize| sample as f64 / case.trial.sample_rate_hz;
    let when = format!("from {:.2} s to {:.2} s", seconds(from), seconds(to));
    let (channels, evidence, advice) = if alone {
        (
            vec![most.channel],
            format!(
                "{when} the channel does not follow the motion as it does in the rest of the run; the others do"
            ),
            "see to its cable and plug for a loose contact, and record the trial again",
        )
    } else {
        let silent = [
            ("accelerometer", &case.trial.accelerometer_m_s2),
            ("gyroscope", &case.trial.gyroscope_rad_s),
        ]
        .into_iter()
        .find(|(_, series)| {
            let outside = squares(&series[..from]) + squares(&series[to..]);
            let size = (outside / (samples - (to - from)) as f64).sqrt();
            let nothing = series[from..to].iter().filter(|x| x.abs() < READS * size);
            nothing.count() as f64 > MOSTLY * (to - from) as f64
        });
        (
            Vec::new(),
            match silent {
                Some((name, _)) => {
                    format!("{when} the standard {name} reads nothing while the channels move")
                }
                None => format!(
                    "{when} channels and standards do not agree as they do in the rest of the run"
                ),
            },
            "see to the cables of the standards and of the recorder for a loose contact, and whether samples are missing there; record the trial again",
        )
    };
    let finding = Finding::new(Cause::Unreadable, evidence, advice);
    Some(finding.in_trial(case.trial).on_channels(channels))
}
