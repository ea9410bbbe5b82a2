//! Motor torque of the standard test, and the heaviest link that leaves a reserve.
//!
//! Motion T2 swings the link by A sin(2 pi f t), A = 0.5 rad, f = 1 Hz. At its turning points the motor gives
//!
//! T = T_0 + i alpha (J_r + J_g) + (alpha J_l + T_w) / (i eta), alpha = A (2 pi f)^2 = 19.7 rad/s^2
//!
//! with the no-load torque T_0, ratio i, efficiency eta, inertias of rotor J_r, gears at the input J_g and link J_l,
//! and the torque of the link's weight T_w.

use std::f64::consts::TAU;

use crate::arguments::DataSheet;
use crate::sizes::Gears;

/// Largest acceleration of the link in motion T2 [rad/s^2].
const ACCELERATION: f64 = 0.5 * TAU * TAU;
/// Largest share of the motor's limit for the standard test with an assumed link; the rest is for flank changes, which
/// cross the gap at the limit, and for errors of the model.
const LIMIT_SHARE_MAX: f64 = 0.5;
/// Inertia of an assumed link over the rotor's inertia at the link, if the motor can swing it.
const LINK_OVER_ROTOR: f64 = 10.0;
/// Least inertia of an assumed link over the rotor's inertia at the link: a joint needs a link.
const LINK_OVER_ROTOR_MIN: f64 = 0.1;

/// Motor torque of the standard test.
pub struct Swing {
    /// Motor turns per turn of the link.
    ratio: f64,
    efficiency: f64,
    /// Motor torque that overcomes the no-load torque and swings rotor and gears [N m].
    without_link: f64,
    /// Torque of the link's weight [N m].
    weight: f64,
    /// Inertia of the rotor, referred to the link [kg m^2].
    rotor: f64,
    /// Torque limit of the motor [N m].
    pub limit: f64,
}

impl Swing {
    /// Torques for a data sheet and its gears.
    pub fn new(sheet: &DataSheet, gears: &Gears) -> Self {
        let ratio = gears.ratio(sheet);
        let rotor = 1e-4 * sheet.rotor_inertia;
        Self {
            ratio,
            efficiency: sheet.efficiency,
            without_link: sheet.no_load_torque + ratio * ACCELERATION * (rotor + gears.inertia_at_input(sheet)),
            weight: sheet.gravity_torque.unwrap_or(0.0).abs(),
            rotor: rotor * ratio * ratio,
            limit: sheet.motor_peak_torque.unwrap_or(2.0 * sheet.rated_torque / ratio),
        }
    }

    /// Motor torque at the turning points of the standard test [N m], with a link of this inertia [kg m^2].
    pub fn torque(&self, link: f64) -> f64 {
        self.without_link + (ACCELERATION * link + self.weight) / (self.ratio * self.efficiency)
    }

    /// Inertia of an unstated link [kg m^2], and its origin.
    pub fn assumed_link(&self) -> (f64, &'static str) {
        let usual = LINK_OVER_ROTOR * self.rotor;
        if self.torque(usual) <= LIMIT_SHARE_MAX * self.limit {
            return (usual, "ten times the rotor's, at the link");
        }
        let left = (LIMIT_SHARE_MAX * self.limit - self.without_link) * self.ratio * self.efficiency - self.weight;
        let swung = left / ACCELERATION;
        let least = LINK_OVER_ROTOR_MIN * self.rotor;
        if swung > least {
            (swung, "what half of the motor's limit swings in the standard test")
        } else {
            (least, "a tenth of the rotor's, at the link: the motor swings no heavier one in the standard test")
        }
    }

    /// Warning for a link that the motor cannot swing in the standard test.
    pub fn warning(&self, link: f64) -> Option<String> {
        let torque = self.torque(link);
        (torque > self.limit).then(|| {
            format!(
                "the standard test swings the link by 0.5 rad at 1 Hz, which takes {torque:.3} N m at the motor, of which {:.3} N m \
                 without the link, and the motor's limit is {:.3} N m: it will saturate",
                self.without_link, self.limit
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Swing;

    /// XH430-W350: 353.5:1, stall torque 3.4 N m at 24 V.
    const SERVO: Swing =
        Swing { ratio: 353.5, efficiency: 0.6, without_link: 0.0047, weight: 0.0, rotor: 0.05, limit: 0.016 };

    /// An assumed link takes at most half of the motor's limit in the standard test.
    #[test]
    fn assumed_link_takes_half_the_limit() {
        let (link, why) = SERVO.assumed_link();
        assert!((SERVO.torque(link) / (0.5 * SERVO.limit) - 1.0).abs() < 1e-12, "{link}: {}", SERVO.torque(link));
        assert!(why.contains("half of the motor's limit") && SERVO.warning(link).is_none());
        assert!(SERVO.warning(0.5).is_some_and(|warning| warning.contains("0.051 N m at the motor")));
        let strong = Swing { limit: 1.0, ..SERVO };
        assert_eq!(strong.assumed_link(), (0.5, "ten times the rotor's, at the link"));
        let weak = Swing { limit: 0.004, ..SERVO };
        let (link, why) = weak.assumed_link();
        assert!((link - 0.005).abs() < 1e-12 && why.contains("no heavier") && weak.warning(link).is_some());
    }
}
