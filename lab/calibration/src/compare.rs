//! A decoupled motion held against the truth, or against another: what `sixaxis compare` does, in bounded memory.
//!
//! | file | holds |
//! |---|---|
//! | [`track`] | one motion on its clock |
//! | [`aligned`] | two motions, sample beside sample |
//! | [`quantile`] | quantiles of a series that is never held in whole |
//! | [`measure`] | the figures |

pub mod aligned;
pub mod measure;
pub mod quantile;
pub mod track;
