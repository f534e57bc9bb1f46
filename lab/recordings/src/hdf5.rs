//! HDF5: files of h5py, PyTables, LabVIEW, MATLAB's `save -v7.3` and others. They are read, not written.
//!
//! A dataset of one dimension is a channel of its name, in a group `group/name`. One of two dimensions gives a channel for
//! each of its columns, or of its rows where those are longer (`name_1`, `name_2` ...): writers differ in which dimension
//! comes first. A square one could be meant either way and is left out. In a MATLAB file the fields of a struct are
//! `data.u1`, and MATLAB's own classes decide what is a channel.
//!
//! Single numbers and texts become properties, attributes of groups too; a single number called `fs`, `fs_hz` or
//! `sample_rate_hz` is the rate of all channels, one in a group that of the group's channels, an attribute of a dataset
//! that of its channels. The attribute `unit` or `units` of a dataset is the unit. Datasets with a scale in the attributes
//! `scale_factor` or `add_offset`, numbers that are not plain integers or IEEE floats, compounds, references and more than
//! two dimensions are no channels; the property [`LEFT_OUT`] names them. Integers beyond 2^53 are rounded to the nearest
//! f64. Samples that were never written are the dataset's fill value, as HDF5 has it.
//!
//! Memory: unpacked chunks of up to 256 MiB are kept for each file; one larger is refused.
//!
//! | file | holds |
//! |---|---|
//! | `number` | which stored numbers are read, and their decoding |
//! | `dataset` | the numbers of a dataset, piece by piece |
//! | `refusal` | the reader's errors as this crate's |

use std::path::Path;

use hdf5_reader::error::Error as Hdf5Error;
use hdf5_reader::group::Group;
use hdf5_reader::{Attribute, Hdf5File, OpenOptions};

use crate::channel::is_sample_rate;
use crate::error::{Error, Place, Result};
pub use crate::layout::LEFT_OUT;
use crate::source::Source;
use crate::variables::{Content, Elements, Variable, arrange};

mod dataset;
mod number;
mod refusal;

use dataset::{Dataset, describe};
use number::Number;
use refusal::{is_unsupported, refused};

/// Largest chunk that is unpacked, and what is kept of unpacked chunks, bytes.
const CHUNKS: usize = 1 << 28;
/// Largest piece that is read at once; pieces of 65536 elements and single texts are far smaller.
const LARGEST_READ: usize = 1 << 24;
/// Largest description of an object, bytes. Most are a few hundred.
const LARGEST_HEADER: usize = 1 << 24;
/// Groups within groups.
const DEEPEST: usize = 16;
/// Objects that are looked at: a group may hold itself.
const MOST_OBJECTS: usize = 100_000;
/// Longest text that becomes a property.
const LONGEST_TEXT: u64 = 1 << 16;

/// Opens an HDF5 file.
///
/// # Errors
/// [`Error::Malformed`], [`Error::Unsupported`] for a file without a numeric vector, [`Error::Io`].
pub(crate) fn open(path: &Path) -> Result<Box<dyn Source>> {
    match find(path)? {
        Some(file) => read(path, false, &file),
        None => Err(Error::malformed(path, Place::Whole, "no HDF5 file")),
    }
}

/// Opens the HDF5 part of a MATLAB file, if it has one.
pub(crate) fn open_matlab(path: &Path) -> Result<Option<Box<dyn Source>>> {
    find(path)?.map(|file| read(path, true, &file)).transpose()
}

fn find(path: &Path) -> Result<Option<Hdf5File>> {
    let options = OpenOptions::default()
        .with_chunk_cache_bytes(CHUNKS)
        .with_max_chunk_bytes(CHUNKS)
        .with_max_read_bytes(LARGEST_READ)
        .with_max_object_header_bytes(LARGEST_HEADER);
    let file = match Hdf5File::open_with_options(path, options) {
        Ok(file) => file,
        Err(Hdf5Error::InvalidMagic) => return Ok(None),
        Err(error) => return Err(refused(path, error)),
    };
    let superblock = file.superblock();
    let length = file.storage().len().saturating_add(superblock.base_address);
    let end = superblock.eof_address;
    if end > length {
        let cause = format!("the file ends here, {end} bytes were to come");
        return Err(Error::malformed(path, Place::Byte(length), cause));
    }
    Ok(Some(file))
}

/// What stands between the names of a group and of its members.
fn separator(matlab: bool) -> char {
    if matlab { '.' } else { '/' }
}

fn read(path: &Path, matlab: bool, file: &Hdf5File) -> Result<Box<dyn Source>> {
    let mut walk = Walk {
        path,
        length: file.storage().len(),
        matlab,
        found: Vec::new(),
        objects: 0,
    };
    let root = file.root_group().map_err(|error| refused(path, error))?;
    walk.group("", &root, 0)?;
    let format = if matlab { "MATLAB 7.3" } else { "HDF5" };
    arrange(path, format, separator(matlab), walk.found)
}

struct Walk<'a> {
    path: &'a Path,
    /// Bytes of the file.
    length: u64,
    matlab: bool,
    found: Vec<Variable>,
    objects: usize,
}

/// The attributes that matter.
#[derive(Default)]
struct Attributes {
    /// MATLAB's class.
    class: Option<String>,
    empty: bool,
    sparse: bool,
    scaled: bool,
    unit: Option<String>,
    rate: Option<f64>,
}

impl Attributes {
    fn of(all: &[Attribute]) -> Self {
        let mut known = Self::default();
        for attribute in all {
            match attribute.name.as_str() {
                "MATLAB_class" => known.class = text_of(attribute),
                "MATLAB_empty" => known.empty = true,
                "MATLAB_sparse" => known.sparse = true,
                "scale_factor" | "add_offset" => known.scaled = true,
                "unit" | "units" => known.unit = text_of(attribute),
                name if is_sample_rate(name) => known.rate = number_of(attribute),
                _ => {}
            }
        }
        known
    }
}

