//! Checks of the encoders against the gap, and of the controller's times and rates.

use std::f64::consts::TAU;

use model_core::gears::Kinematics;
use parameters::AbsoluteEncoder;

use super::judge::{Judge, Limits, UNLIMITED, figure};
use crate::contents::JointFile;
use crate::sheet;

/// Count or error of an encoder over the lost motion, both at the link.
const OVER_GAP_LIMITS: Limits = Limits::above(1.0, UNLIMITED);
/// Age of a reading: interfaces take 0.1 us to 20 ms [s].
const SKEW_LIMITS: Limits = Limits { odd: (1e-7, 0.02), possible: (0.0, UNLIMITED) };
/// Time constant of a current loop [s].
const CURRENT_LAG_LIMITS: Limits = Limits { odd: (2e-6, 0.02), possible: (0.0, UNLIMITED) };
/// Rates of controllers of joints [Hz].
const CONTROL_RATE_LIMITS: Limits = Limits { odd: (100.0, 2.5e5), possible: (0.0, UNLIMITED) };
/// Control periods from measurement to torque.
const DELAY_LIMITS: Limits = Limits::above(20.0, UNLIMITED);
/// Speed at which the excess friction at rest has decayed [rad/s].
const STRIBECK_SPEED_LIMITS: Limits = Limits { odd: (1e-5, 1.0), possible: (0.0, UNLIMITED) };
/// Friction at rest over friction in motion, less 1.
const STRIBECK_RISE_LIMITS: Limits = Limits::above(2.0, UNLIMITED);
/// Relative noise of the torque, and error of the torque constant.
const TORQUE_NOISE_LIMITS: Limits = Limits::above(0.2, UNLIMITED);
const TORQUE_CONSTANT_LIMITS: Limits = Limits { odd: (-0.3, 0.3), possible: (-UNLIMITED, UNLIMITED) };
/// Pressure angles of manufactured teeth [rad].
const PRESSURE_ANGLE_LIMITS: Limits = Limits { odd: (0.17, 0.56), possible: (0.0, UNLIMITED) };
/// Characteristic length of dimensionless results [m].
const CHARACTERISTIC_LENGTH_LIMITS: Limits = Limits { odd: (1e-7, 1e-3), possible: (0.0, UNLIMITED) };

