//! Random joints: three to five planets, both damping laws, both excitations, both dead zones, ripple, errors, unequal backlash, with and
//! without compliance. For all of them the reference's balances close and the core's guarantees hold.

mod balances;
mod core;
mod digest;
mod files;
mod random;
