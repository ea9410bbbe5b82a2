//! What twists the joint: half of the gap by side, compliance by torque, damping by the twist's rate, the motor's dry
//! friction by its direction, errors of both encoders and of the teeth by angle. One linear fit gives them all.

use nalgebra::DVector;

use super::log::Log;
use super::prior::PriorModel;
use super::regression::{Equations, SCATTERING, Scatter, Solution};
use super::rows::{Row, Rows};

/// Unknowns by their place.
pub const OFFSET: usize = 0;
/// Half of the lost motion at the output [rad].
pub const HALF_GAP: usize = 1;
/// [rad/(N m)].
pub const COMPLIANCE: usize = 2;
/// Compliance times damping of the swing [s].
pub const RELAXATION: usize = 3;
/// Compliance times the motor's dry friction, negative [rad/(N m) N m].
pub const MOTOR_FRICTION: usize = 4;
/// Age of the output reading over the motor's [s].
pub const SKEW: usize = 5;
/// Delay of the torque [s].
pub const DELAY: usize = 6;
/// Sine and cosine of the motor encoder's error, once and twice a turn [rad].
pub const MOTOR_MAP: usize = 7;
/// Of the output encoder's [rad].
pub const OUTPUT_MAP: usize = 11;
/// Of the teeth's error, once and twice a tooth [rad].
pub const TEETH: usize = 15;
/// Compliance times the ratio by which the motor's true torque exceeds the logged one [rad/(N m)].
pub const TORQUE_ERROR: usize = 19;
/// All of them; behind the torque's error, sine and cosine of what the teeth's error grows by with the square of speed.
pub const UNKNOWNS: usize = 22;

/// Errors beyond these are not expected: what a log does not show stays within them.
const MOTOR_MAP_WIDTH: f64 = 0.5 * DEGREE;
const OUTPUT_MAP_WIDTH: f64 = 0.2 * DEGREE;
const TEETH_WIDTH: f64 = 0.1 * DEGREE;
const SKEW_WIDTH: f64 = 1e-3;
const DELAY_WIDTH: f64 = 2e-3;
const RELAXATION_WIDTH: f64 = 1e-2;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Length of the blocks whose residuals are assumed to be independent of one another [s].
pub const BLOCK_LENGTH: f64 = 0.1;

/// Teeth whose twist is inside the gap by so many deviations are not in contact.
const FLYING: f64 = 6.0;

/// Takes an unknown out of a fit.
const NONE: f64 = 1e-12;

/// The fit and the samples that it is made from.
#[derive(Debug, Clone)]
pub struct Twist {
    /// The unknowns.
    pub solution: Solution,
    /// Moments, in the order of the residuals.
    pub rows: Vec<Row>,
}

/// Widths that are expected of the map unknowns.
pub fn width(unknown: usize) -> f64 {
    match unknown {
        TORQUE_ERROR => f64::INFINITY,
        RELAXATION => RELAXATION_WIDTH,
        SKEW => SKEW_WIDTH,
        DELAY => DELAY_WIDTH,
        _ if unknown >= TEETH => TEETH_WIDTH,
        _ if unknown >= OUTPUT_MAP => OUTPUT_MAP_WIDTH,
        _ if unknown >= MOTOR_MAP => MOTOR_MAP_WIDTH,
        _ => f64::INFINITY,
    }
}

