//! Control of a link that is not seen, on the motor's place: PID with all poles at the bandwidth in position mode, what is
//! known of the load fed forward. The commanded spring and damper of impedance mode, while the compensation does not act.

use super::integral::Integral;
use super::load::LoadModel;
use super::set_point::{ImpedancePoint, Motion};
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// The integral of the PID, and what lies between motor and link.
#[derive(Debug, Clone)]
pub(super) struct Plain<T: Real> {
    integral: Integral<T>,
    /// Motor beyond the link on the flank that carries, smoothed [rad].
    beyond: T,
    /// 1 or -1: the flank that the motion asked for and the load will have carry; less of it where that is as small as what
    /// the torques are known to. Nothing is foreseen of an impedance, nor of a link that is not seen behind a gap that is
    /// not known.
    foreseen: Option<T>,
}

impl<T: Real> Plain<T> {
    /// Speed of the link against the set-point beyond which it counts as thrown, as travel in a time constant of the loop
    /// over the half-gap [-].
    const THROWN: T = T::QUARTER;

    /// By how much slower than the loop itself what lies between motor and link is smoothed [-].
    const SMOOTHING: T = T::QUARTER;

    pub fn new() -> Self {
        Self { integral: Integral::new(), beyond: T::ZERO, foreseen: None }
    }

    /// Where the motor is, less what lies between it and the link [rad].
    fn place(&self, situation: &Situation<T>) -> T {
        situation.confirmed_motor - self.beyond
    }

    /// Torque of the PID on a link that is not seen [N m].
    pub fn follow(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        now: &Motion<T>,
    ) -> T {
        // What the load model gives up of a link that is not seen passes to the integral, so that the torque does not sag.
        self.integral.add(tables, tables.law.back_calculation * load.even());
        // So the integral says what loads the link.
        let drag = load.planned_drag(tables, now.speed);
        let demand = tables.body.load_inertia * now.acceleration + self.integral.torque() + drag;
        let share = clamp(tables.switching.inverse_step * demand, -T::ONE, T::ONE);
        self.foreseen = situation.half_is_known.then_some(share);
        // A thrown link closes its flank by itself: all of the damping on the motor would meet it too hard, none of the rest on
        // the link too late. A blow is over before it could be answered.
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

    /// Torque of the impedance law [N m]: the damper on the motor, the spring on the link where its encoder is read, otherwise on the motor.
    pub fn yield_to(&mut self, situation: &Situation<T>, point: &ImpedancePoint<T>) -> T {
        self.foreseen = None;
        let error = if situation.feels { situation.error } else { -self.place(situation) };
        point.torque + point.stiffness * error + point.damping * (point.speed - situation.motor_speed)
    }

    /// Integrates while the link is not seen; `cut` is what the limit took off. While it is, others control: the integral fades, so that
    /// it is ready and empty when it is needed, and what the flank in use carries says how far the motor is beyond the link.
    pub fn take(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, cut: T) {
        let slowly = Self::SMOOTHING * tables.law.back_calculation;
        let (towards, part) = if situation.feels {
            self.foreseen = None;
            self.integral.approach(tables, T::ZERO);
            // Nothing is said by teeth that may be open, nor while the link is thrown to and fro.
            let thrown = tables.clock.period * situation.error_rate.abs()
                > Self::THROWN * tables.law.back_calculation * situation.half;
            let says_nothing = situation.contact.is_none() || thrown;
            let towards = if says_nothing { self.beyond } else { situation.beyond_link() };
            (towards, slowly)
        } else {
            self.integral.integrate(tables, self.place(situation), cut);
            // Put right on one flank, the link would be left by the whole lost motion once the other one carries: the motor goes to
            // where the flank is thought to be.
            let foreseen = |share: T| (share * situation.half, tables.law.back_calculation);
            self.foreseen.map_or((T::ZERO, slowly), foreseen)
        };
        let beyond = self.beyond + part * (towards - self.beyond);
        if beyond.is_finite() {
            self.beyond = beyond;
        }
    }
}

/// Damper on the motor in motion [N m s/rad]: somewhat more than what it bears under compensation, where its damper acts against
/// the link.
pub(super) fn damping_on_motor<T: Real>(motor_damping: T) -> T {
    (T::ONE + T::HALF) * motor_damping
}
