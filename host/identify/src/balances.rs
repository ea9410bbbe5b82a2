//! Comparison of the logged torque with the joint file's inertias: the motor's inertia while the joint rings, and the
//! total inertia. `contradictions` rejects implausible ratios; `scales` estimates torque and inertias from them.

use super::friction::{self, MotorSide};
use super::prior::PriorModel;
use super::regression::{Equations, Solution};
use super::rows::Rows;
use super::twist::{self, BLOCK_LENGTH};

/// Standard deviations by which a factor is certain.
pub const CERTAINTY_SIGMA: f64 = 6.0;
/// Prior width of gravity and of an offset, as a share of the largest torque.
const STATIC_TORQUE_WIDTH: f64 = 1.0;
/// Largest relative standard deviation of a factor that counts as determined.
const FACTOR_DEVIATION_MAX: f64 = 0.1;

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
    pub fn of_unknown(solution: &Solution, unknown: usize) -> Self {
        Self { value: solution.values[unknown], deviation: solution.half(&[(unknown, 1.0)]) / solution.coverage_factor }
    }

    /// Returns true if the ratio is determined well enough for comparisons.
    pub fn is_determined(self) -> bool {
        self.deviation < FACTOR_DEVIATION_MAX * self.value.abs()
    }

    /// Returns true if the ratio is certainly outside of 1/most to most.
    pub fn is_certainly_outside(self, most: f64) -> bool {
        let reach = CERTAINTY_SIGMA * self.deviation;
        self.value + reach < 1.0 / most || self.value - reach > most
    }
}

/// Ratio of the logged torque to the torque that accelerates the motor's inertia while the joint rings.
pub fn ringing_factor(free: &Solution) -> Factor {
    let compliance = free.values[twist::COMPLIANCE];
    let value = 1.0 / (1.0 + free.values[twist::TORQUE_ERROR] / compliance);
    Factor {
        value,
        deviation: free.half(&[(twist::TORQUE_ERROR, 1.0)]) / free.coverage_factor / compliance.abs() * value * value,
    }
}

/// Ratios from the torque measured at the output: the motor's true torque over the logged torque, and the inertias of
/// motor and link over the joint file's. `quick` are moments of ringing, `slow` moments of slow motion.
pub fn sensor_factors([quick, slow]: [&Rows; 2], prior: &PriorModel) -> [Option<Factor>; 3] {
    let motor = friction::fit_motor(quick, prior);
    let of = |unknown: usize, over: f64| {
        let Factor { value, deviation } = Factor::of_unknown(motor.as_ref()?, unknown);
        Some(Factor { value: 1.0 + value / over, deviation: deviation / over })
    };
    let link = friction::fit_link(slow, prior, MotorSide::default())
        .map(|link| Factor::of_unknown(&link, friction::LINK_INERTIA));
    let over = prior.link_inertia;
    [
        of(friction::MOTOR_TORQUE_ERROR, 1.0),
        of(friction::MOTOR_INERTIA_EXCESS, prior.motor_inertia),
        link.map(|Factor { value, deviation }| Factor { value: value / over, deviation: deviation / over }),
    ]
}

/// Logged torque over the torque that the joint file's total inertia needs, beside losses, friction and weight.
pub fn total_factor(rows: &Rows, prior: &PriorModel) -> Option<Factor> {
    Some(Factor::of_unknown(&fit_balance(rows, prior, &|needed, _| vec![needed])?, 0))
}

/// Constant torque at the output [N m].
pub fn constant_torque(rows: &Rows, prior: &PriorModel) -> Option<Factor> {
    Some(Factor::of_unknown(&fit_balance(rows, prior, &|needed, _| vec![needed])?, CONSTANT_TORQUE))
}

/// Logged torque over needed torque, for forward and backward torque separately.
pub fn factors_by_direction(rows: &Rows, prior: &PriorModel) -> Option<[Factor; 2]> {
    let solution =
        fit_balance(rows, prior, &|needed, torque| if torque > 0.0 { vec![needed, 0.0] } else { vec![0.0, needed] })?;
    Some([0, 1].map(|way| Factor::of_unknown(&solution, way)))
}

/// Logged torque over needed torque for small torques, and the excess of this ratio for large torques.
pub fn factors_by_size(rows: &Rows, prior: &PriorModel) -> Option<[Factor; 2]> {
    let large = LARGE_TORQUE_SHARE * rows.largest_torque;
    let split = |needed: f64, torque: f64| {
        vec![needed, if torque.abs() > large { needed - large.copysign(torque) } else { 0.0 }]
    };
    let solution = fit_balance(rows, prior, &split)?;
    Some([0, 1].map(|part| Factor::of_unknown(&solution, part)))
}

/// Least share of the largest torque of a large torque.
const LARGE_TORQUE_SHARE: f64 = 0.6;
/// Index of the constant torque after a single unknown for the needed torque.
const CONSTANT_TORQUE: usize = 5;

/// Fits the logged torque by `split` parts of the needed torque, friction, weight and a constant.
fn fit_balance(rows: &Rows, prior: &PriorModel, split: &dyn Fn(f64, f64) -> Vec<f64>) -> Option<Solution> {
    let mut equations = Equations::with_repetition(rows.repetition);
    let mut unknowns = 0;
    for row in rows.all.iter().filter(|row| row.direction != 0.0) {
        let needed =
            row.leverage * prior.motor_inertia * row.motor_acceleration + prior.link_inertia * row.output_acceleration;
        let mut coefficients = split(needed, row.motor_torque);
        unknowns = coefficients.len();
        coefficients.extend([row.direction, row.output_speed, row.output.sin(), row.output.cos(), 1.0]);
        equations.push(coefficients, row.motor_torque, (row.time / BLOCK_LENGTH) as usize);
    }
    let held = STATIC_TORQUE_WIDTH * rows.largest_torque.max(f64::MIN_POSITIVE);
    let mut widths = vec![f64::INFINITY; unknowns + 2];
    widths.extend([held; 3]);
    equations.solve(&widths)
}
