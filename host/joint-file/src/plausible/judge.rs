//! Judgement of a figure by two ranges: outside of the inner one a joint is odd, outside of the outer one impossible.

use crate::notes::Notes;
use crate::problem::Severity;

/// Collects complaints.
pub(super) struct Judge<'n> {
    pub notes: &'n Notes<'n>,
    /// True if impossible figures are accepted with a warning.
    pub lenient: bool,
}

/// Ranges of a figure: outside of `odd` it gives a warning, outside of `possible` an error.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub odd: (f64, f64),
    pub possible: (f64, f64),
}

/// No limit.
pub(super) const UNLIMITED: f64 = f64::INFINITY;

impl Limits {
    /// Limits a figure from above.
    pub(super) const fn above(odd: f64, possible: f64) -> Self {
        Self { odd: (-UNLIMITED, odd), possible: (-UNLIMITED, possible) }
    }

    /// Severity of a figure; `None` within both ranges.
    fn severity(self, figure: f64) -> Option<Severity> {
        let outside = |(low, high): (f64, f64)| figure < low || high < figure;
        match figure {
            _ if outside(self.possible) => Some(Severity::Error),
            _ if outside(self.odd) => Some(Severity::Warning),
            _ => None,
        }
    }
}

impl Judge<'_> {
    /// Judges a figure of the first of `keys` in the file; `complaint` gives message and help from the excess (true if
    /// too large) and the key's name. A derived value is no typing error: the help names its origin instead. Returns
    /// true after a complaint.
    pub(super) fn check_figure(
        &self,
        keys: &[&str],
        figure: f64,
        limits: Limits,
        complaint: impl Fn(bool, &str) -> (String, String),
    ) -> bool {
        let Some(severity) = limits.severity(figure) else { return false };
        let (key, place) = self.notes.first_held(keys);
        let name = key.rsplit('.').next().unwrap_or(key);
        let (message, help) = complaint(figure > limits.odd.1, name);
        let help = match self.notes.derived_from(key) {
            Some(from) => format!("it was derived from {from}; check that, or give the value of a drawing"),
            None => help,
        };
        let severity = if self.lenient { Severity::Warning } else { severity };
        self.notes.problem(place, message, help, severity);
        true
    }
}

/// Figure with three digits, as a person would write it.
pub(super) fn figure(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || !(1e-3..1e5).contains(&size) {
        return if value == 0.0 { "0".to_owned() } else { format!("{value:.2e}") };
    }
    let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::figure;

    #[test]
    fn figure_has_three_digits() {
        let shown = [0.0, 12345.6, 1.2345, 0.01234, 1.5e-7, 2e9].map(figure);
        assert_eq!(shown, ["0", "12346", "1.23", "0.0123", "1.50e-7", "2.00e9"]);
    }
}