fn text_of(attribute: &Attribute) -> Option<String> {
    attribute.read_string().ok().filter(|text| !text.is_empty())
}

fn number_of(attribute: &Attribute) -> Option<f64> {
    match attribute.num_elements() {
        Ok(1) => attribute.read_scalar::<Number>().ok().map(|n| n.0),
        _ => None,
    }
}

impl Walk<'_> {
    fn refused(&self, error: Hdf5Error) -> Error {
        refused(self.path, error)
    }

    fn group(&mut self, prefix: &str, group: &Group, depth: usize) -> Result<()> {
        self.attributes(prefix, group)?;
        let (groups, datasets) = group.member_names().map_err(|e| self.refused(e))?;
        let groups = groups.into_iter().map(|name| (name, true));
        let mut members: Vec<_> = groups
            .chain(datasets.into_iter().map(|name| (name, false)))
            .collect();
        members.sort();
        for (name, is_group) in members {
            // MATLAB's own: what cells and objects refer to.
            if self.matlab && depth == 0 && name.starts_with('#') {
                continue;
            }
            self.objects += 1;
            if self.objects > MOST_OBJECTS {
                let cause = "more than 100000 variables, or one that holds itself";
                return Err(Error::malformed(self.path, Place::Whole, cause));
            }
            let full = format!("{prefix}{name}");
            if is_group {
                let group = group.group(&name).map_err(|e| self.refused(e))?;
                self.subgroup(full, &group, depth)?;
            } else {
                match group.dataset(&name) {
                    Ok(dataset) => self.dataset(full, dataset)?,
                    Err(error) if is_unsupported(&error) => self.other(full, &error.to_string()),
                    Err(error) => return Err(self.refused(error)),
                }
            }
        }
        Ok(())
    }

    /// Texts and single numbers beside the datasets. Those of a MATLAB file say nothing of the recording.
    fn attributes(&mut self, prefix: &str, group: &Group) -> Result<()> {
        if self.matlab {
            return Ok(());
        }
        for attribute in group.attributes().map_err(|e| self.refused(e))? {
            let text = text_of(&attribute).map(Content::Text);
            if let Some(content) = text.or_else(|| number_of(&attribute).map(Content::Value)) {
                let name = format!("{prefix}{}", attribute.name);
                self.found.push(Variable::new(name, content));
            }
        }
        Ok(())
    }

    fn subgroup(&mut self, name: String, group: &Group, depth: usize) -> Result<()> {
        let all = group.attributes().map_err(|e| self.refused(e))?;
        let Attributes {
            class,
            empty,
            sparse,
            ..
        } = Attributes::of(&all);
        let class = class.unwrap_or_default();
        if sparse {
            self.other(name, "sparse");
        } else if empty {
            self.other(name, "empty");
        } else if depth >= DEEPEST || !matches!(class.as_str(), "struct" | "") {
            self.other(name, if class.is_empty() { "group" } else { &class });
        } else {
            let separator = separator(self.matlab);
            self.group(&format!("{name}{separator}"), group, depth + 1)?;
        }
        Ok(())
    }

    fn other(&mut self, name: String, kind: &str) {
        self.found
            .push(Variable::new(name, Content::Other(kind.to_owned())));
    }

    fn dataset(&mut self, name: String, dataset: hdf5_reader::Dataset) -> Result<()> {
        let known = Attributes::of(&dataset.attributes());
        let class = known.class.unwrap_or_default();
        let content = match class.as_str() {
            _ if known.sparse => Content::Other("sparse".to_owned()),
            "char" if known.empty => Content::Text(String::new()),
            _ if known.empty => Content::Other("empty".to_owned()),
            _ if known.scaled => Content::Other("scaled by attributes".to_owned()),
            "" | "double" | "single" | "logical" | "int8" | "uint8" | "int16" | "uint16"
            | "int32" | "uint32" | "int64" | "uint64" => {
                let text = dataset.num_elements().ok().filter(|&n| n == 1);
                match text.and_then(|_| dataset.read_string().ok()) {
                    Some(text) => Content::Text(text),
                    None => numbers(describe(self.path, dataset, self.length)?),
                }
            }
            "char" => match describe(self.path, dataset, self.length)? {
                Ok(dataset) => utf16(dataset)?,
                Err(kind) => Content::Other(kind.to_owned()),
            },
            // An array of structs, too, has a dataset of references for each field.
            kind => Content::Other(kind.to_owned()),
        };
        self.found.push(Variable {
            unit: known.unit,
            rate: known.rate,
            ..Variable::new(name, content)
        });
        Ok(())
    }
}

fn numbers(described: std::result::Result<Dataset, &'static str>) -> Content {
    match described {
        Ok(dataset) => Content::Numbers {
            rows: dataset.rows,
            columns: dataset.columns,
            elements: Box::new(dataset),
        },
        Err(kind) => Content::Other(kind.to_owned()),
    }
}

/// MATLAB's text of one line: UTF-16 numbers.
fn utf16(mut dataset: Dataset) -> Result<Content> {
    if dataset.rows != 1 || dataset.columns > LONGEST_TEXT {
        return Ok(Content::Other("long text".to_owned()));
    }
    let mut units = Vec::new();
    dataset.append(0, 1, dataset.columns as usize, &mut units)?;
    let units = units.iter().map(|&unit| unit as u16);
    let text = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
    Ok(Content::Text(text.collect()))
}
