//! Link without an output encoder (O26, O27): observed through touching teeth, unobservable in the open gap.
//!
//! In contact the deflection is the half-gap plus the wind-up of the mesh force, which the motor side gives; the load
//! side is corrected towards this deflection. In the open gap the load side runs on under the last load torque: the
//! variance of the gap coordinate grows with the square of time for the speed and with the fourth power for the torque.
//!
//! The smoothed force has two contact thresholds: the reported contact needs a force that is likelier with contact than
//! without; the correction of the load side needs a force that no bias explains.

use crate::gears::{Flank, sign};
use crate::numbers::Real;
use crate::numbers::arithmetic::deadband;
use crate::observer::contact::force_contact::with_hysteresis;
use crate::observer::filters::LoadCorrection;
use crate::observer::identification::ParameterEstimator;
use crate::observer::identification::mesh_measurement::MeshMeasurement;
use crate::observer::tables::ObserverTables;

/// Control periods by which contact may have ended before the smoothed force shows it.
const GONE_BEFORE: i32 = 30;

/// Standard deviations of the smoothed force above which contact is certain: no bias explains the force.
const MAKES_CONTACT: i32 = 4;

/// Standard deviations of the smoothed force that keep certain contact.
const KEEPS_CONTACT: i32 = 3;

/// Standard deviations of the smoothed force above which contact is likelier than an open gap (O27). Both are equally
/// likely at F^2 = 2 s^2 ln(F_max / (sqrt(2 pi) s)), with s the standard deviation without contact and, in contact, any
/// force up to F_max: 2 deviations for a bias known to 5 % of the motor's largest torque, 2.5 for 2 %. One deviation
/// keeps contact.
const LIKELY_CONTACT: i32 = 2;

/// Control periods for which the last flank is kept without a force: the force estimate lags.
const SHOWN_LATE: u16 = 10;

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

impl<T: Real> LinkWithoutEncoder<T> {
    /// Decay rate of the bounce over that of the smoothed force [-]: bounces last eight times as long.
    const BOUNCE_DECAY: T = T::EIGHTH;

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
        if self.open_periods < SHOWN_LATE {
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
        let [on, off] = [MAKES_CONTACT, KEEPS_CONTACT].map(|deviations| T::from_i32(deviations) * deviation);
        let before = self.certain;
        self.certain = with_hysteresis(before, self.force, on, off);
        self.likely = with_hysteresis(self.likely, self.force, T::from_i32(LIKELY_CONTACT) * deviation, deviation);
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
            self.landing_speed -= self.landing_speed * tables.contact.smoothing * Self::BOUNCE_DECAY;
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
        let open_periods = if self.open_periods > 0 { i32::from(self.open_periods) + GONE_BEFORE } else { 0 };
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
