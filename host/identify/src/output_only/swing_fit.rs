//! Least-squares fit of the balance of torques to the swings. y is the output's angle, T the motor's torque at the
//! output, d the direction of the swing, I the inertia of motor and link together and D the delay of the torque. The
//! common centre of motor and link obeys
//!
//! ```text
//! I y'' = T(t - D) - d F - d l |T| - v y' - g_s sin y - g_c cos y - o                           (1)
//! ```
//!
//! in every state of contact, with dry friction F, loss l of the gears, viscous friction v, weight g_s, g_c and torque
//! offset o. The output differs from the common centre by the motor's share of the inertia times the twist, and moves
//! on by
//!
//! ```text
//! S + k |dT| along d                                                                            (2)
//! ```
//!
//! after the twist has changed its side. (1) is integrated twice. Angle and speed of each swing, and the change of its
//! speed at the reversal, are unknowns of that swing alone and are eliminated first. Intervals come from the scatter
//! between swings.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::swings::Swing;
use crate::estimate::Estimate;
use crate::statistics::{quantile_of, student};

/// Unknowns that all swings share.
pub const SHARED: usize = 9;
/// 1/I [1/(kg m^2)]; F, l, v, g_s, g_c and o over I; S [rad], k [rad/(N m)].
pub const TORQUE: usize = 0;
pub const DRY: usize = 1;
pub const LOSS: usize = 2;
pub const VISCOUS: usize = 3;
pub const SINE: usize = 4;
pub const COSINE: usize = 5;
pub const OFFSET: usize = 6;
pub const STEP: usize = 7;
pub const STEP_BY_TORQUE: usize = 8;
/// Unknowns of a swing: angle, speed, and change of the speed at the reversal.
const OWN: usize = 3;
/// Number of fits; each uses the delay and the weights of the previous fit.
const FIT_ROUNDS: usize = 4;
/// Standard deviation of the expected loss of the gears, over the torque [-].
const EXPECTED_LOSS: f64 = 0.3;

/// Samples of a log: time [s], output angle [rad] and torque at the output [N m].
#[derive(Debug, Clone, Copy)]
pub struct Samples<'s> {
    pub time: &'s [f64],
    pub angle: &'s [f64],
    pub torque: &'s [f64],
}

/// Solution of the fit.
#[derive(Debug, Clone)]
pub struct SwingFit {
    /// Shared unknowns.
    pub values: SVector<f64, SHARED>,
    /// Covariance of the shared unknowns.
    pub covariance: SMatrix<f64, SHARED, SHARED>,
    /// Half of a 95 % interval in standard deviations.
    pub quantile: f64,
    /// Delay of the torque and of the reading together [s].
    pub delay: f64,
    /// Root mean square of the residuals of a typical swing [rad].
    pub residual: f64,
    /// Residuals: time after the reversal [s] and angle [rad].
    pub residuals: Vec<(f64, f64)>,
    /// Fastest swing [rad/s].
    pub fastest: f64,
}

/// Speed and angle by integration of an acceleration `rate` over the log.
struct Integral {
    speed: Vec<f64>,
    angle: Vec<f64>,
    rate: Vec<f64>,
}

impl Integral {
    /// Integrates a rate that each sample holds until the next.
    fn new(time: &[f64], rate: Vec<f64>) -> Self {
        let (mut speed, mut angle) = (vec![0.0; time.len()], vec![0.0; time.len()]);
        for sample in 1..time.len() {
            let step = time[sample] - time[sample - 1];
            speed[sample] = speed[sample - 1] + step * rate[sample - 1];
            angle[sample] = angle[sample - 1] + step * (speed[sample - 1] + 0.5 * step * rate[sample - 1]);
        }
        Self { speed, angle, rate }
    }

    fn at(&self, time: &[f64], moment: f64) -> f64 {
        let sample = time.partition_point(|time| *time <= moment).saturating_sub(1);
        let since = moment - time[sample];
        self.angle[sample] + since * (self.speed[sample] + 0.5 * since * self.rate[sample])
    }
}

