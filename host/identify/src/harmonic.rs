//! Encoder error of more than twice a turn.

/// Encoder and order of one of its errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// First unknown of the encoder's errors in `twist`.
    pub encoder: usize,
    /// Periods per turn.
    pub order: f64,
}
