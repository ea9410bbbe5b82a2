//! Structs of the tables, by their fields; a missing or an unknown field does not compile.

use model_core::{compensation, gears, observer, virtual_joint, wiring};

use crate::fixed::Fixed;

/// Checks a field whose type is inferred from an accessor.
pub fn is_valid<S, F: Fixed>(bytes: &[u8], offset: usize, _: impl Fn(&S) -> &F) -> bool {
    bytes.get(offset..).is_some_and(F::is_valid)
}

/// Describes a field whose type is inferred from an accessor.
#[cfg(test)]
pub fn describe<S, F: Fixed>(name: &str, offset: usize, _: impl Fn(&S) -> &F, out: &mut Vec<String>) {
    F::describe(name, offset, out);
}

/// Implements [`Fixed`] for structs, by their fields.
macro_rules! structs {
    ($($kind:ty { $($field:ident),* })*) => {$(
        impl $crate::fixed::Fixed for $kind {
            #[cfg(feature = "design")]
            fn write_to(&self, place: &mut [u8]) {
                let Self { $($field),* } = self;
                $($field.write_to(&mut place[core::mem::offset_of!(Self, $field)..]);)*
            }

            fn is_valid(bytes: &[u8]) -> bool {
                true $(&& $crate::layout::is_valid(bytes, core::mem::offset_of!(Self, $field), |it: &Self| &it.$field))*
            }

            #[cfg(test)]
            fn describe(name: &str, offset: usize, out: &mut Vec<String>) {
                $($crate::layout::describe(
                    &format!("{name}.{}", stringify!($field)),
                    offset + core::mem::offset_of!(Self, $field),
                    |it: &Self| &it.$field,
                    out,
                );)*
            }
        }
    )*};
}
pub(crate) use structs;

