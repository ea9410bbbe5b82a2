//! Errors of the design: invalid parameters or an impossible step. They occur offline, never in the loop.

use core::fmt;

use parameters::ParameterError;

/// Error of the design of tables.
#[derive(Debug, Clone, PartialEq)]
pub enum DesignError {
    /// Invalid joint parameters.
    Parameters(ParameterError),
    /// Tables for another number of planets than the joint has.
    WrongPlanetCount {
        /// Number of planets of the requested tables.
        wanted: usize,
        /// Number of planets of the joint.
        given: usize,
    },
    /// Quantity outside its range, or not a number.
    OutOfRange {
        /// Name of the quantity.
        what: &'static str,
        /// Value of the quantity in SI.
        given: f64,
        /// Condition on the quantity.
        must_be: &'static str,
    },
    /// No fixed step at this rate is stable.
    RateTooLow {
        /// Requested tick rate [Hz].
        given: u32,
        /// Lowest stable tick rate [Hz].
        lowest: u32,
    },
    /// Control rate too low for the bandwidth: the motor would oscillate in the open gap, or the gap not be estimated.
    ControlTooSlow {
        /// Requested control rate [Hz].
        given: u32,
        /// Bandwidth that was asked for [rad/s].
        bandwidth: f64,
        /// Lowest control rate that allows the bandwidth [Hz], if any.
        lowest: Option<u32>,
        /// Widest bandwidth at the control rate [rad/s].
        widest: f64,
    },
    /// Bandwidth above the limit at which the joint leaves the loop its stability margin.
    BandwidthTooWide {
        /// Bandwidth that was asked for [rad/s].
        bandwidth: f64,
        /// Widest bandwidth [rad/s].
        widest: f64,
        /// Property of the joint that limits it.
        limit: BandwidthLimit,
    },
    /// Method other than the board's requested for an equivalent gear.
    OneSchemeOnly,
    /// Effect of real joints that a virtual joint does not model.
    NoSuchEffect {
        /// Key of the effect in the joint file.
        key: &'static str,
    },
    /// Number outside the range of single precision.
    NotRepresentable {
        /// Name of the table.
        what: &'static str,
    },
}

/// Property of a joint that limits the bandwidth of its compensation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BandwidthLimit {
    /// First swing of the motor against the link in contact [rad/s].
    Swing(f64),
    /// Time in which the motor crosses the gap from rest to rest at its largest torque [s].
    Crossing(f64),
}

impl fmt::Display for BandwidthLimit {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Swing(frequency) => write!(formatter, "first swing of motor against link {frequency:.0} rad/s"),
            Self::Crossing(time) => write!(formatter, "the motor takes {:.1} ms to cross the gap", 1e3 * time),
        }
    }
}

impl fmt::Display for DesignError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameters(error) => error.fmt(formatter),
            Self::WrongPlanetCount { wanted, given } => {
                write!(formatter, "tables for {wanted} planets were asked for, but the joint has {given}")
            }
            Self::OutOfRange { what, given, must_be } => write!(formatter, "{what} is {given}: it must be {must_be}"),
            Self::NoSuchEffect { key } => {
                write!(
                    formatter,
                    "a virtual joint does not have `{key}`: leave it out, or run it with --plant reference"
                )
            }
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
            Self::BandwidthTooWide { bandwidth, widest, limit } => {
                write!(formatter, "bandwidth: {bandwidth} rad/s asked, {widest} at most: {limit}")
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
