//! Figs 4 and 5: the dead zone with its smoothed forms, and their errors.

use super::axes::{plain, points};
use crate::record::{DeadZoneError, DeadZoneFigure};
use report::number::PAGE;
use report::plot::ink::{Ink, LINES};
use report::plot::mark::Mark;
use report::plot::panel::{Panel, VerticalAxis};
use report::plot::{Figure, HorizontalAxis, Shape};

/// Half the page.
const HALF: Shape = Shape { width: 540, left: 64 };

/// f(x, b): sharp, smoothed and as printed.
pub fn curves(data: &DeadZoneFigure) -> Figure {
    let line =
        |values: &[f64], ink, label: String, width| Mark::line(points(&data.deflection, values), ink, label, width);
    let mut marks = vec![line(&data.sharp, Ink::Reference, "eq. 12".into(), 5.0)];
    for (smoothed, ink) in data.smoothed.iter().zip([LINES[0], LINES[2], LINES[3]]) {
        marks.push(line(&smoothed.force, ink, format!("σ = {}", PAGE.write(smoothed.sharpness)), 1.5));
    }
    marks.push(line(&data.printed, Ink::Limit, "as printed".into(), 1.5));
    let ends = (data.deflection.first().copied().unwrap_or(-1.0), data.deflection.last().copied().unwrap_or(1.0));
    let axis = format!("deflection x over b_c; half-backlash b = {}", PAGE.write(data.half_backlash));
    let panel = Panel { height: 290, ..Panel::lines("f(x, b)", plain("f"), marks) };
    let title = "Dead zone, sharp, smoothed and as printed";
    Figure { shape: HALF, ..Figure::new(title, axis, plain(""), ends, vec![panel]) }
}

/// Largest distance from the sharp dead zone by sharpness.
pub fn errors(data: &DeadZoneFigure) -> Figure {
    let line = |value: fn(&DeadZoneError) -> f64, ink, label| {
        Mark::line(data.errors.iter().map(|error| (error.sharpness, value(error))).collect(), ink, label, 2.0)
    };
    let marks = vec![
        line(|error| error.corrected, Ink::First, "eq. 13 corrected"),
        line(|error| error.printed, Ink::Limit, "as printed"),
    ];
    let sharpness = |error: Option<&DeadZoneError>| error.map_or(1.0, |error| error.sharpness);
    let panel = Panel {
        height: 290,
        axis: VerticalAxis::Decades { from: -5, to: 1 },
        ..Panel::lines("Largest error of f", plain("distance from eq. 12"), marks)
    };
    let range = (sharpness(data.errors.first()), sharpness(data.errors.last()));
    let title = "Largest error of the smoothed dead zone by sharpness";
    let figure = Figure::new(title, "sharpness σ", plain(""), range, vec![panel]);
    Figure { runs: HorizontalAxis::Decades, shape: HALF, ..figure }
}
