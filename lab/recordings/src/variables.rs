//! From the variables of a MATLAB or HDF5 file to channels, and their reading.

use std::collections::BTreeMap;
use std::path::Path;

use crate::channel::{Channel, MOST_CHANNELS, is_rate, is_sample_rate, time_channel};
use crate::error::{Error, Result};
use crate::layout::{LEFT_OUT, Layout};
use crate::source::{Decoder, Source, reading};

/// The numbers of a variable, column by column as MATLAB has them.
pub(crate) trait Elements: Send {
    /// Appends `count` of them, `stride` apart, from `first` on. All are within the variable.
    fn append(&mut self, first: u64, stride: u64, count: usize, out: &mut Vec<f64>) -> Result<()>;
}

/// What a variable holds.
pub(crate) enum Content {
    /// A real matrix.
    Numbers {
        rows: u64,
        columns: u64,
        elements: Box<dyn Elements>,
    },
    /// A single number.
    Value(f64),
    /// A text.
    Text(String),
    /// Something else, as MATLAB calls it.
    Other(String),
}

/// A variable, or the field of a struct: `data.u1`.
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) content: Content,
    /// Unit and samples per second of its channels, where the file has them beside the numbers.
    pub(crate) unit: Option<String>,
    pub(crate) rate: Option<f64>,
}

impl Variable {
    pub(crate) fn new(name: String, content: Content) -> Self {
        Self {
            name,
            content,
            unit: None,
            rate: None,
        }
    }
}

/// Where a channel's samples are.
struct Place {
    variable: usize,
    first: u64,
    stride: u64,
}

/// A file of variables.
struct Variables {
    variables: Vec<Box<dyn Elements>>,
    places: Vec<Place>,
}

/// The name of the struct or group, and that of the field.
fn fold(name: &str, separator: char) -> (&str, &str) {
    name.rsplit_once(separator).unwrap_or(("", name))
}

/// The file as a source. `separator` stands between the name of a struct or group and that of its field.
pub(crate) fn arrange(
    path: &Path,
    format: &str,
    separator: char,
    found: Vec<Variable>,
) -> Result<Box<dyn Source>> {
    let (mut channels, mut places, mut variables) = (Vec::new(), Vec::new(), Vec::new());
    let (mut properties, mut left_out) = (BTreeMap::new(), Vec::new());
    let mut rates = BTreeMap::new();
    for variable in found {
        let name = variable.name;
        let mut single = |name: String, value: f64| {
            let (prefix, last) = fold(&name, separator);
            if is_sample_rate(last) && is_rate(value) {
                rates.insert(prefix.to_owned(), value);
            }
            properties.insert(name, value.to_string());
        };
        let (rows, columns, mut elements) = match variable.content {
            Content::Numbers {
                rows,
                columns,
                elements,
            } => (rows, columns, elements),
            Content::Value(value) => {
                single(name, value);
                continue;
            }
            Content::Text(text) => {
                properties.insert(name, text);
                continue;
            }
            Content::Other(kind) => {
                left_out.push(format!("{name} ({kind})"));
                continue;
            }
        };
        if rows == 0 || columns == 0 {
            left_out.push(format!("{name} (empty)"));
        } else if rows == 1 && columns == 1 {
            let mut value = Vec::new();
            elements.append(0, 1, 1, &mut value)?;
            single(name, value.first().copied().unwrap_or(f64::NAN));
        } else if rows == columns {
            left_out.push(format!("{name} ({rows} x {columns}, square)"));
        } else if rows.min(columns) > MOST_CHANNELS as u64 {
            left_out.push(format!("{name} ({rows} x {columns})"));
        } else {
            let (samples, count) = (rows.max(columns), rows.min(columns));
            for index in 0..count {
                let mut own = name.clone();
                if count > 1 {
                    own = format!("{name}_{}", index + 1);
                }
                channels.push(Channel {
                    samples: Some(samples),
                    sample_rate_hz: variable.rate.filter(|rate| is_rate(*rate)),
                    ..Channel::new(own, variable.unit.as_deref())
                });
                let (first, stride) = if rows > columns {
                    (index.checked_mul(rows), 1)
                } else {
                    (Some(index), rows)
                };
                places.push(Place {
                    variable: variables.len(),
                    first: first.unwrap_or(u64::MAX),
                    stride,
                });
            }
            variables.push(elements);
        }
    }
    if channels.is_empty() {
        let what = if left_out.is_empty() {
            "nothing but single values".to_owned()
        } else {
            left_out.join(", ")
        };
        return Err(Error::unsupported(
            path,
            format!("a file of {format} without a numeric vector (it has {what})"),
            "save vectors; in MATLAB the fields of a struct: save('x.mat', '-struct', 'data'); \
             a table T: data = table2struct(T, 'ToScalar', true)",
        ));
    }
    for channel in &mut channels {
        let (prefix, _) = fold(&channel.name, separator);
        let common = rates.get(prefix).or_else(|| rates.get(""));
        channel.sample_rate_hz = channel.sample_rate_hz.or(common.copied());
    }
    if !left_out.is_empty() {
        properties.insert(LEFT_OUT.to_owned(), left_out.join(", "));
    }
    let mut layout = Layout::new(format, channels, properties);
    let bare = layout.channels.iter();
    let bare: Vec<_> = bare
        .map(|channel| Channel {
            unit: channel.unit.clone(),
            ..Channel::new(fold(&channel.name, separator).1, None)
        })
        .collect();
    layout.time = time_channel(&bare);
    Ok(reading(path, layout, Variables { variables, places }))
}

/// Channels, rows read and rows left.
struct Position(Vec<usize>, u64, u64);

impl Decoder for Variables {
    type Position = Position;

    fn start(&mut self, _layout: &Layout, selected: &[usize], samples: u64) -> Result<Position> {
        Ok(Position(selected.to_vec(), 0, samples))
    }

    fn next(
        &mut self,
        Position(selected, read, left): &mut Position,
        _layout: &Layout,
        columns: &mut [Vec<f64>],
        limit: usize,
    ) -> Result<usize> {
        let rows = usize::try_from(*left).map_or(limit, |left| left.min(limit));
        for (&channel, column) in selected.iter().zip(columns) {
            let place = &self.places[channel];
            let first = read
                .saturating_mul(place.stride)
                .saturating_add(place.first);
            self.variables[place.variable].append(first, place.stride, rows, column)?;
        }
        *read += rows as u64;
        *left -= rows as u64;
        Ok(rows)
    }
}
