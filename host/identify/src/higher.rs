//! An error of an encoder that comes more than twice a turn.

/// An encoder and how many times a turn of it an error comes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Higher {
    /// Place of its errors among the unknowns of `twist`.
    pub encoder: usize,
    /// Times a turn.
    pub order: f64,
}
