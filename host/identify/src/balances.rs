//! Comparison of the logged torque with the joint file's inertias: the motor's inertia while the joint rings, and the
//! total inertia. `contradictions` rejects implausible ratios; `scales` estimates torque and inertias from them.

use super::friction::{self, MotorSide};
use super::prior::PriorModel;
use super::regression::{Equations, Solution};
use super::rows::Rows;
use super::twist::{self, BLOCK_LENGTH};

/// Standard deviations by which a factor is certain.
pub const SURE: f64 = 6.0;
/// Prior width of gravity and of an offset, as a share of the largest torque.
const HELD: f64 = 1.0;
/// Largest relative standard deviation of a factor that counts as determined.
const NARROW: f64 = 0.1;

/// Ratio with the expected value 1.
#[derive(Debug, Clone, Copy)]
pub struct Factor {
    /// Value of the ratio.
    pub value: f64,
    /// Standard deviation of the ratio.
    pub deviation: f64,
}

impl Factor {
    /// Ratio from an unknown of a solution.
    pub fn of(solution: &Solution, unknown: usize) -> Self {
        Self { value: solution.values[unknown], deviation: solution.half(&[(unknown, 1.0)]) / solution.reach }
    }

    /// Returns true if the ratio is determined well enough for comparisons.
    pub fn is_narrow(self) -> bool {
        self.deviation < NARROW * self.value.abs()
    }

    /// Returns true if the ratio is certainly outside of 1/most to most.
    pub fn is_beyond(self, most: f64) -> bool {
        let reach = SURE * self.deviation;
        self.value + reach < 1.0 / most || self.value - reach > most
    }
}

/// Logged torque over the torque that the motor's inertia needs while the joint rings.
pub fn of_the_motor(free: &Solution) -> Factor {
    let compliance = free.values[twist::COMPLIANCE];
    let value = 1.0 / (1.0 + free.values[twist::TORQUE_ERROR] / compliance);
    Factor {
        value,
        deviation: free.half(&[(twist::TORQUE_ERROR, 1.0)]) / free.reach / compliance.abs() * value * value,
    }
}

/// Ratios from the torque measured at the output: the motor's true torque over the logged torque, and the inertias of
/// motor and link over the joint file's. `quick` are moments of ringing, `slow` moments of slow motion.
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

/// Logged torque over the torque that the joint file's total inertia needs, beside losses, friction and weight.
pub fn of_all(rows: &Rows, prior: &PriorModel) -> Option<Factor> {
    Some(Factor::of(&all(rows, prior, &|needed, _| vec![needed])?, 0))
}

/// Constant torque at the output [N m].
pub fn constant(rows: &Rows, prior: &PriorModel) -> Option<Factor> {
    Some(Factor::of(&all(rows, prior, &|needed, _| vec![needed])?, LAST))
}

/// Logged torque over needed torque, for forward and backward torque separately.
pub fn one_way_and_the_other(rows: &Rows, prior: &PriorModel) -> Option<[Factor; 2]> {
    let solution =
        all(rows, prior, &|needed, torque| if torque > 0.0 { vec![needed, 0.0] } else { vec![0.0, needed] })?;
    Some([0, 1].map(|way| Factor::of(&solution, way)))
}

/// Logged torque over needed torque for small torques, and the excess of this ratio for large torques.
pub fn small_and_large(rows: &Rows, prior: &PriorModel) -> Option<[Factor; 2]> {
    let large = LARGE * rows.greatest;
    let split = |needed: f64, torque: f64| {
        vec![needed, if torque.abs() > large { needed - large.copysign(torque) } else { 0.0 }]
    };
    let solution = all(rows, prior, &split)?;
    Some([0, 1].map(|part| Factor::of(&solution, part)))
}

/// Least share of the largest torque of a large torque.
const LARGE: f64 = 0.6;
/// Index of the constant torque after a single unknown for the needed torque.
const LAST: usize = 5;

/// Fits the logged torque by `split` parts of the needed torque, friction, weight and a constant.
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
