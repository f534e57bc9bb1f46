//! MAT version 5: a header of 128 bytes, then tagged elements, each perhaps deflated. Held whole in memory.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use flate2::read::ZlibDecoder;

use crate::error::{Error, Place, Result};
use crate::numbers::{Kind, Number};
use crate::source::Source;
use crate::variables::{Content, Elements, Variable, arrange};

/// Bytes of the header.
const HEADER: usize = 128;
/// Largest file, and largest sum of what is unpacked from it.
const LARGEST: u64 = 1 << 31;
/// Structs within structs.
const DEEPEST: usize = 16;

const UINT32: u32 = 6;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Storage of an element's numbers by its type.
fn kind(element: u32) -> Option<Kind> {
    Some(match element {
        1 => Kind::I8,
        2 => Kind::U8,
        3 => Kind::I16,
        4 => Kind::U16,
        5 => Kind::I32,
        UINT32 => Kind::U32,
        7 => Kind::F32,
        9 => Kind::F64,
        12 => Kind::I64,
        13 => Kind::U64,
        _ => return None,
    })
}

/// Name of an array class that is no matrix of numbers or text.
fn class_name(class: u8) -> &'static str {
    match class {
        1 => "cell",
        3 => "object",
        5 => "sparse",
        16 => "function handle",
        17 => "object, such as a table, string or datetime",
        _ => "of unknown class",
    }
}

/// Numbers in memory.
struct Held {
    bytes: Arc<Vec<u8>>,
    range: Range<usize>,
    number: Number,
}

impl Elements for Held {
    fn append(&mut self, first: u64, stride: u64, count: usize, out: &mut Vec<f64>) -> Result<()> {
        let whole = self.bytes.get(self.range.clone()).unwrap_or_default();
        let bytes_of = |elements: u64| {
            let elements = usize::try_from(elements).unwrap_or(usize::MAX);
            elements.saturating_mul(self.number.kind.size())
        };
        let bytes = whole.get(bytes_of(first)..).unwrap_or_default();
        self.number.append(bytes, bytes_of(stride), count, out);
        Ok(())
    }
}

/// Opens a file.
pub(super) fn open(path: &Path) -> Result<Box<dyn Source>> {
    let io = |source| Error::io(path, source);
    let mut file = File::open(path).map_err(io)?;
    let mut bytes = Vec::new();
    let mut fill = |bytes: &mut Vec<u8>, most: u64| {
        let most = most - bytes.len() as u64;
        (&mut file).take(most).read_to_end(bytes).map_err(io)
    };
    fill(&mut bytes, HEADER as u64)?;
    let big_endian = match bytes.get(124..HEADER) {
        Some([0x00, 0x01, b'I', b'M']) => false,
        Some([0x01, 0x00, b'M', b'I']) => true,
        _ if bytes.get(..4).is_some_and(|text| text.contains(&0)) => {
            return Err(Error::unsupported(
                path,
                "a MATLAB file of version 4",
                "save it with the option -v7",
            ));
        }
        _ => {
            let place = Place::Byte(124.min(bytes.len() as u64));
            return Err(Error::malformed(path, place, "no header of a MATLAB file"));
        }
    };
    fill(&mut bytes, LARGEST + 1)?;
    let mut reader = Reader {
        path,
        big_endian,
        unpacked: bytes.len() as u64,
        found: Vec::new(),
    };
    reader.check_size()?;
    let whole = Part {
        end: bytes.len(),
        bytes: Arc::new(bytes),
        at: HEADER,
        offset: None,
    };
    reader.file(whole)?;
    arrange(path, "MATLAB 5", '.', reader.found)
}

/// Elements side by side.
#[derive(Clone)]
struct Part {
    bytes: Arc<Vec<u8>>,
    at: usize,
    end: usize,
    /// Where the compressed element stands from which the bytes were unpacked.
    offset: Option<u64>,
}

impl Part {
    fn place(&self) -> Place {
        Place::Byte(self.offset.unwrap_or(self.at as u64))
    }

    fn bytes(&self) -> &[u8] {
        self.bytes.get(self.at..self.end).unwrap_or_default()
    }
}

