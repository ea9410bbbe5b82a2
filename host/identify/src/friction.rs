//! Friction from torque balances. The link's balance gives Coulomb and viscous friction where the link moves; with a
//! torque sensor at the output, the motor's balance gives both for the motor. Static friction is not fitted.

use super::prior::PriorModel;
use super::regression::{Equations, Solution};
use super::rows::{Row, Rows};
use super::twist::{BLOCK_LENGTH, FLANKS, LOSS_WIDTH};

/// Index of the link's dry friction in its balance [N m].
pub const DRY: usize = 1;
/// Index of the link's viscous friction [N m s/rad].
pub const VISCOUS: usize = 2;
/// Index of the motor's dry friction in its balance [N m].
pub const MOTOR_DRY: usize = 0;
/// Index of the motor's viscous friction [N m s/rad].
pub const MOTOR_VISCOUS: usize = 1;
/// Index of the excess of the motor's true torque over the logged torque, relative.
pub const TORQUE_ERROR: usize = 2;
/// Index of the excess of the motor's inertia over the joint file's [kg m^2].
pub const MOTOR_INERTIA: usize = 4;
/// Index of the link's inertia in its balance [kg m^2].
pub const LINK_INERTIA: usize = 0;

/// Least speed of the link's balance [rad/s]: below, dry friction differs from its value at speed. A high Stribeck
/// speed of the joint file raises it.
const SLOWEST: f64 = 0.1;
/// Stribeck speeds after which the rise of friction towards rest has decayed.
const STRIBECK_SPEEDS: f64 = 5.0;
/// Prior width of an offset of the torque or of a constant load, as a share of the largest torque.
const BIAS: f64 = 1.0;
/// Prior width of the motor's inertia, relative.
const INERTIA: f64 = 0.5;

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

/// Fits the balance of the motor against the measured output torque.
pub fn of_the_motor(rows: &Rows, prior: &PriorModel) -> Option<Solution> {
    let mut equations = Equations::of_moments(rows.alike);
    for row in rows.carrying().filter(|row| row.direction != 0.0) {
        let Some(measured) = row.measured else { continue };
        // The viscous friction of the joint file was subtracted before.
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
