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
    /// The bandwidth exceeds the one up to which the joint itself lets the loop keep its margin.
    BandwidthTooWide {
        /// Bandwidth that was asked for [rad/s].
        bandwidth: f64,
        /// The widest bandwidth that works [rad/s].
        widest: f64,
        /// Property of the joint that limits it.
        limit: BandwidthLimit,
    },
    /// A scheme of planets' meshes for a gear without them.
    OneSchemeOnly,
    /// An effect of real joints that a virtual joint does not have.
    NoSuchEffect {
        /// Key of the joint file that states it.
        key: &'static str,
    },
    /// A number does not fit into single precision.
    NotRepresentable {
        /// Which table.
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
