//! What the fault monitor said of healthy laboratories, counted.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::laboratories::{Course, Recording};

/// The verdict in a message of the monitor without limbs and samples; none of a message that is no verdict.
pub fn verdict(message: &str) -> Option<&str> {
    let (_, said) = message.split_once(": ")?;
    let (said, _) = said.split_once(" since sample ")?;
    let said = said.strip_suffix(", which shows").unwrap_or(said);
    Some(match said.starts_with("limb") {
        true => said.rsplit_once(": ").map_or(said, |(_, kind)| kind),
        false => said,
    })
}

/// Counts over some of the recordings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// The motion; all of them where there is none.
    pub course: Option<Course>,
    /// Recordings.
    pub recordings: usize,
    /// Recordings with an alarm.
    pub recordings_with_alarm: usize,
    /// Laboratories.
    pub sessions: usize,
    /// Laboratories with an alarm.
    pub sessions_with_alarm: usize,
    /// Hours watched.
    pub hours: f64,
    /// Alarms that began an isolation.
    pub alarms: u64,
    /// Alarms an hour watched; see [`Self::per_alarm_hour`].
    pub per_hour: f64,
    /// Ends of the exact 95 % interval of that for a Poisson process. Alarms come in clusters, a laboratory a cluster: it is a
    /// lower limit of what chance may do.
    pub per_hour_95: [f64; 2],
    /// Share of the answers with a limb excluded or suspected.
    pub flagged_share: f64,
    /// Verdicts that were told, by what was said.
    pub said: BTreeMap<String, u64>,
}

impl Watched {
    /// Hours during which all nine limbs can raise an alarm: while one is excluded or suspected only the relations that are left can, and that is
    /// not counted.
    pub fn alarm_hours(&self) -> f64 {
        self.hours * (1.0 - self.flagged_share)
    }

    /// Alarms in an hour of these. What alarms at once and stays flagged has few alarms an hour watched, however bad it is.
    pub fn per_alarm_hour(&self) -> f64 {
        self.alarms as f64 / self.alarm_hours()
    }

    /// Ends of the Poisson interval of that; as narrow as [`Self::per_hour_95`].
    pub fn per_alarm_hour_95(&self) -> [f64; 2] {
        self.per_hour_95
            .map(|end| end * self.hours / self.alarm_hours())
    }

    /// Counts the recordings of a course, or of all.
    pub fn of(course: Option<Course>, recordings: &[&Recording], sample_rate_hz: f64) -> Self {
        let asked = |r: &&&Recording| course.is_none_or(|course| r.course == course);
        let chosen: Vec<&Recording> = recordings.iter().filter(asked).copied().collect();
        let sum = |of: fn(&Recording) -> u64| chosen.iter().map(|r| of(r)).sum::<u64>();
        let seeds = |of: fn(&&&Recording) -> bool| {
            let mut seeds: Vec<u64> = chosen.iter().filter(of).map(|r| r.seed).collect();
            seeds.dedup();
            seeds.len()
        };
        let samples = sum(|r| r.samples);
        let hours = samples as f64 / sample_rate_hz / 3600.0;
        let alarms = sum(|r| r.alarms);
        let mut said = BTreeMap::new();
        for text in chosen.iter().flat_map(|r| &r.messages) {
            if let Some(kind) = verdict(text) {
                *said.entry(kind.to_owned()).or_default() += 1;
            }
        }
        Self {
            course,
            recordings: chosen.len(),
            recordings_with_alarm: chosen.iter().filter(|r| r.alarms > 0).count(),
            sessions: seeds(|_| true),
            sessions_with_alarm: seeds(|r| r.alarms > 0),
            hours,
            alarms,
            per_hour: alarms as f64 / hours,
            per_hour_95: crate::statistics::poisson_interval(alarms, 0.95).map(|n| n / hours),
            flagged_share: sum(|r| r.flagged) as f64 / samples as f64,
            said,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two hours, of which one and a half with a limb excluded: alarms of half an hour.
    #[test]
    fn dead_time_is_no_time() {
        let recording = Recording {
            seed: 1,
            corner: super::super::laboratories::Corner {
                equal_limbs: false,
                true_parameters: false,
            },
            course: Course::Calm,
            samples: 7200,
            alarms: 3,
            flagged: 5400,
            messages: Vec::new(),
        };
        let watched = Watched::of(None, &[&recording], 1.0);
        assert_eq!(watched.hours, 2.0);
        assert_eq!(watched.alarm_hours(), 0.5);
        assert_eq!(watched.per_alarm_hour(), 6.0);
        let [low, high] = watched.per_alarm_hour_95();
        assert!(low < 6.0 && 6.0 < high);
        assert_eq!([low, high], watched.per_hour_95.map(|end| 4.0 * end));
    }

    #[test]
    fn verdicts_are_read_off_messages() {
        let read = |text: &str| verdict(text).map(str::to_owned);
        let kind = |text: &str| Some(text.to_owned());
        assert_eq!(
            read("sample 9: limb 5: dead since sample 3 to 8"),
            kind("dead")
        );
        assert_eq!(
            read(
                "sample 9: limb 2 or 4: its zero drifts, which shows since sample 1; forces cannot tell which"
            ),
            kind("its zero drifts")
        );
        assert_eq!(
            read("sample 9: it cannot be told which limbs have failed since sample 1"),
            kind("it cannot be told which limbs have failed")
        );
        assert_eq!(
            read("sample 9: decoded without limb 5 from sample 0 on"),
            None
        );
    }
}
