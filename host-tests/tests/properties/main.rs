//! Random joints: three to five planets, both laws, both excitations, both dead zones, ripple, errors, unequal
//! backlash, with a compliance or without. For all of them the reference's balances close and the core's guarantees
//! hold.

mod balances;
mod core;
mod digest;
mod files;
mod random;
