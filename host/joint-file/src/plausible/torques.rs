//! Checks of torques: frictions, cogging and weight against the motor, drive torque against rated torque, and the
//! stiffness behind the carrier against its torque.

use model_core::gears::Kinematics;
use parameters::{Compliance, EquivalentGear};

use super::judge::{Judge, Limits, UNLIMITED, figure};
use super::units;
use crate::contents::JointFile;

/// Wind-up of the compliance at rated torque [rad]: a tenth of a minute of arc to 3 degrees; above 45 degrees it is no
/// joint, below 1.5e-6 no machine part.
const WIND_UP_LIMITS: Limits = Limits { odd: (2.9e-5, 0.055), possible: (1.5e-6, 0.8) };
/// Wind-up of common gearheads [rad]: 0.8 to 35 minutes of arc.
const USUAL_WIND_UP: (f64, f64) = (2.3e-4, 1e-2);
/// Dry friction over the torque that must overcome it.
const FRICTION_LIMITS: Limits = Limits::above(0.5, 1.0);
/// Dry friction of the link over the rated torque; a brake may add to it: tests of a held link state four times the
/// rated torque.
const LOAD_FRICTION_LIMITS: Limits = Limits::above(0.5, 10.0);
/// Speed of the link at which viscous friction alone takes the rated torque [rad/s].
const TOP_SPEED_LIMITS: Limits = Limits { odd: (3.0, UNLIMITED), possible: (0.03, UNLIMITED) };
/// Drive torque times the ratio over the rated torque.
const DRIVE_TORQUE_LIMITS: Limits = Limits { odd: (0.4, 2.5), possible: (0.02, 50.0) };
/// Drive torque times the ratio over the rated torque, for a motor whose limit is below the rated torque: gearheads
/// rated for 20 times their motor are sold.
const LIMITED_DRIVE_LIMITS: Limits = Limits { odd: (0.02, 2.5), possible: (5e-4, 50.0) };
/// Torque limit of the motor over its drive torque.
const MOTOR_LIMIT_LIMITS: Limits = Limits::above(20.0, 500.0);

pub(super) fn check(file: &JointFile, judge: &Judge<'_>) {
    let joint = &file.parameters;
    let around = &file.surroundings;
    let ratio = joint.geometry.ratio_by_radii();
    let rated = joint.rated_output_torque;
    let (drive, limit) = (file.profile.drive_torque, file.profile.motor_torque_limit);

    let over = drive * ratio / rated;
    if limit <= drive && over < 1.0 {
        let keys = ["profile.motor_torque_limit_N_m", "rated_output_torque_N_m"];
        judge.check_figure(&keys, over, LIMITED_DRIVE_LIMITS, |_, key| {
            let message = format!(
                "`{key}`: the motor's limit of {} N m gives {} N m at the link, and the rated torque is {} N m",
                figure(limit),
                figure(limit * ratio),
                figure(rated)
            );
            (message, units::likely(units::TORQUE_SLIPS, limit, over, 1, (0.05, 5.0), "N m"))
        });
    } else {
        drive_torque(judge, [drive, ratio, rated], over);
    }
    judge.check_figure(&["profile.motor_torque_limit_N_m"], limit / drive, MOTOR_LIMIT_LIMITS, |_, key| {
        let message = format!("`{key}` is {} times the drive torque of {} N m", figure(limit / drive), figure(drive));
        (message, units::likely(units::TORQUE_SLIPS, limit, limit / drive, 1, (1.0, 6.0), "N m"))
    });
    frictions(file, judge);

    let weight = around.gravity_torque.abs();
    let most = limit * ratio * around.efficiency;
    let limits = Limits::above(rated.min(most), most.max(rated));
    judge.check_figure(&["drive_train.gravity_torque_N_m"], weight, limits, |_, key| {
        let message = format!(
            "`{key}`: a weight of {} N m against a rated torque of {} N m, and the motor lifts {} N m at its limit",
            figure(weight),
            figure(rated),
            figure(most)
        );
        let help = units::likely(units::TORQUE_SLIPS, weight, weight / rated, 1, (0.02, 0.8), "N m");
        (message, help + "; it is mass times 9.81 times lever")
    });
    if let Some(compliance) = joint.compliance {
        let keys = ["compliance.stiffness_N_m_per_rad", "compliance.total_stiffness_N_m_per_arcmin"];
        spring(rated, &compliance, ("compliance", "shafts twist"), &keys, judge);
    }
    if let Some(EquivalentGear { stiffness, damping_ratio, .. }) = joint.equivalent_gear() {
        let keys = ["equivalent_gear.stiffness_N_m_per_rad", "equivalent_gear.total_stiffness_N_m_per_arcmin"];
        let gear = Compliance { stiffness, damping_ratio };
        spring(rated, &gear, ("equivalent_gear", "gear gives"), &keys, judge);
    }
}

/// Checks a drive torque within the motor's limit against the rated torque.
fn drive_torque(judge: &Judge<'_>, [drive, ratio, rated]: [f64; 3], over: f64) {
    judge.check_figure(
        &["profile.drive_torque_N_m", "rated_output_torque_N_m"],
        over,
        DRIVE_TORQUE_LIMITS,
        |_, key| {
            let message = format!(
                "`{key}`: {} N m at the motor are {} N m at the link, and the rated torque is {} N m",
                figure(drive),
                figure(drive * ratio),
                figure(rated)
            );
            (
                message,
                format!(
                    "drive_torque_N_m = {} balances the rated torque; or the ratio is another",
                    figure(rated / ratio)
                ),
            )
        },
    );
}

