//! Nine voltages in, six accelerations out: the whole of the paper's section 2.1, sample by sample ([`stream`]), along a
//! recording ([`record`]) or along eight recordings at once ([`lanes`]).

pub mod lanes;
pub mod record;
#[cfg(feature = "alloc")]
pub mod rest_to_rest;
pub mod stream;
pub mod uncertainty;

pub use stream::{Decoupler, SixAxis};
