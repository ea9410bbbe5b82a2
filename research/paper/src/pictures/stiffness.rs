//! Fig. 3: the rectangular wave, its first harmonic and its first eight.

use super::axes::{plain, points};
use crate::record::StiffnessFigure;
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::Panel;

/// Figure of the stiffness wave.
pub fn figure(data: &StiffnessFigure) -> Figure {
    let line = |values: &[f64], ink, label, width| Mark::line(points(&data.phase, values), ink, label, width);
    let marks = vec![
        line(&data.eight_harmonics, Ink::Reference, "first eight harmonics", 1.6),
        line(&data.rectangular, Ink::Second, "rectangular wave", 1.6),
        line(&data.first_harmonic, Ink::First, "first harmonic: eq. 7", 2.2),
    ];
    let panel = Panel { height: 240, ..Panel::lines("Mesh stiffness over its mean", plain("K / Kₘ"), marks) };
    let range = (0.0, data.phase.last().copied().unwrap_or(1.0));
    Figure::new("Mesh stiffness over two mesh periods", "mesh periods", plain(""), range, vec![panel])
}
