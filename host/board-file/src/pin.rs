//! Pins of a chip by name, alone and in an alternate function.

use std::fmt;
use std::str::FromStr;

/// A pin, such as PA9.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pin {
    /// Port: 0 for A, 1 for B, up to 10 for K.
    pub port: u8,
    /// Number in the port, up to 15.
    pub number: u8,
}

/// Pin in the alternate function that connects it to a peripheral.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Alternate {
    /// The pin.
    pub pin: Pin,
    /// Number of the alternate function, 0 to 15.
    pub function: u8,
}

/// Letter of the last port.
const LAST_PORT: u8 = b'K';

impl Pin {
    /// Letter of the port.
    pub const fn letter(self) -> char {
        (b'A' + self.port) as char
    }

    /// Parses a pin's name: `P`, the port's letter, a number without leading zeros.
    pub const fn named(name: &[u8]) -> Option<Self> {
        let (letter, number) = match name {
            [b'P', letter, ones @ b'0'..=b'9'] => (*letter, *ones - b'0'),
            [b'P', letter, b'1', ones @ b'0'..=b'5'] => (*letter, 10 + *ones - b'0'),
            _ => return None,
        };
        match letter {
            b'A'..=LAST_PORT => Some(Self { port: letter - b'A', number }),
            _ => None,
        }
    }
}

impl fmt::Display for Pin {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "P{}{}", self.letter(), self.number)
    }
}

/// Error for a text that is no pin's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct InvalidPinName;

impl fmt::Display for InvalidPinName {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("no pin: want a name such as PA9")
    }
}

impl std::error::Error for InvalidPinName {}

impl FromStr for Pin {
    type Err = InvalidPinName;

    fn from_str(text: &str) -> Result<Self, InvalidPinName> {
        Self::named(text.as_bytes()).ok_or(InvalidPinName)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pin is printed as it was parsed.
    #[test]
    fn pin_names_round_trip() {
        for name in ["PA0", "PA9", "PB10", "PC15", "PK7"] {
            assert_eq!(name.parse::<Pin>().expect(name).to_string(), name);
        }
        assert_eq!("PD2".parse(), Ok(Pin { port: 3, number: 2 }));
    }

    /// Texts that are no pin's name are rejected.
    #[test]
    fn invalid_pin_names_rejected() {
        for text in ["", "P", "PA", "A9", "pa9", "PA16", "PA09", "PA-1", "PL0", "PA9 ", "P\u{e4}1", "GPIOA9"] {
            assert_eq!(text.parse::<Pin>(), Err(InvalidPinName), "{text}");
        }
    }
}
