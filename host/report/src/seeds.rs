//! Seeds as an argument: one seed, or a range.

use std::fmt::{self, Display, Formatter};
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Range of seeds, inclusive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seeds {
    /// First seed.
    pub first: u64,
    /// Last seed.
    pub last: u64,
}

/// Largest number of seeds of a run; more are likely a typing error.
pub const MAX_SEEDS: u64 = 10_000;

impl Seeds {
    /// All seeds in order.
    pub fn each(self) -> RangeInclusive<u64> {
        self.first..=self.last
    }
}

impl FromStr for Seeds {
    type Err = String;

    /// Parses `7`, or `1-10000`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (first, last) = text.split_once('-').filter(|(first, _)| !first.is_empty()).unwrap_or((text, text));
        let [Ok(first), Ok(last)] = [first, last].map(str::parse) else {
            return Err(format!("a seed is a whole number from 0 to {}, several are written as 1-200", u64::MAX));
        };
        match last {
            last if last < first => Err(format!("the range of seeds {first}-{last} is empty")),
            last if last - first >= MAX_SEEDS => Err(format!("at most {MAX_SEEDS} seeds are possible")),
            last => Ok(Self { first, last }),
        }
    }
}

impl Display for Seeds {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self { first, last } if first == last => write!(formatter, "{first}"),
            Self { first, last } => write!(formatter, "{first}-{last}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_parse_number_or_range() {
        let read = |text: &str| text.parse::<Seeds>().map(|seeds| (seeds.first, seeds.last));
        assert_eq!(read("7"), Ok((7, 7)));
        assert_eq!(read("201-400"), Ok((201, 400)));
        for wrong in ["", "-1", "7-", "9-8", "1-2-3", "0-10000", "all"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
        for text in ["7", "201-400"] {
            assert_eq!(text.parse::<Seeds>().map(|seeds| seeds.to_string()), Ok(text.to_owned()));
        }
    }
}
