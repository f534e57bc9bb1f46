//! A laboratory's day judged: what conditioning leaves, what channels show of a motion, what is wrong, what the joint fit reports of it, and the
//! calibration file.

mod bare;
mod waveform;

mod calibration_file;
mod conditioning;
mod diagnosis;
mod hypotheses;
mod joint_report;
mod response;
mod statics;
