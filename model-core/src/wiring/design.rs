//! Design of the wiring check: travel of the joint, rise of the torque, and tolerances.
//!
//! With the ratio `r`, the lost motion `l`, the encoders' errors `e` and an output travel `x`, motor over `r` and
//! output agree within `(l/2 + e)/x` of the travel. The travel of the output is
//!
//! `x = WIRING_DESIGN.travel (l/2 + e)` (1)
//!
//! so that the ratio is measured within `1/WIRING_DESIGN.travel`. The torque rises by `U/WIRING_DESIGN.rise` per second
//! up to the allowed torque; `U` is a fifth of the motor's limit. A joint with the inertia `J` at the motor breaks away
//! at the time 0. At the time `t` its acceleration is `a = (U/WIRING_DESIGN.rise) t/J`, its speed `a t/2` and its
//! travel `a t^2/6`. The opposite torque stops the motor after a further travel of `a t^2/8`, three quarters of the
//! travel before. Braking from half of `x` therefore ends before `x`, with or without friction.

use crate::gears::design::DesignError;
use crate::numbers::Real;
use crate::observer::ObserverTables;
use crate::observer::design::body::Body;
use crate::observer::design::thresholds::PROBE_DESIGN;
use crate::observer::design::{ObserverSettings, design_observer};
use crate::wiring::tables::WiringTable;
use crate::wiring::thresholds::WIRING_DESIGN;
use parameters::JointParameters;

/// Table of the wiring check.
pub fn design_wiring<T: Real>(
    joint: &JointParameters,
    settings: &ObserverSettings,
) -> Result<WiringTable<T>, DesignError> {
    let ObserverTables { counts, period: step, .. } = design_observer::<f64>(joint, settings)?;
    let tables = design_observer::<T>(joint, settings)?;
    let body = Body::new(joint);
    let real = T::from_f64;
    let periods = |time: f64| libm::round(time / step).max(1.0) as u32;
    let motor = settings.motor_encoder;
    let output = settings.output_encoder.unwrap_or(motor);
    let lost_motion = 4.0 * body.half_backlash / body.output_lever;
    // Errors once and twice per turn, from peak to peak over less than a turn.
    let errors = 2.0 * (motor.harmonic_error / body.ratio + output.harmonic_error)
        + 2.0 * body.transmission_error / body.output_lever
        + counts.output.angle
        + counts.motor.angle / body.ratio;
    let slack = 0.5 * lost_motion + errors;
    let count = counts.output.angle.max(counts.motor.angle / body.ratio);
    let travel = (WIRING_DESIGN.travel * slack).max(WIRING_DESIGN.min_counts * count).min(WIRING_DESIGN.furthest);
    let torque = (PROBE_DESIGN.usual_share * settings.torque_limit)
        .max(PROBE_DESIGN.usual_uncertainties * settings.torque_uncertainty)
        .min(settings.torque_limit);
    let inertia = body.motor_inertia + body.load_inertia / (body.ratio * body.ratio);
    let acceleration = settings.torque_uncertainty / inertia;
    let block = libm::sqrt(WIRING_DESIGN.block_counts * body.ratio * count / acceleration)
        .clamp(WIRING_DESIGN.block[0], WIRING_DESIGN.block[1]);
    let block = periods(block).max(4);
    let square = (f64::from(block) * step).powi(2);
    let travels = |part: f64| {
        [
            libm::ceil(part * (travel * body.ratio + lost_motion * body.ratio) / counts.motor.angle) as u32,
            libm::ceil(part * travel / counts.output.angle) as u32,
        ]
    };
    let wind_up = body.compliance * torque / body.sun_lever / body.output_lever;
    Ok(WiringTable {
        clock: tables.clock,
        counts: tables.counts,
        ratio: real(body.ratio),
        per_ratio: real(1.0 / body.ratio),
        block,
        per_block: real(1.0 / f64::from(block)),
        impulse: [real(body.motor_inertia / square), real(body.load_inertia / body.ratio / square)],
        slack: real(slack),
        lost_motion: real(lost_motion),
        play: real(2.0 * lost_motion + 2.0 * wind_up + 2.0 * errors),
        ratio_tolerance: real(WIRING_DESIGN.ratio_tolerance),
        torque_factor: real(WIRING_DESIGN.torque_factor),
        leads: {
            let out_in_motor = counts.output.angle * body.ratio / counts.motor.angle;
            [out_in_motor, 1.0 / out_in_motor]
                .map(|counts| libm::ceil(WIRING_DESIGN.lead_counts * counts.max(1.0)) as u32)
        },
        leg: travels(WIRING_DESIGN.braked),
        limit: travels(WIRING_DESIGN.limit),
        rise: real(torque / WIRING_DESIGN.rise * step),
        torque: real(torque),
        torque_limit: real(settings.torque_limit),
        friction: real(WIRING_DESIGN.friction * settings.torque_uncertainty),
        rest: periods(WIRING_DESIGN.rest),
        window: periods(WIRING_DESIGN.window),
        hold: periods(WIRING_DESIGN.hold),
        longest: periods(WIRING_DESIGN.longest),
    })
}