structs! {
    gears::tables::VerletTable<f32> {
        substeps, half_count, substep, square, per_substep, mobility, wind_up_mobility, wind_up_yield,
        damping, half_damped, curvature, release
    }
    gears::tables::StageTable<f32> { rate, square_sixth, mobility, damping }
    gears::tables::UnitTable<f32> { drive, load_on_carrier, load_on_link, length, carrier_speed, motor_offset, link_offset }
    gears::tables::Rigid<f32> { drive, load }
    gears::tables::Mobility<f32> { sun, planet, carrier, link, wind_up, wind_up_stiffness, wind_up_damping }
    gears::tables::Excitation<f32> { phase_step, phase_advance, periods_per_turn, rate, harmonics }
    gears::tables::Spring<f32> { stiffness, damping }
    gears::tables::MeshTable<f32> { half_backlash, error, ripple }
    gears::tables::FlowTable<f32> {
        whole, early, late, early_inputs, late_inputs, whole_inputs, nodes, half, half_constant, whole_linear,
        whole_constant, step, reach, longest_advance
    }
    gears::tables::TransitionTable<f32> { in_phase, deviation, torques }
    gears::tables::Inputs<f32> { in_phase, deviation }
    observer::tables::ObserverTables<f32> {
        identity, control_rate, period, clock, counts, levers, current, drive, load, inertia, cogging, contact,
        learner, supervisor, response
    }
    observer::tables::ClockTable<f32> { tick, period, shortest, longer, oldest }
    observer::tables::EncoderTable<f32> { turn, wraps_at, last, phase, fastest, angle, fraction, turns }
    observer::tables::CountTable<f32> {
        motor, output, has_output, absolute, motor_weight, output_weight, modulus, meshes, mesh_periods,
        length
    }
    observer::tables::LeverTable<f32> { sun, per_sun, output, per_output, ratio, per_ratio }
    observer::tables::CurrentTable<f32> { whole_delay, part_delay, rise, believed, unsure_for }
    observer::tables::DriveTable<f32> { angle, speed, gain, late_gain, variance }
    observer::tables::LoadTable<f32> {
        angle, speed, gain, variance, motor_only_gain, motor_only_variance, deflection_per_torque
    }
    observer::tables::ContactTable<f32> {
        force_variance, ripple_variance, deflection_variance, bias_noise, bias_prior, bias_drift, bias_limit,
        rate_deviation, lag, smoothing, still, still_per_speed, per_turning, known_part, loss_driving,
        loss_driven
    }
    observer::tables::LearnerTable<f32> {
        periods, per_periods, middle, block, per_block, span, mean, deviation, weight, noise, force_noise,
        force_lag, forgetting, mesh_compliance
    }
    observer::tables::StopTable<f32> { stop, forgotten, per_stops }
    observer::tables::SupervisorTable<f32> {
        output, motor, output_brake, motor_brake, motor_drag, motor_counts, motor_unmoved_after,
        motor_trusted_after, motor_slipped_after, silent_after, failed_after, trusted_after, moved, margin,
        widest_part
    }
    observer::tables::ResponseTable<f32> { block, per_block, inertia, large, alone }
    observer::tables::InertiaTable<f32> {
        per_periods, still, slow, moving, settled_after, least, noise, most_restless, memory, prior, limit,
        known, drift
    }
    observer::tables::CoggingTable<f32> {
        periods, settled_after, slow, slow_time, speeds, steady, unsteady, response, late, prior, limit, repeats,
        memory
    }
    observer::tables::ProbeTable<f32> {
        torque, rise, damping, moving, loaded, furthest, longest, settle, still, per_still, turn, deflection,
        least, variance
    }
    wiring::WiringTable<f32> {
        clock, counts, ratio, per_ratio, block, per_block, impulse, slack, lost_motion, play, ratio_tolerance,
        torque_factor, leads, leg, limit, rise, torque, torque_limit, friction, rest, window, hold, longest
    }
    compensation::tables::CompensationTables<f32> {
        clock, gear, body, limits, law, crossing, landing, switching, rest, load, watch
    }
    compensation::tables::ControlClockTable<f32> { rate, period }
    compensation::tables::GearTable<f32> {
        motor_per_link, link_per_motor, turn, inverse_lever,
        mesh_phase_per_radian, radians_per_mesh, cogging_periods, cogging_phase_per_radian, losses
    }
    compensation::tables::BodyTable<f32> {
        motor_inertia, load_inertia, inverse_load_inertia, load_share, inverse_load_share, reduced_inertia,
        compliances, widest_half
    }
    compensation::tables::LimitTable<f32> { motor, teeth, least_room, teeth_at_most, braking }
    compensation::tables::LawTable<f32> {
        position, damping, rate, motor_damping, impedance_damping, integral, back_calculation, trust_step,
        longest_hold
    }
    compensation::tables::CrossingTable<f32> {
        lead, reaction, stiffness, strike_speed_per_torque, strike_torque, hardest_strike, shortest_ramp,
        ramp_per_speed, longest, shorten
    }
    compensation::tables::LandingTable<f32> {
        speed, speed_per_torque, acceleration, fastest, rise, repayment, opening, landed
    }
    compensation::tables::SwitchingTable<f32> {
        planned, measured, least, most_growth, transient_left, most_factor, smoothing, inverse_step
    }
    compensation::tables::RestTable<f32> { hunting, first_deadband, largest_deadband, deadband_left }
    compensation::tables::LoadModelTable<f32> {
        variances, gain, rate_gain, rate_left, fastest, friction_slope, planned_friction_slope,
        frictions
    }
    compensation::tables::MonitorTable<f32> {
        smoothing, least_demand, leaks, most, calm_per_half, memory, error_per_half, error_per_demand, first_away, longest_away,
        longer
    }
    virtual_joint::tables::SurroundingsTable<f32> {
        period, clock_ticks, turn, ratio, gear, units_per_radian, motor_rate, link_rate, current,
        cogging_torque, cogging_periods, motor_friction, load_friction, losses, half_backlash, sun_torque,
        to_link, weight, encoders
    }
    virtual_joint::tables::CurrentLoopTable<f32> { delay, rise, lacking, gain, limit }
    virtual_joint::tables::FrictionTable<f32> { coulomb, viscous, rise, per_speed, stop }
    virtual_joint::tables::EncoderErrorTable<f32> { turn, errors, lag, phase }
}

macro_rules! gears {
    ($($planets:literal),*) => {$(
        structs! {
            gears::Tables<f32, $planets> {
                digest, tick_rate, scheme, substeps, half_substep_share, substep, planet_share,
                damping_law, sharpness, units, rigid, mobility, excitation, springs, meshes, stage,
                flow, verlet
            }
        }
    )*};
}

gears!(1, 3, 4, 5);