/// Checks a spring at the output against the rated torque, and its damping; `section` and `does` are its section and
/// verb.
fn spring(rated: f64, of: &Compliance, (section, does): (&str, &str), keys: &[&str], judge: &Judge<'_>) {
    let turned = rated / of.stiffness;
    judge.check_figure(keys, turned, WIND_UP_LIMITS, |_, key| {
        let message = format!(
            "`{key}`: at the rated torque of {} N m the {does} by {} deg ({} arcmin)",
            figure(rated),
            figure(turned.to_degrees()),
            figure(60.0 * turned.to_degrees())
        );
        let help = match key {
            "total_stiffness_N_m_per_arcmin" => "it is in N m/arcmin: 10.3e3 N m/rad are 3 N m/arcmin".to_owned(),
            _ => units::likely(units::STIFFNESS_SLIPS, of.stiffness, turned, -1, USUAL_WIND_UP, "N m/rad"),
        };
        (message, help)
    });
    let damping = of.damping_ratio;
    if damping > 0.0 {
        let limits = Limits { odd: (2e-4, 0.4), possible: (0.0, 1.0) };
        judge.check_figure(&[&format!("{section}.damping_ratio")], damping, limits, |too_much, key| {
            let what = if too_much { "a joint that hardly swings" } else { "a joint that swings almost undamped" };
            let message = format!("`{key}` of [{section}] = {damping}: {what}");
            (message, "0.01 to 0.05 is usual of bolted steel: 2 % is 0.02; 0 for no damping".into())
        });
    }
}

fn frictions(file: &JointFile, judge: &Judge<'_>) {
    let around = &file.surroundings;
    let ratio = file.parameters.geometry.ratio_by_radii();
    let rated = file.parameters.rated_output_torque;
    let (drive, limit) = (file.profile.drive_torque, file.profile.motor_torque_limit);
    let motor = around.motor_friction.coulomb;
    let load = around.load_friction.coulomb * (1.0 + around.load_friction.stribeck_rise_ratio);
    let help = |value: f64, over: f64| units::likely(units::TORQUE_SLIPS, value, over, 1, (1e-3, 0.2), "N m");

    let motor_keys = ["drive_train.motor_coulomb_friction_N_m", "drive_train.no_load_torque_N_m"];
    judge.check_figure(&motor_keys, motor / drive, FRICTION_LIMITS, |_, key| {
        let message = format!(
            "`{key}`: dry friction of {} N m at the motor takes {} % of the drive torque of {} N m",
            figure(motor),
            figure(100.0 * motor / drive),
            figure(drive)
        );
        (message, help(motor, motor / drive))
    });
    judge.check_figure(
        &["drive_train.cogging_torque_N_m"],
        around.cogging_torque / drive,
        FRICTION_LIMITS,
        |_, key| {
            let message = format!(
                "`{key}`: an amplitude of {} N m is {} % of the drive torque of {} N m",
                figure(around.cogging_torque),
                figure(100.0 * around.cogging_torque / drive),
                figure(drive)
            );
            (message, help(around.cogging_torque, around.cogging_torque / drive))
        },
    );
    let load_keys = ["drive_train.load_coulomb_friction_N_m", "drive_train.load_stribeck_rise_ratio"];
    judge.check_figure(&load_keys, load / rated, LOAD_FRICTION_LIMITS, |_, key| {
        let message = format!(
            "`{key}`: dry friction of {} N m at rest takes {} % of the rated torque of {} N m",
            figure(load),
            figure(100.0 * load / rated),
            figure(rated)
        );
        (message, help(around.load_friction.coulomb, load / rated))
    });
    let all = motor + around.cogging_torque + load / (ratio * around.efficiency);
    let each = motor.max(around.cogging_torque) / drive;
    // If one friction alone is already reported, the sum is not reported as well.
    if each <= 1.0 && load <= rated {
        judge.check_figure(&motor_keys, all / limit, Limits::above(1.0, 1.0), |_, key| {
            let message = format!(
                "`{key}`: frictions and cogging take {} N m at the motor, whose limit is {} N m: nothing moves",
                figure(all),
                figure(limit)
            );
            (message, "one of the frictions is in another unit, or the motor's limit is".into())
        });
    }
    let sides =
        [("motor", around.motor_friction.viscous, drive, ratio), ("load", around.load_friction.viscous, rated, 1.0)];
    for (side, viscous, torque, over) in sides {
        let key = format!("drive_train.{side}_viscous_friction_N_m_s_per_rad");
        let speed = torque / (viscous * over);
        judge.check_figure(&[&key], speed, TOP_SPEED_LIMITS, |_, key| {
            let message = format!(
                "`{key}`: {} N m turn the link no faster than {} rad/s against this friction alone",
                figure(torque),
                figure(speed)
            );
            (message, "in N m s/rad: 1 N m/krpm are 9.55e-3 N m s/rad, 1 mN m s/rad are 1e-3".into())
        });
    }
    let efficiency = around.efficiency;
    judge.check_figure(
        &["drive_train.efficiency"],
        efficiency,
        Limits { odd: (0.4, UNLIMITED), possible: (0.0, UNLIMITED) },
        |_, key| {
            let message = format!(
                "`{key}` = {efficiency}: {} % of the torque is lost in one stage",
                figure(100.0 * (1.0 - efficiency))
            );
            (
                message,
                format!(
                    "a stage of gears has 0.9 to 0.98; a loss of {efficiency} is an efficiency of {}",
                    figure(1.0 - efficiency)
                ),
            )
        },
    );
}
