//! What the torque of a log accelerates, held against the joint file's inertias: the motor's alone while the joint rings, and
//! all that turns. `contradictions` refuses what cannot be; `scales` finds what torque and inertias come to together.

use super::friction::{self, MotorSide};
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

/// By the torque measured at the output: the motor's true torque over the logged one, and the inertias of motor and link over the joint
/// file's. Rows are those of ringing and those of slow motion.
pub fn by_the_sensor([quick, slow]: [&Rows; 2], prior: &PriorModel) -> [Option<Factor>; 3] {
    let motor = friction::of_the_motor(quick, prior);
    let of = |unknown: usize, over: f64| {
        let Factor { value, deviation } = Factor::of(motor.as_ref()?, unknown);
        Some(Factor { value: 1.0 + value / over, deviation: deviation / over })
    };
    let link =
        friction::of_the_link(slow, prior, MotorSide::default()).map(|link| Factor::of(&link, friction::LINK_INERTIA));
    let over = prior.link_inertia;
    [
        of(friction::TORQUE_ERROR, 1.0),
        of(friction::MOTOR_INERTIA, prior.motor_inertia),
        link.map(|Factor { value, deviation }| Factor { value: value / over, deviation: deviation / over }),
    ]
}

/// Logged torque over what the joint file's inertias need: everything that turns, losses, friction and weight apart.
pub fn of_all(rows: &Rows, prior: &PriorModel) -> Option<Factor> {
    Some(Factor::of(&all(rows, prior, &|needed, _| vec![needed])?, 0))
}

/// A constant torque beside them [N m].
pub fn constant(rows: &Rows, prior: &PriorModel) -> Option<Factor> {
    Some(Factor::of(&all(rows, prior, &|needed, _| vec![needed])?, LAST))
}

/// Logged torque over what is needed, where that is forwards and where it is backwards.
pub fn one_way_and_the_other(rows: &Rows, prior: &PriorModel) -> Option<[Factor; 2]> {
    let solution =
        all(rows, prior, &|needed, torque| if torque > 0.0 { vec![needed, 0.0] } else { vec![0.0, needed] })?;
    Some([0, 1].map(|way| Factor::of(&solution, way)))
}

/// Logged torque over what is needed by the smaller torques, and by how much that is another by the larger ones.
pub fn small_and_large(rows: &Rows, prior: &PriorModel) -> Option<[Factor; 2]> {
    let large = LARGE * rows.greatest;
    let split = |needed: f64, torque: f64| {
        vec![needed, if torque.abs() > large { needed - large.copysign(torque) } else { 0.0 }]
    };
    let solution = all(rows, prior, &split)?;
    Some([0, 1].map(|part| Factor::of(&solution, part)))
}

/// Torques above this share of the largest are large.
const LARGE: f64 = 0.6;
/// Place of the constant torque where what is needed has one unknown.
const LAST: usize = 5;

/// Logged torque by unknowns that go with what the inertias need, which `split` makes of it and of the torque, then friction, weight
/// and a constant.
fn all(rows: &Rows, prior: &PriorModel, split: &dyn Fn(f64, f64) -> Vec<f64>) -> Option<Solution> {
    let mut equations = Equations::of_moments(rows.alike);
    let mut unknowns = 0;
    for row in rows.all.iter().filter(|row| row.direction != 0.0) {
        let needed =
            row.leverage * prior.motor_inertia * row.motor_acceleration + prior.link_inertia * row.output_acceleration;
        let mut coefficients = split(needed, row.motor_torque);
        unknowns = coefficients.len();
        coefficients.extend([row.direction, row.output_speed, row.output.sin(), row.output.cos(), 1.0]);
        equations.push(coefficients, row.motor_torque, (row.time / BLOCK_LENGTH) as usize);
    }
    let held = HELD * rows.greatest.max(f64::MIN_POSITIVE);
    let mut widths = vec![f64::INFINITY; unknowns + 2];
    widths.extend([held; 3]);
    equations.solve(&widths)
}
