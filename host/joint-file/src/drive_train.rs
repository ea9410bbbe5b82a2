//! Reads `[drive_train]`: the drive train around the gears, as plain data in SI. The reference and the virtual joint
//! model it; the fixed step does not use it.

use parameters::{
    AbsoluteEncoder, Drift, Effect, Friction, Hysteresis, JointParameters, Payload, PayloadStep, Presliding,
    SubdivisionalError, Surroundings, TorqueErrors, WidthVariation,
};

use crate::notes::Notes;
use crate::problem::Severity;
use crate::section::Section;
use crate::sheet;

/// Default speed of the Stribeck rise at the link [rad/s].
const STRIBECK_SPEED: f64 = 0.05;

/// Reads the drive train, except the motor's torque limit, which is the profile's. Missing keys, wrong keys after a
/// note, and a missing section are ideal. `ratio` is the joint's, if known.
pub(crate) fn read(section: Option<&Section<'_>>, ratio: Option<f64>) -> Surroundings {
    let ideal = Surroundings {
        load_friction: Friction { stribeck_speed: STRIBECK_SPEED, ..Friction::default() },
        ..Surroundings::ideal()
    };
    let Some(section) = section else { return ideal };
    let number = |key: &str, default: f64| section.number(key).unwrap_or(default);
    Surroundings {
        motor_friction: Friction {
            coulomb: motor_friction(section, ratio).unwrap_or(0.0),
            viscous: number("motor_viscous_friction_N_m_s_per_rad", 0.0),
            ..Friction::default()
        },
        cogging_torque: number("cogging_torque_N_m", ideal.cogging_torque),
        cogging_periods_per_turn: section.whole("cogging_periods_per_turn").unwrap_or(ideal.cogging_periods_per_turn),
        load_friction: Friction {
            coulomb: number("load_coulomb_friction_N_m", 0.0),
            stribeck_rise_ratio: number("load_stribeck_rise_ratio", 0.0),
            stribeck_speed: number("load_stribeck_speed_rad_per_s", STRIBECK_SPEED),
            viscous: number("load_viscous_friction_N_m_s_per_rad", 0.0),
        },
        efficiency: number("efficiency", ideal.efficiency),
        gravity_torque: number("gravity_torque_N_m", ideal.gravity_torque),
        current_lag: number("current_lag_ms", ideal.current_lag),
        speed_limit: number("motor_speed_limit_rad_per_s", ideal.speed_limit),
        torque_noise_ratio: number("torque_noise_ratio", ideal.torque_noise_ratio),
        torque_constant_error_ratio: number("torque_constant_error_ratio", ideal.torque_constant_error_ratio),
        control_rate: control_rate(section).unwrap_or(ideal.control_rate),
        delay: number("control_delay_periods", ideal.delay),
        motor_encoder: encoder(section, "motor_encoder"),
        output_encoder: encoder(section, "output_encoder"),
        control_jitter_ratio: number("control_jitter_ratio", 0.0),
        ..effects(section, ideal)
    }
}

/// Effects of the drive train, absent unless stated. A key without effect on its own is rejected.
fn effects(section: &Section<'_>, ideal: Surroundings) -> Surroundings {
    let number = |key: &str| section.number(key).unwrap_or(0.0);
    let needs = |key: &str, other: &str| {
        if section.has(key) && !section.has(other) {
            let help = format!("give `{other}` beside it, or leave it out");
            section.notes.error(section.place(key), format!("`{key}` has no effect without `{other}`"), help);
        }
    };
    needs("payload_inertia_share", "payload_frequency_Hz");
    needs("payload_frequency_Hz", "payload_inertia_share");
    needs("payload_damping_ratio", "payload_inertia_share");
    needs("payload_step_time_s", "payload_step_ratio");
    needs("hysteresis_stiffness_share", "hysteresis_torque_N_m");
    needs("hysteresis_torque_N_m", "hysteresis_stiffness_share");
    needs("torque_ripple_periods_per_turn", "torque_ripple_ratio");
    let width = WidthVariation {
        per_link_turn: number("width_once_per_link_turn_ratio"),
        per_motor_turn: number("width_once_per_motor_turn_ratio"),
    };
    if width.per_link_turn + width.per_motor_turn >= 1.0 {
        let key = "width_once_per_motor_turn_ratio";
        let message = format!("the backlash would vary by {} of itself", width.per_link_turn + width.per_motor_turn);
        let help = "both amplitudes together stay below 1: a backlash is never negative";
        section.notes.error(section.place(key), message, help);
    }
    let usual = TorqueErrors::default();
    Surroundings {
        payload: Payload {
            inertia_share: number("payload_inertia_share"),
            frequency: number("payload_frequency_Hz"),
            damping_ratio: number("payload_damping_ratio"),
        },
        payload_step: PayloadStep {
            time: number("payload_step_time_s"),
            ratio: section.number("payload_step_ratio").unwrap_or(1.0),
        },
        presliding: Presliding { motor: number("motor_presliding_mrad"), load: number("load_presliding_mrad") },
        hysteresis: Hysteresis {
            stiffness_share: number("hysteresis_stiffness_share"),
            torque: number("hysteresis_torque_N_m"),
        },
        width,
        drift: Drift { friction: number("friction_drift_ratio_per_s"), width: number("width_drift_ratio_per_s") },
        torque_errors: TorqueErrors {
            ripple_ratio: number("torque_ripple_ratio"),
            ripple_periods_per_turn: section
                .whole("torque_ripple_periods_per_turn")
                .unwrap_or(usual.ripple_periods_per_turn),
            resolution_ratio: number("torque_resolution_ratio"),
            saturation_ratio: number("torque_saturation_ratio"),
        },
        ..ideal
    }
}

