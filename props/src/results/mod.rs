//! Published results: one type for each file of `props/results`, for the program that makes it and for everybody who reads it.
//!
//! The files are embedded when a program is built, so that a report is the same wherever it is made. Each takes minutes to
//! hours to make anew; [`Published::MAKE`] is the command.

mod accuracy;
mod blind;
mod budget;
mod calibration;
mod digest;
mod faults;
mod growth;
mod hours;
mod mujoco_campaign;
mod speed;

use serde::Serialize;
use serde::de::DeserializeOwned;
pub use sixaxis_campaign::statistics::Summary as Campaign;

pub use self::accuracy::*;
pub use self::blind::*;
pub use self::budget::*;
pub use self::calibration::*;
pub use self::digest::{of_bytes, of_sources};
pub use self::faults::*;
pub use self::growth::*;
pub use self::hours::*;
pub use self::mujoco_campaign::*;
pub use self::speed::*;
use crate::provenance::Provenance;
use crate::publication::File;

/// A result that is kept as a file.
pub trait Published: Serialize + DeserializeOwned {
    /// The file below the workspace's root.
    const FILE: &'static str;
    /// Its text.
    const TEXT: &'static str;
    /// The command that makes it anew.
    const MAKE: &'static str;

    /// The published result.
    ///
    /// # Errors
    /// If the file is not of this type.
    fn embedded() -> serde_json::Result<Self> {
        serde_json::from_str(Self::TEXT)
    }
}

/// A result that depends on seeds and code alone, so that anybody can make the same bits: its file has a
/// [`Provenance`].
pub trait Studied: Published {
    /// Code that it depends on, folders and files below the workspace's root.
    const SOURCES: &'static [&'static str];

    /// The whole file.
    ///
    /// # Errors
    /// If it is not of this type.
    fn file() -> serde_json::Result<File<Self>> {
        serde_json::from_str(Self::TEXT)
    }
}

/// Results of studies, each published by the example of its name of a package.
macro_rules! studies {
    ($($of:ty = $name:literal by $package:literal from [$($source:literal),*]),* $(,)?) => {
    $(
        impl Published for $of {
            const FILE: &'static str = concat!("props/results/", $name, ".json");
            const TEXT: &'static str = include_str!(concat!("../../results/", $name, ".json"));
            const MAKE: &'static str = concat!(
                "cargo run --release -p sixaxis-", $package, " --example ", $name, " -- --publish"
            );

            fn embedded() -> serde_json::Result<Self> {
                Ok(Self::file()?.result)
            }
        }

        impl Studied for $of {
            const SOURCES: &'static [&'static str] = &[
                "core/src", "reference/src", "lab/recordings/src", "lab/calibration/src", "props/src",
                concat!($package, "/examples/", $name, ".rs"), $($source),*
            ];
        }
    )*

    /// Where each of these files is from: its path below the workspace's root, and what it says of itself.
    ///
    /// # Errors
    /// If one is not of its type.
    pub fn provenances() -> serde_json::Result<Vec<(&'static str, Provenance)>> {
        Ok(vec![$((<$of>::FILE, <$of>::file()?.provenance)),*])
    }

    #[cfg(test)]
    const STUDIES: &[fn()] = &[$(tests::same_file::<$of>),*];
    };
}

studies!(
    Blind = "blind" by "props" from [],
    BlindPairs = "blind_mujoco" by "props" from [],
    Budget = "budget" by "reports" from ["reports/src/study"],
    Campaign = "campaign" by "props" from ["lab/campaign/src"],
    Detection = "detection" by "props" from [],
    DyingLimb = "dying_limb" by "props" from [],
    FailedLimbs = "failed_limbs" by "props" from [],
    Hours = "hours" by "props" from [],
    Joint = "joint" by "props" from [],
    Laboratories = "laboratories" by "reports" from ["reports/src/study"],
    MujocoCampaign = "campaign_mujoco" by "props" from ["lab/campaign/src"],
    MujocoHours = "hours_mujoco" by "props" from [],
    Propagation = "propagation" by "props" from [],
    Rooms = "rooms" by "props" from [],
    SelfCalibration = "self_calibration" by "props" from [],
    Taps = "tap" by "props" from [],
    WatchedLaboratories = "watch" by "props" from [],
);

impl Published for Speed {
    const FILE: &'static str = "benches/results/speed.json";
    const TEXT: &'static str = include_str!("../../../benches/results/speed.json");
    const MAKE: &'static str = "benches/peers/run; \
                                cargo run --release -p sixaxis-benches -F studies --example speed -- --publish";
}

impl Published for Growth {
    const FILE: &'static str = "benches/results/growth.json";
    const TEXT: &'static str = include_str!("../../../benches/results/growth.json");
    const MAKE: &'static str =
        "cargo run --release -p sixaxis-benches -F studies --example growth -- --publish";
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative change of a count that no timing shows.
    const SAME_CORE: f64 = 0.03;

    /// Neither the file nor the type has a field that the other has not, and no digit is lost.
    fn same<F: Serialize + DeserializeOwned>(file: &str, text: &str) {
        let json: serde_json::Value = serde_json::from_str(text).expect("JSON");
        let ours: F = serde_json::from_str(text).unwrap_or_else(|e| panic!("{file}: {e}"));
        let ours = serde_json::to_value(ours).expect("JSON");
        assert!(ours == json, "{file} is not what its type writes");
    }

    pub(super) fn same_file<S: Studied>() {
        same::<File<S>>(S::FILE, S::TEXT);
        let Provenance {
            commit,
            command,
            sources,
            samples,
            ..
        } = S::file().expect(S::FILE).provenance;
        let file = S::FILE;
        assert!(
            !commit.contains("dirty") && commit != "unknown",
            "{file} is from {commit}"
        );
        assert_eq!(command, S::MAKE, "{file}");
        let sources: Vec<&str> = sources.iter().map(|source| &source.path[..]).collect();
        assert_eq!(sources, S::SOURCES, "{file}");
        assert!(!samples.is_empty(), "{file} has no samples");
    }

    #[test]
    fn files_are_what_their_types_write() {
        STUDIES.iter().for_each(|study| study());
        same::<Growth>(Growth::FILE, Growth::TEXT);
        same::<Speed>(Speed::FILE, Speed::TEXT);
    }

    /// Times are of a machine, but a core that takes other numbers of instructions than the one that was timed wants its speed measured
    /// anew, on a quiet machine: [`Published::MAKE`]. That today's core takes those of the ledger is `.ci/instructions`' to say.
    #[test]
    fn the_published_speed_is_that_of_this_core() {
        let published = Speed::embedded().expect("published speed");
        let ledger: Instructions =
            serde_json::from_str(include_str!("../../../benches/instructions.json"))
                .expect("a ledger");
        let (file, make) = (Speed::FILE, Speed::MAKE);
        let timed = published.instructions.expect("published counts").per_sample;
        for (path, then) in &timed {
            let now = ledger.per_sample[path];
            assert!(
                (now / then - 1.0).abs() < SAME_CORE,
                "{file} was measured on a core that takes {then} instructions for {path} and not {now}: {make}"
            );
        }
        let hurried = published.speed.quick || published.peers.quick;
        assert!(!hurried, "{file} was measured in a hurry: {make}");
    }
}