/// Fits; `None` if the moments do not determine gap and compliance.
pub fn fit(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<Twist> {
    fit_with(log, rows, prior, prior.torque_error)
}

/// The same for a torque that is right.
pub fn fit_with_this_torque(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<Twist> {
    fit_with(log, rows, prior, 0.0)
}

/// The same for a torque whose scale is not known at all; nothing where no torque of the motor enters.
pub fn fit_with_any_torque(log: &Log, rows: &Rows, prior: &PriorModel) -> Option<Twist> {
    if log.output_torque.is_some() { None } else { fit_with(log, rows, prior, f64::INFINITY) }
}

fn fit_with(log: &Log, rows: &Rows, prior: &PriorModel, torque_error: f64) -> Option<Twist> {
    let used: Vec<Row> = rows.carrying().filter(|row| row.direction != 0.0).copied().collect();
    let mut equations = Equations::of_moments(rows.alike);
    let products = rows.kernel.products();
    for row in &used {
        let block = (row.time / BLOCK_LENGTH) as usize;
        let coefficients = equation(log, rows, prior, row);
        equations.push_scattering(coefficients, row.twist, block, MEASURED, scatter(log, &products, prior, row));
    }
    let mut widths: Vec<f64> = (0..UNKNOWNS).map(width).collect();
    // With the torque measured behind them, the motor's friction and its delay do not show in the twist.
    let measured = log.output_torque.is_some();
    widths[MOTOR_FRICTION] = if measured { NONE } else { prior.compliance * rows.greatest };
    widths[TORQUE_ERROR] = if measured { NONE } else { (prior.compliance * torque_error).max(NONE) };
    if prior.equivalent {
        // No teeth, no errors of theirs.
        (TEETH..TORQUE_ERROR).chain(TORQUE_ERROR + 1..UNKNOWNS).for_each(|unknown| widths[unknown] = NONE);
    }
    let solution = equations.solve(&widths)?;
    Some(Twist { solution, rows: used })
}

/// Unknowns whose coefficients come from encoder readings by way of a rate or an acceleration.
const MEASURED: [usize; SCATTERING] = [COMPLIANCE, RELAXATION, SKEW];

/// How readings that scatter show in those coefficients and in the twist: what of each is their value, first and second
/// derivative, by motor and output.
fn scatter(log: &Log, products: &[[f64; 3]; 3], prior: &PriorModel, row: &Row) -> Scatter {
    let ratio = prior.ratio();
    let taken = if row.measured.is_some() { 0.0 } else { -row.leverage };
    let torque = [0.0, taken * prior.surroundings.motor_friction.viscous, taken * prior.motor_inertia];
    let of_motor = [torque, [0.0, 1.0 / ratio, 0.0], [0.0; 3], [1.0 / ratio, 0.0, 0.0]];
    let of_output = [[0.0; 3], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    let mut covariance = Scatter::default();
    for (parts, noise) in [of_motor, of_output].iter().zip(&log.noise) {
        let variance = noise.at(row.sample);
        for (one, other) in (0..=SCATTERING).flat_map(|one| (0..=SCATTERING).map(move |other| (one, other))) {
            let pairs = (0..3).flat_map(|order| (0..3).map(move |with| (order, with)));
            let sum: f64 =
                pairs.map(|(order, with)| parts[one][order] * parts[other][with] * products[order][with]).sum();
            covariance.0[one][other] += variance * sum;
        }
    }
    covariance
}

/// Coefficients of the unknowns at a moment.
fn equation(log: &Log, rows: &Rows, prior: &PriorModel, row: &Row) -> Vec<f64> {
    // Errors by angle are smoothed as the twist is: at speed the kernel takes a part of them.
    let smooth = |of: &dyn Fn(usize) -> f64| rows.kernel.at(of, row.sample, 0);
    let ratio = prior.ratio();
    let mut equation = vec![1.0, row.side, row.torque(), row.wind_rate];
    equation.push(if row.measured.is_some() { 0.0 } else { row.leverage * row.direction });
    equation.push(row.output_speed);
    equation.push(if row.measured.is_some() { 0.0 } else { -prior.compliance * row.drive_rate });
    for order in [1.0, 2.0] {
        equation.push(smooth(&|place| (order * log.motor[place]).sin()) / ratio);
        equation.push(smooth(&|place| (order * log.motor[place]).cos()) / ratio);
    }
    for order in [1.0, 2.0] {
        equation.push(-smooth(&|place| (order * log.output[place]).sin()));
        equation.push(-smooth(&|place| (order * log.output[place]).cos()));
    }
    for order in [1.0, 2.0] {
        equation.push(smooth(&|place| (order * log.teeth(place, prior)).sin()));
        equation.push(smooth(&|place| (order * log.teeth(place, prior)).cos()));
    }
    equation.push(if row.measured.is_some() { 0.0 } else { row.motor_torque });
    // Teeth that pass near the swing's own frequency shake more than two inertias on a spring say.
    let passing = f64::from(prior.ring_teeth) * row.output_speed * prior.swing() / std::f64::consts::TAU;
    equation.push(passing * passing * smooth(&|place| log.teeth(place, prior).sin()));
    equation.push(passing * passing * smooth(&|place| log.teeth(place, prior).cos()));
    equation
}

impl Twist {
    /// Of the joint [rad/(N m)].
    pub fn compliance(&self) -> f64 {
        self.solution.values[COMPLIANCE]
    }

    /// Error at an angle that comes once and twice in its turn [rad]; `first` is the first of its four unknowns.
    pub fn error(&self, first: usize, angle: f64) -> f64 {
        let part = |place: usize| self.solution.values[first + place];
        let (once, twice) = (angle.sin_cos(), (2.0 * angle).sin_cos());
        part(0) * once.0 + part(1) * once.1 + part(2) * twice.0 + part(3) * twice.1
    }

    /// Leaves out moments at which the teeth fly, whatever the mean torque: those whose twist is inside the gap by more than it
    /// scatters. Teeth may bounce on for long where the joint is accelerated as they are.
    pub fn leave_out_flights(&self, log: &Log, rows: &mut Rows, prior: &PriorModel) {
        let least = self.solution.values[HALF_GAP] - FLYING * self.solution.noise;
        let cleaned = self.cleaned(log, rows, prior);
        for (row, (_, twist)) in rows.all.iter_mut().zip(cleaned) {
            if row.side * twist < least {
                row.side = 0.0;
            }
        }
    }

    /// What is left of a moment's twist without encoder, tooth and skew errors: gap and wind-up alone [rad].
    pub fn cleaned(&self, log: &Log, rows: &Rows, prior: &PriorModel) -> Vec<(Row, f64)> {
        let cleaned = |row: &Row| {
            let coefficients = DVector::from_vec(equation(log, rows, prior, row));
            let errors: f64 = (0..UNKNOWNS)
                .filter(|unknown| *unknown == OFFSET || (*unknown >= SKEW && *unknown != TORQUE_ERROR))
                .map(|unknown| coefficients[unknown] * self.solution.values[unknown])
                .sum();
            (*row, row.twist - errors)
        };
        rows.all.iter().map(cleaned).collect()
    }
}
