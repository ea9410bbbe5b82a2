//! Reads `[drive_train]`: what surrounds the gears in a real joint, as plain data in SI. The reference and the virtual
//! joint model it; the fixed step does not use it.

use parameters::{AbsoluteEncoder, Friction, Surroundings};

use crate::problem::Severity;
use crate::section::Section;
use crate::sheet;

/// Speed of the Stribeck rise at the link where a file gives none [rad/s].
const STRIBECK_SPEED: f64 = 0.05;

/// What surrounds the gears, the motor's torque limit aside, which is the profile's. Keys left out are ideal, and so are
/// wrong ones once they have been noted, and so is everything without the section.
/// `ratio` is the joint's, where it is known.
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
        torque_noise_ratio: number("torque_noise_ratio", ideal.torque_noise_ratio),
        torque_constant_error_ratio: number("torque_constant_error_ratio", ideal.torque_constant_error_ratio),
        control_rate: control_rate(section).unwrap_or(ideal.control_rate),
        delay: number("control_delay_periods", ideal.delay),
        motor_encoder: encoder(section, "motor_encoder"),
        output_encoder: encoder(section, "output_encoder"),
        ..ideal
    }
}

/// Dry friction at the motor, stated or as the rest of a data sheet's no-load torque.
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
                let help = "it is the torque at the input that turns the joint: lower `load_coulomb_friction_N_m`";
                section.notes.error(section.place(NO_LOAD), message, help);
            }
            left
        }
        key => section.number(key),
    }
}

/// Whole control periods a second; what is left of a period is dropped, and said to be.
fn control_rate(section: &Section<'_>) -> Option<u32> {
    let key = "control_rate_Hz";
    let stated = section.number(key)?;
    let rate = stated as u32;
    if f64::from(rate) != stated {
        let message = format!("`{key}` = {stated} is taken as {rate}");
        let help = "give a whole number of control periods a second";
        section.notes.problem(section.place(key), message, help, Severity::Warning);
    }
    Some(rate)
}

fn encoder(section: &Section<'_>, name: &str) -> AbsoluteEncoder {
    let ideal = Surroundings::ideal().motor_encoder;
    let Some(section) = section.section(name, "encoder") else { return ideal };
    let number = |key: &str| section.number(key).unwrap_or(0.0);
    AbsoluteEncoder {
        bits: section.required_whole("bits").unwrap_or(ideal.bits),
        once_per_turn_error: number("once_per_turn_error_deg"),
        twice_per_turn_error: number("twice_per_turn_error_deg"),
        skew: number("skew_us"),
    }
}
