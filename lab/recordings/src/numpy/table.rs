//! An array as channels.

use super::dtype::Element;
use super::header::Header;
use super::stream::Body;
use crate::channel::MOST_CHANNELS;
use crate::numbers::Number;

/// A channel within an array.
#[derive(Debug, Clone)]
pub struct Field {
    /// Name in the file.
    pub name: String,
    /// Type.
    pub number: Number,
    /// Bytes from the beginning of a row; in Fortran order, from the first element of the array.
    pub offset: u64,
}

/// Where the numbers of an array are.
pub struct Table {
    /// Where the array is.
    pub body: Body,
    /// Where its elements begin in it.
    pub begin: u64,
    /// The channels.
    pub fields: Vec<Field>,
    /// Rows.
    pub rows: u64,
    /// Bytes of a row; in Fortran order, of an element.
    pub record: usize,
    /// Column after column.
    pub fortran: bool,
    /// Member of a zip file, for messages.
    pub member: Option<String>,
}

/// Rows up to which an array of far more columns is one of channels by samples, and the times that these must be more.
const MOST_TURNED: u64 = 64;
const FAR_MORE: u64 = 8;
/// Longest row, bytes.
const RECORD: u64 = 1 << 20;

/// Why an array has no channels: what it is, and what the user can do.
pub type Unfit = (String, String);

/// Finds the channels of an array. The shape has been checked against the bytes there are.
pub fn arrange(header: &Header, body: Body, member: Option<String>) -> Result<Table, Unfit> {
    let advice = "save columns of numbers with one row per sample";
    let several = |columns: u64| {
        (
            format!("an array of {columns} columns"),
            format!(
                "at most {MOST_CHANNELS} are read; rows are samples: transpose the array (a.T) before it is saved"
            ),
        )
    };
    let numbered = |column: u64| match &member {
        Some(name) => format!("{name}_{}", column + 1),
        None => format!("column_{}", column + 1),
    };
    let (mut fields, mut fortran) = (Vec::new(), false);
    let bytes = header.element.bytes().unwrap_or(u64::MAX);
    let (rows, record) = match (&header.element, header.shape.as_slice()) {
        (Element::Number(number), &[rows]) => {
            let name = member.clone().unwrap_or_else(|| numbered(0));
            let number = *number;
            fields.push(Field {
                name,
                number,
                offset: 0,
            });
            (rows, bytes)
        }
        (Element::Number(number), &[first, second]) => {
            // Where each row is a channel: the same as a transposed array in the other order.
            let turned = (2..=MOST_TURNED).contains(&first) && second > first * FAR_MORE;
            let (rows, columns) = if turned {
                (second, first)
            } else {
                (first, second)
            };
            if columns > MOST_CHANNELS as u64 {
                return Err(several(columns));
            }
            fortran = header.fortran != turned;
            let stride = if fortran {
                rows.saturating_mul(bytes)
            } else {
                bytes
            };
            fields.extend((0..columns).map(|column| Field {
                name: numbered(column),
                number: *number,
                offset: column.saturating_mul(stride),
            }));
            (rows, if fortran { bytes } else { bytes * columns })
        }
        (Element::Record(parts), &[rows]) => {
            let mut offset = 0_u64;
            for (name, element, count) in parts {
                if let Element::Number(number) = element {
                    if *count > MOST_CHANNELS as u64 {
                        return Err(several(*count));
                    }
                    for at in 0..*count {
                        let name = match count {
                            1 => name.clone(),
                            _ => format!("{name}_{}", at + 1),
                        };
                        fields.push(Field {
                            name: member
                                .as_ref()
                                .map_or(name.clone(), |m| format!("{m}/{name}")),
                            number: *number,
                            offset: offset.saturating_add(at * number.kind.size() as u64),
                        });
                    }
                    if fields.len() > MOST_CHANNELS {
                        return Err(several(fields.len() as u64));
                    }
                }
                let bytes = element.bytes().unwrap_or(u64::MAX);
                offset = offset.saturating_add(bytes.saturating_mul(*count));
            }
            (rows, bytes)
        }
        (Element::Text { .. } | Element::Padding(_), _) => {
            return Err(("an array of text".to_owned(), advice.to_owned()));
        }
        (_, shape) => {
            let feature = match shape.len() {
                0 => "a single value".to_owned(),
                count => format!("an array of {count} dimensions"),
            };
            return Err((feature, advice.to_owned()));
        }
    };
    if fields.is_empty() {
        return Err(("an array without numbers".to_owned(), advice.to_owned()));
    }
    if record > RECORD {
        let feature = format!("a record of {record} bytes");
        return Err((
            feature,
            format!("at most {RECORD} are read; save fewer fields"),
        ));
    }
    Ok(Table {
        body,
        begin: header.begin,
        fields,
        rows,
        record: record as usize,
        fortran,
        member,
    })
}
