//! Manufactured solutions: the mass's motion in the shell is chosen in closed form, and everything else follows from it.
//!
//! [`curve`] differentiates products of rotations exactly; [`motion`] is the chosen relative pose with the limb forces
//! that (2) makes of it; [`formulations`] finds the shell motion that belongs to them, three times, by derivations that
//! share no equation of motion; [`spin`] runs the core's integrator by itself on the exact torques; [`examples`] are
//! single sensors where one will do. No simulator has a say here, and nothing of `sixaxis-core` but its drawing and what
//! is under test: its dynamics and its integrator.

pub mod curve;
pub mod examples;
pub mod formulations;
pub mod motion;
pub mod spin;