/// Equations of one swing, with the unknowns of the swing alone eliminated.
struct SwingEquations {
    /// Left sides, right sides.
    shared: DMatrix<f64>,
    right: DVector<f64>,
    /// Change of the speed at the reversal after elimination: slopes by the shared unknowns, and the value from the
    /// readings.
    change: (SVector<f64, SHARED>, f64),
    /// Time after the reversal [s].
    after: Vec<f64>,
    weight: f64,
}

/// Expected size of the compliance's part of the step [rad/(N m)] and inertia of motor and link together [kg m^2].
#[derive(Debug, Clone, Copy)]
pub struct Expected {
    pub step_by_torque: f64,
    pub inertia: f64,
}

/// Integrals over a log that the equations of all swings use.
pub struct Integrals<'s> {
    samples: Samples<'s>,
    driven: Integral,
    lost: Integral,
    sine: Integral,
    cosine: Integral,
    turned: Integral,
    /// 98 % quantile of the torque's size at the output [N m].
    largest: f64,
}

impl<'s> Integrals<'s> {
    /// Computes the integrals.
    pub fn new(samples: Samples<'s>) -> Self {
        let Samples { time, angle, torque } = samples;
        let magnitude: Vec<f64> = torque.iter().map(|torque| torque.abs()).collect();
        let last = time.len().saturating_sub(1);
        let mean = |value: fn(f64) -> f64| -> Vec<f64> {
            (0..time.len()).map(|sample| 0.5 * (value(angle[sample]) + value(angle[(sample + 1).min(last)]))).collect()
        };
        Self {
            samples,
            largest: quantile_of(&magnitude, 0.98),
            driven: Integral::new(time, torque.to_vec()),
            lost: Integral::new(time, magnitude),
            sine: Integral::new(time, mean(f64::sin)),
            cosine: Integral::new(time, mean(f64::cos)),
            turned: Integral::new(time, mean(|angle| angle)),
        }
    }

    /// Returns the time from the reversal to the end of the swing [s].
    pub fn time_after(&self, swing: &Swing) -> f64 {
        self.samples.time[swing.after[1]] - self.samples.time[swing.reversal]
    }

    /// Returns time and angle since the reversal, and the motion of the output by a unit of each shared unknown.
    pub fn row(&self, swing: &Swing, sample: usize, delay: f64) -> (f64, f64, [f64; SHARED]) {
        let Samples { time, angle, .. } = self.samples;
        let (start, direction) = (swing.reversal, swing.direction);
        let since = time[sample] - time[start];
        let parabola = 0.5 * since * since;
        let late = |integral: &Integral| {
            integral.at(time, time[sample] - delay) - integral.angle[start] - since * integral.speed[start]
        };
        let whole =
            |integral: &Integral| integral.angle[sample] - integral.angle[start] - since * integral.speed[start];
        let later = if sample >= start { direction } else { 0.0 };
        let row = [
            late(&self.driven),
            -direction * parabola,
            -direction * late(&self.lost),
            // The speed's integral is the angle: one integration is enough.
            -(self.turned.speed[sample] - self.turned.speed[start] - since * angle[start]),
            -whole(&self.sine),
            -whole(&self.cosine),
            -parabola,
            later,
            later * (swing.torque[0] + swing.torque[1]),
        ];
        (since, angle[sample] - angle[start], row)
    }
}

