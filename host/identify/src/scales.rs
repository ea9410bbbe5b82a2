//! What a log makes of three scales that a joint file and a drive state and neither knows exactly: the torque's, the motor's
//! inertia's and the link's. A log of motion cannot tell them all, since twice the torque turns twice the inertia alike; it
//! tells two ratios, torque over the motor's inertia while the joint rings, and torque over all that turns. What is expected
//! of each scale and those two ratios together give the likeliest three, and how far they may still be off together.
//!
//! With the logarithms t, m and l of true over stated torque, motor's and link's inertia, and the motor's share a of all that
//! turns, the ratios say t - m = r and t - a m - (1 - a) l = w; expected are t, m and l of zero, each within its deviation. If
//! what is expected does not fit together, all of it is taken to be less well known, by as much (Birge's ratio).

use nalgebra::{SMatrix, SVector, Vector3, Vector4};

use super::balances::{self, Factor};
use super::estimate::QUANTILE;
use super::log::Log;
use super::prior::PriorModel;
use super::regression::Solution;
use super::rows::Rows;

/// Box of the kernel for the balance of all that turns [s]: long enough for coarse counts, short beside a reversal.
const BOX: f64 = 4e-3;
/// What losses, teeth and the shapes of frictions put into a ratio beside its scatter. On simulated logs of the presets it is
/// 0.4 % at most.
const BALANCE_SHARE: f64 = 0.004;
/// Logarithms of ratios that say nothing have this deviation.
const UNKNOWN: f64 = 10.0;
/// A torque that is not doubted: keeps the sums finite.
const EXACT: f64 = 1e-6;
/// How wrong a sensor of the torque at the output may be, as a ratio: a standard deviation, of what data sheets say.
const SENSOR_ERROR: f64 = 0.005;
/// From this ratio of Birge on what is expected contradicts itself.
const CONTRADICTION: f64 = 2.0;

/// True over stated values, each as a logarithm with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Of the torque.
    pub torque: Scale,
    /// Of the motor's inertia.
    pub motor_inertia: Scale,
    /// Of the link's inertia.
    pub link_inertia: Scale,
    /// What is still open of the motor's inertia where the torque's scale is known: standard deviation of its logarithm.
    pub motor_inertia_alone: f64,
    /// What is expected is less well known than stated, by this factor; 1 if it fits together.
    pub birge: f64,
    /// By which share all rates may be off: where both inertias contradict the torque alike, the time step may be what is wrong.
    pub rates: f64,
}

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Logarithm of true over stated.
    pub logarithm: f64,
    /// Its standard deviation.
    pub deviation: f64,
    /// Half of its interval at the least: where what is expected contradicts itself, what was stated may yet be right.
    pub least: f64,
}

/// What stays open of a torque that was not measured behind the gears.
#[derive(Debug, Clone, Copy)]
pub struct Doubt {
    /// Of torque and inertias together.
    pub scales: Scales,
    /// What the motor's inertia, as much as it may still be off beside them, puts into the compliance, as a share of it.
    pub by_inertia: f64,
}

impl Scale {
    /// True over stated.
    pub fn factor(self) -> f64 {
        self.logarithm.exp()
    }

    /// From a solution.
    fn of(logarithm: f64, variance: f64, birge: f64) -> Self {
        let least = if birge > CONTRADICTION { logarithm.abs() } else { 0.0 };
        Self { logarithm, deviation: variance.sqrt(), least }
    }

    /// Half of its 95 % interval.
    pub fn half(self) -> f64 {
        self.least.max(QUANTILE * self.deviation)
    }

    /// Whether it is surely not what was stated.
    pub fn is_another(self) -> bool {
        self.logarithm.abs() > QUANTILE * self.deviation
    }
}

impl Scales {
    /// Of a log, and of a fit that expected nothing of the torque's scale.
    pub fn new(log: &Log, prior: &PriorModel, free: &Solution) -> Self {
        let ringing = Some(balances::of_the_motor(free));
        let all = balances::of_all(&Rows::new(log, prior, BOX), prior);
        Self::together([prior.torque_error, prior.inertia_error], prior.motor_share(), [ringing, all])
    }

    /// The likeliest, given what is expected of torque and inertias, the motor's share of all that turns, and the logged torque
    /// over what the motor's inertia and all inertias need.
    fn together([torque, inertia]: [f64; 2], share: f64, factors: [Option<Factor>; 2]) -> Self {
        // Where the log has less torque than the inertias need, the true torque is that much more.
        let [of_motor, of_all] = factors.map(Seen::of_factor);
        let (solved, covariance, birge) = likeliest(
            Vector3::from([torque, inertia, inertia]),
            &[(Vector3::from([1.0, -1.0, 0.0]), of_motor), (Vector3::from([1.0, -share, share - 1.0]), of_all)],
        );
        let scale = |place: usize| Scale::of(solved[place], covariance[(place, place)], birge);
        let [of_torque, common, of_motor] = [covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]];
        let motor_inertia_alone = (of_motor - common * common / of_torque).max(0.0).sqrt();
        Self {
            torque: scale(0),
            motor_inertia: scale(1),
            link_inertia: scale(2),
            motor_inertia_alone,
            birge,
            rates: rates(factors, birge),
        }
    }

    /// Likewise where the torque was measured at the output: what `sensor` is its scale, and balances tell the motor's torque, the
    /// motor's and the link's inertia by it, true over stated. The torque here is the measured one.
    pub fn of_measured(prior: &PriorModel, [motor_torque, motor, link]: [Option<Factor>; 3]) -> Self {
        let seen = [motor_torque, motor, link].map(Seen::of_factor);
        let told = |place: usize| {
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
        let (solved, covariance, birge) = likeliest(
            Vector4::from([SENSOR_ERROR, prior.torque_error, prior.inertia_error, prior.inertia_error]),
            &[(told(1), seen[0]), (told(2), seen[1]), (told(3), seen[2])],
        );
        let scale = |place: usize| Scale::of(solved[place], covariance[(place, place)], birge);
        Self {
            torque: scale(0),
            motor_inertia: scale(2),
            link_inertia: scale(3),
            motor_inertia_alone: 0.0,
            birge,
            rates: rates([motor, link], birge),
        }
    }

    /// What is known of the joint with the motor's inertia as large as it may be beside the torque's scale.
    pub fn with_most_of_the_motor(&self, prior: &PriorModel) -> PriorModel {
        with_motor(prior, (QUANTILE * self.motor_inertia_alone).exp())
    }

    /// The log and what is known of the joint, as these scales make them.
    pub fn apply(&self, log: &Log, prior: &PriorModel) -> (Log, PriorModel) {
        let mut log = log.clone();
        let torques = log.output_torque.as_mut().unwrap_or(&mut log.torque);
        torques.iter_mut().for_each(|torque| *torque *= self.torque.factor());
        let mut prior = with_motor(prior, self.motor_inertia.factor());
        prior.link_inertia *= self.link_inertia.factor();
        (log, prior)
    }
}

