//! Checks of gears and carrier against their sizes, planets against their own mass, rotor against its torque, and link
//! against the motor.
//!
//! A body's inertia is expressed as the face width of a solid steel disc of its pitch radius: w = 2 I / (rho pi r^4).
//! Hollow bodies and light materials need less; none needs twenty times its radius.

use std::f64::consts::PI;

use model_core::gears::{Kinematics, Mechanics};

use super::judge::{Judge, Limits, UNLIMITED, figure};
use super::units;
use crate::contents::JointFile;
use crate::sheet;

/// Density of steel [kg/m^3].
const STEEL_DENSITY: f64 = 7850.0;

/// Face width of a gear of solid steel over its pitch radius; 0.1 to 4.6 for the presets.
const FACE_WIDTH_LIMITS: Limits = Limits { odd: (5e-3, 10.0), possible: (3e-4, 25.0) };
/// Face width of a carrier of solid steel over r_c; 0.08 to 0.9 for the presets.
const CARRIER_WIDTH_LIMITS: Limits = Limits { odd: (5e-4, 5.0), possible: (1e-5, 25.0) };
/// Usual face width of either over its radius.
const USUAL_WIDTH: (f64, f64) = (0.02, 5.0);

/// Checks gears with teeth. A data sheet's inertia at the input includes everything that turns there, such as a
/// clamping hub: it limits the discs' widths only from below.
pub(super) fn check_gears(file: &JointFile, judge: &Judge<'_>) {
    if judge.notes.holds(AT_INPUT) {
        check_foil(file, judge);
        return;
    }
    gears(file, judge);
    planets(file, judge);
    carrier(file, judge);
}

/// Checks the inertias on either side of the gears.
pub(super) fn check(file: &JointFile, judge: &Judge<'_>) {
    let rotor = rotor(file, judge);
    let gears = judge.notes.holds(AT_INPUT) && at_input(file, judge);
    // A wrong motor side makes the link look wrong.
    link(file, judge, rotor || gears);
}

/// Width of a steel disc with this inertia [m].
fn width(inertia: f64, radius: f64) -> f64 {
    2.0 * inertia / (STEEL_DENSITY * PI * radius.powi(4))
}

fn gears(file: &JointFile, judge: &Judge<'_>) {
    let (geometry, bodies) = (&file.parameters.geometry, &file.parameters.bodies);
    let cosine = geometry.working_pressure_angle.cos();
    let gears = [
        ("sun", bodies.sun_equivalent_mass, geometry.sun_base_radius),
        ("planet", bodies.planet_equivalent_mass, geometry.planet_base_radius),
    ];
    for (name, mass, base_radius) in gears {
        let radius = base_radius / cosine;
        let inertia = mass * base_radius * base_radius;
        let [as_mass, as_inertia] =
            [format!("bodies.{name}_equivalent_mass_kg"), format!("bodies.{name}_inertia_kg_m2")];
        let wide = width(inertia, radius);
        let relative = wide / radius;
        judge.check_figure(&[&as_mass, &as_inertia], relative, FACE_WIDTH_LIMITS, |too_much, key| {
            let (size, wide) = (figure(1e3 * radius), figure(1e3 * wide));
            let message = if too_much {
                format!(
                    "`{key}`: a {name} of {size} mm pitch radius with this inertia would be {wide} mm wide in steel"
                )
            } else {
                format!("`{key}`: a {name} of {size} mm pitch radius with this inertia is {wide} mm of steel, a foil")
            };
            (message, likely_unit(key, inertia, mass, relative))
        });
    }
}

const AT_INPUT: &str = "bodies.gear_inertia_at_input_kg_cm2";

/// Checks a data sheet's inertia at the input as steel discs of one thickness.
fn check_foil(file: &JointFile, judge: &Judge<'_>) {
    let (geometry, bodies) = (&file.parameters.geometry, &file.parameters.bodies);
    let radius = geometry.sun_base_radius / geometry.working_pressure_angle.cos();
    let wide = width(bodies.sun_equivalent_mass * geometry.sun_base_radius * geometry.sun_base_radius, radius);
    let limits =
        Limits { odd: (FACE_WIDTH_LIMITS.odd.0, UNLIMITED), possible: (FACE_WIDTH_LIMITS.possible.0, UNLIMITED) };
    judge.check_figure(&[AT_INPUT], wide / radius, limits, |_, key| {
        let message = format!(
            "`{key}`: sun, planets and carrier with this inertia are {} mm of steel, a foil, and the sun has {} mm pitch radius",
            figure(1e3 * wide),
            figure(1e3 * radius)
        );
        (message, "it is in kg cm^2, at the input: 1e-4 kg m^2 are 1 kg cm^2".to_owned() + RADII)
    });
}

