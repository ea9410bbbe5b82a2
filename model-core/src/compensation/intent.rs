//! Demand of the control law on motor and teeth, referred to the link, (K4) and (K5). The intent is computed anew every
//! control period.

use super::crossing::Crossing;
use super::load::LoadModel;
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;

/// Torque, demand and conditions that the control law gives to the flank control.
#[derive(Debug, Clone, Copy)]
pub(super) struct Intent<T: Real> {
    /// Torque while a flank carries [N m].
    pub law: T,
    /// Torque through the teeth now [N m].
    pub demand_now: T,
    /// Torque through the teeth at the end of a crossing that begins now [N m].
    pub demand_ahead: T,
    /// Acceleration of the link moving freely under its load [rad/s^2].
    pub free_acceleration: T,
    /// Rate of `free_acceleration` [rad/s^3].
    pub free_jerk: T,
    /// Torque that the far flank will carry; sets the speed of the crossing [N m].
    pub far_demand: T,
    /// True in impedance mode: an impulse that the link missed during a crossing is returned afterwards (position mode
    /// corrects it by its own stiffness), and the spring decides on a flank in doubt.
    pub spring: bool,
    /// True if the joint is asked to rest and carries no load.
    pub idles: bool,
    /// True if the joint is asked to rest.
    pub rests: bool,
    /// True if an idle joint needs no flank: friction holds the link at its set-point, and no next start is predicted.
    pub needs_no_flank: bool,
    /// True if the link was recently pushed harder than the limit of the teeth.
    pub thrown: bool,
    /// True if the link is braked early because the motor's torque is limited.
    pub brakes_early: bool,
    /// Predicted torque of the next start of a joint that friction holds; selects the flank to wait on [N m].
    pub expects: T,
}

impl<T: Real> Intent<T> {
    /// Creates an intent from the torque of the law and the demand after a time. The demand at the far flank sets the
    /// speed of the crossing, whose duration sets the time of `demand_ahead`.
    pub fn new(
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        law: T,
        demand: impl Fn(T) -> T,
        spring: bool,
    ) -> Self {
        let unhurried = Crossing::new(tables, situation.half, T::ZERO).duration + tables.crossing.reaction;
        let far_demand = demand(unhurried);
        let crossing = Crossing::new(tables, situation.half, far_demand);
        let ahead = crossing.duration + tables.crossing.reaction;
        Self {
            law,
            demand_now: demand(T::ZERO),
            demand_ahead: demand(ahead),
            free_acceleration: -load.free() * tables.body.inverse_load_inertia,
            free_jerk: -load.rate() * tables.body.inverse_load_inertia,
            far_demand,
            spring,
            idles: false,
            rests: false,
            needs_no_flank: false,
            thrown: false,
            brakes_early: false,
            expects: T::ZERO,
        }
    }

    pub fn is_finite(&self) -> bool {
        (self.law + self.demand_now + self.demand_ahead + self.free_acceleration).is_finite()
    }
}
