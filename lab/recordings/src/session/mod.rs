//! The session: what the laboratory knows and no recording says.
//!
//! Which wedge was under the sensor, which range the amplifier was switched to, what the certificates of the standard
//! instruments allow. A session file is TOML with the units in the names of its keys; `docs/session.md` has a complete example,
//! [`schema()`] the formal description. Paths in it are relative to the file. A value that is impossible is refused with file,
//! line and key before any recording is opened.
//!
//! | file | holds |
//! |---|---|
//! | `schema` | the whole session, limits of a good calibration |
//! | `sensor` | the sensor under calibration |
//! | `standards` | standard instruments and rig |
//! | `channels` | names and units of channels |
//! | `preprocessing` | the stages that recordings pass before anything is computed from them |
//! | `entry` | one recording |
//! | `check` | values that are impossible |
//! | `file` | the file: parsing, paths, the place of an error |

mod channels;
mod check;
mod entry;
mod file;
mod place;
mod preprocessing;
mod schema;
mod sensor;
mod standards;

pub use channels::Channels;
pub use entry::{Entry, Role};
pub use file::SessionFile;
pub use place::{line_at, line_of};
pub use preprocessing::{Detrend, DifferentiatorSettings, LowPass, Outliers, Preprocessing, Stage};
pub use schema::{Limits, Session, schema};
pub use sensor::{Design, LIMBS, PerLimb, SensorCard};
pub use standards::{Accelerometer, Gyroscope, Rig};