/// Checks a data sheet's inertia at the input against the rotor and the torque that turns it. Returns true after a
/// complaint.
fn at_input(file: &JointFile, judge: &Judge<'_>) -> bool {
    /// Inertia of the gears over the rotor's; a clamping hub makes it up to 30.
    const OVER_ROTOR_LIMITS: Limits = Limits { odd: (5e-5, 200.0), possible: (0.0, 1e4) };
    // Too small an inertia of gears with teeth is reported as a foil.
    let equivalent = file.parameters.equivalent_gear().is_some();
    let [over_rotor, accelerated] = match equivalent {
        true => [OVER_ROTOR_LIMITS, ROTOR_ACCELERATION_LIMITS],
        false => [
            Limits { odd: (0.0, OVER_ROTOR_LIMITS.odd.1), ..OVER_ROTOR_LIMITS },
            Limits {
                odd: (ROTOR_ACCELERATION_LIMITS.odd.0, UNLIMITED),
                possible: (ROTOR_ACCELERATION_LIMITS.possible.0, UNLIMITED),
            },
        ],
    };
    let joint = &file.parameters;
    let inertia = sheet::inertia_at_input(&joint.bodies, &joint.geometry);
    let in_file = 1e4 * inertia;
    if inertia == 0.0 {
        return false;
    }
    if joint.rotor_inertia > 0.0 {
        let over = inertia / joint.rotor_inertia;
        return judge.check_figure(&[AT_INPUT], over, over_rotor, |_, key| {
            let message = format!("`{key}` = {}: {} times the inertia of the rotor", figure(in_file), figure(over));
            let help = units::likely(units::INERTIA_AT_INPUT_SLIPS, in_file, over, 1, (5e-3, 20.0), "kg cm^2");
            (message, help + "; or `rotor_inertia_kg_m2` is in another unit")
        });
    }
    let acceleration = file.profile.drive_torque / inertia;
    judge.check_figure(&[AT_INPUT], acceleration, accelerated, |_, key| {
        let message = format!(
            "`{key}` = {}: the drive torque of {} N m alone brings these gears to {} rad/s^2",
            figure(in_file),
            figure(file.profile.drive_torque),
            figure(acceleration)
        );
        (message, units::likely(units::INERTIA_AT_INPUT_SLIPS, in_file, acceleration, -1, (500.0, 5e5), "kg cm^2"))
    })
}
const RADII: &str = "; or the module or radii are wrong";

/// Likely unit of a body's inertia or equivalent mass, by the key that states it.
fn likely_unit(key: &str, inertia: f64, mass: f64, wide: f64) -> String {
    let likely = |slips, value, unit| units::likely(slips, value, wide, 1, USUAL_WIDTH, unit);
    let unit = match key {
        key if key.ends_with("kg_m2") => likely(units::INERTIA_SLIPS, inertia, "kg m^2"),
        _ => likely(units::MASS_SLIPS, mass, "kg"),
    };
    unit + RADII
}

/// Checks a planet: all of its mass lies within its tip circle, I <= m r_tip^2, and its teeth are part of the mass.
fn planets(file: &JointFile, judge: &Judge<'_>) {
    /// I / r_b^2 over the mass: 0.57 for a solid disc, less with a heavy pin and bearing.
    const GYRATION_MIN: (f64, f64) = (0.03, 5e-4);
    let (geometry, bodies) = (&file.parameters.geometry, &file.parameters.bodies);
    let (mass, equivalent) = (bodies.planet_mass, bodies.planet_equivalent_mass);
    // 0 means no stated mass.
    if mass == 0.0 {
        return;
    }
    let cosine = geometry.working_pressure_angle.cos();
    let tip = (1.0 + 2.0 / f64::from(geometry.planet_teeth)) / cosine;
    let most = tip * tip;
    let limits = Limits { odd: (GYRATION_MIN.0, most), possible: (GYRATION_MIN.1, most) };
    let keys = ["bodies.planet_mass_kg", "bodies.planet_equivalent_mass_kg", "bodies.planet_inertia_kg_m2"];
    judge.check_figure(&keys, equivalent / mass, limits, |too_much, key| {
        let [mass, equivalent] = [mass, equivalent].map(figure);
        if too_much {
            let message = format!(
                "`{key}`: a planet of {mass} kg cannot have an equivalent mass of {equivalent} kg: with all of it at the \
                 tips of the teeth I / r_b^2 is {} kg",
                figure(most * bodies.planet_mass)
            );
            (message, "a solid planet has I / r_b^2 of about 0.57 of its mass; one of the two is in another unit".into())
        } else {
            let message = format!("`{key}`: a planet of {mass} kg has an equivalent mass of {equivalent} kg only");
            (message, "a solid planet has I / r_b^2 of about 0.57 of its mass; one of the two is in another unit".into())
        }
    });
    let radius = geometry.planet_base_radius / cosine;
    let wide = mass / (STEEL_DENSITY * PI * radius * radius);
    judge.check_figure(&keys, wide / radius, Limits::above(10.0, 25.0), |_, key| {
        let message = format!(
            "`{key}`: a planet of {} mm pitch radius and {} kg would be {} mm wide in steel",
            figure(1e3 * radius),
            figure(mass),
            figure(1e3 * wide)
        );
        (message, units::likely(units::MASS_SLIPS, mass, wide / radius, 1, USUAL_WIDTH, "kg") + RADII)
    });
}

