//! Names, units, rates and properties.

use std::collections::{BTreeMap, HashMap};

use super::index::Index;
use super::kind::Kind;
use super::object::{Object, join_path};
use super::scaling::Scale;
use super::value::{Timestamp, Value};
use crate::began::BEGAN;
use crate::channel::{Channel, time_channel};
use crate::layout::{LEFT_OUT, Layout};

/// How to read a channel of the layout.
#[derive(Debug)]
pub struct Reading {
    /// Index of the object.
    pub object: u32,
    pub kind: Kind,
    /// What is to be applied to the raw values.
    pub scale: Option<Scale>,
    /// Why the channel cannot be read.
    pub obstacle: Option<String>,
    /// Time stamps count from here: the channel's first.
    pub origin: Timestamp,
}

/// The layout, and how to read each of its channels.
pub fn describe(index: &Index) -> (Layout, Vec<Reading>) {
    let mut layout = Layout {
        format: "TDMS".into(),
        ..Layout::default()
    };
    let mut readings = Vec::new();
    let by_names: HashMap<&[String], &Object> = index
        .objects
        .iter()
        .map(|object| (object.names.as_slice(), object))
        .collect();
    let mut used: HashMap<String, usize> = HashMap::new();
    for object in &index.objects {
        *used.entry(object.names.join("/")).or_default() += 1;
    }
    let earliest = index.objects.iter().filter_map(start_time).min();
    let mut left_out = Vec::new();
    for (at, object) in (0..).zip(&index.objects) {
        let mut name = object.names.join("/");
        if used.get(&name).is_some_and(|count| *count > 1) {
            // Slashes inside the names make it ambiguous.
            name = join_path(object.names.iter().map(String::as_str));
        }
        properties(object, &name, &mut layout.properties);
        let [group, _] = object.names.as_slice() else {
            continue;
        };
        let kind = object.raw.as_ref().map_or(Kind::Void, |raw| raw.kind);
        if kind == Kind::Text {
            left_out.push(format!("{name} (text)"));
            continue;
        }
        let levels = [
            Some(object),
            by_names.get([group.clone()].as_slice()).copied(),
            by_names.get([].as_slice()).copied(),
        ];
        let (scale, obstacle) = match scale(object, kind, levels) {
            Ok(scale) => (scale, None),
            Err(obstacle) => (None, Some(obstacle)),
        };
        layout.channels.push(channel(object, name, kind, earliest));
        readings.push(Reading {
            object: at,
            kind,
            scale,
            obstacle,
            origin: Timestamp(0),
        });
    }
    let not_readable: Vec<String> = layout
        .channels
        .iter()
        .zip(&readings)
        .filter_map(|(channel, reading)| {
            Some(format!("{} ({})", channel.name, reading.obstacle.as_ref()?))
        })
        .collect();
    let mut note = |name: &str, text: String| layout.properties.insert(name.into(), text);
    if !left_out.is_empty() {
        note(LEFT_OUT, left_out.join(", "));
    }
    if !not_readable.is_empty() {
        note("channels_not_readable", not_readable.join(", "));
    }
    if let Some(time) = earliest {
        note(BEGAN, time.to_string());
    }
    if index.incomplete {
        note("incomplete_last_segment", "true".into());
        layout.cut = Some(
            "its last segment is cut short; it is read as far as all its channels reach".into(),
        );
    }
    layout.time = time_channel(&layout.channels)
        .or_else(|| readings.iter().position(|r| r.kind == Kind::Time));
    (layout, readings)
}

/// The scale of a channel, or why it cannot be read.
fn scale(
    object: &Object,
    kind: Kind,
    levels: [Option<&Object>; 3],
) -> Result<Option<Scale>, String> {
    if matches!(kind, Kind::Complex32 | Kind::Complex64) {
        return Err("complex samples".into());
    }
    let daqmx = object.raw.as_ref().and_then(|raw| raw.daqmx.as_ref());
    if daqmx.is_some_and(|daqmx| daqmx.scalers.len() > 1) {
        return Err("DAQmx raw data with several scalers".into());
    }
    if kind == Kind::Time {
        return Ok(None);
    }
    let scaler = daqmx
        .filter(|daqmx| daqmx.scaled_by_id)
        .and_then(|daqmx| daqmx.scalers.first())
        .map(|scaler| scaler.id);
    Scale::find(
        levels
            .into_iter()
            .flatten()
            .map(|object| &object.properties),
        scaler,
    )
}

fn channel(object: &Object, name: String, kind: Kind, earliest: Option<Timestamp>) -> Channel {
    let number = |name: &str| {
        object
            .properties
            .get(name)
            .and_then(Value::number)
            .filter(|value| value.is_finite())
    };
    let text = |name: &str| {
        object
            .properties
            .get(name)
            .and_then(Value::text)
            .filter(|text| !text.is_empty())
    };
    let unit = if kind == Kind::Time {
        Some("s")
    } else {
        text("unit_string").or_else(|| text("NI_UnitDescription"))
    };
    // Waveforms may each have their own start; the file's is the earliest.
    let late = match (start_time(object), earliest) {
        (Some(start), Some(earliest)) => start.seconds_since(earliest),
        _ => 0.0,
    };
    Channel {
        name,
        unit: unit.map(str::to_owned),
        samples: Some(object.samples),
        sample_rate_hz: number("wf_increment").filter(|step| *step > 0.0).map(rate),
        start_offset_s: number("wf_start_offset").unwrap_or(0.0) + late,
    }
}

/// Samples per second from the step between them, s: a whole number where that is what the step stands for.
fn rate(step: f64) -> f64 {
    let rate = 1.0 / step;
    let whole = rate.round();
    if 1.0 / whole == step { whole } else { rate }
}

fn start_time(object: &Object) -> Option<Timestamp> {
    match object.properties.get(BEGAN) {
        // LabVIEW writes zero for "none".
        Some(Value::Time(time)) if object.names.len() == 2 && time.0 != 0 => Some(*time),
        _ => None,
    }
}

/// Those of the file under their own name, others as `object/name`; scales are applied and waveform steps told otherwise.
fn properties(object: &Object, name: &str, into: &mut BTreeMap<String, String>) {
    for (property, value) in &object.properties {
        let told = property.starts_with("NI_Scale[")
            || object.names.len() == 2
                && matches!(
                    property.as_str(),
                    "wf_increment" | "wf_start_offset" | "unit_string"
                );
        if !told {
            let key = if object.names.is_empty() {
                property.clone()
            } else {
                format!("{name}/{property}")
            };
            into.insert(key, value.to_string());
        }
    }
}
