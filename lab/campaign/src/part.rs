//! A few dozen consecutive cases in one Parquet file, which is there whole or not at all.
//!
//! Any engine can query it: one column for each quantity of each parameter, named in [`crate::row`], null where there is none.
//! Where the cases come from stands in the key-value metadata, and a checksum over all values, because a compressed page with
//! a flipped bit may still be a page.

mod read;
mod write;

pub use read::{Part, read};
pub use write::write;

use core::ops::Range;
use sixaxis_core::Parameter;
use std::path::Path;

use crate::row::{Group, Row, Scalar, Text, column};

/// Cases in a part: what a kill loses at most per thread, a few seconds of work.
pub const CASES: u64 = 64;

/// Name and version of the format; a reader refuses another.
const FORMAT: &str = "sixaxis-campaign-1";

const FORMAT_KEY: &str = "sixaxis.campaign.format";
const VERSION_KEY: &str = "sixaxis.campaign.version";
const PLAN_KEY: &str = "sixaxis.campaign.plan";
const FIRST_SEED_KEY: &str = "sixaxis.campaign.first_seed";
const COUNT_KEY: &str = "sixaxis.campaign.count";
const PART_KEY: &str = "sixaxis.campaign.part";
const CHECKSUM_KEY: &str = "sixaxis.campaign.checksum";

/// Name of the first column.
const SEED: &str = "seed";

/// Where cases come from: the same in all parts of a campaign.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// Version of this program.
    pub version: String,
    /// Text of the session plan.
    pub plan: String,
    /// Seeds of the whole campaign, as it was asked for.
    pub asked: Range<u64>,
}

/// Name of the part with these seeds; in the order of names parts are in the order of seeds.
pub fn file_name(seeds: &Range<u64>) -> String {
    format!(
        "cases-{:019}-{:019}.parquet",
        seeds.start,
        seeds.end.saturating_sub(1)
    )
}

/// Seeds that a part of this name has; none for a file that is none.
pub fn seeds_of(path: &Path) -> Option<Range<u64>> {
    let name = path.file_name()?.to_str()?;
    let (first, last) = name
        .strip_prefix("cases-")?
        .strip_suffix(".parquet")?
        .split_once('-')?;
    let seeds = first.parse().ok()?..last.parse::<u64>().ok()?.checked_add(1)?;
    // Another way to write the same numbers is another file.
    (!seeds.is_empty() && file_name(&seeds) == name).then_some(seeds)
}

/// Names of the columns after the seed's: texts, then numbers.
fn columns() -> (Vec<String>, Vec<String>) {
    let texts = Text::ALL.iter().map(|t| t.name().to_owned()).collect();
    let scalars = Scalar::ALL.iter().map(|s| s.name().to_owned());
    let groups = Group::ALL
        .iter()
        .flat_map(|group| Parameter::all().map(|p| column(*group, p)));
    (texts, scalars.chain(groups).collect())
}

/// The numbers of a row in the order of their columns.
fn numbers(row: &Row) -> impl Iterator<Item = Option<f64>> {
    row.scalars
        .into_iter()
        .chain(row.groups.into_iter().flatten())
}

/// FNV-1a over 64 bits of everything in the rows.
fn checksum(rows: &[Row]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut byte = |b: u8| hash = (hash ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3);
    for row in rows {
        row.seed.to_le_bytes().into_iter().for_each(&mut byte);
        for text in &row.texts {
            byte(u8::from(text.is_some()));
            let text = text.as_deref().unwrap_or_default();
            (text.len() as u64)
                .to_le_bytes()
                .into_iter()
                .chain(text.bytes())
                .for_each(&mut byte);
        }
        for number in numbers(row) {
            byte(u8::from(number.is_some()));
            number
                .unwrap_or_default()
                .to_bits()
                .to_le_bytes()
                .into_iter()
                .for_each(&mut byte);
        }
    }
    hash
}
