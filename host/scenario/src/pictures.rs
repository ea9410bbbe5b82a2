//! Pictures of a test: the shown seed under every controller, over the whole run and around one crossing of the gap.
//! Points come from `trace`, drawing from `report`.

use super::campaign::FinishedTest;
use super::controller::ControllerName;
use super::trace::{Trace, TracePoint};
use report::panels::BROAD;
use report::plot::Figure;
use report::plot::ink::{Ink, LINES};
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{FORCE, MILLISECONDS, SECONDS, TORQUE, Unit, greatest};

/// Width of a line [px].
const LINE_WIDTH: f64 = 1.2;
/// Width of the tested controller's line [px].
const TESTED_LINE_WIDTH: f64 = 1.8;
/// Bins of time in a picture of the whole run; each has the least and the greatest error.
const BINS: usize = 450;
/// Time before and after the crossing in the close-up [s].
const CLOSE_UP_MARGIN: f64 = 0.12;

/// Picture of the whole run.
pub fn whole_run(tested: &FinishedTest) -> Option<Figure> {
    let end =
        tested.shown.iter().flat_map(|(_, trace)| trace.points.last()).map(|point| point.time).fold(0.0, f32::max);
    let coarse = |(name, trace): &(ControllerName, Trace)| (*name, trace.coarse(trace.points.len() / BINS));
    let shown: Vec<_> = tested.shown.iter().map(coarse).collect();
    let view = View { shown: &shown, faults: &tested.faults, range: (0.0, f64::from(end)) };
    (end > 0.0).then(|| view.figure(format!("The whole run: {}", tested.record.file), true))
}

/// Picture of a crossing of the gap: the tested controller's longest one, or that of another controller.
pub fn crossing(tested: &FinishedTest) -> Option<Figure> {
    let settle = tested.record.settle_s;
    let longest = |trace: &Trace| {
        let late = trace.crossings.iter().filter(|(time, _)| *time >= settle);
        late.copied().reduce(|a, b| if b.1 > a.1 { b } else { a })
    };
    let (time, took) = tested.shown.iter().find_map(|(_, trace)| longest(trace))?;
    let from = (time - took.min(0.3) - CLOSE_UP_MARGIN).max(0.0);
    let view = View { shown: &tested.shown, faults: &tested.faults, range: (from, time + CLOSE_UP_MARGIN) };
    Some(view.figure(format!("A crossing of the gap: {}", tested.record.file), false))
}

enum Scale {
    Angle,
    Torque,
    Force,
}

struct View<'t> {
    shown: &'t [(ControllerName, Trace)],
    faults: &'t [(&'static str, [f64; 2])],
    range: (f64, f64),
}

impl View<'_> {
    fn figure(&self, title: String, whole: bool) -> Figure {
        let mut panels = vec![
            self.panel("Link error", |point| point.error, Scale::Angle),
            self.gap(),
            self.panel("Motor torque", |point| point.torque, Scale::Torque),
            self.panel("Peak mesh force", |point| point.force, Scale::Force),
        ];
        if whole {
            panels.insert(0, self.position());
            panels.push(self.lost_motion());
        }
        for (index, panel) in panels.iter_mut().enumerate() {
            panel.marks.extend(self.fault_limits(index == 0));
        }
        Figure::over_time(title, SECONDS, self.range, panels)
    }

    /// Marks at the start and end of faults, with labels in the first panel: the fault's word if there is only one
    /// fault.
    fn fault_limits(&self, named: bool) -> Vec<Mark> {
        let inside = |time: f64| self.range.0 < time && time < self.range.1;
        let ends = self
            .faults
            .iter()
            .flat_map(|(word, [start, end])| [(*start, format!("{word} begins")), (*end, format!("{word} ends"))]);
        let limits = ends.filter(|(at, _)| inside(*at)).enumerate().map(|(index, (at, label))| {
            let label = match (named, self.faults.len(), index) {
                (true, 1, _) => label,
                (true, _, 0) => "a fault begins or ends".to_owned(),
                _ => String::new(),
            };
            Mark::Deadline { at, label }
        });
        limits.collect()
    }

    /// Lines of all controllers; the tested one is drawn last, on top.
    fn lines(&self, value: impl Fn(&TracePoint) -> f32) -> Vec<Mark> {
        let shown = self.shown.iter().enumerate().rev();
        shown.map(|(index, (name, trace))| self.line(index, name.label(), trace, &value)).collect()
    }

    fn line(&self, index: usize, label: &str, trace: &Trace, value: &impl Fn(&TracePoint) -> f32) -> Mark {
        let inside = |point: &&TracePoint| (self.range.0..=self.range.1).contains(&f64::from(point.time));
        Mark::Line {
            points: trace.points.iter().filter(inside).map(|p| (p.time.into(), value(p).into())).collect(),
            ink: LINES[index.min(LINES.len() - 1)],
            label: label.to_owned(),
            width: if index == 0 { TESTED_LINE_WIDTH } else { LINE_WIDTH },
        }
    }

    fn panel(&self, title: &str, value: impl Fn(&TracePoint) -> f32, scale: Scale) -> Panel {
        let marks = self.lines(value);
        let most = greatest(marks.iter().flat_map(Mark::values));
        let unit = match scale {
            Scale::Angle => Unit::of_angle(most.max(1.01e-3)),
            Scale::Torque => TORQUE,
            Scale::Force => FORCE,
        };
        Panel { height: 190, ..Panel::lines(title, unit, marks) }
    }

    fn position(&self) -> Panel {
        let mut marks = self.lines(|point| point.wanted - point.error);
        if let Some((_, trace)) = self.shown.first() {
            let mut wanted = self.line(0, "wanted", trace, &|point| point.wanted);
            if let Mark::Line { ink, width, .. } = &mut wanted {
                (*ink, *width) = (Ink::Reference, BROAD);
            }
            marks.insert(0, wanted);
        }
        let most = greatest(marks.iter().flat_map(Mark::values));
        Panel { height: 170, ..Panel::lines("Link", Unit::of_angle(most.max(1.01e-3)), marks) }
    }

    /// True gap coordinate of the tested controller and the first rival, with the observer's estimate, over the free
    /// gap.
    fn gap(&self) -> Panel {
        let half = self.shown.first().map_or(0.0, |(_, trace)| trace.half_gap);
        let mut marks = vec![Mark::Band { range: (-half, half), label: "free gap".into() }];
        for (index, (name, trace)) in self.shown.iter().enumerate().take(2).rev() {
            marks.push(self.line(index, name.label(), trace, &|point| point.gap));
        }
        if let Some((_, trace)) = self.shown.first().filter(|(name, _)| name.is_compensation()) {
            let mut estimate = self.line(0, "as observed", trace, &|point| point.estimated_gap);
            if let Mark::Line { ink, width, .. } = &mut estimate {
                (*ink, *width) = (Ink::Text, 0.8);
            }
            marks.push(estimate);
        }
        Panel { height: 190, ..Panel::lines("Gap coordinate", Unit::of_length(4.0 * half), marks) }
    }

    /// Duration of every crossing.
    fn lost_motion(&self) -> Panel {
        let shown = self.shown.iter().enumerate().rev();
        let marks = shown
            .map(|(index, (name, trace))| Mark::Points {
                points: trace.crossings.clone(),
                ink: LINES[index.min(LINES.len() - 1)],
                label: name.label().to_owned(),
                size: 5.0,
            })
            .collect();
        Panel { height: 170, ..Panel::lines("Lost motion", MILLISECONDS, marks) }
    }
}
