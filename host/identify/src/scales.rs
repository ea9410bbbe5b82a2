//! Scales of torque, motor inertia and link inertia, which neither joint file nor drive knows exactly. A log of motion
//! cannot determine all three: twice the torque accelerates twice the inertia alike. It determines two ratios: torque
//! over motor inertia while the joint rings, and torque over total inertia. Expectations and ratios together give the
//! likeliest scales and their joint covariance.
//!
//! With the logarithms t, m and l of true over stated torque, motor inertia and link inertia, and the motor's share a
//! of the total inertia, the ratios are t - m = r and t - a m - (1 - a) l = w. The expected values of t, m and l are
//! zero, each with its deviation. If expectations and ratios contradict one another, all expected deviations are scaled
//! up (Birge's ratio).

use nalgebra::{SMatrix, SVector, Vector3, Vector4};

use super::balances::{self, Factor};
use super::estimate::NORMAL_QUANTILE;
use super::log::Log;
use super::prior::PriorModel;
use super::regression::Solution;
use super::rows::Rows;

/// Kernel box for the balance of the total inertia [s]: long enough for coarse counts, short against a reversal.
const BALANCE_KERNEL_BOX: f64 = 4e-3;
/// Systematic error of a ratio by losses, teeth and the shapes of friction; at most 0.4 % on simulated logs of the
/// presets.
const RATIO_SYSTEMATIC: f64 = 0.004;
/// Deviation of the logarithm of an undetermined ratio.
const UNDETERMINED_DEVIATION: f64 = 10.0;
/// Least deviation of a scale; keeps the sums finite for an exact torque.
const DEVIATION_MIN: f64 = 1e-6;
/// Standard deviation of the scale of a torque sensor at the output; typical of data sheets.
const SENSOR_SCALE_DEVIATION: f64 = 0.005;
/// Birge's ratio from which expectations and ratios contradict one another.
const BIRGE_CONTRADICTION: f64 = 2.0;

/// True over stated values, as logarithms with standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Scale of the torque.
    pub torque: Scale,
    /// Scale of the motor's inertia.
    pub motor_inertia: Scale,
    /// Scale of the link's inertia.
    pub link_inertia: Scale,
    /// Standard deviation of the logarithm of the motor's inertia for a known scale of the torque.
    pub motor_inertia_alone: f64,
    /// Birge's ratio: factor on the expected deviations, 1 without contradiction.
    pub birge: f64,
    /// Relative error of all rates: if both inertias contradict the torque alike, the time step may be wrong.
    pub rate_error: f64,
}

/// One scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Logarithm of true over stated.
    pub logarithm: f64,
    /// Standard deviation of the logarithm.
    pub deviation: f64,
    /// Least half of the interval: after a contradiction the stated value may still be right.
    pub half_min: f64,
}

/// Uncertainty of a torque that was not measured behind the gears.
#[derive(Debug, Clone, Copy)]
pub struct ScaleUncertainty {
    /// Scales of torque and inertias.
    pub scales: Scales,
    /// Relative change of the compliance by the motor's inertia at the end of its interval for a known torque.
    pub compliance_by_inertia: f64,
}

impl Scale {
    /// True over stated.
    pub fn factor(self) -> f64 {
        self.logarithm.exp()
    }

    /// Scale of a logarithm with its variance.
    fn from_logarithm(logarithm: f64, variance: f64, birge: f64) -> Self {
        let half_min = if birge > BIRGE_CONTRADICTION { logarithm.abs() } else { 0.0 };
        Self { logarithm, deviation: variance.sqrt(), half_min }
    }

    /// Half of the 95 % interval.
    pub fn half(self) -> f64 {
        self.half_min.max(NORMAL_QUANTILE * self.deviation)
    }

    /// Returns true if the stated value is outside of the interval.
    pub fn differs_from_stated(self) -> bool {
        self.logarithm.abs() > NORMAL_QUANTILE * self.deviation
    }
}

impl Scales {
    /// Scales of a log, from a fit with an unknown scale of the torque.
    pub fn new(log: &Log, prior: &PriorModel, free: &Solution) -> Self {
        let ringing = Some(balances::ringing_factor(free));
        let all = balances::total_factor(&Rows::new(log, prior, BALANCE_KERNEL_BOX), prior);
        Self::from_expectations([prior.torque_error, prior.inertia_error], prior.motor_share(), [ringing, all])
    }

