//! Pictures of the results: lost motion over the place, difference by direction, error map, and residuals of the model.

use super::loading::Loading;
use super::results::Results;
use report::plot::Figure;
use report::plot::ink::{Ink, LINES};
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{SECONDS, Unit};

/// All pictures with their file names.
pub fn all(results: &Results) -> Vec<(&'static str, Figure)> {
    let Results { profiles, width, map, prediction, groups, levels, loading, hysteresis, .. } = results;
    let unit = match results.scale.degrees() {
        Some(factor) => Unit { factor, name: "deg" },
        None => Unit { factor: 1.0, name: "units" },
    };
    let (first, last) = (profiles.places[0], profiles.places[profiles.places.len() - 1]);
    let range = (first - 0.5 * profiles.width, last + 0.5 * profiles.width);
    let over =
        |values: &[f64]| -> Vec<(f64, f64)> { profiles.places.iter().copied().zip(values.iter().copied()).collect() };
    let line = |values: &[f64], ink: Ink, label: &str, width: f64| Mark::line(over(values), ink, label, width);
    let figure = |title: &str, panels: Vec<Panel>| Figure::new(title, "output", unit, range, panels);
    let interval = |low: &[f64], high: &[f64], label: &str| Mark::Boxes {
        boxes: boxes(&profiles.places, profiles.width, low, high),
        ink: Ink::Band,
        label: label.into(),
    };
    let name = if loading.groups() == 4 { "Lost motion" } else { "Width by direction" };
    let zero = Mark::line(vec![(range.0, 0.0), (range.1, 0.0)], Ink::Axis, "", 1.0);
    let panel = Panel {
        height: 260,
        ..Panel::lines(
            name,
            unit,
            vec![
                interval(&width.low, &width.high, "95 % interval"),
                zero,
                line(&width.value, Ink::First, "mean of the passes", 2.0),
            ],
        )
    };
    let mut panels = vec![panel];
    if !hysteresis.is_empty() {
        let lines = hysteresis.iter().zip(loading.names()).zip(LINES);
        let lines = lines.map(|((curve, name), ink)| line(&curve.value, ink, name, 1.6));
        let zero = Mark::line(vec![(range.0, 0.0), (range.1, 0.0)], Ink::Axis, "", 1.0);
        panels.push(Panel::lines("Hysteresis", unit, [zero].into_iter().chain(lines).collect()));
    }
    let lost_motion = figure(&format!("{name} over the place"), panels);

    let middle = groups.iter().flatten().sum::<f64>() / groups.iter().map(Vec::len).sum::<usize>() as f64;
    let marks = groups.iter().enumerate().map(|(group, values)| {
        let values: Vec<f64> = values.iter().map(|value| value - middle).collect();
        let way = ["forwards", "backwards"][group % 2];
        let label = match loading {
            Loading::ByHalf | Loading::ByTorque => format!("{way}, {}", loading.names()[group / 2]),
            _ => way.to_owned(),
        };
        line(&values, LINES[group], &label, 1.6)
    });
    let panel = Panel { height: 320, ..Panel::lines("Output less motor, without its mean", unit, marks.collect()) };
    let difference = figure("Output less motor by direction", vec![panel]);

    let long = Panel::lines(
        "Error map",
        unit,
        vec![
            line(&map.whole, Ink::First, "mean of all groups", 1.6),
            line(&map.long_wave, Ink::Second, "long wave", 2.0),
        ],
    );
    let ripple = Panel { height: 170, ..Panel::lines("Ripple", unit, vec![line(&map.ripple, Ink::Third, "", 1.6)]) };
    let map = figure("Error map of output against motor", vec![long, ripple]);

    let at = |index: usize| -> Vec<f64> { prediction.residuals.iter().map(|one| one[index]).collect() };
    let left = Panel::lines(
        "Residual of a map and one width in unseen passes",
        unit,
        vec![interval(&at(1), &at(2), "10 to 90 % of the passes"), line(&at(0), Ink::First, "mean", 1.6)],
    );
    let marks = prediction.systematic.iter().enumerate().map(|(group, values)| line(values, LINES[group], "", 1.6));
    let by_group = Panel::lines("Systematic part per direction and load", unit, marks.collect());
    let residual = figure("Residuals of the model", vec![left, by_group]);

    let points = Mark::Points { points: levels.clone(), ink: Ink::First, label: String::new(), size: 6.0 };
    let end = profiles.all.iter().map(|one| one.time[2]).fold(0.0, f64::max);
    let panel = Panel::lines("Mean of each pass about its group's mean", unit, vec![points]);
    let drift = Figure::over_time("How passes repeat", SECONDS, (0.0, end), vec![panel]);
    vec![
        ("lost-motion.svg", lost_motion),
        ("difference.svg", difference),
        ("error-map.svg", map),
        ("left-over.svg", residual),
        ("passes.svg", drift),
    ]
}

fn boxes(places: &[f64], width: f64, low: &[f64], high: &[f64]) -> Vec<[f64; 4]> {
    let ends = low.iter().zip(high).map(|(low, high)| (*low, *high));
    let finite = places.iter().zip(ends).filter(|(_, (low, high))| low.is_finite() && high.is_finite());
    finite.map(|(place, (low, high))| [place - 0.5 * width, place + 0.5 * width, low, high]).collect()
}