/// With so many times the motor's inertia.
fn with_motor(prior: &PriorModel, factor: f64) -> PriorModel {
    PriorModel {
        sun_inertia: factor * prior.sun_inertia,
        carrier_inertia: factor * prior.carrier_inertia,
        motor_inertia: factor * prior.motor_inertia,
        ..prior.clone()
    }
}

/// A logarithm with its deviation.
#[derive(Debug, Clone, Copy)]
struct Seen {
    logarithm: f64,
    deviation: f64,
}

impl Seen {
    /// Of a factor, logged over true; nothing where it is not known well.
    fn of_factor(factor: Option<Factor>) -> Self {
        factor.filter(|factor| factor.value > 0.0 && factor.is_narrow()).map_or(
            Self { logarithm: 0.0, deviation: UNKNOWN },
            |Factor { value, deviation }| Self {
                logarithm: -value.ln(),
                deviation: (deviation / value).hypot(BALANCE_SHARE),
            },
        )
    }
}

/// The likeliest logarithms, each expected to be zero within its deviation, by what is seen of sums of them; their covariance,
/// and Birge's ratio, which is in it.
fn likeliest<const N: usize>(
    expected: SVector<f64, N>,
    seen: &[(SVector<f64, N>, Seen)],
) -> (SVector<f64, N>, SMatrix<f64, N, N>, f64) {
    let solve = |birge: f64| {
        let expected = expected.map(|deviation| (birge * deviation.max(EXACT)).powi(-2));
        let mut information = SMatrix::<f64, N, N>::from_diagonal(&expected);
        let mut right = SVector::<f64, N>::zeros();
        for (of, Seen { logarithm, deviation }) in seen {
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

/// By which share rates may be off, from the torque over what both inertias need.
fn rates(factors: [Option<Factor>; 2], birge: f64) -> f64 {
    let [Some(one), Some(other)] = factors else { return 0.0 };
    let [one, other] = [one, other].map(|factor| factor.value.max(f64::MIN_POSITIVE).ln());
    if birge < CONTRADICTION || one * other <= 0.0 { 0.0 } else { 0.5 * one.abs().min(other.abs()) }
}

#[cfg(test)]
mod tests {
    use super::Scales;
    use crate::balances::Factor;

    /// What is found where torque and inertias are so much more than stated.
    fn found(torque: f64, motor: f64, link: f64) -> Scales {
        let share = 0.06;
        let factor = |inertia: f64| Some(Factor { value: inertia / torque, deviation: 1e-3 });
        Scales::together([0.03, 0.015], share, [factor(motor), factor(share * motor + (1.0 - share) * link)])
    }

    #[test]
    fn one_inertia_off_by_five_percent_is_within_the_interval() {
        for torque in [0.97, 1.0, 1.03] {
            for (motor, link) in [(1.0, 1.0), (1.05, 1.0), (0.95, 1.0), (1.0, 1.05), (1.0, 0.95)] {
                let scales = found(torque, motor, link);
                let off = (scales.torque.logarithm - f64::ln(torque)).abs();
                assert!(off < scales.torque.half(), "{torque} {motor} {link}: {off} of {scales:?}");
            }
        }
    }

    #[test]
    fn intervals_are_narrow_where_all_fits_and_wide_where_it_does_not() {
        assert!(found(1.03, 1.0, 1.0).torque.half() < 0.025);
        let contradicting = found(1.0, 1.2, 1.0);
        assert!(contradicting.birge > 3.0 && contradicting.torque.half() > 0.06, "{contradicting:?}");
    }

    #[test]
    fn a_torque_that_is_not_doubted_tells_the_inertias() {
        let factor = |value: f64| Some(Factor { value, deviation: 1e-4 });
        let scales = Scales::together([0.0, 0.015], 0.06, [factor(1.05), factor(0.06 * 1.05 + 0.94)]);
        assert!(scales.torque.logarithm.abs() < 1e-4, "{scales:?}");
        assert!((scales.motor_inertia.factor() - 1.05).abs() < 0.01, "{scales:?}");
        assert!(scales.motor_inertia.is_another() && !scales.link_inertia.is_another(), "{scales:?}");
    }

    #[test]
    fn a_log_that_tells_no_ratio_leaves_what_was_expected() {
        let scales = Scales::together([0.03, 0.015], 0.06, [None, None]);
        assert!(scales.torque.logarithm.abs() < 1e-6 && (scales.torque.deviation - 0.03).abs() < 1e-4, "{scales:?}");
    }
}
