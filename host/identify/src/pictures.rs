//! Pictures of the fit: twist over torque with both branches, and the residual over time.

use super::log::Log;
use super::prior::PriorModel;
use super::rows::Rows;
use super::twist::{self, Twist};
use report::plot::Figure;
use report::plot::ink::Ink;
use report::plot::mark::Mark;
use report::plot::panel::Panel;
use report::plot::unit::{SECONDS, TORQUE, Unit};

/// Largest number of points in a picture.
const POINTS: usize = 6000;

/// Returns the step by which points are thinned out for a picture.
pub fn thinning(points: usize) -> usize {
    points.div_ceil(POINTS).max(1)
}

/// Twist over torque: moments of either flank, those near a change, and the fitted branches.
pub fn loop_of(log: &Log, rows: &Rows, twist: &Twist, prior: &PriorModel) -> Figure {
    let cleaned = twist.gap_and_wind_up(log, rows, prior);
    let every = thinning(cleaned.len());
    let points = |side: f64| -> Vec<(f64, f64)> {
        let own = cleaned.iter().filter(|(row, _)| row.flank == side);
        own.step_by(every).map(|(row, twist)| (row.torque(), *twist)).collect()
    };
    let [half_gap, compliance] = [twist::HALF_GAP, twist::COMPLIANCE].map(|unknown| twist.solution.values[unknown]);
    let reach = 1.05 * rows.all.iter().map(|row| row.torque().abs()).fold(0.0, f64::max);
    let branch = |side: f64| vec![(0.0, side * half_gap), (side * reach, side * (half_gap + compliance * reach))];
    let dots =
        |side: f64, ink: Ink, label: &str| Mark::Points { points: points(side), ink, label: label.into(), size: 2.5 };
    let line =
        |side: f64, label: &str| Mark::Line { points: branch(side), ink: Ink::Text, label: label.into(), width: 2.0 };
    let marks = vec![
        dots(0.0, Ink::Reference, "near a change, not used"),
        dots(1.0, Ink::DriveSide, "drive side"),
        dots(-1.0, Ink::BackSide, "back side"),
        line(1.0, "fit"),
        line(-1.0, ""),
    ];
    let unit = Unit::of_angle(half_gap.abs() + compliance.abs() * reach);
    let panel = Panel { height: 420, ..Panel::lines("Motor over ratio less output", unit, marks) };
    let note =
        "Encoder, tooth and skew errors are subtracted; the step between the branches is the lost motion.".into();
    Figure { note, ..Figure::new("Twist over torque", "torque at the output", TORQUE, (-reach, reach), vec![panel]) }
}

/// Torque and residuals of the fit over time.
pub fn time_history(log: &Log, twist: &Twist) -> Figure {
    let every = thinning(log.time.len());
    let torque = log.time.iter().copied().zip(log.torque.iter().copied()).step_by(every).collect();
    let every = thinning(twist.rows.len());
    let left: Vec<(f64, f64)> =
        twist.rows.iter().zip(&twist.solution.residuals).step_by(every).map(|(row, left)| (row.time, *left)).collect();
    let greatest = left.iter().map(|point| point.1.abs()).fold(0.0, f64::max);
    let range = (0.0, log.time.last().copied().unwrap_or(1.0));
    let torque = Mark::Line { points: torque, ink: Ink::First, label: String::new(), width: 1.2 };
    let left = Mark::Points { points: left, ink: Ink::Second, label: String::new(), size: 2.0 };
    let panels = vec![
        Panel::lines("Motor torque", TORQUE, vec![torque]),
        Panel::lines("Residual of the twist", Unit::of_angle(greatest), vec![left]),
    ];
    Figure::over_time("Residuals of the fit", SECONDS, range, panels)
}
