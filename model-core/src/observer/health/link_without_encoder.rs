//! Link without an output encoder: observed through touching teeth, unobservable in the open gap.
//!
//! ```text
//! (O26) var(X) = var(edge) + noise + t_o^2 (bounce^2 + r_o^2 var(w_l)) + t_o^4 (r_o/(2 J_l))^2 var(t_l)
//! (O27) contact is likelier than an open gap:  F^2 > 2 s_F^2 ln(F_max/(sqrt(2 pi) s_F))
//! ```
//!
//! Symbols: t_o = `time` since certain contact, bounce = `landing_speed`, r_o/(2 J_l) = `deflection_per_torque`, F =
//! `force`, s_F = `mean_force_deviation`.
//!
//! In contact the deflection is the half-gap plus the wind-up of the mesh force, which the motor side gives; the load
//! side is corrected towards this deflection. In the open gap the load side runs on under the last load torque.
//!
//! The smoothed force has two contact thresholds: the reported contact needs a force that is likelier with contact than
//! without; the correction of the load side needs a force that no bias explains.

use super::thresholds::UnseenLinkThresholds;
use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::arithmetic::deadband;
use crate::numbers::state_words::state_words;
use crate::observer::contact::force_contact::with_hysteresis;
use crate::observer::filters::LoadCorrection;
use crate::observer::identification::ParameterEstimator;
use crate::observer::identification::mesh_measurement::MeshMeasurement;
use crate::observer::tables::ObserverTables;

/// Estimate of the link's motion without its encoder.
#[derive(Debug, Clone, Copy, Default)]
pub struct LinkWithoutEncoder<T: Real> {
    /// Flank of certain contact.
    pub certain: Option<Flank>,
    /// Flank of likely contact (O27).
    likely: Option<Flank>,
    /// Periods since certain contact, saturated.
    open_periods: u16,
    /// True if contact was certain since the exclusion of the output encoder, or if the link's speed was known then.
    position_known: bool,
    /// Smoothed mesh force [N].
    force: T,
    /// Sum of landing speeds, decaying as bounces do [m/s].
    landing_speed: T,
}
state_words! {
    struct LinkWithoutEncoder<T> {
        certain, likely, open_periods, position_known, force, landing_speed,
    }
}

impl<T: Real> LinkWithoutEncoder<T> {
    const LIMITS: UnseenLinkThresholds<T> = UnseenLinkThresholds::TUNED;

    /// Keeps place and speed of the link, which were known when its encoder was excluded.
    pub fn keep_position(&mut self) {
        self.position_known = true;
    }

    /// Touching flank: by force if it suffices, otherwise by a motor position beyond a flank, however light the
    /// contact.
    #[cold]
    pub fn contact<const P: usize>(
        &self,
        measurement: &MeshMeasurement<T>,
        estimator: &ParameterEstimator<T, P>,
        before: Option<Flank>,
    ) -> Option<Flank> {
        if self.likely.is_some() {
            return self.likely;
        }
        if self.open_periods < Self::LIMITS.flank_kept_periods {
            return before;
        }
        let [half_gap, _] = estimator.half_gap_and_compliance();
        Flank::towards(deadband(measurement.tooth_deflection(), half_gap))
    }