struct Reader<'a> {
    path: &'a Path,
    big_endian: bool,
    /// Bytes in memory.
    unpacked: u64,
    found: Vec<Variable>,
}

impl Reader<'_> {
    fn malformed(&self, part: &Part, cause: &str) -> Error {
        Error::malformed(self.path, part.place(), cause)
    }

    fn check_size(&self) -> Result<()> {
        if self.unpacked > LARGEST {
            return Err(Error::unsupported(
                self.path,
                "a MATLAB file of more than 2 GiB unpacked",
                "save it with the option -v7.3, which is read in pieces",
            ));
        }
        Ok(())
    }

    fn word(&self, part: &Part, at: usize) -> Result<u32> {
        let end = at.saturating_add(4).min(part.end);
        match part.bytes.get(at..end) {
            Some(&[a, b, c, d]) if self.big_endian => Ok(u32::from_be_bytes([a, b, c, d])),
            Some(&[a, b, c, d]) => Ok(u32::from_le_bytes([a, b, c, d])),
            _ => Err(self.malformed(part, "the file ends within an element")),
        }
    }

    /// The next element and its type; `part` moves behind it.
    fn element(&self, part: &mut Part) -> Result<(u32, Part)> {
        let first = self.word(part, part.at)?;
        let (kind, size, from) = if first >> 16 != 0 {
            // Small elements: size and type share a word, the data follow in the other.
            (first & 0xffff, (first >> 16) as usize, part.at + 4)
        } else {
            let size = self.word(part, part.at + 4)?;
            (first, size as usize, part.at + 8)
        };
        let small = from == part.at + 4;
        let end = from.checked_add(size).filter(|&end| end <= part.end);
        let Some(end) = end.filter(|_| !small || size <= 4) else {
            return Err(self.malformed(part, "an element reaches beyond the end of what holds it"));
        };
        let inside = Part {
            at: from,
            end,
            ..part.clone()
        };
        let next = if small {
            part.at + 8
        } else if kind == COMPRESSED {
            end
        } else {
            end.next_multiple_of(8)
        };
        part.at = next.min(part.end);
        Ok((kind, inside))
    }

    fn file(&mut self, mut part: Part) -> Result<()> {
        while part.at < part.end {
            let (kind, inside) = self.element(&mut part)?;
            match kind {
                MATRIX => self.matrix(inside, "", 0)?,
                COMPRESSED => {
                    let mut unpacked = self.unpack(&inside)?;
                    let (kind, matrix) = self.element(&mut unpacked)?;
                    if kind == MATRIX {
                        self.matrix(matrix, "", 0)?;
                    }
                }
                // Anything else at this level is not a variable.
                _ => {}
            }
        }
        Ok(())
    }

    fn unpack(&mut self, packed: &Part) -> Result<Part> {
        let offset = packed.at as u64;
        let mut bytes = Vec::new();
        // One more than allowed shows that there is more.
        let allowed = LARGEST + 1 - self.unpacked;
        ZlibDecoder::new(packed.bytes())
            .take(allowed)
            .read_to_end(&mut bytes)
            .map_err(|error| self.malformed(packed, &format!("a compressed variable: {error}")))?;
        self.unpacked += bytes.len() as u64;
        self.check_size()?;
        Ok(Part {
            at: 0,
            end: bytes.len(),
            bytes: Arc::new(bytes),
            offset: Some(offset),
        })
    }

    /// An array; `name` replaces the one it carries unless empty.
    fn matrix(&mut self, mut part: Part, name: &str, depth: usize) -> Result<()> {
        if part.at == part.end {
            // A field that was never set.
            let empty = Content::Other("empty".to_owned());
            self.found.push(Variable::new(name.to_owned(), empty));
            return Ok(());
        }
        let (kind, flags) = self.element(&mut part)?;
        if kind != UINT32 {
            return Err(self.malformed(&part, "an array without its flags"));
        }
        let flags = self.word(&flags, flags.at)?;
        let class = (flags & 0xff) as u8;
        let complex = flags & 0x0800 != 0;
        // Objects of classes have no size before their name.
        let dimensions = match class {
            17 => Vec::new(),
            _ => {
                let (_, sizes) = self.element(&mut part)?;
                let mut all = Vec::new();
                for at in (sizes.at..sizes.end).step_by(4) {
                    all.push(u64::from(self.word(&sizes, at)?));
                }
                all
            }
        };
        let (_, own) = self.element(&mut part)?;
        let own = String::from_utf8_lossy(own.bytes()).into_owned();
        let name = if name.is_empty() {
            own
        } else {
            name.to_owned()
        };
        if name.is_empty() {
            // MATLAB's own record of the objects in the file.
            return Ok(());
        }
        let other = |kind: &str| Content::Other(kind.to_owned());
        let content = match (class, dimensions.as_slice()) {
            (6..=15, _) if complex => other("complex"),
            (6..=15, &[rows, columns]) => self.numbers(&mut part, rows, columns)?,
            (6..=15, _) => other("of more than two dimensions"),
            (4, &[rows, columns]) => match self.text(&mut part, rows, columns)? {
                Some(text) => Content::Text(text),
                None => other("text of several lines"),
            },
            (4, _) => other("text of more than two dimensions"),
            (2, [1, 1]) if depth < DEEPEST => return self.fields(&mut part, &name, depth),
            (2, [1, 1]) => other("deeply nested struct"),
            (2, _) => other("array of structs"),
            _ => other(class_name(class)),
        };
        self.found.push(Variable::new(name, content));
        Ok(())
    }

    fn numbers(&self, part: &mut Part, rows: u64, columns: u64) -> Result<Content> {
        let (element, data) = self.element(part)?;
        let kind =
            kind(element).ok_or_else(|| self.malformed(&data, "numbers of an unknown type"))?;
        let bytes = rows
            .checked_mul(columns)
            .and_then(|count| count.checked_mul(kind.size() as u64));
        if bytes != Some((data.end - data.at) as u64) {
            return Err(self.malformed(&data, "the numbers are not as many as the size says"));
        }
        Ok(Content::Numbers {
            rows,
            columns,
            elements: Box::new(Held {
                range: data.at..data.end,
                bytes: data.bytes,
                number: Number {
                    kind,
                    big_endian: self.big_endian,
                },
            }),
        })
    }

    /// Text of one line.
    fn text(&self, part: &mut Part, rows: u64, columns: u64) -> Result<Option<String>> {
        if rows == 0 || columns == 0 {
            return Ok(Some(String::new()));
        }
        let (element, data) = self.element(part)?;
        if rows != 1 {
            return Ok(None);
        }
        let bytes = data.bytes();
        Ok(match element {
            // Bytes in whatever the writer's character set was: beyond ASCII only UTF-8 is understood.
            1 | 2 | 16 => Some(String::from_utf8_lossy(bytes).into_owned()),
            3 | 4 | 17 => {
                let (units, _) = bytes.as_chunks::<2>();
                let units = units.iter().map(|&unit| match self.big_endian {
                    true => u16::from_be_bytes(unit),
                    false => u16::from_le_bytes(unit),
                });
                Some(
                    char::decode_utf16(units)
                        .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
                        .collect(),
                )
            }
            _ => None,
        })
    }

    fn fields(&mut self, part: &mut Part, name: &str, depth: usize) -> Result<()> {
        let (_, width) = self.element(part)?;
        let width = self.word(&width, width.at)? as usize;
        let (_, names) = self.element(part)?;
        if width == 0 {
            return Ok(());
        }
        let names: Vec<_> = names
            .bytes()
            .chunks(width)
            .map(|field| {
                let text = field.split(|&byte| byte == 0).next().unwrap_or_default();
                format!("{name}.{}", String::from_utf8_lossy(text))
            })
            .collect();
        for field in names {
            let (kind, inside) = self.element(part)?;
            if kind != MATRIX {
                return Err(self.malformed(&inside, "a struct's field that is no array"));
            }
            self.matrix(inside, &field, depth + 1)?;
        }
        Ok(())
    }
}
