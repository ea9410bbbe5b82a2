//! What the observer is given once a control period: raw counts with the moments at which they were taken, and the
//! torque of the motor.

use crate::numbers::Real;

/// One reading of an encoder.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Reading {
    /// Raw counts as the encoder gives them. They may wrap wherever the settings say; only what the shaft has turned
    /// since the last reading is used, and that must be less than half of the range in which they wrap.
    pub counts: u32,
    /// When the reading was taken, in ticks of the clock that also gives [`Samples::time`]; wraps at 2^32.
    pub time: u32,
}

/// Everything that is measured in one control period.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Samples<T: Real> {
    /// Now, in ticks of the settings' clock; wraps at 2^32.
    pub time: u32,
    /// Encoder on the motor.
    pub motor: Reading,
    /// Encoder on the link; `None` when there is none, or when it gave nothing in this period.
    pub output: Option<Reading>,
    /// Torque that was commanded last, after every limit: the one in force since the samples before these, delay and
    /// lag aside [N m]. A motor controller that estimates its torque gives that instead, with delay and lag set to zero
    /// in the settings.
    pub torque: T,
}
