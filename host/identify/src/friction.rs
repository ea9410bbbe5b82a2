//! Friction: the link's torque balance gives Coulomb and viscous friction where the link moves; with a torque sensor at
//! the output, the motor's own balance does so too. Static friction is not fitted.

use super::prior::PriorModel;
use super::regression::{Equations, Solution};
use super::rows::{Row, Rows};
use super::twist::{BLOCK_LENGTH, FLANKS, LOSS_WIDTH};

/// Unknowns of the link's balance by their place, behind its inertia: dry friction [N m].
pub const DRY: usize = 1;
/// Viscous friction [N m s/rad].
pub const VISCOUS: usize = 2;
/// Dry, viscous: places in the motor's balance.
pub const MOTOR_DRY: usize = 0;
/// Viscous friction at the motor [N m s/rad].
pub const MOTOR_VISCOUS: usize = 1;
/// By which the motor's true torque exceeds the logged one, as a ratio.
pub const TORQUE_ERROR: usize = 2;
/// By which what turns with the motor exceeds what the joint file says [kg m^2].
pub const MOTOR_INERTIA: usize = 4;
/// What turns with the link, in its own balance [kg m^2].
pub const LINK_INERTIA: usize = 0;

/// Below this speed dry friction is not what it is at speed [rad/s]; more if the joint file's Stribeck speed is high.
const SLOWEST: f64 = 0.1;
/// Stribeck speeds after which the rise at rest is forgotten.
const STRIBECK_SPEEDS: f64 = 5.0;
/// Share of the largest torque within which an offset of the torque, or a constant load, is expected.
const BIAS: f64 = 1.0;
/// Share of its inertia within which what turns with the motor is expected.
const INERTIA: f64 = 0.5;

/// What the link's balance takes from the motor's side, if no torque was measured behind it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MotorSide {
    /// Ratio by which the true torque, the measured one if there is one, exceeds the scaled one.
    pub torque_error: f64,
    /// Dry friction of the motor [N m].
    pub dry: f64,
    /// Delay of its torque [s]: at speed it looks like viscous friction.
    pub delay: f64,
    /// Share by which less of the load comes through the gears than is stated.
    pub loss: f64,
}

/// Balance of the link.
pub fn of_the_link(rows: &Rows, prior: &PriorModel, motor: MotorSide) -> Option<Solution> {
    let slowest = SLOWEST.max(STRIBECK_SPEEDS * prior.surroundings.load_friction.stribeck_speed);
    let mut equations = Equations::of_moments(rows.alike);
    for row in rows.carrying().filter(|row| row.output_speed.abs() > slowest && row.direction != 0.0) {
        let coefficients = vec![
            row.output_acceleration,
            row.output_speed.signum(),
            row.output_speed,
            row.output.sin(),
            row.output.cos(),
            1.0,
        ];
        let from_motor = row.drive + motor.torque_error * row.motor_torque
            - row.leverage * row.direction * motor.dry
            - motor.delay * row.drive_rate
            - motor.loss * row.loss();
        let torque = row.measured.map_or(from_motor, |measured| measured * (1.0 + motor.torque_error));
        equations.push(coefficients, torque, block(row));
        equations.in_group(row.level(rows.greatest));
    }
    let weight = rows.greatest;
    equations.solve(&[f64::INFINITY, f64::INFINITY, f64::INFINITY, weight, weight, BIAS * weight])
}

/// Balance of the motor against the measured output torque.
pub fn of_the_motor(rows: &Rows, prior: &PriorModel) -> Option<Solution> {
    let mut equations = Equations::of_moments(rows.alike);
    for row in rows.carrying().filter(|row| row.direction != 0.0) {
        let Some(measured) = row.measured else { continue };
        // What the joint file says of the viscous part was taken off before.
        let known = prior.surroundings.motor_friction.viscous * row.motor_speed;
        let left = (row.drive - measured) / row.leverage + known;
        let coefficients = vec![
            row.direction,
            row.motor_speed,
            -row.motor_torque / row.leverage,
            1.0,
            row.motor_acceleration,
            row.loss() / prior.ratio(),
            row.direction * row.side,
        ];
        equations.push(coefficients, left, block(row));
        equations.in_group(row.level(rows.greatest));
    }
    equations.solve(&[
        f64::INFINITY,
        f64::INFINITY,
        prior.torque_error.max(1e-9),
        BIAS * rows.greatest / prior.ratio(),
        INERTIA * prior.motor_inertia,
        LOSS_WIDTH,
        FLANKS * rows.greatest / prior.ratio(),
    ])
}

fn block(row: &Row) -> usize {
    (row.time / BLOCK_LENGTH) as usize
}