    /// Detects contact in one period and returns the correction of the load side.
    pub fn step<const P: usize>(
        &mut self,
        tables: &ObserverTables<T>,
        measurement: &MeshMeasurement<T>,
        estimator: &ParameterEstimator<T, P>,
    ) -> LoadCorrection<T> {
        let levers = &tables.levers;
        let [half_gap, compliance] = estimator.half_gap_and_compliance();
        self.force += (measurement.force - self.force) * tables.contact.smoothing;
        let deviation = estimator.uncertainty.mean_force_deviation;
        let [on, off] = [Self::LIMITS.certain_begin, Self::LIMITS.certain_keep]
            .map(|deviations| T::from_i32(deviations) * deviation);
        let before = self.certain;
        self.certain = with_hysteresis(before, self.force, on, off);
        self.likely =
            with_hysteresis(self.likely, self.force, T::from_i32(Self::LIMITS.likely_begin) * deviation, deviation);
        let side: T = sign(self.certain);
        let innovation =
            (measurement.tooth_deflection() - side * half_gap - compliance * measurement.force) * levers.per_output;
        if self.certain.is_none() {
            self.open_periods = self.open_periods.saturating_add(1);
            // Beyond an edge the teeth touch, however lightly: the link turns with the motor.
            let excess = deadband(measurement.tooth_deflection(), half_gap);
            if excess == T::ZERO {
                return LoadCorrection::None;
            }
            return LoadCorrection::TurnsWithMotor(excess * levers.per_output);
        }
        self.open_periods = 0;
        if self.certain == before {
            self.landing_speed -= self.landing_speed * tables.contact.smoothing * Self::LIMITS.landing_speed_decay;
            return LoadCorrection::InContact(innovation);
        }
        // A landing gives the link's position and speed, but not its torque.
        self.landing_speed += measurement.rate.abs();
        self.position_known = true;
        LoadCorrection::TurnsWithMotor(innovation)
    }

    /// Variance of the gap coordinate (O26) [m^2]; `None` if the link's place is unknown.
    pub fn gap_variance<const P: usize>(
        &self,
        tables: &ObserverTables<T>,
        estimator: &ParameterEstimator<T, P>,
    ) -> Option<T> {
        let edge = estimator.uncertainty.edge_deviation;
        self.position_known.then(|| edge * edge + tables.contact.deflection_variance + self.drift_variance(tables))
    }

    /// Variance added since certain contact [m^2].
    fn drift_variance(&self, tables: &ObserverTables<T>) -> T {
        let load = &tables.load;
        let open_periods =
            if self.open_periods > 0 { i32::from(self.open_periods) + Self::LIMITS.contact_lag } else { 0 };
        let time = tables.period * T::from_i32(open_periods);
        let [speed_variance, torque_variance] = load.motor_only_variance;
        let lever = tables.levers.output;
        let landing_speed = self.landing_speed;
        let by_torque = time * load.deflection_per_torque;
        (landing_speed * landing_speed + lever * lever * speed_variance + by_torque * by_torque * torque_variance)
            * time
            * time
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::test_tables::{estimator, observer};

    #[test]
    fn contact_may_have_ended_30_periods_ago() {
        let mut tables = observer();
        tables.load.motor_only_variance = [0.0; 2];
        let deviation = |open_periods| {
            let link =
                LinkWithoutEncoder { open_periods, position_known: true, landing_speed: 10e-3, ..Default::default() };
            link.gap_variance(&tables, &estimator(&tables)).expect("a position").square_root()
        };
        // 10 mm/s for 31 periods of 0.1 ms.
        assert!((deviation(0) - 1e-6).abs() < 0.1e-6 && (deviation(1) - 31e-6).abs() < 0.1e-6, "{}", deviation(1));
    }

    #[test]
    fn bounces_outlast_force_eight_times() {
        let tables = observer();
        let mut estimator = estimator(&tables);
        estimator.uncertainty.mean_force_deviation = 1.0;
        let mut link =
            LinkWithoutEncoder { certain: Some(Flank::Drive), force: 10.0, landing_speed: 1.0, ..Default::default() };
        let measurement = MeshMeasurement {
            flank_shift: 0.0,
            raw_deflection: 80e-6,
            deflection: 80e-6,
            rate: 0.0,
            travel: 0.0,
            motor_force: 10.0,
            direction: 0.0,
            force: 10.0,
        };
        // The smoothed force follows within 10 periods.
        (0..80).for_each(|_| _ = link.step(&tables, &measurement, &estimator));
        assert!((link.landing_speed - 1.0 / core::f32::consts::E).abs() < 0.01, "{}", link.landing_speed);
    }
}
