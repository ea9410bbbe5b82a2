//! Link without an output encoder (O26, O27): observed through touching teeth, unobservable in the open gap.
//!
//! In contact the deflection is the half-gap plus the wind-up of the mesh force, which the motor side gives; the load
//! side is corrected towards this deflection. In the open gap the load side runs on under the last load torque: the
//! variance of the gap coordinate grows with the square of time for the speed and with the fourth power for the torque.
//!
//! The smoothed force has two contact thresholds: the reported contact needs a force that is likelier with contact than
//! without; the correction of the load side needs a force that no bias explains.

use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::arithmetic::beyond;
use crate::observer::contact::by_force::with_hysteresis;
use crate::observer::filters::LoadCorrection;
use crate::observer::learnt::Learnt;
use crate::observer::learnt::fusion::Fused;
use crate::observer::tables::ObserverTables;

/// Control periods by which contact may have ended before the smoothed force shows it.
const GONE_BEFORE: i32 = 30;

/// Standard deviations of the smoothed force above which contact is certain: no bias explains the force.
const MAKES_CONTACT: i32 = 4;

/// Standard deviations of the smoothed force that keep certain contact.
const KEEPS_CONTACT: i32 = 3;

/// Standard deviations of the smoothed force above which contact is likelier than an open gap (O27). Both are equally
/// likely at F^2 = 2 s^2 ln(F_max / (sqrt(2 pi) s)), with s the standard deviation without contact and, in contact, any
/// force up to F_max: 2 deviations for a bias known to 5 % of the motor's largest torque, 2.5 for 2 %. One deviation
/// keeps contact.
const LIKELY_CONTACT: i32 = 2;

/// Control periods for which the last flank is kept without a force: the force estimate lags.
const SHOWN_LATE: u16 = 10;

/// Estimate of the link's motion without its encoder.
#[derive(Debug, Clone, Copy, Default)]
pub struct MotorOnly<T: Real> {
    /// Flank of certain contact.
    pub felt: Option<Flank>,
    /// Flank of likely contact (O27).
    likely: Option<Flank>,
    /// Periods since certain contact, saturated.
    open_for: u16,
    /// True if contact was certain since the exclusion of the output encoder, or if the link's speed was known then.
    place_known: bool,
    /// Smoothed mesh force [N].
    force: T,
    /// Sum of landing speeds, decaying as bounces do [m/s].
    bounce: T,
}

impl<T: Real> MotorOnly<T> {
    /// Decay rate of the bounce over that of the smoothed force [-]: bounces last eight times as long.
    const BOUNCE_DECAY: T = T::EIGHTH;

    /// Keeps place and speed of the link, which were known when its encoder was excluded.
    pub fn keep_place(&mut self) {
        self.place_known = true;
    }

    /// Touching flank: by force if it suffices, otherwise by a motor position beyond a flank, however light the
    /// contact.
    #[cold]
    pub fn contact<const P: usize>(
        &self,
        fused: &Fused<T>,
        learnt: &Learnt<T, P>,
        before: Option<Flank>,
    ) -> Option<Flank> {
        if self.likely.is_some() {
            return self.likely;
        }
        if self.open_for < SHOWN_LATE {
            return before;
        }
        let [half_gap, _] = learnt.shape();
        Flank::towards(beyond(fused.of_teeth(), half_gap))
    }

    /// Detects contact in one period and returns the correction of the load side.
    pub fn step<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        fused: &Fused<T>,
        learnt: &Learnt<T, P>,
    ) -> LoadCorrection<T> {
        let levers = &tables.levers;
        let [half_gap, compliance] = learnt.shape();
        self.force += (fused.force - self.force) * tables.contact.smoothing;
        let deviation = learnt.uncertainty.mean_force_deviation;
        let [on, off] = [MAKES_CONTACT, KEEPS_CONTACT].map(|deviations| T::from_i32(deviations) * deviation);
        let before = self.felt;
        self.felt = with_hysteresis(before, self.force, on, off);
        self.likely = with_hysteresis(self.likely, self.force, T::from_i32(LIKELY_CONTACT) * deviation, deviation);
        let side: T = sign(self.felt);
        let innovation = (fused.of_teeth() - side * half_gap - compliance * fused.force) * levers.per_output;
        if self.felt.is_none() {
            self.open_for = self.open_for.saturating_add(1);
            // Beyond an edge the teeth touch, however lightly: the link turns with the motor.
            let past = beyond(fused.of_teeth(), half_gap);
            if past == T::ZERO {
                return LoadCorrection::None;
            }
            return LoadCorrection::TurnsWithMotor(past * levers.per_output);
        }
        self.open_for = 0;
        if self.felt == before {
            self.bounce -= self.bounce * tables.contact.smoothing * Self::BOUNCE_DECAY;
            return LoadCorrection::InContact(innovation);
        }
        // A landing gives the link's position and speed, but not its torque.
        self.bounce += fused.rate.abs();
        self.place_known = true;
        LoadCorrection::TurnsWithMotor(innovation)
    }

    /// Variance of the gap coordinate (O26) [m^2]; `None` if the link's place is unknown.
    pub fn gap_variance<const P: usize>(&self, tables: &ObserverTables<T>, learnt: &Learnt<T, P>) -> Option<T> {
        let edge = learnt.uncertainty.edge_deviation;
        self.place_known.then(|| edge * edge + tables.contact.deflection_variance + self.drift_variance(tables))
    }

    /// Variance added since certain contact [m^2].
    fn drift_variance(&self, tables: &ObserverTables<T>) -> T {
        let load = &tables.load;
        let open_for = if self.open_for > 0 { i32::from(self.open_for) + GONE_BEFORE } else { 0 };
        let time = tables.period * T::from_i32(open_for);
        let [speed_variance, torque_variance] = load.motor_only_variance;
        let lever = tables.levers.output;
        let bounce = self.bounce;
        let by_torque = time * load.deflection_per_torque;
        (bounce * bounce + lever * lever * speed_variance + by_torque * by_torque * torque_variance) * time * time
    }
}
