//! Keys of what a file says of its channels beside their numbers.

/// Property that names the columns which are no channels, each with its type.
pub const LEFT_OUT: &str = "columns left out";
/// Samples per second, of the file or of one column.
pub const RATE_KEY: &str = "sample_rate_hz";
/// Time of the first sample, s.
pub const OFFSET_KEY: &str = "start_offset_s";
