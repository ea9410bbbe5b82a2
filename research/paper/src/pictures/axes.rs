//! What stands at axes, and points between them.

use report::number::PAGE;
use report::plot::unit::Unit;

/// A number without unit; the name is what stands at the axis.
pub const fn plain(name: &'static str) -> Unit {
    Unit { factor: 1.0, name }
}

/// Points of two columns.
pub fn points(across: &[f64], up: &[f64]) -> Vec<(f64, f64)> {
    across.iter().copied().zip(up.iter().copied()).collect()
}

/// b in micrometres, without the noise of the way to metres and back.
pub fn micrometres(length: f64) -> String {
    PAGE.write((length * 1e9).round() / 1e3)
}
