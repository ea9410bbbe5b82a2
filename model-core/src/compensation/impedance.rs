//! Control law of impedance mode: commanded spring on the link, commanded damper on the motor, commanded torque. Without a preview the
//! demand is extrapolated from its own course (K4).
//!
//! ```text
//! (K3)  torque = t + k_p e + k_d (v - w_m) + 0.1 D_m (w_l + v_e - w_m) - cog(theta_m) + cog(theta_l)
//! ```
//!
//! Symbols: t, k_p, k_d, v = `point`; cog(theta_m) - cog(theta_l) = `cogging_by_gap()`.

use super::intent::Intent;
use super::limit::passed;
use super::load::LoadModel;
use super::set_point::ImpedancePoint;
use super::situation::Situation;
use super::start_prediction::StartPrediction;
use super::stream::Stream;
use crate::compensation::tables::CompensationTables;
use crate::gears::sign;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;

/// State of impedance mode.
#[derive(Debug, Clone)]
pub(super) struct ImpedanceLaw<T: Real> {
    stream: Stream<T>,
    /// Prediction of the next start of the set-point.
    start: StartPrediction<T>,
}

impl<T: Real> ImpedanceLaw<T> {
    pub fn new() -> Self {
        Self { stream: Stream::default(), start: StartPrediction::new() }
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
        // Friction and cogging of the motor are not compensated: the law is that of a joint without a gap, not without
        // losses. The swing of motor against link stays as well, except the part caused by the loop's delays. Only the
        // cogging's difference to a joint without a gap is removed, because the motor stands elsewhere.
        let law = clamp(spring, -tables.limits.motor, tables.limits.motor)
            + point.damping * (point.speed - situation.motor_speed)
            + tables.law.impedance_damping * situation.damping_torque(tables)
            - situation.cogging_by_gap(tables);
        let free = load.even() + load.drag();
        self.stream.step(tables, point);
        let overdue = self.stream.overdue(tables);
        let error = situation.error + point.speed * overdue;
        let torque = point.torque + self.stream.torque_rate() * overdue;
        let asked = point.stiffness * error + point.damping * situation.error_rate + torque;
        let demand_now = passed(tables, free, asked);
        let rate = tables.body.load_share * (point.stiffness * situation.error_rate + self.stream.torque_rate());
        let demand = |time: T| demand_now + time * rate;
        let rests = point.speed == T::ZERO && self.stream.rests(tables);
        let likely = self.start.step(tables, situation, self.stream.direction(), rests);
        let expects = sign::<T>(likely) * load.start(tables);
        Intent { expects, ..Intent::new(tables, load, situation, law, demand, true) }
    }
}
