//! The control law of impedance mode: the commanded spring on the link, the commanded damper on the motor, the
//! commanded torque on top. It comes without a preview, so what will be asked is extrapolated from its own course.

use super::intent::{Intent, Situation, crossing_time};
use super::load::LoadModel;
use super::set_point::ImpedancePoint;
use crate::real::Real;
use crate::tables::compensation::CompensationTables;

/// What impedance mode remembers.
#[derive(Debug, Clone)]
pub(super) struct ImpedanceLaw<T: Real> {
    /// Demand, smoothed over about a crossing, and its rate.
    smooth: Option<[T; 2]>,
}

impl<T: Real> ImpedanceLaw<T> {
    pub fn new() -> Self {
        Self { smooth: None }
    }

    pub fn forget(&mut self) {
        self.smooth = None;
    }

    pub fn intend(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        point: &ImpedancePoint<T>,
    ) -> Intent<T> {
        let spring = point.torque + point.stiffness * situation.error;
        // Friction of the motor stays: the law is that of a joint without a gap, not of one without losses.
        let law = spring + point.damping * (point.speed + situation.error_speed - situation.motor_speed);
        let free = load.even() + load.drag(tables, situation.link_speed);
        // Law and load accelerate motor and load together; the teeth pass on what is not the motor's share.
        let asked = spring + point.damping * situation.error_rate;
        let demand = asked - tables.motor_share * (asked - free);
        let demand_now = demand;

        // A tracking filter: position and rate of the demand.
        let [value, rate] = self.smooth.unwrap_or([demand, T::ZERO]);
        let predicted = value + tables.period * rate;
        let off = demand - predicted;
        let value = predicted + tables.demand_gains[0] * off;
        let rate = rate + tables.demand_gains[1] * off;
        self.smooth = Some([value, rate]);
        let unhurried = crossing_time(tables, situation.half, T::ZERO) + tables.reaction;
        let crossing = crossing_time(tables, situation.half, value + unhurried * rate);
        let demand_ahead = value + (crossing + tables.reaction) * rate;
        Intent {
            law,
            demand_now,
            demand_ahead,
            free_acceleration: -free * tables.inverse_load_inertia,
            free_jerk: -load.rate() * tables.inverse_load_inertia,
            crossing,
            repays: true,
        }
    }
}
