//! The chips: which peripherals are where.

pub mod f405;
