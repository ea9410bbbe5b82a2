//! Units and labels of axes, and points of curves.

use report::number::PAGE;
use report::plot::unit::Unit;

/// Dimensionless number with its axis label.
pub const fn plain(name: &'static str) -> Unit {
    Unit { factor: 1.0, name }
}

/// Points of two columns.
pub fn points(across: &[f64], up: &[f64]) -> Vec<(f64, f64)> {
    across.iter().copied().zip(up.iter().copied()).collect()
}

/// Half-backlash in micrometres, without the rounding noise of the conversion to metres and back.
pub fn micrometres(length: f64) -> String {
    PAGE.write((length * 1e9).round() / 1e3)
}
