//! The bifurcation diagram with the Lyapunov exponent below it. Points that would coincide are drawn once.

use super::axes::plain;
use super::picture::Picture;
use crate::record::{Class, Reading, Sweep, SweepPoint};
use report::folder::file_part;
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::Unit;

/// Number of distinguishable heights.
const ROWS: f64 = 350.0;

const MICROMETRES: Unit = Unit { factor: 1e6, name: "µm" };

/// Picture of a sweep.
pub fn diagram(reading: &Reading, sweep: &Sweep) -> Picture {
    let ends = (
        sweep.points.first().map_or(0.0, |point| point.half_backlash_m),
        sweep.points.last().map_or(1e-6, |point| point.half_backlash_m),
    );
    let air = if ends.1 > ends.0 { 0.004 * (ends.1 - ends.0) } else { 1e-6 };
    let values = extremes(sweep.points.iter().flat_map(|point| point.x_sp.iter().copied()));
    let exponents = extremes(sweep.points.iter().map(|point| point.exponent).chain([0.0]));
    let mut upper = guides(reading, values);
    upper.extend(classes(sweep, values));
    let mut lower = guides(reading, exponents);
    lower.push(Mark::line(vec![(ends.0 - air, 0.0), (ends.1 + air, 0.0)], Ink::Axis, "", 1.2));
    let curve = sweep.points.iter().map(|point| (point.half_backlash_m, point.exponent)).collect();
    lower.push(Mark::line(curve, Ink::Fourth, "", 1.6));
    let title = format!("Bifurcation diagram of {}, start {}", reading.joint, sweep.start);
    let panels = vec![
        Panel { height: 380, ..Panel::lines("X_sp at the Poincaré sections", plain("X_sp"), upper) },
        Panel { height: 190, ..Panel::lines("Largest Lyapunov exponent", plain("1 / τ"), lower) },
    ];
    let figure = Figure::new(title, "half-backlash b", MICROMETRES, (ends.0 - air, ends.1 + air), panels);
    Picture { name: format!("bifurcation-{}-{}", file_part(&reading.joint), sweep.start), figure }
}

fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// Vertical lines at the half-backlashes of Figs 5 to 8.
fn guides(reading: &Reading, range: (f64, f64)) -> Vec<Mark> {
    let at = |b: f64| Mark::line(vec![(b, range.0), (b, range.1)], Ink::Reference, "", 1.0);
    reading.attractors.iter().map(|attractor| at(attractor.half_backlash_m)).collect()
}

fn classes(sweep: &Sweep, range: (f64, f64)) -> Vec<Mark> {
    let of = |wanted: fn(Class) -> bool, ink: Ink, label: &str, size: f64| {
        let own = sweep.points.iter().filter(|point| wanted(point.class));
        let points: Vec<(f64, f64)> = own.flat_map(|point| spots(point, range)).collect();
        (!points.is_empty()).then(|| Mark::Points { points, ink, label: label.to_owned(), size })
    };
    let marks = [
        of(|class| matches!(class, Class::Periodic(_)), Ink::First, "periodic", 2.5),
        of(|class| class == Class::Chaotic, Ink::Second, "chaotic", 1.75),
        of(|class| class == Class::Unsettled, Ink::Third, "no period found", 1.75),
    ];
    marks.into_iter().flatten().collect()
}

fn spots(point: &SweepPoint, range: (f64, f64)) -> Vec<(f64, f64)> {
    let height = ((range.1 - range.0) / ROWS).max(1e-9);
    let mut rows: Vec<i64> = point.x_sp.iter().map(|x| ((x - range.0) / height).floor() as i64).collect();
    rows.sort_unstable();
    rows.dedup();
    rows.into_iter().map(|row| (point.half_backlash_m, range.0 + (row as f64 + 0.5) * height)).collect()
}
