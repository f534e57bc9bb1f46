//! The nine limbs and the standards: what was found of them, and what was stated otherwise.

use super::{Facts, list};
use crate::inspect::facts::{Inspection, Sensor};
use crate::inspect::sensor::{Expected, last_part};
use crate::session::{Channels, LIMBS};
use crate::unit;

impl Facts {
    /// Names and unit that were stated, where nine voltages were found by others.
    fn of_names(&mut self, stated: &Channels, sensor: &Sensor, inspection: &Inspection) {
        let is = |name: &str, found: &String| {
            found == name || last_part(found).eq_ignore_ascii_case(name)
        };
        let there = |name: &String| sensor.limbs.iter().any(|found| is(name, found));
        if stated.limbs != Channels::default().limbs && !stated.limbs.iter().all(there) {
            let text = format!(
                "channels {} are not all in this file; its nine voltages, {}, were looked at instead",
                list(&stated.limbs),
                list(&sensor.limbs)
            );
            self.notice("names", &sensor.limbs, text);
        }
        let channels = inspection.groups.iter().flat_map(|group| &group.channels);
        let found = channels.filter(|c| sensor.limbs.contains(&c.name));
        let Some(stated) = &stated.limbs_unit else {
            return;
        };
        for unit in found.filter_map(|channel| channel.unit.as_ref()) {
            if unit::named(&unit.name) != unit::named(stated) {
                let text = format!("the limbs are in {}, and {stated} is stated", unit.name);
                self.notice("unit", &sensor.limbs, text);
            }
        }
    }

    /// Of u1 to u9 some and not all.
    fn of_missing_names(&mut self, inspection: &Inspection) {
        let channels = || inspection.groups.iter().flat_map(|group| &group.channels);
        let is_there =
            |name: &String| channels().any(|c| last_part(&c.name).eq_ignore_ascii_case(name));
        let names = Channels::default().limbs;
        let (there, missing): (Vec<String>, Vec<String>) = names.into_iter().partition(is_there);
        if there.len() > missing.len() {
            let text = format!(
                "of the nine limbs, {} are in this file and {} not",
                list(&there),
                list(&missing)
            );
            self.notice("names", &there, text);
        }
    }

    /// None of u1 to u9, where nine channels and more may be limbs.
    fn of_unknown_names(&mut self, inspection: &Inspection) {
        let limbs = Channels::default().limbs;
        let channels = inspection.groups.iter().flat_map(|group| &group.channels);
        let may_be = channels.filter(|c| c.unit.is_none() || c.measures("voltage"));
        let names: Vec<String> = may_be.map(|c| c.name.clone()).collect();
        let is_limb = |name: &String| {
            let is = |limb: &String| last_part(name).eq_ignore_ascii_case(limb);
            limbs.iter().any(is)
        };
        if names.len() >= LIMBS && !names.iter().any(is_limb) {
            let text = format!(
                "which of {} channels are the nine limbs is not known, as none is called {} to {}: --channels names them, or a session does",
                names.len(),
                limbs[0],
                limbs[LIMBS - 1]
            );
            self.notice("names", &names, text);
        }
    }

    pub(super) fn of_sensor(&mut self, inspection: &Inspection, expected: Option<&Expected>) {
        if let Some(session) = expected.and_then(|e| e.foreign_to.as_deref()) {
            self.remark(format!("not among the recordings of {}", session.display()));
        }
        let Some(sensor) = &inspection.sensor else {
            match expected {
                Some(expected) => {
                    let limbs = &expected.channels.limbs;
                    let text = format!("the nine limbs, {}, are not all in this file", list(limbs));
                    // One of the session's recordings must have them; of another file nothing is known.
                    match expected.role {
                        Some(_) => self.notice("names", limbs, text),
                        None => self.remark(text),
                    }
                }
                None => {
                    self.of_missing_names(inspection);
                    self.of_unknown_names(inspection);
                }
            }
            return;
        };
        if let Some(expected) = expected {
            self.of_names(&expected.channels, sensor, inspection);
        }
        let standard = |name: &Option<String>, what: &str| match name {
            Some(name) => format!("{what} ({name})"),
            None => format!("no {what}"),
        };
        self.remark(format!(
            "nine limbs ({} to {}), {}, {}",
            sensor.limbs.first().map_or("", String::as_str),
            sensor.limbs.last().map_or("", String::as_str),
            standard(&sensor.accelerometer, "accelerometer"),
            standard(&sensor.gyroscope, "gyroscope")
        ));
        if !sensor.dead.is_empty() {
            self.remark(format!("dead limbs: {}", list(&sensor.dead)));
        }
        if !sensor.silent.is_empty() {
            let (shows, it) = match sensor.silent.as_slice() {
                [_] => ("shows", "it"),
                _ => ("show", "them"),
            };
            self.remark(format!(
                "{} {shows} nothing but noise while most limbs move: dead, or this motion does not reach {it}",
                list(&sensor.silent),
            ));
        }
        self.remark(
            "exchanged, inverted or wrongly scaled limbs do not show in one recording: `sixaxis calibrate SESSION` looks for them in all trials together",
        );
    }
}
