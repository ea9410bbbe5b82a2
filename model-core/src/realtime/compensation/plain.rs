//! Control without compensation, on the motor's place: PID with all poles at the bandwidth in position mode, what is
//! known of the load fed forward, and the commanded spring and damper in impedance mode. It is what remains when the gap
//! cannot be seen.

use super::intent::Situation;
use super::load::LoadModel;
use super::set_point::{ImpedancePoint, Motion};
use crate::real::Real;
use crate::realtime::arithmetic::clamp;
use crate::tables::compensation::CompensationTables;

/// The integral of the PID.
#[derive(Debug, Clone)]
pub(super) struct Plain<T: Real> {
    integral: T,
}

impl<T: Real> Plain<T> {
    pub fn new() -> Self {
        Self { integral: T::ZERO }
    }

    /// Torque of the PID [N m].
    pub fn follow(
        &self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        situation: &Situation<T>,
        now: &Motion<T>,
    ) -> T {
        (tables.load_inertia + tables.motor_inertia) * now.acceleration
            - tables.position_gain * situation.confirmed_motor
            + tables.damping_gain * (now.speed - situation.motor_speed)
            + load.even()
            + load.planned_drag(tables, now.speed)
            + self.integral
    }

    /// Torque of the impedance law [N m].
    pub fn yield_to(&self, situation: &Situation<T>, point: &ImpedancePoint<T>) -> T {
        point.torque - point.stiffness * situation.confirmed_motor
            + point.damping * (point.speed - situation.motor_speed)
    }

    /// Integrates; `cut` is what the limit took off. Under compensation the integral fades, so that it is ready and
    /// empty when it is needed.
    pub fn take(&mut self, tables: &CompensationTables<T>, situation: &Situation<T>, cut: T, trust: T) {
        let growth = tables.back_calculation * cut - tables.integral_gain * situation.confirmed_motor;
        let next = self.integral + (T::ONE - trust) * growth - trust * tables.back_calculation * self.integral;
        if next.is_finite() {
            self.integral = clamp(next, -tables.torque_limit, tables.torque_limit);
        }
    }
}
