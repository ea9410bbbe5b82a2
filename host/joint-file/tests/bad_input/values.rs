//! Values of the right type that no joint can have, most of them in another unit. Contradicting values are in `gears`
//! and `meshes`.

use crate::{refused, spoilt};

#[test]
fn negative_stiffness_is_rejected() {
    let text = spoilt("mean_stiffness_N_per_m = 1e8", "mean_stiffness_N_per_m = -1e8");
    let message = "`mean_stiffness_N_per_m` must be between 1e4 and 1e12, not -1e8";
    refused(&text, message, "-1e8", "about 1e8 for steel teeth");
}

#[test]
fn stiffness_in_n_per_um_is_rejected() {
    let text = spoilt("mean_stiffness_N_per_m = 1e8", "mean_stiffness_N_per_m = 100");
    let message = "`mean_stiffness_N_per_m` must be between 1e4 and 1e12, not 100";
    refused(&text, message, "100", "100 N/um are 1e8 N/m");
}

#[test]
fn nan_and_infinity_are_rejected() {
    for value in ["nan", "inf", "-inf", "+nan"] {
        let text = spoilt("mean_stiffness_N_per_m = 1e8", &format!("mean_stiffness_N_per_m = {value}"));
        let message = format!("`mean_stiffness_N_per_m` must be a finite number, not {value}");
        refused(&text, &message, value, "N/m");
        let text = spoilt("transmission_error_um = 3.0", &format!("transmission_error_um = [1, {value}, 3]"));
        let message = format!("`transmission_error_um` must be a finite number, not {value}");
        refused(&text, &message, value, "amplitude E");
        let text = spoilt("gravity_torque_N_m = 6.0", &format!("gravity_torque_N_m = {value}"));
        refused(&text, &format!("`gravity_torque_N_m` must be a finite number, not {value}"), value, "link's weight");
    }
}

#[test]
fn overflowing_number_is_rejected() {
    let text = spoilt("link_inertia_kg_m2 = 0.15", "link_inertia_kg_m2 = 1e999");
    refused(&text, "`link_inertia_kg_m2` must be a finite number, not 1e999", "1e999", "kg m^2");
    let text = spoilt("planets = 3", "planets = 99999999999999999999999");
    let message = "`planets` must be between 3 and 5, not 99999999999999999999999";
    refused(&text, message, "99999999999999999999999", "3, 4 or 5");
}

#[test]
fn planets_outside_3_to_5_are_rejected() {
    for planets in ["2", "6", "0", "-3"] {
        let text = spoilt("planets = 3", &format!("planets = {planets}"));
        refused(
            &text,
            &format!("`planets` must be between 3 and 5, not {planets}"),
            planets,
            "equally spaced planets: 3, 4 or 5",
        );
    }
}

#[test]
fn backlash_in_mm_or_m_is_rejected() {
    for value in ["0.04", "4e-5", "40000.0", "-40.0"] {
        let text = spoilt("half_backlash_um = 40.0", &format!("half_backlash_um = {value}"));
        let message = format!("`half_backlash_um` must be 0, or between 0.5 and 1000, not {value}");
        refused(&text, &message, value, "a mesh is free over 2b: 0.06 mm are 60 um, 6e-5 m are 60 um");
    }
}

#[test]
fn angle_in_radians_is_rejected() {
    let text = spoilt("working_pressure_angle_deg = 20.0", "working_pressure_angle_deg = 0.349");
    let message = "`working_pressure_angle_deg` must be between 5 and 45, not 0.349";
    refused(&text, message, "0.349", "not in rad");
}

#[test]
fn damping_ratio_in_percent_is_rejected() {
    let text = spoilt("damping_ratio = 0.05", "damping_ratio = 5.0");
    refused(&text, "`damping_ratio` must be at least 0 and less than 1, not 5.0", "5.0", "5 % is 0.05");
    let text = spoilt("damping_ratio = 0.02", "damping_ratio = -0.02");
    refused(&text, "`damping_ratio` must be at least 0 and less than 1, not -0.02", "-0.02", "2 % is 0.02");
}

#[test]
fn motor_limit_below_drive_is_rejected() {
    let text = spoilt("motor_torque_limit_N_m = 2.5", "motor_torque_limit_N_m = 1.5");
    let message = "`motor_torque_limit_N_m` is below the drive torque of 2.0000 N m that the joint is rated for";
    refused(&text, message, "1.5", "raise the limit");
}