/// Rejects effects of parts that the joint does not have.
pub(crate) fn check(joint: &JointParameters, around: &Surroundings, notes: &Notes<'_>) {
    let refuse = |key: &str, message: &str, help: &str| {
        let place = notes.first_place(&[&format!("drive_train.{key}")]);
        notes.error(place, format!("`{key}` {message}"), help);
    };
    if around.hysteresis.stiffness_share > 0.0 && joint.compliance.is_none() {
        let help = "give [compliance], or leave it out: carrier and link of this joint turn as one";
        refuse(Effect::Hysteresis.key(), "needs a stiffness that the joint does not have", help);
    }
    for effect in [Effect::Payload, Effect::PayloadStep] {
        if around.size(effect) != 0.0 && joint.link_inertia == 0.0 {
            let help = "give `link_inertia_kg_m2` in [bodies]";
            refuse(effect.key(), "needs an inertia that the joint does not have", help);
        }
    }
}

/// Dry friction at the motor, stated or as the motor's part of a data sheet's no-load torque.
fn motor_friction(section: &Section<'_>, ratio: Option<f64>) -> Option<f64> {
    const NO_LOAD: &str = "no_load_torque_N_m";
    match section.one_of(&["motor_coulomb_friction_N_m", NO_LOAD], false)? {
        NO_LOAD => {
            let no_load = section.number(NO_LOAD)?;
            let load = section.number("load_coulomb_friction_N_m").unwrap_or(0.0);
            let (ratio, efficiency) = (ratio?, section.number("efficiency").unwrap_or(1.0));
            let left = sheet::motor_friction(no_load, load, ratio, efficiency);
            if left.is_none() {
                let at_motor = load / (ratio * efficiency);
                let message =
                    format!("`{NO_LOAD}` is {no_load}, but the load's dry friction alone takes {at_motor:.4} N m");
                let help =
                    "it is the torque at the input that turns the unloaded joint: lower `load_coulomb_friction_N_m`";
                section.notes.error(section.place(NO_LOAD), message, help);
            }
            left
        }
        key => section.number(key),
    }
}

/// Whole control periods per second; a fraction is dropped with a warning.
fn control_rate(section: &Section<'_>) -> Option<u32> {
    let key = "control_rate_Hz";
    let stated = section.number(key)?;
    let rate = stated as u32;
    if f64::from(rate) != stated {
        let message = format!("`{key}` = {stated} is taken as {rate}");
        let help = "give a whole number of control periods per second";
        section.notes.problem(section.place(key), message, help, Severity::Warning);
    }
    Some(rate)
}

fn encoder(section: &Section<'_>, name: &str) -> AbsoluteEncoder {
    let ideal = Surroundings::ideal().motor_encoder;
    let Some(section) = section.section(name, "encoder") else { return ideal };
    let number = |key: &str| section.number(key).unwrap_or(0.0);
    AbsoluteEncoder {
        counts_per_turn: counts_per_turn(&section).unwrap_or(ideal.counts_per_turn),
        once_per_turn_error: number("once_per_turn_error_deg"),
        twice_per_turn_error: number("twice_per_turn_error_deg"),
        skew: number("skew_us"),
        age_jitter: number("age_jitter_us"),
        noise_counts: number("noise_counts"),
        subdivision: subdivision(&section),
        missing_share: number("missing_frames_share"),
    }
}

/// Resolution from bits or counts; exactly one of them is stated.
fn counts_per_turn(section: &Section<'_>) -> Option<u64> {
    const COUNTS: &str = "counts_per_turn";
    match section.one_of(&["bits", COUNTS], true)? {
        COUNTS => section.whole(COUNTS).map(u64::from),
        bits => section.whole(bits).map(AbsoluteEncoder::counts_of_bits),
    }
}

/// Error within a period of the scale; absent without an amplitude.
fn subdivision(section: &Section<'_>) -> SubdivisionalError {
    const PERIODS: &str = "subdivisional_periods_per_turn";
    let (first, second) = ("subdivisional_error_deg", "subdivisional_second_error_deg");
    if ![first, second].into_iter().any(|key| section.has(key)) {
        if section.has(PERIODS) {
            let help = format!("give `{first}` or `{second}` beside it, or leave it out");
            section.notes.error(
                section.place(PERIODS),
                format!("`{PERIODS}` has no effect without an amplitude"),
                help,
            );
        }
        return SubdivisionalError::default();
    }
    let amplitude = |key: &str| section.number(key).unwrap_or(0.0);
    SubdivisionalError {
        periods_per_turn: section.required_whole(PERIODS).unwrap_or(1),
        first: amplitude(first),
        second: amplitude(second),
    }
}
