//! Figs 5 to 8: time history, phase portrait with Poincare points, and spectrum of X_sp.

use super::axes::{micrometres, plain, points};
use super::picture::Picture;
use crate::record::{AttractorRecord, Class, Reading};
use report::folder::file_part;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::{Panel, VerticalAxis};
use report::plot::unit::axis_range;
use report::plot::{Figure, Shape};

/// Height of each picture [px].
const HEIGHT: i32 = 250;

/// Periods of the time history.
const PERIODS: f64 = 18.0;

/// Highest multiple of the mesh frequency in the spectrum.
const HIGHEST: f64 = 4.5;

/// The three pictures of one attractor.
pub fn regime(reading: &Reading, attractor: &AttractorRecord) -> [Picture; 3] {
    let b = micrometres(attractor.half_backlash_m);
    let name = |what: &str| format!("attractor-{}-b{}-{what}", file_part(&reading.joint), file_part(&b));
    [
        Picture { name: name("history"), figure: history(attractor, &b) },
        Picture { name: name("portrait"), figure: portrait(attractor, &b) },
        Picture { name: name("spectrum"), figure: spectrum(attractor, &b) },
    ]
}

fn figure(title: String, axis: &str, range: (f64, f64), width: i32, panel: Panel) -> Figure {
    let panels = vec![Panel { height: HEIGHT, ..panel }];
    Figure { shape: Shape { width, left: 58 }, ..Figure::new(title, axis, plain(""), range, panels) }
}

fn history(attractor: &AttractorRecord, b: &str) -> Figure {
    let history = &attractor.history;
    let shown = points(&history.periods, &history.x_sp).into_iter().filter(|point| point.0 <= PERIODS).collect();
    let marks = vec![Mark::line(shown, Ink::First, "", 1.3)];
    let panel = Panel::lines(format!("b = {b} µm: {}", attractor.class), plain("X_sp"), marks);
    figure(format!("Time history at b = {b} µm"), "mesh periods", (0.0, PERIODS), 400, panel)
}

fn portrait(attractor: &AttractorRecord, b: &str) -> Figure {
    let history = &attractor.history;
    // A closed curve is drawn once; an open one is drawn over the whole record, in a thinner line.
    let (cycles, width) = match attractor.class {
        Class::Periodic(period) => (period as f64, 1.6),
        _ => (f64::INFINITY, 0.5),
    };
    let until = history.periods.iter().take_while(|time| **time <= cycles + 0.02).count();
    let curve = points(&history.x_sp[..until], &history.x_sp_rate[..until]);
    let section: Vec<(f64, f64)> = attractor.poincare_points.iter().map(|point| (point[0], point[2])).collect();
    let range = axis_range(curve.iter().chain(&section).map(|point| point.0));
    let size = if section.len() > 24 { 2.5 } else { 7.0 };
    let marks = vec![
        Mark::line(curve, Ink::First, "", width),
        Mark::Points { points: section, ink: Ink::Limit, label: "Poincaré".into(), size },
    ];
    let panel = Panel::lines("Phase portrait", plain("X_sp′"), marks);
    figure(format!("Phase portrait at b = {b} µm"), "X_sp", range, 330, panel)
}

fn spectrum(attractor: &AttractorRecord, b: &str) -> Figure {
    let spectrum = &attractor.spectrum;
    let shown = spectrum.over_mesh_frequency.iter().take_while(|frequency| **frequency <= HIGHEST).count();
    let lines = points(&spectrum.over_mesh_frequency[..shown], &spectrum.amplitude);
    let marks = vec![Mark::line(lines, Ink::First, "", 1.0)];
    let axis = VerticalAxis::Decades { from: -4, to: 2 };
    let panel = Panel { axis, ..Panel::lines("Spectrum of X_sp", plain("amplitude"), marks) };
    figure(format!("Spectrum at b = {b} µm"), "frequency over mesh frequency", (0.0, HIGHEST), 380, panel)
}
