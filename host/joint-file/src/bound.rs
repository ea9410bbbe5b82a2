//! Units of keys, and the range of a value in the key's unit. `keys` assigns both to the keys.

use crate::sheet::ARCMIN;

/// Unit in a key's name, with its conversion to SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unit {
    /// SI, or a pure number.
    Si,
    /// mm or ms.
    Milli,
    /// um or us.
    Micro,
    /// Degrees of angle.
    Degrees,
    /// Minutes of arc.
    Arcmin,
    /// Torque per minute of arc.
    PerArcmin,
    /// kg cm^2.
    SquareCentimetres,
}

impl Unit {
    /// Converts to SI. Division makes 40 um the double nearest to 40e-6 m.
    pub(crate) fn to_si(self, value: f64) -> f64 {
        match self {
            Self::Si => value,
            Self::Milli => value / 1e3,
            Self::Micro => value / 1e6,
            Self::Degrees => value.to_radians(),
            Self::Arcmin => value * ARCMIN,
            Self::PerArcmin => value / ARCMIN,
            Self::SquareCentimetres => value / 1e4,
        }
    }
}

/// Range of a number in the unit of its key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Bound {
    /// Both ends allowed.
    Between(f64, f64),
    /// Neither end allowed.
    Inside(f64, f64),
    /// Lower end allowed, upper end not.
    FromToBelow(f64, f64),
    /// 0, or within the range with both ends.
    ZeroOr(f64, f64),
}

impl Bound {
    /// Returns true if the value is within the range; false for NaN.
    pub(crate) fn holds(self, value: f64) -> bool {
        match self {
            Self::Between(low, high) => low <= value && value <= high,
            Self::Inside(low, high) => low < value && value < high,
            Self::FromToBelow(low, high) => low <= value && value < high,
            Self::ZeroOr(low, high) => value == 0.0 || low <= value && value <= high,
        }
    }

    /// Text that completes the sentence "... must be".
    pub(crate) fn text(self) -> String {
        match self {
            Self::Between(low, high) => format!("between {} and {}", plain(low), plain(high)),
            Self::Inside(low, high) => format!("greater than {} and less than {}", plain(low), plain(high)),
            Self::FromToBelow(low, high) => format!("at least {} and less than {}", plain(low), plain(high)),
            Self::ZeroOr(low, high) => format!("0, or between {} and {}", plain(low), plain(high)),
        }
    }
}

/// Number as a person would write it.
fn plain(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e4).contains(&value.abs()) { format!("{value:e}") } else { format!("{value}") }
}
