//! Tables with round numbers, for unit tests.

use std::sync::LazyLock;

use super::design::{design_observer, observer_settings};
use super::identification::ParameterEstimator;
use super::identification::regressors::{HALF_GAP, PLAIN};
use super::tables::{
    ContactTable, CurrentTable, DriveTable, LearnerTable, LoadTable, MOST_PARAMETERS, ObserverTables, StopTable,
    SupervisorTable,
};
use crate::numbers::Real;

/// Prior standard deviation of each parameter.
pub const DEVIATION: f32 = 1e-3;

/// Tables of Q1 in both precisions, designed once for all tests: 10 kHz, a motor of 2.5 N m, a half-gap of 80 um.
pub static Q1: LazyLock<ObserverTables<f32>> = LazyLock::new(q1);
pub static Q1_DOUBLE: LazyLock<ObserverTables<f64>> = LazyLock::new(q1);

/// Tables of Q1.
pub fn q1<T: Real>() -> ObserverTables<T> {
    let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
    design_observer(&q1.parameters, &observer_settings(&q1.surroundings)).expect("tables")
}

/// Tables of Q1 with the round numbers below.
pub fn observer() -> ObserverTables<f32> {
    ObserverTables {
        current: current(),
        drive: drive(),
        load: load(),
        contact: contact(),
        learner: learner(),
        supervisor: supervisor(),
        ..Q1.clone()
    }
}

/// Estimator of a joint with exactly known parameters: a half-gap of 80 um, no compliance, no errors.
pub fn estimator(tables: &ObserverTables<f32>) -> ParameterEstimator<f32, PLAIN> {
    let mut estimator = ParameterEstimator::uninitialized(tables);
    estimator.least_squares.values[HALF_GAP] = 80e-6;
    estimator.uncertainty.half_gap_is_known = true;
    estimator
}

/// Current loop without delay and lag.
pub fn current() -> CurrentTable<f32> {
    CurrentTable { whole_delay: 0, part_delay: 0.0, rise: 1.0, believed: 10.0, unsure_for: 200 }
}

/// Motor side with 1 rad/s^2 per newton metre and periods of 1 s.
pub fn drive() -> DriveTable<f32> {
    DriveTable {
        angle: [1.0, -0.5, 0.0, 0.5],
        speed: [-1.0, 0.0, 1.0],
        gain: [0.5, 0.25, -0.125],
        late_gain: [0.25, 0.125, -0.0625],
        variance: [1.0, 1.0],
    }
}

/// Load side with 1 rad/s^2 per newton metre and periods of 1 s.
pub fn load() -> LoadTable<f32> {
    LoadTable {
        angle: [1.0, 0.5],
        speed: 1.0,
        gain: [0.5, 0.25, -0.125],
        variance: [1.0, 1.0],
        motor_only_gain: [0.25, 0.125, -0.0625],
        motor_only_variance: [1.0, 1.0],
        deflection_per_torque: 0.5,
    }
}

/// Noise of 1 N and 1 um.
pub fn contact() -> ContactTable<f32> {
    ContactTable {
        force_variance: 1.0,
        ripple_variance: 0.0,
        deflection_variance: 1e-12,
        bias_noise: 1.0,
        bias_prior: 4.0,
        bias_drift: 0.5,
        bias_limit: 6.0,
        rate_deviation: 1e-4,
        lag: 3e-4,
        smoothing: 0.1,
        still: 1e-6,
        still_per_speed: 0.0,
        per_turning: 2.0,
        known_part: 0.08,
        loss_driving: 0.0,
        loss_driven: 0.0,
    }
}

/// Intervals of 10 periods, blocks of 8 intervals.
pub fn learner() -> LearnerTable<f32> {
    LearnerTable {
        periods: 10,
        per_periods: 0.1,
        middle: 5,
        block: 8,
        per_block: 0.125,
        span: 1e-3,
        mean: [0.0; MOST_PARAMETERS],
        deviation: [DEVIATION; MOST_PARAMETERS],
        weight: 1e6,
        noise: 1e-6,
        force_noise: 1.0,
        force_lag: 0.5,
        forgetting: 0.5,
        mesh_compliance: 0.0,
    }
}

/// Motor of 1 count per period^2 and newton metre, friction of 0.1 N m.
pub fn supervisor() -> SupervisorTable<f32> {
    let stops = StopTable { stop: 10, forgotten: 12, per_stops: 0.05 };
    SupervisorTable {
        output: stops.clone(),
        motor: stops,
        output_brake: 0.0,
        motor_brake: 0.5,
        motor_drag: 0.1,
        motor_counts: 1.0,
        motor_unmoved_after: 10,
        motor_trusted_after: 20,
        motor_slipped_after: 100,
        silent_after: 100,
        failed_after: 40,
        trusted_after: 5,
        moved: 1000,
        margin: 10e-6,
        widest_part: 0.1,
    }
}
