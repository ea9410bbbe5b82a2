//! Number formats: every number for a person is written here. Purposes differ in their digits and in the start of
//! powers of ten; each is a named [`Style`].

/// Number format of one purpose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Digits.
    pub digits: Digits,
    /// Format of whole numbers.
    pub whole: Whole,
    /// Uses true minus signs, and removes trailing zeros after the point.
    pub typeset: bool,
}

/// Number of digits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Digits {
    /// Significant digits for sizes within `from..below`; powers of ten outside.
    Significant {
        /// Significant digits.
        count: i32,
        /// Least size without a power of ten.
        from: f64,
        /// Size from which powers of ten are used.
        below: f64,
        /// Decimals before a power of ten.
        decimals: usize,
    },
    /// Fixed number of decimals.
    Fixed(usize),
    /// As many digits as the exact value needs; powers of ten outside `from..below`.
    All {
        /// Least size without a power of ten.
        from: f64,
        /// Size from which powers of ten are used.
        below: f64,
    },
}

/// Format of whole numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Whole {
    /// Like other numbers, zero included.
    Alike,
    /// Like other numbers, but zero is `0`.
    Zero,
    /// Without a point below this size.
    Plain(f64),
    /// Without a point below this size, in groups of three.
    Grouped(f64),
}

/// Pages: at most four digits, whole numbers in groups of three.
pub const PAGE: Style = Style {
    digits: Digits::Significant { count: 4, from: 1e-3, below: 1e7, decimals: 3 },
    whole: Whole::Grouped(1e7),
    typeset: true,
};
/// Terminals, with figures in columns: four digits, whole numbers without a point.
pub const TERMINAL: Style = Style {
    digits: Digits::Significant { count: 4, from: 0.01, below: f64::INFINITY, decimals: 2 },
    whole: Whole::Plain(1e15),
    typeset: false,
};
/// Estimates with intervals: always four digits, since a trailing zero is significant.
pub const ESTIMATE: Style = Style {
    digits: Digits::Significant { count: 4, from: 1e-3, below: 1e5, decimals: 3 },
    whole: Whole::Zero,
    typeset: false,
};
/// Derived quantities of a joint file: always five digits.
pub const DATA_SHEET: Style = Style {
    digits: Digits::Significant { count: 5, from: 1e-4, below: 1e6, decimals: 4 },
    whole: Whole::Zero,
    typeset: false,
};
/// Errors over many decades: two digits and a power of ten.
pub const SCIENTIFIC: Style = powers_of_ten(1);
/// Exact form: a number from the user is repeated as it was typed.
pub const TYPED: Style = Style { digits: Digits::All { from: 1e-6, below: 1e15 }, whole: Whole::Alike, typeset: false };

/// Fixed number of decimals.
pub const fn fixed(decimals: usize) -> Style {
    Style { digits: Digits::Fixed(decimals), whole: Whole::Alike, typeset: false }
}

/// Fixed number of decimals, with a power of ten.
pub const fn powers_of_ten(decimals: usize) -> Style {
    let digits = Digits::Significant { count: 1, from: f64::INFINITY, below: f64::INFINITY, decimals };
    Style { digits, whole: Whole::Alike, typeset: false }
}

impl Style {
    /// Formats a number.
    pub fn write(self, value: f64) -> String {
        if !value.is_finite() {
            return if value.is_nan() && self.typeset { "not a number".to_owned() } else { value.to_string() };
        }
        let size = value.abs();
        let text = match self.whole {
            Whole::Zero if size == 0.0 => return "0".to_owned(),
            Whole::Plain(most) if value.fract() == 0.0 && size < most => return value.to_string(),
            Whole::Grouped(most) if value.fract() == 0.0 && size < most => grouped(value),
            _ => self.with_digits(value),
        };
        if self.typeset { text.replace('-', "\u{2212}") } else { text }
    }

    fn with_digits(self, value: f64) -> String {
        let size = value.abs();
        match self.digits {
            Digits::Fixed(decimals) => format!("{value:.decimals$}"),
            Digits::All { from, below } if (from..below).contains(&size) || size == 0.0 => value.to_string(),
            Digits::All { .. } => format!("{value:e}"),
            Digits::Significant { count, from, below, .. } if (from..below).contains(&size) => {
                let decimals = (count - 1 - size.log10().floor() as i32).max(0) as usize;
                let text = format!("{value:.decimals$}");
                if self.typeset { trimmed(&text).to_owned() } else { text }
            }
            Digits::Significant { decimals, .. } => format!("{value:.decimals$e}"),
        }
    }
}

/// Removes trailing zeros after the point.
pub fn trimmed(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// Whole numbers in groups of three, with thin spaces.
fn grouped(value: f64) -> String {
    let digits = format!("{:.0}", value.abs());
    let mut text = String::from(if value < 0.0 { "-" } else { "" });
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_numbers_are_grouped() {
        assert_eq!(
            [0.0, 120_000.0, -3.0, 0.123_456, 14.0 / 3.0, 1.5e-9, -0.5, 1e8].map(|value| PAGE.write(value)),
            ["0", "120\u{202f}000", "\u{2212}3", "0.1235", "4.667", "1.500e\u{2212}9", "\u{2212}0.5", "1.000e8"]
        );
        assert_eq!(PAGE.write(f64::NAN), "not a number");
    }

    #[test]
    fn terminal_keeps_four_digits() {
        let figures = [0.0, 100_000.0, 12.345_67, 0.001_234_5, 4321.9, 0.25].map(|value| TERMINAL.write(value));
        assert_eq!(figures, ["0", "100000", "12.35", "1.23e-3", "4322", "0.2500"]);
        assert_eq!(TERMINAL.write(f64::NAN), "NaN");
    }

    #[test]
    fn estimates_keep_trailing_zeros() {
        assert_eq!([0.0, 40.0, 1e5, 1e-4].map(|value| ESTIMATE.write(value)), ["0", "40.00", "1.000e5", "1.000e-4"]);
        assert_eq!([0.0, 40.0, 1e6, 1e-4].map(|v| DATA_SHEET.write(v)), ["0", "40.000", "1.0000e6", "0.00010000"]);
        assert_eq!([0.0, 0.012_34].map(|value| SCIENTIFIC.write(value)), ["0.0e0", "1.2e-2"]);
        assert_eq!(fixed(2).write(1234.567), "1234.57");
    }

    #[test]
    fn typed_numbers_are_exact() {
        let texts = [0.0, -1.0, 0.25, 1e308, 1e-300, f64::NAN].map(|value| TYPED.write(value));
        assert_eq!(texts, ["0", "-1", "0.25", "1e308", "1e-300", "NaN"]);
    }
}
