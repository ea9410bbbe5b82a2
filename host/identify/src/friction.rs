//! Friction from torque balances. The link's balance gives Coulomb and viscous friction where the link moves; with a
//! torque sensor at the output, the motor's balance gives both for the motor. Static friction is not fitted.

use super::prior::PriorModel;
use super::regression::{Equations, Solution};
use super::rows::{Row, Rows};
use super::twist::{BLOCK_LENGTH, FLANK_FRICTION_WIDTH, LOSS_WIDTH};

/// Index of the link's dry friction in its balance [N m].
pub const LINK_DRY: usize = 1;
/// Index of the link's viscous friction [N m s/rad].
pub const LINK_VISCOUS: usize = 2;
/// Index of the motor's dry friction in its balance [N m].
pub const MOTOR_DRY: usize = 0;
/// Index of the motor's viscous friction [N m s/rad].
pub const MOTOR_VISCOUS: usize = 1;
/// Index of the excess of the motor's true torque over the logged torque, relative.
pub const MOTOR_TORQUE_ERROR: usize = 2;
/// Index of the excess of the motor's inertia over the joint file's [kg m^2].
pub const MOTOR_INERTIA_EXCESS: usize = 4;
/// Index of the link's inertia in its balance [kg m^2].
pub const LINK_INERTIA: usize = 0;

/// Least speed of the link's balance [rad/s]: below, dry friction differs from its value at speed. A high Stribeck
/// speed of the joint file raises it.
const LINK_SPEED_MIN: f64 = 0.1;
/// Stribeck speeds after which the rise of friction towards rest has decayed.
const STRIBECK_SPEEDS_MIN: f64 = 5.0;
/// Prior width of an offset of the torque or of a constant load, as a share of the largest torque.
const OFFSET_WIDTH: f64 = 1.0;
/// Prior width of the motor's inertia, relative.
const MOTOR_INERTIA_WIDTH: f64 = 0.5;

/// Motor's part of the link's balance, if no torque was measured behind the motor.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MotorSide {
    /// Excess of the true torque over the scaled torque, relative; of the measured torque if there is one.
    pub torque_error: f64,
    /// Dry friction of the motor [N m].
    pub dry: f64,
    /// Delay of the motor's torque [s]; at speed it looks like viscous friction.
    pub delay: f64,
    /// Excess of the gears' losses over the stated losses, as a share of the load.
    pub loss: f64,
}

/// Fits the balance of the link.
pub fn fit_link(rows: &Rows, prior: &PriorModel, motor: MotorSide) -> Option<Solution> {
    let slowest = LINK_SPEED_MIN.max(STRIBECK_SPEEDS_MIN * prior.surroundings.load_friction.stribeck_speed);
    let mut equations = Equations::with_repetition(rows.repetition);
    for row in rows.carrying().filter(|row| row.output_speed.abs() > slowest && row.direction != 0.0) {
        let coefficients = vec![
            row.output_acceleration,
            row.output_speed.signum(),
            row.output_speed,
            row.output.sin(),
            row.output.cos(),
            1.0,
        ];
        let from_motor = row.drive_torque + motor.torque_error * row.motor_torque
            - row.leverage * row.direction * motor.dry
            - motor.delay * row.drive_rate
            - motor.loss * row.loss_sensitivity();
        let torque = row.measured.map_or(from_motor, |measured| measured * (1.0 + motor.torque_error));
        equations.push(coefficients, torque, block(row));
        equations.set_group(row.level(rows.largest_torque));
    }
    let weight = rows.largest_torque;
    equations.solve(&[f64::INFINITY, f64::INFINITY, f64::INFINITY, weight, weight, OFFSET_WIDTH * weight])
}

/// Fits the balance of the motor against the measured output torque.
pub fn fit_motor(rows: &Rows, prior: &PriorModel) -> Option<Solution> {
    let mut equations = Equations::with_repetition(rows.repetition);
    for row in rows.carrying().filter(|row| row.direction != 0.0) {
        let Some(measured) = row.measured else { continue };
        // The viscous friction of the joint file was subtracted before.
        let known = prior.surroundings.motor_friction.viscous * row.motor_speed;
        let left = (row.drive_torque - measured) / row.leverage + known;
        let coefficients = vec![
            row.direction,
            row.motor_speed,
            -row.motor_torque / row.leverage,
            1.0,
            row.motor_acceleration,
            row.loss_sensitivity() / prior.ratio(),
            row.direction * row.flank,
        ];
        equations.push(coefficients, left, block(row));
        equations.set_group(row.level(rows.largest_torque));
    }
    equations.solve(&[
        f64::INFINITY,
        f64::INFINITY,
        prior.torque_error.max(1e-9),
        OFFSET_WIDTH * rows.largest_torque / prior.ratio(),
        MOTOR_INERTIA_WIDTH * prior.motor_inertia,
        LOSS_WIDTH,
        FLANK_FRICTION_WIDTH * rows.largest_torque / prior.ratio(),
    ])
}

fn block(row: &Row) -> usize {
    (row.time / BLOCK_LENGTH) as usize
}
