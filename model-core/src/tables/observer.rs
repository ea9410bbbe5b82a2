//! What the observer needs as plain numbers, made by `design::observer`. SI, except that angles of encoders are in
//! counts; how the numbers come about is left to the design.

use crate::real::Real;

/// Tables of the observer of one joint with its encoders at one control rate.
#[derive(Debug, Clone, PartialEq)]
pub struct ObserverTables<T: Real> {
    /// Control periods a second [Hz].
    pub control_rate: u32,
    /// Control period [s].
    pub period: T,
}
