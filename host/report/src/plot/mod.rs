//! Pictures as SVG text: panels one above the other over a common horizontal axis, drawn by `plotters`.

mod canvas;
mod compact;
mod figure;
pub mod ink;
pub mod mark;
pub mod panel;
mod thin;
pub mod unit;

pub use canvas::{HorizontalAxis, Shape};
pub use figure::Figure;
