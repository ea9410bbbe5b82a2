//! A picture with the name of its file.

use report::plot::Figure;

/// A picture.
pub struct Picture {
    /// File name without its extension.
    pub name: String,
    /// Figure to draw.
    pub figure: Figure,
}
