//! What MATLAB makes of HDF5: variables are datasets, structs are groups, the attribute `MATLAB_class` says which.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use super::dataset::{Dataset, describe};
use super::hdf5::Hdf5;
use super::messages::{Message, attribute};
use super::variables::{Content, Elements, Variable, arrange};
use crate::error::Result;
use crate::source::Source;

/// Structs within structs.
const DEEPEST: usize = 16;
/// Objects that are looked at: a group may hold itself.
const MOST_OBJECTS: usize = 100_000;
/// Longest text that becomes a property.
const LONGEST_TEXT: u64 = 1 << 16;

/// Opens a file whose HDF5 part begins at `at`.
pub(super) fn open(path: &Path, file: File, length: u64, at: u64) -> Result<Box<dyn Source>> {
    let file = Hdf5::open(path, file, length, at)?;
    let mut walk = Walk {
        file: Arc::clone(&file),
        found: Vec::new(),
        objects: 0,
    };
    let root = file.root()?;
    walk.group("", &root, 0)?;
    arrange(path, "MATLAB 7.3", walk.found)
}

struct Walk {
    file: Arc<Hdf5>,
    found: Vec<Variable>,
    objects: usize,
}

/// The attributes that matter.
#[derive(Default)]
struct Attributes {
    class: Option<String>,
    empty: bool,
    sparse: bool,
}

fn attributes(messages: &[Message]) -> Attributes {
    let mut all = Attributes::default();
    for (name, value) in messages
        .iter()
        .filter(|message| message.kind == 0x0c)
        .filter_map(attribute)
    {
        match name.as_str() {
            "MATLAB_class" => all.class = value,
            "MATLAB_empty" => all.empty = true,
            "MATLAB_sparse" => all.sparse = true,
            _ => {}
        }
    }
    all
}

impl Walk {
    fn group(&mut self, prefix: &str, messages: &[Message], depth: usize) -> Result<()> {
        let file = Arc::clone(&self.file);
        for (name, address) in file.members(messages)?.into_iter().flatten() {
            // MATLAB's own: what cells and objects refer to.
            if depth == 0 && name.starts_with('#') {
                continue;
            }
            self.objects += 1;
            if self.objects > MOST_OBJECTS {
                return Err(file.malformed(
                    address,
                    "more than 100000 variables, or one that holds itself",
                ));
            }
            self.variable(format!("{prefix}{name}"), &file.object(address)?, depth)?;
        }
        Ok(())
    }

    fn variable(&mut self, name: String, messages: &[Message], depth: usize) -> Result<()> {
        let Attributes {
            class,
            empty,
            sparse,
        } = attributes(messages);
        let class = class.unwrap_or_default();
        let other = |kind: &str| Content::Other(kind.to_owned());
        let is_group = !messages.iter().any(|message| message.kind == 0x08);
        let content = if sparse {
            other("sparse")
        } else if empty {
            match class.as_str() {
                "char" => Content::Text(String::new()),
                _ => other("empty"),
            }
        } else if is_group {
            if depth < DEEPEST && matches!(class.as_str(), "struct" | "") {
                return self.group(&format!("{name}."), messages, depth + 1);
            }
            other(if class.is_empty() { "group" } else { &class })
        } else {
            match class.as_str() {
                "" | "double" | "single" | "logical" | "int8" | "uint8" | "int16" | "uint16"
                | "int32" | "uint32" | "int64" | "uint64" => {
                    match describe(&self.file, messages)? {
                        Ok(dataset) => numbers(dataset),
                        Err(kind) => other(&kind),
                    }
                }
                "char" => match describe(&self.file, messages)? {
                    Ok(dataset) => text(dataset)?,
                    Err(kind) => other(&kind),
                },
                // An array of structs, too, has a dataset of references for each field.
                kind => other(kind),
            }
        };
        self.found.push(Variable { name, content });
        Ok(())
    }
}

fn numbers(dataset: Dataset) -> Content {
    Content::Numbers {
        rows: dataset.rows,
        columns: dataset.columns,
        elements: Box::new(dataset),
    }
}

/// Text of one line: UTF-16 numbers.
fn text(mut dataset: Dataset) -> Result<Content> {
    if dataset.rows != 1 || dataset.columns > LONGEST_TEXT {
        return Ok(Content::Other("long text".to_owned()));
    }
    let mut units = Vec::new();
    dataset.append(0, 1, dataset.columns as usize, &mut units)?;
    let units = units.iter().map(|&unit| unit as u16);
    Ok(Content::Text(
        char::decode_utf16(units)
            .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect(),
    ))
}
