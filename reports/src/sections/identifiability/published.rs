//! Results of examples and campaigns that take too long for a report, as `props/results` holds them.
//!
//! They are embedded when the report is built, so that it is the same wherever it is made. Each comes with the command that makes
//! it anew.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

const CAMPAIGN: &str = include_str!("../../../../props/results/campaign.json");
const PROPAGATION: &str = include_str!("../../../../props/results/propagation.json");
const TAPS: &str = include_str!("../../../../props/results/tap.json");

