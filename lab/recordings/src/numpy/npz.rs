//! A zip file of arrays: channels, properties, and what is left aside.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use super::dtype::Element;
use super::header::{self, Header, Refusal};
use super::source::{arrays, failed, share};
use super::stream::Stream;
use super::table::arrange;
use super::zip;
use crate::channel::{MOST_CHANNELS, is_sample_rate, sample_rate};
use crate::error::{Error, Place, Result};
use crate::source::Source;

/// Longest string that is a property, bytes in the file.
const TEXT: u64 = 1 << 16;

/// Opens an NPZ file.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`], [`Error::Io`].
pub(crate) fn open(path: &Path) -> Result<Box<dyn Source>> {
    let (file, length) = share(path)?;
    let mut tables = Vec::new();
    let (mut properties, mut rate) = (BTreeMap::new(), None);
    let (mut channels, mut deflated) = (0, false);
    for member in zip::members(path, &file, length)? {
        let Some(name) = member.name.strip_suffix(".npy") else {
            properties.insert(member.name, "not read: not an array".to_owned());
            continue;
        };
        let io = |source| failed(path, Some(name), Place::Whole, source);
        let mut stream = member.body.open();
        let header = match header::read(&mut stream, member.body.bytes) {
            Ok(header) => header,
            Err(Refusal::Io(source)) => return Err(io(source)),
            Err(Refusal::Malformed(cause)) => {
                let cause = format!("member {name}: {cause}");
                return Err(Error::malformed(path, Place::Whole, cause));
            }
            Err(Refusal::Unsupported(feature)) => {
                properties.insert(name.to_owned(), format!("not read: {feature}"));
                continue;
            }
        };
        let alone = header.shape.iter().all(|&length| length == 1);
        if header.shape.is_empty() || (alone && is_sample_rate(name)) {
            let value =
                single(&header, &mut stream, member.body.bytes - header.begin).map_err(io)?;
            if is_sample_rate(name) {
                let stated = sample_rate(name, value.as_deref().unwrap_or("unreadable"));
                rate = Some(stated.map_err(|cause| Error::malformed(path, Place::Whole, cause))?);
            }
            let value = value.unwrap_or_else(|| "not read: an unusual value".to_owned());
            properties.insert(name.to_owned(), value);
            continue;
        }
        match arrange(&header, member.body, Some(name.to_owned())) {
            Ok(table) => {
                channels += table.fields.len();
                deflated |= table.body.deflated;
                tables.push(table);
            }
            Err((feature, _)) => {
                properties.insert(name.to_owned(), format!("not read: {feature}"));
            }
        }
        if channels > MOST_CHANNELS {
            return Err(Error::unsupported(
                path,
                format!("a file of more than {MOST_CHANNELS} channels"),
                "split it; rows are samples, so an array may be transposed",
            ));
        }
    }
    let format = if deflated { "NPZ (deflated)" } else { "NPZ" };
    Ok(arrays(path, format, tables, rate, properties))
}

/// A single number or string as text; none if it cannot be told.
fn single(header: &Header, stream: &mut Stream, bytes: u64) -> std::io::Result<Option<String>> {
    if bytes > TEXT {
        return Ok(None);
    }
    let mut value = vec![0; bytes as usize];
    stream.read_exact(&mut value)?;
    stream.finish()?;
    Ok(match &header.element {
        Element::Number(number) => {
            let mut values = Vec::new();
            let size = number.kind.size();
            number.append(&value, size, 1, &mut values);
            let exact = number.first_rounded(&value, size, 1).is_none();
            values.first().filter(|_| exact).map(f64::to_string)
        }
        Element::Text {
            wide: true, big, ..
        } => {
            let (characters, _) = value.as_chunks::<4>();
            let text: Option<String> = characters
                .iter()
                .map(|&bytes| match big {
                    true => char::from_u32(u32::from_be_bytes(bytes)),
                    false => char::from_u32(u32::from_le_bytes(bytes)),
                })
                .collect();
            text.map(|text| text.trim_end_matches('\0').to_owned())
        }
        Element::Text { .. } => String::from_utf8(value)
            .ok()
            .map(|text| text.trim_end_matches('\0').to_owned()),
        _ => None,
    })
}