    /// Likeliest scales, from the expected deviations of torque and inertias, the motor's share of the total inertia,
    /// and the logged torque over the torque for the motor's inertia and for the total inertia.
    fn from_expectations([torque, inertia]: [f64; 2], share: f64, factors: [Option<Factor>; 2]) -> Self {
        // Logged torque below the torque for the inertias means a larger true torque.
        let [of_motor, of_all] = factors.map(MeasuredLogarithm::of_factor);
        let (solved, covariance, birge) = most_likely(
            Vector3::from([torque, inertia, inertia]),
            &[(Vector3::from([1.0, -1.0, 0.0]), of_motor), (Vector3::from([1.0, -share, share - 1.0]), of_all)],
        );
        let scale = |place: usize| Scale::from_logarithm(solved[place], covariance[(place, place)], birge);
        let [of_torque, common, of_motor] = [covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]];
        let motor_inertia_alone = (of_motor - common * common / of_torque).max(0.0).sqrt();
        Self {
            torque: scale(0),
            motor_inertia: scale(1),
            link_inertia: scale(2),
            motor_inertia_alone,
            birge,
            rate_error: rate_error(factors, birge),
        }
    }

    /// Scales of a log with a torque sensor at the output: `torque` is the sensor's scale, and balances give the scales
    /// of motor torque, motor inertia and link inertia relative to it.
    pub fn from_sensor(prior: &PriorModel, [motor_torque, motor, link]: [Option<Factor>; 3]) -> Self {
        let seen = [motor_torque, motor, link].map(MeasuredLogarithm::of_factor);
        let log_ratio_to_sensor = |place: usize| {
            Vector4::from_fn(|row, _| {
                if row == 0 {
                    1.0
                } else if row == place {
                    -1.0
                } else {
                    0.0
                }
            })
        };
        let (solved, covariance, birge) = most_likely(
            Vector4::from([SENSOR_SCALE_DEVIATION, prior.torque_error, prior.inertia_error, prior.inertia_error]),
            &[(log_ratio_to_sensor(1), seen[0]), (log_ratio_to_sensor(2), seen[1]), (log_ratio_to_sensor(3), seen[2])],
        );
        let scale = |place: usize| Scale::from_logarithm(solved[place], covariance[(place, place)], birge);
        Self {
            torque: scale(0),
            motor_inertia: scale(2),
            link_inertia: scale(3),
            motor_inertia_alone: 0.0,
            birge,
            rate_error: rate_error([motor, link], birge),
        }
    }

    /// Joint with the motor's inertia at the upper end of its interval for a known torque.
    pub fn with_largest_motor_inertia(&self, prior: &PriorModel) -> PriorModel {
        with_motor(prior, (NORMAL_QUANTILE * self.motor_inertia_alone).exp())
    }

    /// Applies the scales to a log and to the joint.
    pub fn apply(&self, log: &Log, prior: &PriorModel) -> (Log, PriorModel) {
        let mut log = log.clone();
        let torques = log.output_torque.as_mut().unwrap_or(&mut log.torque);
        torques.iter_mut().for_each(|torque| *torque *= self.torque.factor());
        let mut prior = with_motor(prior, self.motor_inertia.factor());
        prior.link_inertia *= self.link_inertia.factor();
        (log, prior)
    }
}

/// Joint with the motor's inertia times `factor`.
fn with_motor(prior: &PriorModel, factor: f64) -> PriorModel {
    PriorModel {
        sun_inertia: factor * prior.sun_inertia,
        carrier_inertia: factor * prior.carrier_inertia,
        motor_inertia: factor * prior.motor_inertia,
        ..prior.clone()
    }
}

/// Logarithm with its standard deviation.
#[derive(Debug, Clone, Copy)]
struct MeasuredLogarithm {
    logarithm: f64,
    deviation: f64,
}

impl MeasuredLogarithm {
    /// Logarithm of a factor of logged over true; undetermined for a factor with a wide interval.
    fn of_factor(factor: Option<Factor>) -> Self {
        factor.filter(|factor| factor.value > 0.0 && factor.is_determined()).map_or(
            Self { logarithm: 0.0, deviation: UNDETERMINED_DEVIATION },
            |Factor { value, deviation }| Self {
                logarithm: -value.ln(),
                deviation: (deviation / value).hypot(RATIO_SYSTEMATIC),
            },
        )
    }
}

