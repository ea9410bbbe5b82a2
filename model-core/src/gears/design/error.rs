//! What can be wrong with parameters or with a wanted step. Raised offline, never in the loop.

use core::fmt;

use parameters::ParameterError;

/// Why no tables could be made.
#[derive(Debug, Clone, PartialEq)]
pub enum DesignError {
    /// The parameters are no joint's.
    Parameters(ParameterError),
    /// Tables for another number of planets than the joint has.
    WrongPlanetCount {
        /// Of the tables asked for.
        wanted: usize,
        /// Of the joint.
        given: usize,
    },
    /// A quantity that must be positive (or not negative) is not, or is not a number.
    OutOfRange {
        /// Which quantity.
        what: &'static str,
        /// Its value in SI.
        given: f64,
        /// What it must be.
        must_be: &'static str,
    },
    /// No fixed step at this rate is stable.
    RateTooLow {
        /// What was asked for [Hz].
        given: u32,
        /// The lowest rate that works [Hz].
        lowest: u32,
    },
    /// Under a compensation of this rate and bandwidth the motor would swing in the open gap, or the gap not be learnt.
    ControlTooSlow {
        /// Control rate that was asked for [Hz].
        given: u32,
        /// Bandwidth that was asked for [rad/s].
        bandwidth: f64,
        /// The lowest control rate that works with it [Hz], if any does.
        lowest: Option<u32>,
        /// The widest bandwidth that works at the rate [rad/s].
        widest: f64,
    },
    /// A scheme of planets' meshes for a gear without them.
    OneSchemeOnly,
    /// A number does not fit into single precision.
    NotRepresentable {
        /// Which table.
        what: &'static str,
    },
}

impl fmt::Display for DesignError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameters(error) => error.fmt(formatter),
            Self::WrongPlanetCount { wanted, given } => {
                write!(formatter, "tables for {wanted} planets were asked for, but the joint has {given}")
            }
            Self::OutOfRange { what, given, must_be } => write!(formatter, "{what} is {given}: it must be {must_be}"),
            Self::RateTooLow { given, lowest } => {
                write!(formatter, "a tick rate of {given} Hz is too low for this joint: use {lowest} Hz or more")
            }
            Self::ControlTooSlow { given, bandwidth, lowest, widest } => {
                write!(
                    formatter,
                    "control at {given} Hz is too slow for a bandwidth of {bandwidth} rad/s with these delays of torque and \
                     current loop: in the open gap the motor would swing, or the gap not be learnt. Take "
                )?;
                if let Some(lowest) = lowest {
                    write!(formatter, "{lowest} Hz or more, or ")?;
                }
                write!(formatter, "a bandwidth of {widest} rad/s or less")
            }
            Self::OneSchemeOnly => formatter.write_str("an equivalent gear has one scheme, the board's"),
            Self::NotRepresentable { what } => write!(
                formatter,
                "{what} does not fit into single precision: look for a parameter that is orders of magnitude off"
            ),
        }
    }
}

impl core::error::Error for DesignError {}

impl From<ParameterError> for DesignError {
    fn from(error: ParameterError) -> Self {
        Self::Parameters(error)
    }
}
