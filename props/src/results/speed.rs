//! Speed: what `benches/examples/speed` times, what `benches/peers/run` leaves, and what callgrind counts.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use sixaxis_core::Scheme;

/// All of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Speed {
    /// What the core takes.
    pub speed: CoreSpeed,
    /// What others take.
    pub peers: Peers,
    /// What callgrind counts.
    pub instructions: Option<Instructions>,
}

/// What the core takes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CoreSpeed {
    /// When it was measured.
    pub date_utc: String,
    /// The commit that was measured.
    pub commit: String,
    /// Whether the core was another than that commit's.
    pub core_changed_since_commit: bool,
    /// Whether times are rough.
    pub quick: bool,
    /// Rounds of which medians are taken.
    pub rounds: usize,
    /// What was measured on.
    pub machine: Machine,
    /// Error against time.
    pub work_precision: WorkPrecision,
    /// Time against the length of a record.
    pub length: Length,
    /// Time against the number of streams.
    pub streams: Streams,
}

/// What was measured on, and of what.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Machine {
    /// The processor's name.
    pub cpu: String,
    /// Its logical cores.
    pub logical_cores: usize,
    /// Operating system and architecture.
    pub system: String,
    /// The compiler.
    pub rustc: String,
    /// Instructions that the program was compiled for beyond the architecture's least.
    pub compiled_for: Vec<String>,
    /// Vector instructions that the processor has: the record path and the lanes choose by them.
    pub processor_has: Vec<String>,
}

/// Error against time: schemes and sample rates on one motion. Errors are over the peak of the linear acceleration.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct WorkPrecision {
    /// The motion.
    pub problem: String,
    /// Its length, s.
    pub signal_s: f64,
    /// How far halving MuJoCo's step moves the most accurate answer against its truth.
    pub reference_error: f64,
    /// One a scheme.
    pub curves: Vec<SchemeCurve>,
}

/// One scheme.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SchemeCurve {
    /// The scheme.
    pub scheme: Scheme,
    /// One a sample rate.
    pub points: Vec<WorkPrecisionPoint>,
}

/// One sample rate; times are seconds of work for a second of signal.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct WorkPrecisionPoint {
    /// The rate.
    pub sample_rate_hz: f64,
    /// Largest error of push.
    pub push_error: f64,
    /// Largest error of the record path.
    pub record_error: f64,
    /// Time of push.
    pub push_s_per_s: Spread,
    /// Time of the record path.
    pub record_s_per_s: Spread,
}

/// Time per sample against the length of a record, and the memory it takes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Length {
    /// The scheme.
    pub scheme: Scheme,
    /// A recording is repeated as it arrives, in pieces of this many samples.
    pub streamed_piece_samples: usize,
    /// As it arrives.
    pub streamed: Vec<LengthPoint>,
    /// The same as one array in memory.
    pub held: Vec<LengthPoint>,
    /// Peak memory of the program before the first streamed sample; none where unknown.
    pub peak_memory_before_bytes: Option<u64>,
    /// The same after the last.
    pub peak_memory_after_bytes: Option<u64>,
}

/// One length, nanoseconds per sample.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct LengthPoint {
    /// The length.
    pub samples: usize,
    /// Time of push.
    pub push_ns: Spread,
    /// Time of the record path.
    pub record_ns: Spread,
    /// Largest difference of the two over the peak.
    pub difference: f64,
}

/// Time per sample against the number of streams.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Streams {
    /// The scheme.
    pub scheme: Scheme,
    /// Samples of each stream.
    pub samples_per_stream: usize,
    /// Threads.
    pub threads: usize,
    /// How many cores as many threads of mere arithmetic were given at the same time: neighbours take the rest.
    pub cores_given: f64,
    /// One a number of streams.
    pub points: Vec<StreamsPoint>,
}

/// Nanoseconds per sample and stream; lanes take eight streams.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct StreamsPoint {
    /// The number of streams.
    pub streams: usize,
    /// Time of push.
    pub push_ns: Spread,
    /// Time of the record path.
    pub record_ns: Spread,
    /// Time of the lanes.
    pub lanes_ns: Option<Spread>,
    /// Time of the lanes on all threads.
    pub lanes_threads_ns: Option<Spread>,
}

/// Median and quartiles over the rounds.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// First quartile.
    pub q1: f64,
    /// Third quartile.
    pub q3: f64,
}

/// What else one could run takes, as `benches/peers/run` left it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Peers {
    /// When it was measured.
    pub date_utc: String,
    /// The commit that was measured.
    pub commit: Option<String>,
    /// Whether core or peers were others than that commit's.
    pub changed_since_commit: bool,
    /// Whether times are rough.
    pub quick: bool,
    /// Rounds of which medians are taken.
    pub rounds: usize,
    /// Tools by name; none for one that was not there.
    pub versions: BTreeMap<String, Option<String>>,
    /// Each implementation.
    pub peers: Vec<Peer>,
    /// Why the others were left out.
    pub not_run: BTreeMap<String, String>,
    /// What else the script wrote.
    #[serde(flatten)]
    pub other: BTreeMap<String, serde_json::Value>,
}

/// One implementation.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Peer {
    /// Its name.
    pub name: String,
    /// From what to what.
    pub computes: String,
    /// What differs from the others, and affects fairness.
    pub differs: String,
    /// Time.
    pub ns_per_sample: Spread,
    /// Time over another's, by that one's name.
    pub ratio_to: BTreeMap<String, Spread>,
    /// How wrong it is.
    pub error: PeerError,
    /// What else the script wrote.
    #[serde(flatten)]
    pub other: BTreeMap<String, serde_json::Value>,
}

/// Largest error against MuJoCo's truth over its peak; none of a half that is not computed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PeerError {
    /// Of the linear acceleration.
    pub linear_truth: Option<f64>,
    /// Of the angular acceleration.
    pub angular_truth: Option<f64>,
    /// What else the script wrote.
    #[serde(flatten)]
    pub other: BTreeMap<String, serde_json::Value>,
}

/// What callgrind counts.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Instructions {
    /// The compiler.
    pub rustc: String,
    /// Per sample, by the names of `core/examples/instructions.rs`.
    pub per_sample: BTreeMap<String, f64>,
}
