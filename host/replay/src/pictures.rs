//! Pictures of a replay: gap, flank and validity, estimated width, load and torque, over the whole log and around its
//! last change of flank.

use crate::pass::{Interval, Pass, Point};
use crate::record::ReplayRecord;
use report::contacts::Contact;
use report::panels::{Points, line};
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::{Panel, VerticalAxis};
use report::plot::unit::{SECONDS, TORQUE, Unit};

/// Time shown before and after the change of flank [s].
const CLOSE_UP_TIME: f64 = 0.05;
/// Width of the lines of an interval [px].
const INTERVAL_LINE_WIDTH: f64 = 0.7;
/// Coloured share of a row's height.
const STRIP_HEIGHT: f64 = 0.7;
/// Rows of states.
const STATE_ROWS: [&str; 3] = ["side", "gap", "encoders"];
/// Strips over the whole width; more cannot be distinguished.
const STRIPS_MAX: usize = 600;
/// Reach of the axes beyond the values, in last half-intervals: the prior intervals are much wider.
const AXIS_REACH: f64 = 40.0;

/// All pictures.
pub fn all(pass: &Pass<'_>, record: &ReplayRecord) -> Vec<Figure> {
    let points = &pass.points;
    let end = points.last().map_or(0.0, |point| point.time);
    let mut figures = vec![view(points, (0.0, end.max(1e-6)), format!("The observer over {}", record.log))];
    let landed = |pair: &[Point]| pair[0].side != pair[1].side && pair[1].side != Contact::Separated;
    if let Some(place) = points.windows(2).rposition(landed) {
        let time = points[place].time;
        let range = ((time - CLOSE_UP_TIME).max(0.0), (time + CLOSE_UP_TIME).min(end));
        let from = points.partition_point(|point| point.time < range.0);
        let to = points.partition_point(|point| point.time <= range.1);
        if to > from + 10 {
            figures.push(view(&points[from..to], range, "The last landing on a flank".to_owned()));
        }
    }
    figures
}

fn view(points: &[Point], range: (f64, f64), title: String) -> Figure {
    let span = range.1 - range.0;
    let half = points.last().map_or(0.0, |point| 2.0 * point.half_backlash.value);
    let band = Mark::Band { range: (-half, half), label: "estimated free gap (4b)".into() };
    let gap = interval(points, |point| point.gap, Ink::First, Some(3.0 * half));
    let panels = vec![
        Panel::lines("Gap coordinate", Unit::of_length(2.0 * half), std::iter::once(band).chain(gap).collect()),
        states(points, range),
        Panel {
            height: 170,
            ..Panel::lines(
                "Estimated half-backlash",
                Unit::of_length(half),
                interval(points, |point| point.half_backlash, Ink::Second, None),
            )
        },
        Panel {
            height: 170,
            ..Panel::lines("Load torque", TORQUE, interval(points, |point| point.load_torque, Ink::Third, None))
        },
        Panel {
            height: 150,
            ..Panel::lines("Motor torque", TORQUE, vec![line(over_time(points, |p| p.torque), Ink::Fourth, "")])
        },
    ];
    let unit = if span < 0.5 { Unit::of_time(span) } else { SECONDS };
    Figure::over_time(title, unit, range, panels)
}

/// Value and the ends of its 95 % interval, clipped far beyond the values.
fn interval(points: &[Point], of: impl Fn(&Point) -> Interval, ink: Ink, least: Option<f64>) -> Vec<Mark> {
    let last = points.last().map_or(0.0, |point| of(point).half);
    let (low, high) = points
        .iter()
        .map(|point| of(point).value)
        .fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
    let beyond = (AXIS_REACH * last).min(2.0 * (high - low).max(last)).max(0.0);
    let (low, high) = match least {
        Some(least) => (low.min(-least), high.max(least)),
        None => (low - beyond, high + beyond),
    };
    let end = |sign: f64| {
        over_time(points, |point| {
            let Interval { value, half } = of(point);
            (value + sign * half).clamp(low, high)
        })
    };
    vec![
        Mark::line(end(1.0), Ink::Reference, "95 % interval", INTERVAL_LINE_WIDTH),
        Mark::line(end(-1.0), Ink::Reference, "", INTERVAL_LINE_WIDTH),
        line(over_time(points, |point| of(point).value), ink, "estimate"),
    ]
}

fn over_time(points: &[Point], value: impl Fn(&Point) -> f64) -> Points {
    points.iter().map(|point| (point.time, value(point))).collect()
}

/// Flank, validity of the gap and trust in the encoders as rows of strips.
fn states(points: &[Point], range: (f64, f64)) -> Panel {
    let side = |wanted: Contact| move |point: &Point| point.side_valid && point.side == wanted;
    let marks = vec![
        strips(points, range, 0, side(Contact::DriveSide), Ink::DriveSide, "drive side"),
        strips(points, range, 0, side(Contact::Separated), Ink::Separated, "separated"),
        strips(points, range, 0, side(Contact::BackSide), Ink::BackSide, "back side"),
        strips(points, range, 1, |point| point.gap_valid, Ink::Third, "gap valid"),
        strips(points, range, 2, |point| point.both, Ink::Reference, "both encoders used"),
    ];
    Panel {
        title: "Side and validity".into(),
        unit: Unit { factor: 1.0, name: "" },
        height: 44 + 24 * STATE_ROWS.len() as i32,
        marks,
        axis: VerticalAxis::Rows(STATE_ROWS.map(str::to_owned).to_vec()),
    }
}

/// Boxes of a row for the times at which `holds` holds; the height of a strip is the share of its points.
fn strips(
    points: &[Point],
    range: (f64, f64),
    row: usize,
    holds: impl Fn(&Point) -> bool,
    ink: Ink,
    label: &str,
) -> Mark {
    let bottom = (STATE_ROWS.len() - 1 - row) as f64 + 0.5 * (1.0 - STRIP_HEIGHT);
    let width = (range.1 - range.0) / STRIPS_MAX as f64;
    let column = |point: &Point| ((point.time - range.0) / width).floor();
    let mut boxes: Vec<[f64; 4]> = Vec::new();
    let mut from = range.0;
    for group in points.chunk_by(|a, b| column(a) == column(b)) {
        let to = group.last().map_or(from, |point| point.time);
        let share = group.iter().filter(|point| holds(point)).count() as f64 / group.len() as f64;
        let top = bottom + STRIP_HEIGHT * share;
        match boxes.last_mut() {
            Some(last) if last[1] == from && last[3] == top => last[1] = to,
            _ if share > 0.0 => boxes.push([from, to, bottom, top]),
            _ => {}
        }
        from = to;
    }
    Mark::Boxes { boxes, ink, label: label.into() }
}
