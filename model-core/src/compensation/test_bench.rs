//! Tables and state with round numbers for the unit tests of the compensation.

use core::f64::consts::TAU;

use super::control_demand::ControlDemand;
use super::design::{compensation_settings, design_compensation};
use super::loop_state::LoopState;
use super::set_point::Position;
use super::tables::{
    BodyTable, CompensationTables, ControlClockTable, CrossingTable, GearTable, LandingTable, LawTable, LimitTable,
    LoadModelTable, MonitorTable, RestTable, SwitchingTable,
};
use crate::gears::Flank;
use crate::numbers::Real;

/// Half of the lost motion in [`state`] [rad].
pub const HALF_GAP: f64 = 2e-3;

/// Tables of a joint at 1 kHz: J_m = 1, J_l = 3, w = 10, motor 10 N m, teeth 8 N m.
pub fn tables() -> CompensationTables<f64> {
    CompensationTables {
        clock: ControlClockTable { rate: 1000.0, period: 1e-3 },
        gear: GearTable {
            motor_per_link: 6.0,
            link_per_motor: 1.0 / 6.0,
            turn: TAU,
            inverse_lever: 1.0,
            mesh_phase_per_radian: 72.0 / TAU * f64::powi(2.0, 32),
            radians_per_mesh: 1.0 / 72.0,
            cogging_periods: 12,
            cogging_phase_per_radian: 72.0 / TAU * f64::powi(2.0, 32),
            losses: [0.1, 0.2],
        },
        body: BodyTable {
            motor_inertia: 1.0,
            load_inertia: 3.0,
            inverse_load_inertia: 1.0 / 3.0,
            load_share: 0.75,
            inverse_load_share: 4.0 / 3.0,
            reduced_inertia: 0.75,
            compliances: [4e-3, 0.25e-3],
            widest_half: 10e-3,
        },
        limits: LimitTable { motor: 10.0, teeth: 8.0, least_room: 0.8, teeth_at_most: 10.0, braking: 0.9 },
        law: LawTable {
            position: 1200.0,
            damping: 120.0,
            rate: 10.0,
            motor_damping: 20.0,
            impedance_damping: 0.1,
            integral: 4.0,
            back_calculation: 0.01,
            trust_step: 0.1,
            longest_hold: 5e-3,
        },
        crossing: CrossingTable {
            lead: 22e-3,
            reaction: 2e-3,
            stiffness: 100.0,
            strike_speed_per_torque: 0.1,
            strike_torque: 2.0,
            hardest_strike: 6.0,
            shortest_ramp: 8e-3,
            ramp_per_speed: 0.15,
            longest: 60e-3,
            shorten: 0.8,
        },
        landing: LandingTable {
            speed: 0.02,
            speed_per_torque: 0.01,
            acceleration: 1.0,
            fastest: 0.1,
            rise: 0.5,
            repayment: 50.0,
            opening: 0.3,
            landed: 0.03,
        },
        switching: SwitchingTable {
            planned: 0.05,
            measured: 0.2,
            least: 0.3,
            most_growth: 360.0,
            transient_left: 0.99,
            most_factor: 6.0,
            smoothing: 0.03,
            inverse_step: 2.0,
        },
        rest: RestTable { hunting: 1.5, first_deadband: 0.05, largest_deadband: 0.5, deadband_left: 0.9999 },
        load: LoadModelTable {
            variances: [0.1, 1e-4, 1.0],
            gain: 0.3,
            rate_gain: 30.0,
            rate_left: 0.99,
            fastest: 300.0,
            friction_slope: 100.0,
            planned_friction_slope: 1000.0,
            frictions: [0.5, 0.5],
        },
        watch: MonitorTable {
            smoothing: 0.025,
            least_demand: 0.05,
            leaks: [1.0, 20.0],
            most: 4.0,
            calm_per_half: 0.35,
            memory: 1.0 / 150.0,
            error_per_half: 1.5,
            error_per_demand: 0.25e-3,
            first_away: 10.0,
            longest_away: 120.0,
            longer: 4.0,
        },
    }
}

/// Tables of Q1 at 60 rad/s and 10 kHz; half-backlash of 40 um.
pub fn q1<T: Real>() -> CompensationTables<T> {
    let q1 = joint_file::read(joint_file::preset("q1").expect("a preset")).expect("a joint");
    design_compensation(&q1.parameters, &compensation_settings(&q1.surroundings, 60.0)).expect("tables")
}

/// State of a joint at rest at its set-point, whose drive flank touches without a force.
pub fn state() -> LoopState<f64> {
    LoopState {
        error: 0.0,
        error_rate: 0.0,
        motor_position: HALF_GAP,
        motor_lead: HALF_GAP,
        encoder_offset: 0.0,
        bounded_motor_position: HALF_GAP,
        motor_speed: 0.0,
        link_speed: 0.0,
        motor_angle: 0.0,
        cogging: [0.0; 2],
        origin: Position::default(),
        transmission_error_speed: 0.0,
        losses: [0.0; 2],
        half_gap: HALF_GAP,
        half_gap_known: true,
        mesh_torque: 0.0,
        stiffness: 1000.0,
        inertia: 4.0,
        flank_shift: 0.0,
        flank_shift_slope: 0.0,
        gap: HALF_GAP,
        contact: Some(Flank::Drive),
        teeth_open: false,
        link_seen: true,
        gap_known: true,
    }
}

/// Demand of a law, now and after a crossing [N m].
pub fn demand(now: f64, after_crossing: f64) -> ControlDemand<f64> {
    ControlDemand {
        law_torque: now,
        now,
        after_crossing,
        free_acceleration: 0.0,
        free_jerk: 0.0,
        at_far_flank: after_crossing,
        is_impedance: false,
        rests_unloaded: false,
        rests: false,
        needs_no_flank: false,
        external_impact: false,
        brakes_early: false,
        expected_start_torque: 0.0,
    }
}