impl SwingFit {
    /// Fits the swings; returns `None` if the swings do not determine the unknowns.
    pub fn fit(integrals: &Integrals<'_>, swings: &[Swing], expected: Expected) -> Option<Self> {
        let largest = integrals.largest;
        let (mut delay, mut inverse) = (0.0, 1.0 / expected.inertia);
        let mut solved = None;
        let mut weights = vec![1.0; swings.len()];
        for _ in 0..FIT_ROUNDS {
            let of_swing =
                |(swing, weight): (&Swing, &f64)| SwingEquations::from_swing(integrals, swing, delay, *weight);
            let equations: Vec<SwingEquations> = swings.iter().zip(&weights).filter_map(of_swing).collect();
            if equations.len() != swings.len() {
                return None;
            }
            let compliance_by_inertia = |torque: f64| 1.0 / (torque * inverse).powi(2);
            let fastest =
                largest * inverse * swings.iter().map(|swing| integrals.time_after(swing)).fold(0.0, f64::max);
            // Prior widths separate unknowns that no swing separates.
            let mut expected_size = SVector::<f64, SHARED>::zeros();
            expected_size[LOSS] = 1.0 / (EXPECTED_LOSS * inverse).powi(2);
            expected_size[VISCOUS] = compliance_by_inertia(largest / fastest.max(f64::MIN_POSITIVE));
            for unknown in [SINE, COSINE, OFFSET] {
                expected_size[unknown] = compliance_by_inertia(largest);
            }
            let late = 0.5 * delay * delay * inverse;
            expected_size[STEP_BY_TORQUE] = 1.0 / (0.5 * expected.step_by_torque + late).powi(2);
            let fit = solve(&equations, expected_size, expected.step_by_torque)?;
            let reached = |one: &SwingEquations| {
                let left = &one.right - &one.shared * DVector::from_column_slice(fit.values.as_slice());
                (left.norm_squared() / left.len() as f64).max(f64::MIN_POSITIVE)
            };
            let scatter: Vec<f64> = equations.iter().map(reached).collect();
            let usual = quantile_of(&scatter, 0.25);
            weights = scatter.iter().map(|scatter| usual / scatter.max(usual)).collect();
            inverse = fit.values[TORQUE].abs().max(f64::MIN_POSITIVE);
            // A torque delayed by D changes the speed by D times the change of acceleration.
            let late: Vec<f64> = swings
                .iter()
                .zip(&equations)
                .map(|(swing, one)| {
                    let change = one.change.1 - one.change.0.dot(&fit.values);
                    swing.direction * change / (inverse * (swing.torque[0] + swing.torque[1]))
                })
                .collect();
            delay = (delay + quantile_of(&late, 0.5)).max(0.0);
            if !delay.is_finite() {
                return None;
            }
            solved = Some(Self { delay, fastest, ..fit });
        }
        solved
    }

    /// Half of the 95 % interval of a combination of the unknowns, by its slopes.
    pub fn half(&self, slopes: &[(usize, f64)]) -> f64 {
        let mut all = SVector::<f64, SHARED>::zeros();
        slopes.iter().for_each(|(unknown, slope)| all[*unknown] = *slope);
        self.quantile * (all.transpose() * self.covariance * all)[0].max(0.0).sqrt()
    }

    /// Combination of the unknowns, by its slopes.
    pub fn combination(&self, slopes: &[(usize, f64)]) -> Estimate {
        let value = slopes.iter().map(|(unknown, slope)| slope * self.values[*unknown]).sum();
        Estimate { value, half: self.half(slopes) }
    }

    /// Estimate of one unknown.
    pub fn estimate(&self, unknown: usize) -> Estimate {
        self.combination(&[(unknown, 1.0)])
    }

    /// Returns an unknown times the inertia, in the unit of a torque: (1) is divided by I.
    pub fn torque_of(&self, unknown: usize) -> Estimate {
        let inverse = self.values[TORQUE];
        let value = self.values[unknown] / inverse;
        Estimate { value, half: self.half(&[(unknown, 1.0 / inverse), (TORQUE, -value / inverse)]) }
    }
}

impl SwingEquations {
    fn from_swing(integrals: &Integrals<'_>, swing: &Swing, delay: f64, weight: f64) -> Option<Self> {
        let chosen: Vec<usize> = swing.samples().collect();
        let (mut own, mut shared) = (DMatrix::zeros(chosen.len(), OWN), DMatrix::zeros(chosen.len(), SHARED));
        let mut right = DVector::zeros(chosen.len());
        let mut after = Vec::with_capacity(chosen.len());
        for (row, sample) in chosen.into_iter().enumerate() {
            let (since, angle, values) = integrals.row(swing, sample, delay);
            own.row_mut(row).copy_from_slice(&[1.0, since, since.max(0.0)]);
            shared.row_mut(row).copy_from_slice(&values);
            right[row] = angle;
            after.push(since);
        }
        Self::without_own(&own, shared, right, after, weight)
    }

