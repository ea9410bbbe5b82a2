//! What a log makes of three scales that a joint file and a drive state and neither knows exactly: the torque's, the motor's
//! inertia's and the link's. A log of motion cannot tell them all, since twice the torque turns twice the inertia alike; it
//! tells two ratios, torque over the motor's inertia while the joint rings, and torque over all that turns. What is expected
//! of each scale and those two ratios together give the likeliest three, and how far they may still be off together.
//!
//! With the logarithms t, m and l of true over stated torque, motor's and link's inertia, and the motor's share a of all that
//! turns, the ratios say t - m = r and t - a m - (1 - a) l = w; expected are t, m and l of zero, each within its deviation. If
//! what is expected does not fit together, all of it is taken to be less well known, by as much (Birge's ratio).

use nalgebra::{Matrix3, Matrix5x3, Vector3, Vector5};

use super::balances::{self, Factor};
use super::log::Log;
use super::prior::PriorModel;
use super::regression::Solution;
use super::rows::Rows;

/// Box of the kernel for the balance of all that turns [s]: long enough for coarse counts, short beside a reversal.
const BOX: f64 = 4e-3;
/// What losses, teeth and the shapes of frictions put into a ratio beside its scatter. On simulated logs of the presets it is
/// 0.4 % at most.
const BALANCE_SHARE: f64 = 0.004;
/// Half of a 95 % interval is so many standard deviations.
const QUANTILE: f64 = 1.96;
/// Logarithms of ratios that say nothing have this deviation.
const UNKNOWN: f64 = 10.0;
/// A torque that is not doubted: keeps the sums finite.
const EXACT: f64 = 1e-6;
/// What is expected and seen, less what is sought.
const FREEDOM: f64 = 2.0;

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
}

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Logarithm of true over stated.
    pub logarithm: f64,
    /// Its standard deviation.
    pub deviation: f64,
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

    /// Half of its 95 % interval.
    pub fn half(self) -> f64 {
        QUANTILE * self.deviation
    }

    /// Whether it is surely not what was stated.
    pub fn is_another(self) -> bool {
        self.logarithm.abs() > self.half()
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
        let seen = factors.map(|factor| factor.filter(|factor| factor.value > 0.0 && factor.is_narrow()));
        // Where the log has less torque than the inertias need, the true torque is that much more.
        let ratio = seen.map(|factor| factor.map_or(0.0, |factor| -factor.value.ln()));
        let scatter = seen.map(|factor| {
            factor.map_or(UNKNOWN, |Factor { value, deviation }| (deviation / value).hypot(BALANCE_SHARE))
        });
        let equations = Matrix5x3::from_row_slice(&[
            1.0,
            0.0,
            0.0, //
            0.0,
            1.0,
            0.0, //
            0.0,
            0.0,
            1.0, //
            1.0,
            -1.0,
            0.0, //
            1.0,
            -share,
            share - 1.0,
        ]);
        let values = Vector5::from([0.0, 0.0, 0.0, ratio[0], ratio[1]]);
        let expected = [torque.max(EXACT), inertia.max(EXACT), inertia.max(EXACT)];
        let solve = |birge: f64| {
            let [torque, motor, link] = expected.map(|deviation| birge * deviation);
            let weights =
                Vector5::from([torque, motor, link, scatter[0], scatter[1]]).map(|deviation| deviation.powi(-2));
            let weighted = equations.transpose() * nalgebra::Matrix5::from_diagonal(&weights);
            let covariance = (weighted * equations).try_inverse().unwrap_or_else(Matrix3::zeros);
            let solved: Vector3<f64> = covariance * (weighted * values);
            let squares = (equations * solved - values).component_mul(&(equations * solved - values)).dot(&weights);
            (solved, covariance, squares)
        };
        let birge = (solve(1.0).2 / FREEDOM).sqrt().max(1.0);
        let (solved, covariance, _) = solve(birge);
        let scale = |place: usize| Scale { logarithm: solved[place], deviation: covariance[(place, place)].sqrt() };
        let [of_torque, common, of_motor] = [covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]];
        let motor_inertia_alone = (of_motor - common * common / of_torque).max(0.0).sqrt();
        Self { torque: scale(0), motor_inertia: scale(1), link_inertia: scale(2), motor_inertia_alone, birge }
    }

    /// What is known of the joint with the motor's inertia as large as it may be beside the torque's scale.
    pub fn with_most_of_the_motor(&self, prior: &PriorModel) -> PriorModel {
        with_motor(prior, (QUANTILE * self.motor_inertia_alone).exp())
    }

    /// The log and what is known of the joint, as these scales make them.
    pub fn apply(&self, log: &Log, prior: &PriorModel) -> (Log, PriorModel) {
        let mut log = log.clone();
        log.torque.iter_mut().for_each(|torque| *torque *= self.torque.factor());
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
