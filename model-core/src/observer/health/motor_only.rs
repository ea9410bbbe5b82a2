//! The link without an output encoder: it is seen through the teeth while they touch and cannot be seen while they do not.
//!
//! In contact the deflection is the half-gap and the wind-up of the mesh force, which the motor side gives; the load side is
//! corrected towards that. In the open gap it runs on under the load torque that it had, and the variance of the gap
//! coordinate grows with the square of time for the speed and with the fourth power for the torque.
//!
//! The smoothed force tells contact twice: what touches more likely than not is what is said, and only what no bias can be
//! corrects the load side.

use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::arithmetic::beyond;
use crate::observer::contact::by_force::with_hysteresis;
use crate::observer::filters::LoadCorrection;
use crate::observer::learnt::Learnt;
use crate::observer::learnt::fusion::Fused;
use crate::observer::tables::ObserverTables;

/// Control periods by which contact may have gone before the smoothed force says so.
const GONE_BEFORE: i32 = 30;

/// Standard deviations of the smoothed force that make contact for sure: only what no bias can be.
const MAKES_CONTACT: i32 = 4;

/// Standard deviations of the smoothed force that keep it.
const KEEPS_CONTACT: i32 = 3;

/// Standard deviations of the smoothed force from which on contact is likelier than an open gap. A force F is as likely under
/// either where F^2 = 2 s^2 ln(F_max / (sqrt(2 pi) s)), with s its standard deviation without contact, and in contact any up to
/// F_max: at two of them for a motor whose bias is known to 5 % of its largest torque, at 2.5 for 2 %. One keeps it.
const LIKELY_CONTACT: i32 = 2;

/// Control periods for which the flank before is kept when the force shows it no more: its estimate lags behind.
const SHOWN_LATE: u16 = 10;

/// What is known of the link without its encoder.
#[derive(Debug, Clone, Copy, Default)]
pub struct MotorOnly<T: Real> {
    /// Contact that is felt for sure now.
    pub felt: Option<Flank>,
    /// Contact that the force makes likelier than an open gap.
    likely: Option<Flank>,
    /// Periods since contact was last felt for sure, as far as they count.
    open_for: u16,
    /// Contact has been felt since the output encoder was given up, or the link's speed was known then.
    place_known: bool,
    /// Mesh force, smoothed [N].
    force: T,
    /// Speed at which the teeth landed last, dying away as bounces do [m/s].
    bounce: T,
}

impl<T: Real> MotorOnly<T> {
    /// Part of the bounce's decay in that of the smoothed force [-]: bounces last eight times as long.
    const BOUNCE_DECAY: T = T::EIGHTH;

    /// The link's place and speed were known when its encoder was given up.
    pub fn keep_place(&mut self) {
        self.place_known = true;
    }

    /// The flank that touches: by force where there is enough of it, otherwise a flank beyond which the motor has turned, however
    /// light the contact.
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

    /// Feels for contact in one period; how that corrects the load side.
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
            // Beyond an edge there is contact, however light: the link goes with the motor.
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
        // A landing says where the link is, and that it goes with the motor; of its torque it says nothing.
        self.bounce += fused.rate.abs();
        self.place_known = true;
        LoadCorrection::TurnsWithMotor(innovation)
    }

    /// Variance of the gap coordinate [m^2]; `None` where nothing is known of it.
    pub fn gap_variance<const P: usize>(&self, tables: &ObserverTables<T>, learnt: &Learnt<T, P>) -> Option<T> {
        let edge = learnt.uncertainty.edge_deviation;
        self.place_known.then(|| edge * edge + tables.contact.deflection_variance + self.drift_variance(tables))
    }

    /// What has been added since contact was last felt [m^2].
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
