//! Plain control: a PID on the motor position with all poles at the bandwidth and known load fed forward, while the link is not seen; in
//! impedance mode the commanded law, while the compensation does not act.
//!
//! ```text
//! (K17)  torque = t + k_p (r - theta_l) + k_d (v - w_m);   theta_m replaces theta_l if the link is not seen
//! ```

use super::integral::Integral;
use super::load::LoadModel;
use super::set_point::{ImpedancePoint, Motion};
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// Integral of the PID, and motor position relative to the link.
#[derive(Debug, Clone)]
pub(super) struct Plain<T: Real> {
    integral: Integral<T>,
    /// Motor less link on the flank that carries, smoothed [rad].
    beyond: T,
    /// Flank that motion and load ask for, 1 or -1; a share of it for a demand as small as the uncertainty of torques.
    /// `None` in impedance mode, while the link is seen, and while the half-gap is unknown.
    foreseen: Option<T>,
}

impl<T: Real> Plain<T> {
    /// Speed of the link against the set-point beyond which the flank in use gives no distance of motor and link, as
    /// travel in a time constant of the loop over the half-gap [-].
    const THROWN: T = T::QUARTER;

    /// Smoothing rate of motor less link, over the rate of the loop [-].
    const SMOOTHING: T = T::QUARTER;

    pub fn new() -> Self {
        Self { integral: Integral::new(), beyond: T::ZERO, foreseen: None }
    }

    /// Motor position less the expected distance to the link [rad].
    fn place(&self, situation: &Situation<T>) -> T {
        situation.confirmed_motor - self.beyond
    }

    /// Computes the torque of the PID while the link is not seen [N m].
    pub fn follow(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        now: &Motion<T>,
    ) -> T {
        // The integral takes over the load that the load model gives up while the link is not seen, so that the torque
        // does not sag.
        self.integral.add(tables, tables.law.back_calculation * load.even());
        // The integral then holds the load.
        let drag = load.planned_drag(tables, now.speed);
        let demand = tables.body.load_inertia * now.acceleration + self.integral.torque() + drag;
        let share = clamp(tables.switching.inverse_step * demand, -T::ONE, T::ONE);
        self.foreseen = situation.half_is_known.then_some(share);
        // A link that is pushed hard closes the gap by itself: with all damping on the motor the teeth meet too hard,
        // without damping on the link too late. The blow is not fed forward, because it ends before the motor can
        // answer.
        let (on_motor, on_link, known) = if load.throws(tables) {
            let on_motor = damping_on_motor(tables.law.motor_damping);
            (on_motor, T::HALF * (tables.law.damping - on_motor), T::ZERO)
        } else {
            (tables.law.damping, T::ZERO, load.even() + drag)
        };
        let torque = (tables.body.load_inertia + tables.body.motor_inertia) * now.acceleration
            - tables.law.position * self.place(situation)
            + on_motor * (now.speed - situation.motor_speed)
            + on_link * situation.error_rate
            + known
            + self.integral.torque();
        self.integral.watch(tables, torque, T::ONE);
        torque
    }

    /// Computes the torque of the impedance law [N m]: damper on the motor; spring on the link, or on the motor while
    /// the link is not seen.
    pub fn yield_to(&mut self, situation: &Situation<T>, point: &ImpedancePoint<T>) -> T {
        self.foreseen = None;
        let error = if situation.feels { situation.error } else { -self.place(situation) };
        point.torque + point.stiffness * error + point.damping * (point.speed - situation.motor_speed)
    }

    /// Updates the integral while the link is not seen; `cut` is the torque that the limit cut off. While the link is
    /// seen, other laws control: the integral decays to be ready, and the flank in use gives the distance of motor and
    /// link.
    pub fn take(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, cut: T) {
        let slowly = Self::SMOOTHING * tables.law.back_calculation;
        let (towards, part) = if situation.feels {
            self.foreseen = None;
            self.integral.approach(tables, T::ZERO);
            // Teeth that may be open, and a link that moves fast against its set-point, give no distance.
            let thrown = tables.clock.period * situation.error_rate.abs()
                > Self::THROWN * tables.law.back_calculation * situation.half;
            let says_nothing = situation.contact.is_none() || thrown;
            let towards = if says_nothing { self.beyond } else { situation.beyond_link() };
            (towards, slowly)
        } else {
            self.integral.integrate(tables, self.place(situation), cut);
            // A distance corrected on one flank would be wrong by the whole lost motion on the other: the motor moves
            // to the expected flank.
            let foreseen = |share: T| (share * situation.half, tables.law.back_calculation);
            self.foreseen.map_or((T::ZERO, slowly), foreseen)
        };
        let beyond = self.beyond + part * (towards - self.beyond);
        if beyond.is_finite() {
            self.beyond = beyond;
        }
    }
}

/// Damper on the motor [N m s/rad]: larger than D_m of the compensation, whose damper acts against the link.
pub(super) fn damping_on_motor<T: Real>(motor_damping: T) -> T {
    (T::ONE + T::HALF) * motor_damping
}
