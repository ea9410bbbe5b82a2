//! What the control law wants, referred to the link. It is made anew every control period and carries no state.

use super::crossing::Crossing;
use super::load::LoadModel;
use super::situation::Situation;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;

/// What the control law wants.
#[derive(Debug, Clone, Copy)]
pub(super) struct Intent<T: Real> {
    /// Torque while a flank carries [N m].
    pub law: T,
    /// What the teeth have to pass on now [N m].
    pub demand_now: T,
    /// What they will have to pass on when a crossing that began now ends [N m].
    pub demand_ahead: T,
    /// Acceleration of the load left to itself [rad/s^2].
    pub free_acceleration: T,
    /// Its rate [rad/s^3].
    pub free_jerk: T,
    /// How hard the far flank will be needed, which says how fast to go there [N m].
    pub far_demand: T,
    /// Whether the law is a spring that was asked for: an impulse that the load missed on the way is made good afterwards,
    /// which a law stiff enough does itself, and a flank that is in doubt is left to it.
    pub spring: bool,
    /// Whether the joint is asked to rest and feels no load.
    pub idles: bool,
    /// Whether the joint is asked to rest.
    pub rests: bool,
    /// Whether a joint that idles needs no flank: friction holds its link where it shall be, and nothing tells which flank it
    /// will need.
    pub needs_no_flank: bool,
    /// Whether the link was pushed of late with more than the teeth shall pass on.
    pub thrown: bool,
    /// Whether the link is braked early, for the motor has no more torque.
    pub brakes_early: bool,
    /// What a joint that friction holds is likely to be asked for first; it decides on the flank to wait on [N m].
    pub expects: T,
}

impl<T: Real> Intent<T> {
    /// An intent from the law's torque and from what the teeth will have to pass on after a time. How hard the far flank will
    /// be needed says how fast to go there, and that again when to start.
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
