//! What the torque of a log accelerates, held against the joint file's inertias: the motor's alone while the joint rings, and
//! all that turns. `contradictions` refuses what cannot be; `scales` finds what torque and inertias come to together.

use super::prior::PriorModel;
use super::regression::{Equations, Solution};
use super::rows::Rows;
use super::twist::{self, BLOCK_LENGTH};

/// A factor is taken for certain if it stands out of its scatter by so many standard deviations.
pub const SURE: f64 = 6.0;
/// Share of the largest torque that gravity, or an offset, may take.
const HELD: f64 = 1.0;
/// A balance of torques tells its factor if it is as narrow as this.
const NARROW: f64 = 0.1;

/// What should be 1.
#[derive(Debug, Clone, Copy)]
pub struct Factor {
    /// What it is.
    pub value: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

impl Factor {
    /// An unknown of a solution.
    pub fn of(solution: &Solution, unknown: usize) -> Self {
        Self { value: solution.values[unknown], deviation: solution.half(&[(unknown, 1.0)]) / solution.reach }
    }

    /// Known well enough to be held against anything.
    pub fn is_narrow(self) -> bool {
        self.deviation < NARROW * self.value.abs()
    }

    /// Surely not from 1/most to most.
    pub fn is_beyond(self, most: f64) -> bool {
        let reach = SURE * self.deviation;
        self.value + reach < 1.0 / most || self.value - reach > most
    }
}

/// Logged torque over what the motor's inertia takes of it while the joint rings.
pub fn of_the_motor(free: &Solution) -> Factor {
    let compliance = free.values[twist::COMPLIANCE];
    let value = 1.0 / (1.0 + free.values[twist::TORQUE_ERROR] / compliance);
    Factor {
        value,
        deviation: free.half(&[(twist::TORQUE_ERROR, 1.0)]) / free.reach / compliance.abs() * value * value,
    }
}

/// Logged torque over what the joint file's inertias need: everything that turns, losses, friction and weight apart.
pub fn of_all(rows: &Rows, prior: &PriorModel) -> Option<Factor> {
    let mut equations = Equations::of_moments(rows.alike);
    for row in rows.all.iter().filter(|row| row.direction != 0.0) {
        let needed =
            row.leverage * prior.motor_inertia * row.motor_acceleration + prior.link_inertia * row.output_acceleration;
        let coefficients = vec![needed, row.direction, row.output_speed, row.output.sin(), row.output.cos(), 1.0];
        let block = (row.time / BLOCK_LENGTH) as usize;
        equations.push(coefficients, row.motor_torque, block);
    }
    let held = HELD * rows.greatest.max(f64::MIN_POSITIVE);
    let solution = equations.solve(&[f64::INFINITY, f64::INFINITY, f64::INFINITY, held, held, held])?;
    Some(Factor::of(&solution, 0))
}
