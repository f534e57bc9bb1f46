//! `sixaxis` as people and scripts meet it: the program itself, files and arguments in; files, words and exit codes out.

mod architecture;
mod calibrate;
mod calibrate_joint;
mod campaign;
mod decouple;
mod docs;
#[cfg(feature = "harness")]
mod exit_codes;
mod help;
mod inputs;
mod inspect;
#[cfg(all(feature = "harness", target_os = "linux"))]
mod mistakes;
#[cfg(all(feature = "harness", target_os = "linux"))]
mod mistakes_in_files;
#[cfg(all(feature = "harness", target_os = "linux"))]
mod mistakes_in_statements;
mod mistakes_in_the_field;
#[cfg(all(feature = "harness", target_os = "linux"))]
mod mistakes_of_clocks;
mod mistakes_on_the_way;
#[cfg(all(feature = "harness", target_os = "linux"))]
mod mistakes_over_the_day;
mod moved;
mod noise;
mod outputs;
mod panel;
mod program;
mod self_calibrate;
mod simulate;
