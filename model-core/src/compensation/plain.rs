//! Control without compensation, on the motor's place: PID with all poles at the bandwidth in position mode, what is
//! known of the load fed forward, and the commanded spring and damper in impedance mode. It is what remains when the gap
//! cannot be seen.

use super::load::LoadModel;
use super::set_point::{ImpedancePoint, Motion};
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;
use crate::numbers::arithmetic::{beyond, clamp};

/// The integral of the PID, and what lies between motor and link.
#[derive(Debug, Clone)]
pub(super) struct Plain<T: Real> {
    integral: T,
    /// Motor beyond the link on the flank that carries, smoothed [rad].
    beyond: T,
    /// 1 or -1: the flank that the motion asked for and the load will have carry; less of it where that is as small as what
    /// the torques are known to. Nothing is foreseen of an impedance, nor of a link that is not seen behind a gap that is
    /// not known.
    foreseen: Option<T>,
    /// 1 or -1: to which side the torque last was large, fading to 0.
    large: T,
    /// Whether the torque has gone from large to large of the other side within that: the loop has more delay than it was
    /// designed for.
    swings: bool,
}

impl<T: Real> Plain<T> {
    /// Speed of the link against the set-point beyond which it counts as thrown, as travel in a time constant of the loop
    /// over the half-gap [-].
    const THROWN: T = T::QUARTER;

    /// By how much slower than the loop itself what lies between motor and link is smoothed [-].
    const SMOOTHING: T = T::QUARTER;

    /// A torque is large beyond this part of the motor's limit [-].
    const LARGE: T = T::HALF;

    /// Time constants of the loop over that within which the torque goes from side to side where it swings [-]. No motion
    /// that the loop can follow does.
    const SWINGS: T = T::FOUR;

    pub fn new() -> Self {
        Self { integral: T::ZERO, beyond: T::ZERO, foreseen: None, large: T::ZERO, swings: false }
    }

    /// Where the motor is, less what lies between it and the link [rad].
    fn place(&self, situation: &Situation<T>) -> T {
        situation.confirmed_motor - self.beyond
    }

    /// Torque of the PID [N m].
    pub fn follow(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        now: &Motion<T>,
    ) -> T {
        // Of a link that is not seen the integral says what loads it.
        let level = if situation.feels { load.even() } else { self.integral };
        let demand = tables.body.load_inertia * now.acceleration + level + load.planned_drag(tables, now.speed);
        let share = clamp(tables.switching.inverse_step * demand, -T::ONE, T::ONE);
        self.foreseen = (situation.feels || situation.half_is_known).then_some(share);
        // In the open gap the motor is alone, and takes little more damping than the loop's delays allow; the rest of what both
        // need together acts on the link, where that is seen and the teeth may carry: a motor that went after the link in the
        // open gap would strike. At rest all of it acts on the motor, as long as that does not swing: it takes the link's
        // energy out in fewer blows, which show the gap sooner.
        let rests = now.speed == T::ZERO && now.acceleration == T::ZERO;
        // A thrown link closes its flank by itself: all of the damping on the motor would meet it too hard, none of the rest on
        // the link too late.
        let thrown = load.throws(tables);
        let on_motor = if !thrown && (!situation.feels || (rests && !self.swings)) {
            tables.law.damping
        } else {
            damping_on_motor(tables.law.motor_damping)
        };
        let rest = tables.law.damping - on_motor;
        let on_link = if thrown {
            T::HALF * rest
        } else if situation.open {
            T::ZERO
        } else {
            rest
        };
        // A blow is over before it could be answered.
        let known = if thrown { T::ZERO } else { load.even() + load.planned_drag(tables, now.speed) };
        let torque = (tables.body.load_inertia + tables.body.motor_inertia) * now.acceleration
            - tables.law.position * self.place(situation)
            + on_motor * (now.speed - situation.motor_speed)
            + on_link * situation.error_rate
            + known
            + self.integral;
        self.watch(tables, torque);
        torque
    }

    /// Torque of the impedance law [N m].
    pub fn yield_to(&mut self, situation: &Situation<T>, point: &ImpedancePoint<T>) -> T {
        self.foreseen = None;
        point.torque - point.stiffness * self.place(situation) + point.damping * (point.speed - situation.motor_speed)
    }

    /// Integrates; `cut` is what the limit took off. Under compensation the integral fades, so that it is ready and
    /// empty when it is needed.
    pub fn take(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, cut: T, trust: T) {
        // What the limit cuts off a torque that swings from side to side does not say that the integral is too large.
        let cut = if self.swings { T::ZERO } else { cut };
        let growth = tables.law.back_calculation * cut - tables.law.integral * self.place(situation);
        // What a flank carries is as far from the link as it is; nothing is said by teeth that may be open, nor while the
        // link is thrown to and fro.
        let thrown = tables.clock.period * situation.error_rate.abs()
            > Self::THROWN * tables.law.back_calculation * situation.half;
        // Put right on one flank, the link would be left by the whole lost motion once the other one carries. So before that
        // the motor goes to where the other flank is thought to be, by way of the middle. Where the link is not
        // seen, that is all there is to put right.
        let leaves = |share: &T| match situation.contact {
            _ if !situation.feels => true,
            Some(flank) => flank.sign::<T>() * *share < T::ONE,
            None => share.abs() < T::ONE,
        };
        let slowly = Self::SMOOTHING * tables.law.back_calculation;
        let (towards, part) = if let Some(share) = self.foreseen.filter(leaves) {
            (share * situation.half, tables.law.back_calculation)
        } else if !situation.feels {
            (T::ZERO, slowly)
        } else if situation.contact.is_none() || thrown {
            (self.beyond, slowly)
        } else {
            (situation.beyond_link(), slowly)
        };
        let beyond = self.beyond + part * (towards - self.beyond);
        if beyond.is_finite() {
            self.beyond = beyond;
        }
        let next = self.integral + (T::ONE - trust) * growth - trust * tables.law.back_calculation * self.integral;
        if next.is_finite() {
            self.integral = clamp(next, -tables.limits.motor, tables.limits.motor);
        }
    }

    /// Notices a swing of the torque from side to side.
    fn watch(&mut self, tables: &CompensationTables<T>, torque: T) {
        let excess = beyond(torque, Self::LARGE * tables.limits.motor);
        if excess == T::ZERO {
            self.large = beyond(self.large, Self::SWINGS * tables.law.back_calculation);
        } else {
            let side = if excess > T::ZERO { T::ONE } else { -T::ONE };
            self.swings |= side * self.large < T::ZERO;
            self.large = side;
        }
    }
}

/// Damper on the motor in motion [N m s/rad]: somewhat more than what it bears under compensation, where its damper acts against
/// the link.
pub(super) fn damping_on_motor<T: Real>(motor_damping: T) -> T {
    (T::ONE + T::HALF) * motor_damping
}