/// Checks the carrier as a disc of 1.5 r_c, which covers the planets' pins and bearings.
fn carrier(file: &JointFile, judge: &Judge<'_>) {
    const CARRIER_DISC_RADIUS: f64 = 1.5;
    let geometry = &file.parameters.geometry;
    let over_square = file.parameters.bodies.carrier_inertia_over_radius_squared;
    let inertia = over_square * geometry.carrier_radius.powi(2);
    let wide = width(inertia, CARRIER_DISC_RADIUS * geometry.carrier_radius);
    let keys = [
        "bodies.carrier_inertia_over_radius_squared_kg",
        "bodies.carrier_equivalent_mass_kg",
        "bodies.carrier_inertia_kg_m2",
    ];
    let relative = wide / geometry.carrier_radius;
    judge.check_figure(&keys, relative, CARRIER_WIDTH_LIMITS, |too_much, key| {
        let message = format!(
            "`{key}`: a carrier with pins at {} mm and this inertia would be a disc of {} mm of steel{}",
            figure(1e3 * geometry.carrier_radius),
            figure(1e3 * wide),
            if too_much { "" } else { ", a foil" }
        );
        (message, likely_unit(key, inertia, over_square, relative))
    });
}

/// Acceleration of a rotor by its continuous torque: some 1e3 to 2e5 rad/s^2 for motors.
const ROTOR_ACCELERATION_LIMITS: Limits = Limits { odd: (50.0, 3e6), possible: (0.05, 3e9) };

/// Checks the rotor against its torque. Returns true after a complaint.
fn rotor(file: &JointFile, judge: &Judge<'_>) -> bool {
    let inertia = file.parameters.rotor_inertia;
    // 0 means no stated rotor.
    if inertia == 0.0 {
        return false;
    }
    let acceleration = file.profile.drive_torque / inertia;
    judge.check_figure(&["bodies.rotor_inertia_kg_m2"], acceleration, ROTOR_ACCELERATION_LIMITS, |_, key| {
        let message = format!(
            "`{key}`: the drive torque of {} N m alone brings this rotor to {} rad/s^2",
            figure(file.profile.drive_torque),
            figure(acceleration)
        );
        (message, units::likely(units::INERTIA_SLIPS, inertia, acceleration, -1, (500.0, 5e5), "kg m^2"))
    })
}

/// Checks the link, referred to the motor, against the inertia that turns with the motor: 0.05 to 50 times is built.
fn link(file: &JointFile, judge: &Judge<'_>, motor_side_is_odd: bool) {
    const LINK_RATIO_LIMITS: Limits = Limits { odd: (2e-3, 3e3), possible: (0.0, 1e7) };
    let joint = &file.parameters;
    if joint.link_inertia == 0.0 {
        return;
    }
    let sun = joint.bodies.sun_equivalent_mass + joint.rotor_equivalent_mass();
    let ratio = joint.geometry.ratio_by_radii();
    let at_motor = joint.link_inertia / (ratio * ratio);
    let motor = sun * joint.geometry.sun_base_radius.powi(2);
    let keys = ["bodies.link_inertia_kg_m2"];
    let against_motor = if motor_side_is_odd { Limits::above(UNLIMITED, UNLIMITED) } else { LINK_RATIO_LIMITS };
    judge.check_figure(&keys, at_motor / motor, against_motor, |_, key| {
        let message = format!(
            "`{key}`: at the motor the link is {} times what turns there ({} against {} kg m^2)",
            figure(at_motor / motor),
            figure(at_motor),
            figure(motor)
        );
        let help =
            units::likely(units::INERTIA_SLIPS, joint.link_inertia, at_motor / motor, 1, (0.05, 100.0), "kg m^2");
        (message, help + "; or `rotor_inertia_kg_m2` is in another unit")
    });
    // A link may be large, but its rated torque must bring it to speed within half a minute.
    let acceleration = joint.rated_output_torque / joint.link_inertia;
    judge.check_figure(
        &keys,
        acceleration,
        Limits { odd: (0.05, UNLIMITED), possible: (1e-5, UNLIMITED) },
        |_, key| {
            let message = format!(
                "`{key}`: the rated torque of {} N m brings this link to {} rad/s^2 only",
                figure(joint.rated_output_torque),
                figure(acceleration)
            );
            (message, units::likely(units::INERTIA_SLIPS, joint.link_inertia, acceleration, -1, (5.0, 5e3), "kg m^2"))
        },
    );
}
