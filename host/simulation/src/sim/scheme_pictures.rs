//! Pictures of schemes: the energy balance, and the comparison of schemes. Data come from `energy` and `comparison`.

use super::comparison::Comparison;
use super::energy::BalanceEntry;
use super::pictures::View;
use super::plan::SimulationPlan;
use super::scheme::SchemeName;
use report::panels;
use report::panels::{BROAD, LINE};
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{DECIBELS, Unit, axis_range, greatest};

/// Smallest drawn error; smaller ones are rounding.
const SMALLEST_ERROR: f64 = 1e-8;

/// Stored energy and work, and the residual on its own scale.
pub fn energy(plan: &SimulationPlan, entries: &[BalanceEntry]) -> Figure {
    let joules = |most: f64| match most {
        most if most < 1e-6 => Unit { factor: 1e9, name: "nJ" },
        most if most < 1e-3 => Unit { factor: 1e6, name: "µJ" },
        most if most < 1.0 => Unit { factor: 1e3, name: "mJ" },
        _ => Unit { factor: 1.0, name: "J" },
    };
    let start = entries.first().map_or(0.0, |entry| entry.stored);
    let line = |value: &dyn Fn(&BalanceEntry) -> f64, ink: Ink, label: &str| {
        panels::line(entries.iter().map(|entry| (entry.time, value(entry))).collect(), ink, label)
    };
    let marks = vec![
        line(&|entry| entry.work.supplied, Ink::First, "supplied by torques"),
        line(&|entry| entry.work.dissipated, Ink::Second, "dissipated"),
        line(&|entry| entry.work.against_errors, Ink::Third, "against errors"),
        line(&|entry| entry.work.by_stiffness, Ink::Fourth, "by stiffness"),
        line(&|entry| entry.stored - start, Ink::Fifth, "stored"),
    ];
    let works = entries.iter().flat_map(|entry| [entry.work.supplied, entry.work.dissipated, entry.stored - start]);
    let account = Panel::lines("Energy since the start", joules(greatest(works)), marks);
    let residual = line(&|entry| entry.residual, Ink::Limit, "");
    let most = greatest(entries.iter().map(|entry| entry.residual));
    let residual = Panel { height: 150, ..Panel::lines("Residual of the balance", joules(most), vec![residual]) };
    let end = entries.last().map_or(1.0, |entry| entry.time);
    View { plan, samples: &[], range: (0.0, if end > 0.0 { end } else { 1.0 }) }
        .figure("Energy", vec![account, residual])
}

/// Colours of the schemes.
fn ink(scheme: SchemeName) -> Ink {
    match scheme {
        SchemeName::Reference => Ink::Reference,
        SchemeName::Realtime => Ink::First,
        SchemeName::Paper => Ink::Second,
        SchemeName::RungeKutta4 => Ink::Third,
        SchemeName::Euler => Ink::Fourth,
    }
}

/// One deflection by every scheme at the end of the predictable time, and the error of each scheme over all of it.
pub fn schemes(plan: &SimulationPlan, comparison: &Comparison) -> Vec<Figure> {
    let until = comparison.predictable_until();
    let length = (6.0 / plan.mesh_frequency()).min(until);
    let from = (until - length).max(0.0);
    let inside = |time: f64| (from..=until).contains(&time);
    // The axis fits the reference with a margin, so that an inaccurate scheme does not flatten the others.
    let exact = comparison.times().iter().zip(&comparison.tracks[0].columns[0]);
    let (low, high) = axis_range(exact.filter(|(time, _)| inside(**time)).map(|(_, value)| *value));
    let air = 0.5 * (high - low);
    let tracks = comparison.tracks.iter().map(|track| {
        let points = comparison.times().iter().zip(&track.columns[0]).filter(|(time, _)| inside(**time));
        let clipped = points.map(|(time, value)| (*time, value.clamp(low - air, high + air))).collect();
        let width = if track.scheme == SchemeName::Reference { BROAD } else { LINE };
        Mark::line(clipped, ink(track.scheme), track.scheme.name(), width)
    });
    let unit = Unit::of_length(greatest([low, high].into_iter()));
    let panel = Panel { height: 300, ..Panel::lines("Sun–planet deflection of planet 1", unit, tracks.collect()) };
    let view = |range| View { plan, samples: &[], range };
    let errors = comparison.tracks.iter().skip(1).map(|track| {
        let error = |(time, error): (f64, f64)| (time, 20.0 * error.max(SMALLEST_ERROR).log10());
        let points = comparison.error_over_time(track).into_iter().map(error).collect();
        panels::line(points, ink(track.scheme), track.scheme.name())
    });
    let title = "Error of that deflection over its standard deviation, RMS of short stretches";
    let errors = Panel { height: 300, ..Panel::lines(title, DECIBELS, errors.collect()) };
    let whole = (0.0, if until > 0.0 { until } else { 1.0 });
    let close = (from < until).then(|| view((from, until)).figure("Deflection by every scheme", vec![panel]));
    close.into_iter().chain([view(whole).figure("Error of every scheme", vec![errors])]).collect()
}
