//! Motor and load side combined in one control period (O7, O9), before any decision. [`Learnt::fuse`] makes it.
//!
//! [`Learnt::fuse`]: super::Learnt::fuse

use crate::numbers::Real;

/// Combined measurement of one period.
#[derive(Debug, Clone, Copy)]
pub struct Fused<T: Real> {
    /// Shift of both flanks by the transmission error now [m].
    pub flank_shift: T,
    /// Motor less ratio times link along the line of action, as measured [m].
    pub measured: T,
    /// Measured deflection less offset, skew and error maps; wind-up is included [m].
    pub deflection: T,
    /// Rate of the deflection [m/s].
    pub rate: T,
    /// Travel of the deflection during the lag of the measurement, where it exceeds noise [m].
    pub travel: T,
    /// Force lost at the motor, friction and bias included [N].
    pub lost: T,
    /// Direction of the motor's dry friction, from -1 to 1.
    pub direction: T,
    /// Mesh force from the motor side [N].
    pub force: T,
}

impl<T: Real> Fused<T> {
    /// Deflection of the teeth including wind-up; zero in the middle of the gap [m].
    pub fn of_teeth(&self) -> T {
        self.deflection - self.flank_shift
    }
}

/// Converts a difference of counts, which teeth keep small, and saturates: conversion of wide integers is slow without
/// hardware.
pub fn small<T: Real>(difference: i64) -> T {
    let narrow = difference as i32;
    T::from_i32(if i64::from(narrow) == difference {
        narrow
    } else if difference < 0 {
        i32::MIN
    } else {
        i32::MAX
    })
}
