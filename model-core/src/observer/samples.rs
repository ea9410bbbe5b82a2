//! Inputs of the observer in one control period: raw counts with time stamps, and the motor torque.

use crate::numbers::Real;

/// One reading of an encoder.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Reading {
    /// Raw counts as the encoder delivers them, wrapping where the settings say. Only the difference to the last
    /// reading is used; it must be less than half of the wrapping range.
    pub counts: u32,
    /// Time stamp of the reading in ticks of the clock of [`Samples::time`]; wraps at 2^32.
    pub time: u32,
}

/// Samples of one control period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Samples<T: Real = f32> {
    /// Present time in ticks of the settings' clock; wraps at 2^32.
    pub time: u32,
    /// Encoder on the motor.
    pub motor: Reading,
    /// Encoder on the link; `None` without an encoder, or without a reading in this period.
    pub output: Option<Reading>,
    /// Torque commanded last, after every limit: in force since the previous samples, apart from delay and lag [N m]. A
    /// motor controller that estimates its torque passes the estimate, with delay and lag set to zero in the settings.
    pub torque: T,
}
