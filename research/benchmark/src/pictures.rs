//! Pictures of error against cost, case by case: instructions of the fixed-step methods on the board, processor time of the methods on the
//! host. Both axes are logarithmic.

use comparison::method::Method;

use super::libraries::Time;
use super::method_results::{CaseRecord, MethodResult};
use super::verdicts::{CLOCK_RATE, CYCLES_PER_INSTRUCTION, curve, pareto_front};
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::{Panel, VerticalAxis};
use report::plot::unit::Unit;
use report::plot::{Figure, HorizontalAxis};

const NO_UNIT: Unit = Unit { factor: 1.0, name: "" };
/// Instructions a second of the joint.
const MEGA: Unit = Unit { factor: 1e-6, name: "million" };
const MILLI: Unit = Unit { factor: 1e3, name: "ms" };
/// Line width of this step, and of the others.
const WIDTHS: [f64; 2] = [3.0, 1.6];
const HEIGHT: i32 = 420;

/// Line of one method.
struct Curve<'a> {
    /// Cost and error.
    points: Vec<(f64, f64)>,
    ink: Ink,
    name: &'a str,
    /// True for this step.
    own: bool,
}

/// Colour of a method.
fn ink(method: Method) -> Ink {
    match method {
        Method::Realtime => Ink::First,
        Method::PaperEtd1 => Ink::Second,
        Method::RungeKutta4 => Ink::Third,
        Method::RungeKutta4Tanh => Ink::Fifth,
        Method::Euler => Ink::Fourth,
        Method::Trapezoid => Ink::Text,
        Method::TwoMassSpring => Ink::Axis,
        Method::TwoMassRestitution => Ink::BackSide,
    }
}

/// Name short enough for a legend of many.
fn short(name: &str) -> &str {
    const SHORT: [(&str, &str); 12] = [
        ("the paper's (ETD1)", "ETD1"),
        ("RK4, sharp", "RK4"),
        ("RK4, f64", "RK4"),
        ("RK4, tanh", "RK4 tanh"),
        ("semi-implicit Euler", "Euler"),
        ("trapezoid, active set", "trapezoid"),
        ("two masses, spring-damper", "two-mass spring"),
        ("two masses, restitution", "two-mass impact"),
        ("CVODE Adams, restarted at crossings", "CVODE, restarted"),
        ("differential-equations dopri5", "dopri5"),
        ("differential-equations dop853", "dop853"),
        ("differential-equations Cash-Karp", "Cash-Karp"),
    ];
    SHORT.iter().find(|pair| pair.0 == name).map_or(name, |pair| pair.1)
}

/// Figure of error against instructions.
pub fn board(case: &CaseRecord, entries: &[MethodResult]) -> Option<Figure> {
    let own = |entry: &&MethodResult| entry.case == case.key && entry.marks.iter().any(|mark| mark.error.is_some());
    let curves: Vec<Curve<'_>> = entries
        .iter()
        .filter(own)
        .map(|entry| {
            let points = pareto_front(entry.series().into_iter().flatten().collect());
            Curve { points, ink: ink(entry.method), name: entry.name, own: entry.method == Method::Realtime }
        })
        .collect();
    let half = 0.5 * CLOCK_RATE / CYCLES_PER_INSTRUCTION;
    let note = format!(
        "Instructions for a second of the joint. Vertical: half a {:.0} MHz core at {CYCLES_PER_INSTRUCTION} cycles each.",
        CLOCK_RATE / 1e6
    );
    figure(format!("Case {}: {}", case.key, case.title), "instructions", MEGA, curves, Some(half), note)
}

/// Figure of error against processor time.
pub fn host(case: &CaseRecord, times: &[Time]) -> Option<Figure> {
    let mut names: Vec<&str> = Vec::new();
    for time in times.iter().filter(|time| time.case == case.key && time.error.is_some()) {
        // One line for this step and one for Runge-Kutta: in f64, as in the libraries.
        if !names.contains(&time.name.as_str()) && !time.name.ends_with("f32") {
            names.push(&time.name);
        }
    }
    let mut colours =
        [Ink::Second, Ink::Limit, Ink::Third, Ink::Fourth, Ink::Fifth, Ink::Text, Ink::Axis, Ink::DriveSide]
            .into_iter();
    let curves = names
        .iter()
        .map(|name| {
            let points = curve(times, &case.key, name);
            let own = name.starts_with("this step");
            let ink = if own { Ink::First } else { colours.next().unwrap_or(Ink::Reference) };
            Curve { points, ink, name, own }
        })
        .collect();
    let note = "Processor time for a second of the joint; real time is 1000 ms.".to_owned();
    figure(format!("Case {} on the host", case.key), "processor time", MILLI, curves, None, note)
}

fn figure(
    title: String,
    axis: &str,
    unit: Unit,
    curves: Vec<Curve<'_>>,
    limit: Option<f64>,
    note: String,
) -> Option<Figure> {
    let all = || curves.iter().flat_map(|curve| curve.points.iter().copied());
    let least = |of: fn((f64, f64)) -> f64| all().map(of).fold(f64::INFINITY, f64::min);
    let most = |of: fn((f64, f64)) -> f64| all().map(of).fold(0.0, f64::max);
    let (left, right) = (least(|point| point.0), most(|point| point.0));
    let (low, high) = (least(|point| point.1), most(|point| point.1));
    // Without any points the least value is infinite.
    if !(left > 0.0 && left.is_finite() && low > 0.0 && right.is_finite()) {
        return None;
    }
    let mut marks: Vec<Mark> = limit.into_iter().map(|at| Mark::Deadline { at, label: "half a core".into() }).collect();
    // This step is drawn last, above the others.
    let (own, others): (Vec<_>, Vec<_>) = curves.into_iter().partition(|curve| curve.own);
    for Curve { points, ink, name, own } in others.into_iter().chain(own) {
        marks.push(Mark::Points {
            points: points.clone(),
            ink,
            label: String::new(),
            size: if own { 7.0 } else { 5.0 },
        });
        marks.push(Mark::line(points, ink, short(name), WIDTHS[usize::from(!own)]));
    }
    let axis_of_error =
        VerticalAxis::Decades { from: low.log10().floor() as i32, to: (high.log10().ceil() as i32).clamp(-8, 1) };
    let panel = Panel { height: HEIGHT, axis: axis_of_error, ..Panel::lines("Error", NO_UNIT, marks) };
    let figure = Figure::new(title, axis, unit, (0.8 * left, 1.25 * right), vec![panel]);
    Some(Figure { runs: HorizontalAxis::Decades, note, ..figure })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f64, f64)], own: bool) -> Curve<'static> {
        Curve { points: points.to_vec(), ink: Ink::First, name: "a method", own }
    }

    /// Curves over many decades are drawn.
    #[test]
    fn curves_over_many_decades_are_drawn() {
        let curves = vec![
            curve(&[(4e6, 1e5), (4e7, 3.0), (8e8, 2e-7)], false),
            curve(&[(9e6, 2e-5), (5e7, 6e-6), (8e8, 4e-6)], true),
        ];
        let figure = figure("A case".into(), "instructions", MEGA, curves, Some(6e7), String::new()).unwrap();
        let svg = figure.to_svg();
        assert!(svg.contains("a method") && svg.contains("half a core"), "{svg}");
    }

    /// Without points there is no picture.
    #[test]
    fn no_points_give_no_picture() {
        assert!(figure(String::new(), "", MEGA, vec![curve(&[], true)], None, String::new()).is_none());
    }
}
