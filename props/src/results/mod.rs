//! Published results: one type for each file of `props/results`, for the program that makes it and for everybody who reads it.
//!
//! The files are embedded when a program is built, so that a report is the same wherever it is made. Each takes minutes to
//! hours to make anew; [`Published::MAKE`] is the command.

mod accuracy;
mod calibration;
mod digest;
mod faults;
mod growth;
mod speed;

use serde::Serialize;
use serde::de::DeserializeOwned;
pub use sixaxis_campaign::statistics::Summary as Campaign;

pub use self::accuracy::*;
pub use self::calibration::*;
pub use self::digest::core_digest;
pub use self::faults::*;
pub use self::growth::*;
pub use self::speed::*;

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

/// A result that the example of the same name publishes.
macro_rules! published_by_example {
    ($($of:ty = $name:literal),* $(,)?) => {$(
        impl Published for $of {
            const FILE: &'static str = concat!("props/results/", $name, ".json");
            const TEXT: &'static str = include_str!(concat!("../../results/", $name, ".json"));
            const MAKE: &'static str = concat!(
                "cargo run --release -p sixaxis-props --example ", $name, " -- --publish"
            );
        }
    )*};
}

published_by_example!(
    Blind = "blind",
    Detection = "detection",
    DyingLimb = "dying_limb",
    FailedLimbs = "failed_limbs",
    Joint = "joint",
    Propagation = "propagation",
    SelfCalibration = "self_calibration",
    Taps = "tap",
    WatchedLaboratories = "watch",
);

impl Published for Campaign {
    const FILE: &'static str = "props/results/campaign.json";
    const TEXT: &'static str = include_str!("../../results/campaign.json");
    const MAKE: &'static str = "sixaxis campaign run --plan props/results/campaign.toml --count 10000 --out campaign; \
                                sixaxis campaign summary campaign --json";
}

impl Published for Laboratories {
    const FILE: &'static str = "props/results/laboratories.json";
    const TEXT: &'static str = include_str!("../../results/laboratories.json");
    const MAKE: &'static str =
        "cargo run --release -p sixaxis-reports --example laboratories -- --publish";
}

impl Published for Speed {
    const FILE: &'static str = "benches/results/speed.json";
    const TEXT: &'static str = include_str!("../../../benches/results/speed.json");
    const MAKE: &'static str = "benches/peers/run; \
                                cargo run --release -p sixaxis-benches --example speed -- --publish";
}

impl Published for Growth {
    const FILE: &'static str = "benches/results/growth.json";
    const TEXT: &'static str = include_str!("../../../benches/results/growth.json");
    const MAKE: &'static str =
        "cargo run --release -p sixaxis-benches --example growth -- --publish";
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neither the file nor the type has a field that the other has not, and no digit is lost.
    fn same<P: Published>() {
        let text: serde_json::Value = serde_json::from_str(P::TEXT).expect("JSON");
        let ours = P::embedded().unwrap_or_else(|e| panic!("{}: {e}", P::FILE));
        let ours = serde_json::to_value(ours).expect("JSON");
        assert!(ours == text, "{} is not what its type writes", P::FILE);
    }

    #[test]
    fn files_are_what_their_types_write() {
        same::<Blind>();
        same::<Campaign>();
        same::<Detection>();
        same::<DyingLimb>();
        same::<FailedLimbs>();
        same::<Growth>();
        same::<Joint>();
        same::<Laboratories>();
        same::<Propagation>();
        same::<SelfCalibration>();
        same::<Speed>();
        same::<Taps>();
        same::<WatchedLaboratories>();
    }
    /// A change to the core wants its speed measured anew, on a quiet machine: [`Published::MAKE`].
    #[test]
    fn the_published_speed_is_that_of_this_core() {
        let published = Speed::embedded().expect("published speed");
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let now = core_digest(&root).expect("core's sources");
        let (file, make) = (Speed::FILE, Speed::MAKE);
        assert_eq!(
            published.core_digest, now,
            "{file} was measured on another core: {make}"
        );
        let hurried = published.speed.quick || published.peers.quick;
        assert!(!hurried, "{file} was measured in a hurry: {make}");
    }
}
