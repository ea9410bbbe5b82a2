//! Design of the wiring check: travel of the joint, rise of the torque, and tolerances.
//!
//! With the ratio `r`, the lost motion `l`, the encoders' errors `e` and an output travel `x`, motor over `r` and
//! output agree within `(l/2 + e)/x` of the travel. The travel of the output is
//!
//! `x = TRAVEL (l/2 + e)` (1)
//!
//! so that the ratio is measured within `1/TRAVEL`. The torque rises by `U/RISE` per second up to the allowed torque;
//! `U` is a fifth of the motor's limit. A joint with the inertia `J` at the motor breaks away at the time 0. At the
//! time `t` its acceleration is `a = (U/RISE) t/J`, its speed `a t/2` and its travel `a t^2/6`. The opposite torque
//! stops the motor after a further travel of `a t^2/8`, three quarters of the travel before. Braking from half of `x`
//! therefore ends before `x`, with or without friction.

use crate::gears::design::DesignError;
use crate::numbers::Real;
use crate::observer::ObserverTables;
use crate::observer::design::body::Body;
use crate::observer::design::{ObserverSettings, design_observer};
use crate::wiring::tables::WiringTable;
use parameters::JointParameters;

/// Output travel over the slack between motor and output, equation (1) [-]: the ratio is measured within 4 %. Gears of
/// neighbouring ratios are 7 % apart (5 and 14/3).
const TRAVEL: f64 = 25.0;

/// Least travel [counts of either encoder]: a travel is measured within 2 %.
const COUNTS: f64 = 200.0;

/// Least travel of a leading shaft, and of the other shaft if it had followed [counts].
const LEADS: f64 = 8.0;

/// Largest travel of the output [rad]: 14 degrees. Chosen.
const FURTHEST: f64 = 0.25;

/// Part of the travel at which the motor is braked [-].
const BRAKED: f64 = 0.5;

/// Travel of the output from the start at which the check ends, over the travel of a leg [-]: legs alternate, and
/// friction of unequal size makes the legs drift.
///
/// An encoder with four times too few counts doubles the travel; this limit is larger.
const LIMIT: f64 = 2.5;

/// Part of the motor's limit that the check uses [-], as in the width probe.
const USUAL_SHARE: f64 = 0.2;

/// Least torque of the check [torque uncertainties], as in the width probe.
const USUAL_UNCERTAINTIES: f64 = 8.0;

/// Time in which the torque rises to its largest value [s]: long compared with a crossing of the gap, so that landings
/// are soft.
const RISE: f64 = 1.0;

/// Torque that sets a joint in motion [torque uncertainties]: bias and dry friction of motor and link, two standard
/// deviations.
const FRICTION: f64 = 4.0;

/// Change of speed over a block under the torque uncertainty [counts].
const BLOCK_COUNTS: f64 = 8.0;

/// Shortest and longest block [s].
const BLOCK: [f64; 2] = [1e-3, 20e-3];

/// Time without torque before each leg [s].
const REST: f64 = 50e-3;

/// Time over which a speed is measured [s].
const WINDOW: f64 = 3e-3;

/// Time at the full torque after which a leg ends [s].
const HOLD: f64 = 0.5;

/// Time after which the check ends [s].
const LONGEST: f64 = 20.0;

/// Tolerance of the ratio beside slack over travel [-]: backlash and compliance of the joint file are guesses.
const RATIO_TOLERANCE: f64 = 0.02;

/// Tolerance of the torque as a factor [-]: between 1 and 2.5, the factor between units that are mistaken for one
/// another, as `identify` limits the inertia.
const TORQUE_FACTOR: f64 = 1.6;

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
    let travel = (TRAVEL * slack).max(COUNTS * count).min(FURTHEST);
    let torque = (USUAL_SHARE * settings.torque_limit)
        .max(USUAL_UNCERTAINTIES * settings.torque_uncertainty)
        .min(settings.torque_limit);
    let inertia = body.motor_inertia + body.load_inertia / (body.ratio * body.ratio);
    let acceleration = settings.torque_uncertainty / inertia;
    let block = libm::sqrt(BLOCK_COUNTS * body.ratio * count / acceleration).clamp(BLOCK[0], BLOCK[1]);
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
        ratio_tolerance: real(RATIO_TOLERANCE),
        torque_factor: real(TORQUE_FACTOR),
        leads: {
            let out_in_motor = counts.output.angle * body.ratio / counts.motor.angle;
            [out_in_motor, 1.0 / out_in_motor].map(|counts| libm::ceil(LEADS * counts.max(1.0)) as u32)
        },
        leg: travels(BRAKED),
        limit: travels(LIMIT),
        rise: real(torque / RISE * step),
        torque: real(torque),
        torque_limit: real(settings.torque_limit),
        friction: real(FRICTION * settings.torque_uncertainty),
        rest: periods(REST),
        window: periods(WINDOW),
        hold: periods(HOLD),
        longest: periods(LONGEST),
    })
}