/// Likeliest logarithms, expected to be zero within their deviations, given noisy linear combinations; their
/// covariance, and Birge's ratio, which the covariance includes.
fn most_likely<const N: usize>(
    expected: SVector<f64, N>,
    seen: &[(SVector<f64, N>, MeasuredLogarithm)],
) -> (SVector<f64, N>, SMatrix<f64, N, N>, f64) {
    let solve = |birge: f64| {
        let expected = expected.map(|deviation| (birge * deviation.max(DEVIATION_MIN)).powi(-2));
        let mut information = SMatrix::<f64, N, N>::from_diagonal(&expected);
        let mut right = SVector::<f64, N>::zeros();
        for (of, MeasuredLogarithm { logarithm, deviation }) in seen {
            information += of * of.transpose() * deviation.powi(-2);
            right += of * (logarithm * deviation.powi(-2));
        }
        let covariance = information.cholesky().map_or_else(SMatrix::zeros, |cholesky| cholesky.inverse());
        let solved = covariance * right;
        let left: f64 =
            seen.iter().map(|(of, seen)| ((of.dot(&solved) - seen.logarithm) / seen.deviation).powi(2)).sum();
        (solved, covariance, left + solved.component_mul(&solved).dot(&expected))
    };
    let birge = (solve(1.0).2 / seen.len() as f64).sqrt().max(1.0);
    let (solved, covariance, _) = solve(birge);
    (solved, covariance, birge)
}

/// Relative error of the rates, from the factors of both inertias.
fn rate_error(factors: [Option<Factor>; 2], birge: f64) -> f64 {
    let [Some(one), Some(other)] = factors else { return 0.0 };
    let [one, other] = [one, other].map(|factor| factor.value.max(f64::MIN_POSITIVE).ln());
    if birge < BIRGE_CONTRADICTION || one * other <= 0.0 { 0.0 } else { 0.5 * one.abs().min(other.abs()) }
}

#[cfg(test)]
mod tests {
    use super::Scales;
    use crate::balances::Factor;

    /// Scales found for true over stated torque, motor inertia and link inertia.
    fn found(torque: f64, motor: f64, link: f64) -> Scales {
        let share = 0.06;
        let factor = |inertia: f64| Some(Factor { value: inertia / torque, deviation: 1e-3 });
        Scales::from_expectations([0.03, 0.015], share, [factor(motor), factor(share * motor + (1.0 - share) * link)])
    }

    /// An inertia off by 5 % leaves the true torque scale within its interval.
    #[test]
    fn scales_wrong_inertia_stays_in_interval() {
        for torque in [0.97, 1.0, 1.03] {
            for (motor, link) in [(1.0, 1.0), (1.05, 1.0), (0.95, 1.0), (1.0, 1.05), (1.0, 0.95)] {
                let scales = found(torque, motor, link);
                let off = (scales.torque.logarithm - f64::ln(torque)).abs();
                assert!(off < scales.torque.half(), "{torque} {motor} {link}: {off} of {scales:?}");
            }
        }
    }

    /// Consistent ratios narrow the interval; contradicting ones widen it by Birge's ratio.
    #[test]
    fn scales_contradiction_widens_interval() {
        assert!(found(1.03, 1.0, 1.0).torque.half() < 0.025);
        let contradicting = found(1.0, 1.2, 1.0);
        assert!(contradicting.birge > 3.0 && contradicting.torque.half() > 0.06, "{contradicting:?}");
    }

    /// With an exact torque the ratios determine both inertias.
    #[test]
    fn scales_exact_torque_determines_inertias() {
        let factor = |value: f64| Some(Factor { value, deviation: 1e-4 });
        let scales = Scales::from_expectations([0.0, 0.015], 0.06, [factor(1.05), factor(0.06 * 1.05 + 0.94)]);
        assert!(scales.torque.logarithm.abs() < 1e-4, "{scales:?}");
        assert!((scales.motor_inertia.factor() - 1.05).abs() < 0.01, "{scales:?}");
        assert!(scales.motor_inertia.differs_from_stated() && !scales.link_inertia.differs_from_stated(), "{scales:?}");
    }

    /// Without ratios the scales keep their expected values and deviations.
    #[test]
    fn scales_without_ratios_keep_expectation() {
        let scales = Scales::from_expectations([0.03, 0.015], 0.06, [None, None]);
        assert!(scales.torque.logarithm.abs() < 1e-6 && (scales.torque.deviation - 0.03).abs() < 1e-4, "{scales:?}");
    }
}
