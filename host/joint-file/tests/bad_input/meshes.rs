//! Keys of meshes, contact and excitation that depend on each other. Single values are in `values`.

use joint_file::read;

use crate::{only, problems, refused, spoilt};

#[test]
fn half_and_whole_backlash_conflict() {
    let text = spoilt("half_backlash_um = 40.0", "half_backlash_um = 40.0\nbacklash_um = 80.0");
    let message = "`half_backlash_um` and `backlash_um` state one quantity twice";
    refused(&text, message, "80.0", "keep one of `half_backlash_um` and `backlash_um`");
}

/// A stiffness ratio that lets the stiffness vanish is rejected.
#[test]
fn vanishing_stiffness_is_rejected() {
    let text = spoilt("stiffness_ratio = 0.15", "stiffness_ratio = 1.0");
    refused(&text, "`stiffness_ratio` must be at least 0 and less than 1, not 1.0", "1.0", "10 % is 0.1");
    let wave = "stiffness_ratio = 0.7\nstiffness_wave = \"rectangular\"\ncontact_ratio = 1.9\norder = 5";
    let text = spoilt("stiffness_ratio = 0.15", wave);
    let (message, place, help) = only(&text);
    assert_eq!(message, "the harmonics of this wave sum to 1.168 of the mean: the stiffness may vanish");
    assert_eq!(place, "0.7");
    assert!(help.contains("`stiffness_ratio` must stay below 0."), "{help}");
}

#[test]
fn suggested_stiffness_ratio_is_accepted() {
    let wave = "stiffness_ratio = RATIO\nstiffness_wave = \"rectangular\"\ncontact_ratio = 1.9\norder = 5";
    let spoilt = spoilt("stiffness_ratio = 0.15", wave);
    let (_, _, help) = only(&spoilt.replace("RATIO", "0.9"));
    let named = help.rsplit(' ').next().expect("a number");
    assert!(read(&spoilt.replace("RATIO", named)).is_ok(), "{help}");
}

/// The rectangular wave needs contact ratio and order within their bounds.
#[test]
fn rectangular_wave_needs_its_keys() {
    let text = spoilt("stiffness_ratio = 0.15", "stiffness_ratio = 0.15\nstiffness_wave = \"rectangular\"");
    let messages: Vec<_> = problems(&text).into_iter().map(|problem| problem.message).collect();
    assert_eq!(messages, ["`contact_ratio` is missing from [mesh]", "`order` is missing from [mesh]"]);
    for (key, value, message) in [
        ("contact_ratio", "2.0", "`contact_ratio` must be greater than 1 and less than 2, not 2.0"),
        ("contact_ratio", "1", "`contact_ratio` must be greater than 1 and less than 2, not 1"),
        ("order", "0", "`order` must be between 1 and 8, not 0"),
        ("order", "9", "`order` must be between 1 and 8, not 9"),
    ] {
        let (ratio, order) = if key == "order" { ("1.6", value) } else { (value, "5") };
        let wave = format!("stiffness_wave = \"rectangular\"\ncontact_ratio = {ratio}\norder = {order}");
        let text = spoilt("stiffness_ratio = 0.15", &format!("stiffness_ratio = 0.15\n{wave}"));
        refused(&text, message, value, "");
    }
}

#[test]
fn harmonic_wave_rejects_order() {
    let text = spoilt("stiffness_ratio = 0.15", "stiffness_ratio = 0.15\norder = 5");
    let message = "`order` belongs to the rectangular wave, and this one is harmonic";
    refused(&text, message, "5", "stiffness_wave = \"rectangular\"");
}

#[test]
fn wrong_list_length_is_rejected() {
    let text = spoilt("half_backlash_um = 40.0", "half_backlash_um = [40.0, 41.0]");
    let message = "`half_backlash_um` lists 2 values for 3 planets";
    refused(&text, message, "[40.0, 41.0]", "give 3 values, or one number for all planets");
}

#[test]
fn wrong_list_item_is_underlined() {
    let text = spoilt("half_backlash_um = 40.0", "half_backlash_um = [40.0, -41.0, 42.0]");
    refused(&text, "`half_backlash_um` must be 0, or between 0.5 and 1000, not -41.0", "-41.0", "2b");
    let text = spoilt("half_backlash_um = 40.0", "half_backlash_um = [40.0, \"x\", 42.0]");
    refused(&text, "`half_backlash_um` must be a number, not a string", "\"x\"", "2b");
}

#[test]
fn list_and_single_phase_conflict() {
    let text = spoilt("[contact]", "[mesh.sun_planet]\nerror_phase_rad = [0.0, 2.0, 4.0]\n\n[contact]");
    let message = "`error_phase_rad` is a list and `stiffness_phase_rad` is not";
    refused(&text, message, "[0.0, 2.0, 4.0]", "state every planet's phase for both");
}

#[test]
fn phase_in_degrees_is_rejected() {
    let text = spoilt("[contact]", "[mesh.sun_planet]\nerror_phase_rad = 120\n\n[contact]");
    refused(&text, "`error_phase_rad` must be between -6.3 and 6.3, not 120", "120", "in rad");
}

#[test]
fn unknown_choice_lists_choices() {
    let text = spoilt("damping_law = \"contact\"", "damping_law = \"viscous\"");
    let message = "`damping_law` must be \"contact\" or \"paper\", not \"viscous\"";
    refused(&text, message, "\"viscous\"", "teeth only push");
}

/// The tanh dead zone needs a sharpness; the sharp one rejects it.
#[test]
fn sharpness_belongs_to_tanh() {
    let text = spoilt("dead_zone = \"sharp\"", "dead_zone = \"tanh\"");
    refused(&text, "`sharpness` is missing from [contact]", "[contact]", "eq. 13");
    let text = spoilt("dead_zone = \"sharp\"", "dead_zone = \"sharp\"\nsharpness = 20.0");
    refused(&text, "`sharpness` belongs to the tanh dead zone, and this one is sharp", "20.0", "dead_zone = \"tanh\"");
}

/// Mode "time" needs one frequency; mode "angle" rejects it.
#[test]
fn mesh_frequency_belongs_to_time_mode() {
    let text = spoilt("mode = \"angle\"", "mode = \"time\"");
    let message =
        "[excitation] needs one of `mesh_frequency_rad_per_s`, `mesh_frequency_Hz` and `mesh_frequency_over_omega_n`";
    refused(&text, message, "[excitation]", "rad/s");
    let text =
        spoilt("mode = \"angle\"", "mode = \"time\"\nmesh_frequency_Hz = 100\nmesh_frequency_over_omega_n = 2.1");
    let message = "`mesh_frequency_Hz` and `mesh_frequency_over_omega_n` state one quantity twice";
    refused(&text, message, "2.1", "keep one of");
    let text = spoilt("mode = \"angle\"", "mode = \"angle\"\nmesh_frequency_Hz = 100");
    let message =
        "`mesh_frequency_Hz` belongs to mode \"time\"; in mode \"angle\" the frequency follows from the motion";
    refused(&text, message, "100", "mode = \"time\"");
}
