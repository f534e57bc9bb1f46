//! Pages from the file, with sizes checked before anything of their size is allocated, and zstd.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::sync::Arc;

use bytes::Bytes;

use ::parquet::basic::Compression;
use ::parquet::column::page::{Page, PageMetadata, PageReader};
use ::parquet::errors::{ParquetError, Result};
use ::parquet::file::metadata::ColumnChunkMetaData;
use ::parquet::file::reader::{ChunkReader, Length};
use ::parquet::file::serialized_reader::SerializedPageReader;

/// What deflate can at most make of a byte; snappy and LZ4 make less.
const INFLATION: u64 = 1032;
/// Allowance for pages of a few bytes.
const SMALL_PAGE: u64 = 4096;
/// Largest page that is unpacked. Writers aim at 1 MiB; some put a whole row group into one.
const LARGEST_PAGE: u64 = 1 << 30;

fn implausible(cause: impl Into<String>) -> ParquetError {
    ParquetError::General(cause.into())
}

/// The file, which refuses a page whose header promises more than its bytes can hold.
#[derive(Debug)]
pub(super) struct Pages {
    file: File,
    length: u64,
    inflation: u64,
}

impl Length for Pages {
    fn len(&self) -> u64 {
        self.length
    }
}

impl ChunkReader for Pages {
    type T = BufReader<File>;

    /// Asked for only where a page header begins.
    fn get_read(&self, start: u64) -> Result<Self::T> {
        let mut file = self.file.try_clone()?;
        file.seek(SeekFrom::Start(start))?;
        let mut reader = BufReader::new(file);
        let (unpacked, packed) = page_sizes(reader.fill_buf()?)
            .ok_or_else(|| implausible(format!("no page header at byte {start}")))?;
        if unpacked > LARGEST_PAGE
            || unpacked
                > packed
                    .saturating_mul(self.inflation)
                    .saturating_add(SMALL_PAGE)
        {
            return Err(implausible(format!(
                "the page at byte {start} claims to unpack {packed} bytes into {unpacked}"
            )));
        }
        Ok(reader)
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        if start
            .checked_add(length as u64)
            .is_none_or(|end| end > self.length)
        {
            return Err(implausible(format!(
                "{length} bytes from byte {start} on reach beyond the end of the file"
            )));
        }
        self.file.get_bytes(start, length)
    }
}

/// Size of a page unpacked and packed, from the beginning of its header: type, then these two, as Thrift's compact protocol
/// has them.
fn page_sizes(header: &[u8]) -> Option<(u64, u64)> {
    /// Field of type i32 whose number is one more than the last one's.
    const NEXT_I32: u8 = 0x15;
    let mut bytes = header.iter().copied();
    let mut fields = [0; 3];
    for field in &mut fields {
        if bytes.next()? != NEXT_I32 {
            return None;
        }
        let mut shift = 0;
        loop {
            let byte = bytes.next()?;
            *field |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                break;
            }
            shift += 7;
            if shift > 28 {
                return None;
            }
        }
    }
    // Zigzag: odd numbers are negative ones.
    let [_, unpacked, packed] = fields;
    (unpacked % 2 == 0 && packed % 2 == 0).then_some((unpacked / 2, packed / 2))
}

/// The pages of a column chunk, unpacked.
pub(super) fn page_reader(
    file: &File,
    chunk: &ColumnChunkMetaData,
    rows: usize,
) -> Result<Box<dyn PageReader>> {
    let length = file.metadata()?.len();
    // The library asserts this where it could say so.
    if chunk.data_page_offset() < 0
        || chunk.dictionary_page_offset().is_some_and(|at| at < 0)
        || chunk.compressed_size() < 0
    {
        return Err(implausible("a column chunk at a negative place"));
    }
    let zstd = matches!(chunk.compression(), Compression::ZSTD(_));
    let pages = Pages {
        file: file.try_clone()?,
        length,
        inflation: if zstd { u64::MAX } else { INFLATION },
    };
    if !zstd {
        let reader = SerializedPageReader::new(Arc::new(pages), chunk, rows, None)?;
        return Ok(Box::new(reader));
    }
    let packed = chunk
        .clone()
        .into_builder()
        .set_compression(Compression::UNCOMPRESSED)
        .build()?;
    let inner = SerializedPageReader::new(Arc::new(pages), &packed, rows, None)?;
    Ok(Box::new(Zstd { inner }))
}

/// Unpacks what the library takes for uncompressed pages.
struct Zstd {
    inner: SerializedPageReader<Pages>,
}

fn unpack(packed: &[u8]) -> Result<Vec<u8>> {
    let mut unpacked = Vec::new();
    if packed.is_empty() {
        return Ok(unpacked);
    }
    let broken = |cause: &dyn std::fmt::Display| implausible(format!("zstd: {cause}"));
    let decoder =
        ruzstd::decoding::StreamingDecoder::new(packed).map_err(|error| broken(&error))?;
    decoder
        .take(LARGEST_PAGE + 1)
        .read_to_end(&mut unpacked)
        .map_err(|error| broken(&error))?;
    if unpacked.len() as u64 > LARGEST_PAGE {
        return Err(broken(&"a page of more than 1 GiB"));
    }
    Ok(unpacked)
}

impl PageReader for Zstd {
    fn get_next_page(&mut self) -> Result<Option<Page>> {
        let Some(mut page) = self.inner.get_next_page()? else {
            return Ok(None);
        };
        match &mut page {
            Page::DataPage { buf, .. } | Page::DictionaryPage { buf, .. } => {
                *buf = unpack(buf)?.into();
            }
            Page::DataPageV2 {
                buf,
                def_levels_byte_len,
                rep_levels_byte_len,
                is_compressed,
                ..
            } => {
                // The levels stand in front, never compressed.
                let levels = u64::from(*def_levels_byte_len) + u64::from(*rep_levels_byte_len);
                let split = usize::try_from(levels)
                    .ok()
                    .and_then(|levels| buf.split_at_checked(levels));
                let Some((levels, values)) = split else {
                    return Err(implausible("levels that reach beyond their page"));
                };
                if *is_compressed {
                    let mut whole = levels.to_vec();
                    whole.extend_from_slice(&unpack(values)?);
                    *buf = whole.into();
                    *is_compressed = false;
                }
            }
        }
        Ok(Some(page))
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>> {
        self.inner.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<()> {
        self.inner.skip_next_page()
    }

    fn at_record_boundary(&mut self) -> Result<bool> {
        self.inner.at_record_boundary()
    }
}

impl Iterator for Zstd {
    type Item = Result<Page>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}