    fn without_own(
        own: &DMatrix<f64>,
        shared: DMatrix<f64>,
        right: DVector<f64>,
        after: Vec<f64>,
        weight: f64,
    ) -> Option<Self> {
        let elimination = (own.transpose() * own).cholesky()?.inverse() * own.transpose();
        let (by_shared, by_right) = (&elimination * &shared, &elimination * &right);
        let change = (SVector::from_iterator(by_shared.row(OWN - 1).iter().copied()), by_right[OWN - 1]);
        Some(Self { shared: shared - own * by_shared, right: right - own * by_right, change, after, weight })
    }
}

/// Least squares of all swings with prior terms: `expected` is the inverse variance of each unknown around zero; for
/// the step by the torque, around `step_by_torque`.
fn solve(equations: &[SwingEquations], expected: SVector<f64, SHARED>, step_by_torque: f64) -> Option<SwingFit> {
    type Square = SMatrix<f64, SHARED, SHARED>;
    let (mut square, mut right) = (Square::zeros(), SVector::<f64, SHARED>::zeros());
    for one in equations {
        let product = one.weight * one.shared.transpose() * &one.shared;
        square += Square::from_iterator(product.iter().copied());
        right += SVector::from_iterator((one.weight * one.shared.transpose() * &one.right).iter().copied());
    }
    let scale = square.diagonal().map(|value| if value > 0.0 { value.sqrt().recip() } else { 1.0 });
    let scaling = Square::from_diagonal(&scale);
    let count: usize = equations.iter().map(|one| one.right.len()).sum();
    let freedom = count.checked_sub(OWN * equations.len() + SHARED).filter(|freedom| *freedom > 0)? as f64;
    let swings_left = equations.len().checked_sub(SHARED).filter(|left| *left > 0)? as f64;
    let mut middle = SVector::<f64, SHARED>::zeros();
    middle[STEP_BY_TORQUE] = step_by_torque;
    let left_over = |one: &SwingEquations, values: &SVector<f64, SHARED>| {
        &one.right - &one.shared * DVector::from_column_slice(values.as_slice())
    };
    let mut variance = 0.0;
    let mut solved = None;
    for _ in 0..3 {
        let prior = Square::from_diagonal(&(variance * expected));
        // A diagonal of 1e-12 makes the first solution unique if no swing does.
        let scaled = scaling * (square + prior) * scaling + Square::identity() * 1e-12;
        let inverse = scaling * scaled.cholesky()?.inverse() * scaling;
        let values = inverse * (right + prior * middle);
        let weighted = |one: &SwingEquations| one.weight * left_over(one, &values).norm_squared();
        let of_residuals = equations.iter().map(weighted).sum::<f64>() / freedom;
        solved = Some((inverse, values, prior));
        variance = of_residuals;
    }
    let (inverse, values, prior) = solved?;
    let mut scatter = variance * prior;
    let few = equations.len() as f64 / swings_left;
    for one in equations {
        let score = one.weight * one.shared.transpose() * left_over(one, &values);
        let score = SVector::<f64, SHARED>::from_iterator(score.iter().copied());
        scatter += few * score * score.transpose();
    }
    let all_residuals = equations
        .iter()
        .flat_map(|one| {
            let left = left_over(one, &values);
            one.after.iter().copied().zip(left.iter().copied()).collect::<Vec<_>>()
        })
        .collect();
    values.iter().all(|value| value.is_finite()).then_some(SwingFit {
        values,
        covariance: inverse * scatter * inverse,
        quantile: student(swings_left),
        delay: 0.0,
        residual: variance.sqrt(),
        residuals: all_residuals,
        fastest: 0.0,
    })
}
