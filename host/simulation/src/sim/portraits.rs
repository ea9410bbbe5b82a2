//! Phase portraits with their Poincare points, and the spectrum. `statistics` and `spectrum` compute points and
//! amplitudes.

use super::plan::SimulationPlan;
use super::snapshot::Snapshot;
use super::statistics::PoincarePoint;
use report::panels::line;
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{DECIBELS, Unit, axis_range, greatest};
use report::spectrum::Spectrum;

/// Samples drawn in a phase portrait under constant torques; more would only blacken it.
const PORTRAIT_SAMPLES: usize = 6000;
/// Samples drawn in a phase portrait under a profile, which shows the whole run.
const PROFILE_PORTRAIT_SAMPLES: usize = 20_000;
/// Least distance between drawn samples over the picture's size; larger if there are too many samples.
const MIN_DISTANCE: f64 = 1e-3;
/// Size of a Poincare point over the size of the picture, for few points and for many.
const LARGE_POINT: [f64; 2] = [0.0085, 0.024];
const SMALL_POINT: [f64; 2] = [0.0042, 0.012];
/// Largest period that is shown with large points.
const LARGE_POINT_PERIODS: usize = 8;

/// Motion of a phase portrait.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Portrait {
    /// Sun-planet deflection of planet 1.
    Deflection,
    /// Gap coordinate.
    Gap,
}

/// Rate over position of the last samples, with the Poincare points.
pub fn portrait(
    plan: &SimulationPlan,
    samples: &[Snapshot],
    (points, period): (&[PoincarePoint], Option<usize>),
    which: Portrait,
) -> Figure {
    let samples = if plan.constant { &samples[samples.len().saturating_sub(PORTRAIT_SAMPLES)..] } else { samples };
    let of = |snapshot: &Snapshot| match which {
        Portrait::Deflection => (snapshot.teeth[0].deflection, snapshot.teeth[0].rate),
        Portrait::Gap => (snapshot.gap, snapshot.gap_rate),
    };
    let of_point = |point: &PoincarePoint| match which {
        Portrait::Deflection => (point.deflection, point.rate),
        Portrait::Gap => (point.gap, point.gap_rate),
    };
    let mut curve: Vec<(f64, f64)> = samples.iter().map(of).collect();
    let range = axis_range(curve.iter().map(|point| point.0));
    let up = axis_range(curve.iter().map(|point| point.1));
    if !plan.constant {
        curve = thinned(curve, (range.1 - range.0, up.1 - up.0));
    }
    let size = if period.is_some_and(|period| period <= LARGE_POINT_PERIODS) { LARGE_POINT } else { SMALL_POINT };
    let (half_width, half_height) = (0.5 * size[0] * (range.1 - range.0), 0.5 * size[1] * (up.1 - up.0));
    let dot = |point: &PoincarePoint| {
        let (x, y) = of_point(point);
        [x - half_width, x + half_width, y - half_height, y + half_height]
    };
    let inside = |point: &&PoincarePoint| {
        let (x, y) = of_point(point);
        (range.0..=range.1).contains(&x) && (up.0..=up.1).contains(&y)
    };
    // A periodic motion hits few points again and again: one dot for each point is enough.
    let mut boxes: Vec<[f64; 4]> = Vec::new();
    for dot in points.iter().filter(inside).map(dot) {
        let near = |other: &[f64; 4]| {
            (other[0] - dot[0]).abs() < 0.1 * half_width && (other[2] - dot[2]).abs() < 0.1 * half_height
        };
        if !boxes.iter().any(near) {
            boxes.push(dot);
        }
    }
    let label = if points.is_empty() { "" } else { "once a mesh period" };
    let (title, axis) = match which {
        Portrait::Deflection => ("Phase portrait, sun–planet deflection of planet 1", "deflection"),
        Portrait::Gap => ("Phase portrait, gap coordinate", "gap"),
    };
    let most = greatest(curve.iter().map(|point| point.1));
    let unit = if most < 1.0 { Unit { factor: 1e3, name: "mm/s" } } else { Unit { factor: 1.0, name: "m/s" } };
    let marks = vec![Mark::line(curve, Ink::Bar, "", 1.0), Mark::Boxes { boxes, ink: Ink::Limit, label: label.into() }];
    let panel = Panel { height: 380, ..Panel::lines(format!("{title}: rate"), unit, marks) };
    let across = Unit::of_length(greatest([range.0, range.1].into_iter()));
    Figure::new(format!("{title} of joint {}", plan.parameters().name), axis, across, range, vec![panel])
}

/// Removes samples close to the previous one: a rest becomes one point, fast motion keeps every sample.
fn thinned(curve: Vec<(f64, f64)>, (width, height): (f64, f64)) -> Vec<(f64, f64)> {
    let mut near = MIN_DISTANCE;
    loop {
        let mut kept: Vec<(f64, f64)> = Vec::new();
        for point in &curve {
            let is_new =
                |last: &(f64, f64)| (point.0 - last.0).abs() > near * width || (point.1 - last.1).abs() > near * height;
            if kept.last().is_none_or(is_new) {
                kept.push(*point);
            }
        }
        if kept.len() <= PROFILE_PORTRAIT_SAMPLES {
            return kept;
        }
        near *= 2.0;
    }
}

/// Amplitudes in decibels over a micrometre, up to the highest drawn harmonic of the mesh frequency.
pub fn spectrum(plan: &SimulationPlan, spectrum: &Spectrum) -> Figure {
    let mesh = plan.mesh_frequency();
    let top = spectrum.step * spectrum.amplitudes.len() as f64;
    let end = if mesh > 0.0 { top.min(8.5 * mesh) } else { top };
    // Below a picometre there is only rounding.
    let decibels = |amplitude: f64| 20.0 * (1e6 * amplitude).max(1e-6).log10();
    let shown = (end / spectrum.step) as usize;
    let points = spectrum.amplitudes.iter().take(shown).enumerate();
    let points = points.map(|(place, amplitude)| (place as f64 * spectrum.step, decibels(*amplitude))).collect();
    let mut marks = Vec::new();
    if mesh > 0.0 && mesh < end {
        marks.push(Mark::Deadline { at: mesh, label: "mesh frequency".into() });
    }
    marks.push(line(points, Ink::First, ""));
    let unit = if end < 2e3 { Unit { factor: 1.0, name: "Hz" } } else { Unit { factor: 1e-3, name: "kHz" } };
    let title = "Spectrum of the sun–planet deflection of planet 1";
    let panel = Panel { height: 260, ..Panel::lines(format!("{title}, over 1 µm"), DECIBELS, marks) };
    Figure::new(format!("{title} of joint {}", plan.parameters().name), "frequency", unit, (0.0, end), vec![panel])
}