pub(super) fn check(file: &JointFile, judge: &Judge<'_>) {
    let around = &file.surroundings;
    let ratio = file.parameters.geometry.ratio_by_radii();
    encoder(file, judge, "motor", &around.motor_encoder, ratio);
    encoder(file, judge, "output", &around.output_encoder, 1.0);

    let only_if = |value: f64, limits: Limits, key: &str, unit: &str, scale: f64, what: &str, help: &str| {
        if value != 0.0 {
            judge.check_figure(&[key], value, limits, |_, key| {
                (format!("`{key}`: {} {unit} {what}", figure(scale * value)), help.to_owned())
            });
        }
    };
    let rate = f64::from(around.control_rate);
    let of_rate = "is implausible as the rate of a joint's controller";
    only_if(
        rate,
        CONTROL_RATE_LIMITS,
        "drive_train.control_rate_Hz",
        "Hz",
        1.0,
        of_rate,
        "it is in Hz: 10 kHz are 10e3 Hz",
    );
    let of_lag = "is implausible as the time constant of a current loop";
    only_if(
        around.current_lag,
        CURRENT_LAG_LIMITS,
        "drive_train.current_lag_ms",
        "ms",
        1e3,
        of_lag,
        "it is in ms: 0.0002 s and 200 us are 0.2 ms",
    );
    let of_delay = "from measuring to acting";
    only_if(
        around.delay,
        DELAY_LIMITS,
        "drive_train.control_delay_periods",
        "control periods",
        1.0,
        of_delay,
        "it counts periods, 1 is usual; 100 us at 10 kHz are 1",
    );
    let friction = &around.load_friction;
    let of_speed = "is implausible as the speed at which excess friction decays";
    only_if(
        friction.stribeck_speed,
        STRIBECK_SPEED_LIMITS,
        "drive_train.load_stribeck_speed_rad_per_s",
        "rad/s",
        1.0,
        of_speed,
        "in rad/s of the link, 0.01 to 0.1 is usual: 3 deg/s are 0.05 rad/s",
    );
    let of_rise = "of friction more at rest than in motion";
    only_if(
        friction.stribeck_rise_ratio,
        STRIBECK_RISE_LIMITS,
        "drive_train.load_stribeck_rise_ratio",
        "times",
        1.0,
        of_rise,
        "a ratio: 20 % is 0.2",
    );
    let of_noise = "of the torque is noise";
    only_if(
        around.torque_noise_ratio,
        TORQUE_NOISE_LIMITS,
        "drive_train.torque_noise_ratio",
        "part",
        1.0,
        of_noise,
        "a ratio: 1.5 % is 0.015",
    );
    let of_constant = "is how far the torque constant is off";
    only_if(
        around.torque_constant_error_ratio,
        TORQUE_CONSTANT_LIMITS,
        "drive_train.torque_constant_error_ratio",
        "part",
        1.0,
        of_constant,
        "a ratio: 3 % is 0.03",
    );
    let angle = file.parameters.geometry.working_pressure_angle;
    let of_angle = "is not a usual pressure angle of teeth";
    only_if(
        angle,
        PRESSURE_ANGLE_LIMITS,
        "geometry.working_pressure_angle_deg",
        "deg",
        180.0 / std::f64::consts::PI,
        of_angle,
        "20 is usual, 14.5 to 28 are made",
    );
    // An equivalent gear's length follows from its stiffness.
    let stated = file.parameters.equivalent_gear().is_none();
    let length = if stated { file.parameters.characteristic_length } else { 0.0 };
    let of_length = "is far from the deflections that it scales";
    only_if(length, CHARACTERISTIC_LENGTH_LIMITS, "characteristic_length_um", "um", 1e6, of_length, "10 is usual");
}

fn encoder(file: &JointFile, judge: &Judge<'_>, side: &str, encoder: &AbsoluteEncoder, ratio: f64) {
    let key = |name: &str| format!("drive_train.{side}_encoder.{name}");
    let gap = sheet::lost_motion(&file.parameters);
    let at_link = |angle: f64| angle / ratio;
    if gap > 0.0 {
        let count = at_link(TAU / encoder.counts_per_turn as f64);
        judge.check_figure(&[&key("bits"), &key("counts_per_turn")], count / gap, OVER_GAP_LIMITS, |_, name| {
            let stated = if name == "bits" { encoder.bits().map(u64::from) } else { None };
            let message = format!(
                "`{name}` = {} of the {side} encoder: one count is {} mrad at the link, more than the lost motion of {} mrad",
                stated.unwrap_or(encoder.counts_per_turn),
                figure(1e3 * count),
                figure(1e3 * gap)
            );
            (message, "no encoder resolves this gap: use more counts per turn; or the backlash is in another unit".into())
        });
        let errors = [
            ("once_per_turn_error_deg", encoder.once_per_turn_error),
            ("twice_per_turn_error_deg", encoder.twice_per_turn_error),
        ];
        for (name, error) in errors {
            judge.check_figure(&[&key(name)], at_link(error) / gap, Limits::above(3.0, UNLIMITED), |_, name| {
                let message = format!(
                    "`{name}` of the {side} encoder: {} mrad at the link, more than three times the lost motion of {} mrad",
                    figure(1e3 * at_link(error)),
                    figure(1e3 * gap)
                );
                (message, "an amplitude in degrees: 1 arcmin is 0.0167 deg, 0.35 mrad are 0.02 deg".into())
            });
        }
    }
    if encoder.skew != 0.0 {
        judge.check_figure(&[&key("skew_us")], encoder.skew, SKEW_LIMITS, |_, name| {
            let message = format!(
                "`{name}` of the {side} encoder: {} us is implausible as the age of a reading",
                figure(1e6 * encoder.skew)
            );
            (message, "it is in us: 0.05 ms and 5e-5 s are 50 us".into())
        });
    }
}
