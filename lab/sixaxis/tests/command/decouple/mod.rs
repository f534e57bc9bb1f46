//! `sixaxis decouple` and `sixaxis compare`, on one session that MuJoCo plays once.

mod attitude;
mod clocks;
mod conventions;
mod deviations;
mod excluded_limbs;
mod forms;
mod guards;
mod refusals;
mod results;
mod ride;
mod session;
mod streams;
mod watch;
