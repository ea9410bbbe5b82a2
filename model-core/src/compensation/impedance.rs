//! The control law of impedance mode: the commanded spring on the link, the commanded damper on the motor, the
//! commanded torque on top. It comes without a preview, so what will be asked is extrapolated from its own course.

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

/// What impedance mode remembers.
#[derive(Debug, Clone)]
pub(super) struct ImpedanceLaw<T: Real> {
    stream: Stream<T>,
    /// How the point usually starts.
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
        // Friction and cogging of the motor stay: the law is that of a joint without a gap, not of one without losses. So does
        // the swing of motor against link, but for what the loop's delays would add to it. But a motor that stands beside
        // where it would without a gap has another cogging there.
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
