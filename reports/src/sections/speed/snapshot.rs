//! The measurements that the section on speed shows, as `benches/examples/speed` published them.
//!
//! They are embedded when the report is built: a report times nothing, so that it is the same on every machine.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use sixaxis_core::Scheme;

const EMBEDDED: &str = include_str!("../../../../benches/results/speed.json");

/// Whole of `benches/results/speed.json`.
#[derive(Serialize, Deserialize)]
pub struct Snapshot {
    pub speed: Speed,
    pub peers: Peers,
    pub instructions: Instructions,
}

impl Snapshot {
    /// The one this was built with.
    pub fn embedded() -> serde_json::Result<Self> {
        serde_json::from_str(EMBEDDED)
    }
}

/// What the core takes.
#[derive(Serialize, Deserialize)]
pub struct Speed {
    pub date_utc: String,
    pub commit: String,
    pub core_changed_since_commit: bool,
    pub quick: bool,
    pub machine: Machine,
    pub work_precision: WorkPrecision,
    pub length: Length,
    pub streams: Streams,
}

#[derive(Serialize, Deserialize)]
pub struct Machine {
    pub cpu: String,
    pub logical_cores: usize,
    pub system: String,
    pub rustc: String,
    /// Instructions beyond the architecture's least.
    pub compiled_for: Vec<String>,
    pub processor_has: Vec<String>,
}

#[derive(Serialize, Deserialize)]
pub struct WorkPrecision {
    /// Over the peak of the linear acceleration, as are all errors of the points.
    pub reference_error: f64,
    pub curves: Vec<Curve>,
}

#[derive(Serialize, Deserialize)]
pub struct Curve {
    pub scheme: Scheme,
    pub points: Vec<Point>,
}

/// One sample rate; times are seconds of work for a second of signal.
#[derive(Serialize, Deserialize)]
pub struct Point {
    pub sample_rate_hz: f64,
    pub push_error: f64,
    pub record_error: f64,
    pub push_s_per_s: Spread,
    pub record_s_per_s: Spread,
}

#[derive(Serialize, Deserialize)]
pub struct Length {
    pub scheme: Scheme,
    pub streamed_piece_samples: usize,
    pub streamed: Vec<LengthPoint>,
    pub held: Vec<LengthPoint>,
    pub peak_memory_before_bytes: Option<u64>,
    pub peak_memory_after_bytes: Option<u64>,
}

#[derive(Serialize, Deserialize)]
pub struct LengthPoint {
    pub samples: usize,
    pub push_ns: Spread,
    pub record_ns: Spread,
}

#[derive(Serialize, Deserialize)]
pub struct Streams {
    pub scheme: Scheme,
    pub samples_per_stream: usize,
    pub threads: usize,
    /// How many cores that many threads of mere arithmetic got at the same time.
    pub cores_given: f64,
    pub points: Vec<StreamsPoint>,
}

/// Nanoseconds per sample and stream.
#[derive(Serialize, Deserialize)]
pub struct StreamsPoint {
    pub streams: usize,
    pub push_ns: Spread,
    pub record_ns: Spread,
    pub lanes_ns: Option<Spread>,
    pub lanes_threads_ns: Option<Spread>,
}

/// Median and quartiles over the rounds.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub struct Spread {
    pub median: f64,
    pub q1: f64,
    pub q3: f64,
}

/// What else one could run takes, as `benches/peers/run` left it.
#[derive(Serialize, Deserialize)]
pub struct Peers {
    pub date_utc: String,
    pub commit: Option<String>,
    pub quick: bool,
    pub rounds: usize,
    /// Tools by name; null for one that was not there.
    pub versions: BTreeMap<String, Option<String>>,
    pub peers: Vec<Peer>,
    /// Why the others were left out.
    pub not_run: BTreeMap<String, String>,
}

#[derive(Serialize, Deserialize)]
pub struct Peer {
    pub name: String,
    pub computes: String,
    pub differs: String,
    pub ns_per_sample: Spread,
    /// By name of what the ratio is to.
    pub ratio_to: BTreeMap<String, Spread>,
    pub error: PeerError,
}

/// Largest error against MuJoCo's truth over its peak; none of a half that is not computed.
#[derive(Serialize, Deserialize)]
pub struct PeerError {
    pub linear_truth: Option<f64>,
    pub angular_truth: Option<f64>,
}

/// What callgrind counts.
#[derive(Serialize, Deserialize)]
pub struct Instructions {
    pub rustc: String,
    /// Per sample, by the names of `core/examples/instructions.rs`.
    pub per_sample: BTreeMap<String, f64>,
}
