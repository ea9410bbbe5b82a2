//! Demand of the control law on motor and teeth, referred to the link, (K4) and (K5). The demand is computed anew every
//! control period.

use super::crossing_timing::CrossingTiming;
use super::load::LoadModel;
use super::loop_state::LoopState;
use crate::compensation::tables::CompensationTables;
use crate::numbers::Real;

/// Torque, demand and conditions that the control law gives to the flank control.
#[derive(Debug, Clone, Copy)]
pub(super) struct ControlDemand<T: Real> {
    /// Torque while a flank carries [N m].
    pub law_torque: T,
    /// Torque through the teeth now [N m].
    pub now: T,
    /// Torque through the teeth at the end of a crossing that begins now [N m].
    pub after_crossing: T,
    /// Acceleration of the link moving freely under its load [rad/s^2].
    pub free_acceleration: T,
    /// Rate of `free_acceleration` [rad/s^3].
    pub free_jerk: T,
    /// Torque that the far flank will carry; sets the speed of the crossing [N m].
    pub at_far_flank: T,
    /// True in impedance mode: an impulse that the link missed during a crossing is returned afterwards (position mode
    /// corrects it by its own stiffness), and the spring decides on a flank in doubt.
    pub is_impedance: bool,
    /// True if the joint is asked to rest and carries no load.
    pub rests_unloaded: bool,
    /// True if the joint is asked to rest.
    pub rests: bool,
    /// True if an idle joint needs no flank: friction holds the link at its set-point, and no next start is predicted.
    pub needs_no_flank: bool,
    /// True if the link was recently pushed harder than the limit of the teeth.
    pub external_impact: bool,
    /// True if the link is braked early because the motor's torque is limited.
    pub brakes_early: bool,
    /// Predicted torque of the next start of a joint that friction holds; selects the flank to wait on [N m].
    pub expected_start_torque: T,
}

impl<T: Real> ControlDemand<T> {
    /// Creates a demand from the torque of the law and the demand after a time. The demand at the far flank sets the
    /// speed of the crossing, whose duration sets the time of `after_crossing`.
    pub fn new(
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        state: &LoopState<T>,
        law_torque: T,
        demand: impl Fn(T) -> T,
        is_impedance: bool,
    ) -> Self {
        let unhurried = CrossingTiming::new(tables, state.half_gap, T::ZERO).duration + tables.crossing.reaction;
        let at_far_flank = demand(unhurried);
        let crossing = CrossingTiming::new(tables, state.half_gap, at_far_flank);
        let ahead = crossing.duration + tables.crossing.reaction;
        Self {
            law_torque,
            now: demand(T::ZERO),
            after_crossing: demand(ahead),
            free_acceleration: -load.free_load_torque() * tables.body.inverse_load_inertia,
            free_jerk: -load.gravity_rate() * tables.body.inverse_load_inertia,
            at_far_flank,
            is_impedance,
            rests_unloaded: false,
            rests: false,
            needs_no_flank: false,
            external_impact: false,
            brakes_early: false,
            expected_start_torque: T::ZERO,
        }
    }

    pub fn is_finite(&self) -> bool {
        (self.law_torque + self.now + self.after_crossing + self.free_acceleration).is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{state, tables};

    fn demand(torque: impl Fn(f64) -> f64) -> ControlDemand<f64> {
        ControlDemand::new(&tables(), &LoadModel::of_known(3.0, 0.0), &state(), 1.0, torque, false)
    }

    #[test]
    fn demand_after_the_crossing_is_that_of_its_end() {
        let crossing = CrossingTiming::new(&tables(), state().half_gap, 0.0).duration;
        let demand = demand(|time| 100.0 * time);
        assert_eq!(demand.now, 0.0);
        assert!((demand.after_crossing - 100.0 * (crossing + 2e-3)).abs() < 1e-9);
    }

    #[test]
    fn link_without_a_flank_accelerates_under_its_load() {
        assert_eq!(demand(|_| 0.0).free_acceleration, -1.0);
    }

    #[test]
    fn demand_that_is_no_number_is_not_finite() {
        assert!(demand(|_| 1.0).is_finite());
        assert!(!demand(|_| f64::NAN).is_finite());
        assert!(!ControlDemand { law_torque: f64::INFINITY, ..demand(|_| 1.0) }.is_finite());
    }
}
