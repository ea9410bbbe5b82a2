//! The control law of impedance mode: the commanded spring on the link, the commanded damper on the motor, the
//! commanded torque on top. It comes without a preview, so what will be asked is extrapolated from its own course.

use super::arithmetic::clamp;
use super::intent::{Intent, Situation, crossing_time};
use super::load::LoadModel;
use super::set_point::{ImpedancePoint, Position};
use crate::real::Real;
use crate::tables::compensation::CompensationTables;

/// What impedance mode remembers.
#[derive(Debug, Clone)]
pub(super) struct ImpedanceLaw<T: Real> {
    /// Demand that does not come from spring and damper, smoothed over about a crossing, and its rate.
    smooth: Option<[T; 2]>,
    /// The set-point of one period ago for how long it has been held, and the one before it was [s].
    held: Option<(Position<T>, T, T)>,
}

impl<T: Real> ImpedanceLaw<T> {
    pub fn new() -> Self {
        Self { smooth: None, held: None }
    }

    pub fn forget(&mut self) {
        *self = Self::new();
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
        let law = clamp(spring, -tables.torque_limit, tables.torque_limit)
            + point.damping * (point.speed + situation.error_speed - situation.motor_speed);
        let free = load.even() + load.drag(tables, situation.link_speed);
        // Law and load accelerate motor and load together; the teeth pass on what is not the motor's share.
        let load_share = T::ONE - tables.motor_share;
        let error = situation.error + point.speed * self.overdue(tables, point);
        let felt = load_share * (point.stiffness * error + point.damping * situation.error_rate);
        let sent = load_share * point.torque + tables.motor_share * free;
        let demand_now = felt + sent;

        // How spring and damper go on is known; for the rest a tracking filter: value and rate.
        let [value, rate] = self.smooth.unwrap_or([sent, T::ZERO]);
        let predicted = value + tables.period * rate;
        let off = sent - predicted;
        let value = predicted + tables.demand_gains[0] * off;
        let rate = rate + tables.demand_gains[1] * off;
        self.smooth = Some([value, rate]);
        let value = value + felt;
        let rate = rate + load_share * point.stiffness * situation.error_rate;
        let unhurried = crossing_time(tables, situation.half, T::ZERO) + tables.reaction;
        let crossing = crossing_time(tables, situation.half, value + unhurried * rate);
        let demand_ahead = value + (crossing + tables.reaction) * rate;
        Intent {
            law,
            demand_now,
            demand_ahead,
            free_acceleration: -load.free(tables, situation.link_speed) * tables.inverse_load_inertia,
            free_jerk: -load.rate() * tables.inverse_load_inertia,
            crossing,
            repays: true,
        }
    }

    /// By how much longer than usual the set-point has been held: the sender is slower than the control, and its point
    /// moves on meanwhile. One that has fallen silent stands still.
    fn overdue(&mut self, tables: &CompensationTables<T>, point: &ImpedancePoint<T>) -> T {
        let (age, usual) = match self.held {
            Some((position, age, usual)) if position == point.position => {
                (clamp(age + tables.period, T::ZERO, tables.longest_hold), usual)
            }
            // One that was at rest says nothing of the sender's pace.
            Some((_, age, usual)) => (T::ZERO, if age < tables.longest_hold { age } else { usual }),
            None => (T::ZERO, T::ZERO),
        };
        self.held = Some((point.position, age, usual));
        if age < tables.longest_hold { age - T::HALF * usual } else { T::ZERO }
    }
}
