//! A picture with the name of its file.

use report::plot::Figure;

/// A picture.
pub struct Picture {
    /// File name without its ending.
    pub name: String,
    /// What is drawn.
    pub figure: Figure,
}
