//! Control law of impedance mode: commanded spring on the link, commanded damper on the motor, commanded torque.
//! Without a preview the demand is extrapolated from its own course.
//!
//! ```text
//! (K3)  torque = t + k_p e + k_d (v - w_m) + 0.1 D_m (w_l + v_e - w_m) - cog(theta_m) + cog(theta_l)
//! (K4)  demand(time) = L + f dir + J_l/J (t + k_p e + k_d (v - w_l) - L - f dir), extrapolated by time
//! ```
//!
//! Symbols: t, k_p, k_d, v = `point`; e = `state.error`; D_m term = `state.damping_torque()`;
//! cog(theta_m) - cog(theta_l) = `state.cogging_difference()`.

use super::control_demand::ControlDemand;
use super::limit::mesh_torque;
use super::load::LoadModel;
use super::loop_state::LoopState;
use super::set_point::ImpedancePoint;
use super::set_point_stream::SetPointStream;
use super::start_prediction::StartPrediction;
use crate::compensation::tables::CompensationTables;
use crate::gears::sign;
use crate::numbers::Real;
use crate::numbers::arithmetic::clamp;
use crate::numbers::state_words::state_words;

/// State of impedance mode.
#[derive(Debug, Clone)]
pub(super) struct ImpedanceLaw<T: Real> {
    stream: SetPointStream<T>,
    /// Prediction of the next start of the set-point.
    start: StartPrediction<T>,
}
state_words! { struct ImpedanceLaw<T> { stream, start } }

impl<T: Real> ImpedanceLaw<T> {
    pub fn new() -> Self {
        Self { stream: SetPointStream::default(), start: StartPrediction::new() }
    }

    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// Computes the demand of a set-point.
    pub fn demand(
        &mut self,
        tables: &CompensationTables<T>,
        load: &LoadModel<T>,
        state: &LoopState<T>,
        point: &ImpedancePoint<T>,
    ) -> ControlDemand<T> {
        let spring = point.torque + point.stiffness * state.error;
        // Friction and cogging of the motor are not compensated: the law is that of a joint without a gap, not without
        // losses. The swing of motor against link stays as well, except the part caused by the loop's delays. Only the
        // cogging's difference to a joint without a gap is removed, because the motor stands elsewhere.
        let law_torque = clamp(spring, -tables.limits.motor, tables.limits.motor)
            + point.damping * (point.speed - state.motor_speed)
            + tables.law.impedance_damping * state.damping_torque(tables)
            - state.cogging_difference(tables);
        let load_torque = load.gravity_torque() + load.friction_torque();
        self.stream.step(tables, point);
        let extrapolation_time = self.stream.extrapolation_time(tables);
        let error = state.error + point.speed * extrapolation_time;
        let torque = point.torque + self.stream.torque_rate() * extrapolation_time;
        let requested = point.stiffness * error + point.damping * state.error_rate + torque;
        let demand_now = mesh_torque(tables, load_torque, requested);
        let rate = tables.body.load_share * (point.stiffness * state.error_rate + self.stream.torque_rate());
        let demand = |time: T| demand_now + time * rate;
        let rests = point.speed == T::ZERO && self.stream.rests(tables);
        let flank = self.start.step(tables, state, self.stream.direction(), rests);
        let expected_start_torque = sign::<T>(flank) * load.start_torque(tables);
        ControlDemand { expected_start_torque, ..ControlDemand::new(tables, load, state, law_torque, demand, true) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensation::test_bench::{state, tables};

    fn demand(point: &ImpedancePoint<f64>, state: &LoopState<f64>) -> ControlDemand<f64> {
        ImpedanceLaw::new().demand(&tables(), &LoadModel::of_known(0.0, 0.0), state, point)
    }

    #[test]
    fn law_is_spring_damper_and_torque() {
        let point = ImpedancePoint { torque: 1.0, stiffness: 100.0, damping: 4.0, speed: 0.1, ..Default::default() };
        let state = LoopState { error: 0.02, motor_speed: 0.3, link_speed: 0.3, ..state() };
        assert!((demand(&point, &state).law_torque - (1.0 + 2.0 - 0.8)).abs() < 1e-12);
    }

    #[test]
    fn spring_is_cut_at_the_motor_limit() {
        let point = ImpedancePoint { stiffness: 1e6, ..Default::default() };
        assert_eq!(demand(&point, &LoopState { error: -1.0, ..state() }).law_torque, -10.0);
    }

    #[test]
    fn tenth_of_the_motor_damper_stays() {
        let state = LoopState { motor_speed: 0.1, ..state() };
        assert!((demand(&ImpedancePoint::default(), &state).law_torque + 0.2).abs() < 1e-12);
    }

    #[test]
    fn demand_is_the_share_of_the_link() {
        let point = ImpedancePoint { torque: 4.0, ..Default::default() };
        let demand = demand(&point, &state());
        assert!(demand.is_impedance && demand.now == 3.0);
    }

    /// Set-points held for three periods of 1 ms: from one period to the next the demand grows as the spring follows the
    /// moving point, and by the torque's own rate.
    #[test]
    fn moving_point_is_extrapolated_between_set_points() {
        let mut law = ImpedanceLaw::new();
        let mut demand = |torque: f64| {
            let point = ImpedancePoint { torque, stiffness: 100.0, speed: 2.0, ..Default::default() };
            law.demand(&tables(), &LoadModel::of_known(0.0, 0.0), &state(), &point).now
        };
        let found = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0].map(&mut demand);
        // The link's share of the torque is 0.75; half of the change of 1 N m in three periods counts as its rate.
        let rate = (found[4] - found[3]) / 0.75e-3;
        assert!((rate - (100.0 * 2.0 + 0.5 / 3e-3)).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn reset_forgets_the_set_points() {
        let point = |torque: f64| ImpedancePoint { torque, stiffness: 100.0, speed: 2.0, ..Default::default() };
        let demand = |law: &mut ImpedanceLaw<f64>, torque: f64| {
            law.demand(&tables(), &LoadModel::of_known(0.0, 0.0), &state(), &point(torque)).now
        };
        let (mut used, mut new) = (ImpedanceLaw::new(), ImpedanceLaw::new());
        for torque in [0.0, 0.0, 4.0] {
            demand(&mut used, torque);
        }
        used.reset();
        assert_eq!(
            [1.0, 1.0].map(|torque| demand(&mut used, torque)),
            [1.0, 1.0].map(|torque| demand(&mut new, torque))
        );
    }

    #[test]
    fn error_that_is_no_number_is_not_finite() {
        let point = ImpedancePoint { stiffness: 100.0, ..Default::default() };
        assert!(!demand(&point, &LoopState { error: f64::NAN, ..state() }).is_finite());
    }
}
