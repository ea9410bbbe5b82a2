//! Built-in joint files: all are readable, have only known warnings, and give the numbers of the paper and of the robot
//! joints. Problems of bad files are in `bad_input`.

use joint_file::{JointFile, PRESETS, preset, read};
use model_core::gears::{Kinematics, Mechanics, MeshPhasing, Scales};
use parameters::{Friction, Surroundings};

fn file(name: &str) -> JointFile {
    match read(preset(name).expect("a preset")) {
        Ok(file) => file,
        Err(problems) => panic!("{name}: {problems:#?}"),
    }
}

/// Equal within a relative distance.
fn assert_close(value: f64, expected: f64, relative: f64) {
    assert!((value - expected).abs() <= relative * expected.abs(), "{value} is not {expected}");
}

#[test]
fn presets_are_read_with_their_names() {
    for name in PRESETS {
        assert!(file(name).parameters.name.eq_ignore_ascii_case(name), "{name}");
    }
}

#[test]
fn robot_joints_have_no_warning() {
    for name in ["q1", "s1", "d2", "l1", "c1"] {
        assert_eq!(file(name).warnings, [], "{name}");
        assert!(file(name).parameters.geometry.coherence == parameters::Coherence::Required);
    }
}

/// The paper's gears give the known warnings on their fit.
#[test]
fn paper_warns_not_coaxial() {
    let messages: Vec<_> = file("paper").warnings.into_iter().map(|warning| warning.message).collect();
    assert_eq!(
        messages,
        [
            "not coaxial: the ring has 99 teeth, sun and planets need 27 + 2 x 35 = 97",
            "the ratio is 4.59259 by base radii and 4.66667 by teeth",
        ]
    );
}

/// The paper as printed gives a third warning, on its carrier radius.
#[test]
fn printed_paper_warns_carrier_radius() {
    let messages: Vec<_> = file("paper_printed").warnings.into_iter().map(|warning| warning.message).collect();
    assert_eq!(messages.len(), 3, "{messages:#?}");
    assert_eq!(messages[1], "the ratio is 4.59259 by base radii and 4.66667 by teeth");
    assert_eq!(messages[2], "r_c cos(alpha) = 84.1043 mm, but the base radii of sun and planet sum to 84.5590 mm");
}

/// Masses, radii and omega_n of the paper follow from its Table 1.
#[test]
fn paper_masses_follow_from_table_1() {
    let paper = file("paper").parameters;
    assert_close(paper.carrier_equivalent_mass(), 10.0035, 1e-5);
    assert_close(file("paper_printed").parameters.carrier_equivalent_mass(), 6.0239, 1e-5);
    assert_eq!(Scales::new(&paper).frequency.round(), 20502.0);
    assert_close(paper.geometry.sun_base_radius, 36.8241e-3, 2e-6);
    assert_close(paper.geometry.planet_base_radius, 47.7349e-3, 2e-6);
    assert_close(paper.geometry.carrier_radius, 93.0e-3, 1e-12);
    assert_close(paper.balanced_load_torque(80.0), 367.4, 3e-5);
}

#[test]
fn paper_mesh_frequency_is_2_1_omega_n() {
    let paper = file("paper").parameters;
    let omega_n = Scales::new(&paper).frequency;
    assert_eq!(paper.excitation, parameters::Excitation::Time { mesh_frequency: 2.1 * omega_n });
}

#[test]
fn paper_meshes_are_in_phase() {
    let paper = file("paper").parameters;
    for kind in parameters::MESH_KINDS {
        for planet in 0..3 {
            assert_eq!((paper.stiffness_phase(kind, planet), paper.error_phase(kind, planet)), (0.0, 0.0));
        }
    }
}

/// Q1 has the radii, ratio and lost motion of its data sheet.
#[test]
fn q1_matches_its_data_sheet() {
    let q1 = file("q1").parameters;
    assert_close(q1.geometry.sun_base_radius, 7.0477e-3, 1e-5);
    assert_close(q1.geometry.planet_base_radius, 14.0954e-3, 1e-5);
    assert_close(q1.geometry.carrier_base_radius(), 21.1431e-3, 1e-5);
    assert_close(q1.geometry.ratio_by_radii(), 6.0, 1e-14);
    assert_close(2.0 * q1.sun_planet.half_backlash[0] / q1.geometry.carrier_base_radius(), 3.78e-3, 1e-3);
    let lever = q1.geometry.carrier_base_radius();
    let carrier = q1.bodies.carrier_inertia_over_radius_squared * q1.geometry.carrier_radius.powi(2);
    assert_close(carrier / (lever * lever), 0.15, 1e-12);
}

#[test]
fn presets_have_described_lost_motion() {
    let arcmin = std::f64::consts::PI / 180.0 / 60.0;
    for (name, lost) in [("s1", 3.0 * arcmin), ("d2", 7.0 * arcmin), ("l1", 1.329e-3)] {
        let joint = file(name).parameters;
        assert_close(2.0 * joint.ring_planet.half_backlash[0] / joint.geometry.carrier_base_radius(), lost, 1e-4);
    }
}

#[test]
fn ratio_by_radii_equals_by_teeth() {
    for (name, ratio) in [("q1", 6.0), ("s1", 5.0), ("d2", 6.0), ("l1", 14.0 / 3.0)] {
        let geometry = file(name).parameters.geometry;
        assert_close(geometry.ratio_by_radii(), ratio, 1e-12);
        assert_close(geometry.ratio_by_teeth(), ratio, 1e-12);
    }
}

/// Every number of every preset states its source.
#[test]
fn preset_numbers_have_sources() {
    for name in PRESETS {
        let sources = file(name).sources;
        assert!(sources.len() > 15, "{name}: {}", sources.len());
        let silent: Vec<_> = sources.iter().filter(|source| source.remark.is_none()).collect();
        assert!(silent.is_empty(), "{name}: {silent:#?}");
    }
}

#[test]
fn q1_drive_train_is_in_si() {
    let around = file("q1").surroundings;
    assert_eq!(around.current_lag, 0.2e-3);
    assert_eq!(around.output_encoder.skew, 50e-6);
    assert_close(around.output_encoder.once_per_turn_error, 0.35e-3, 3e-3);
    assert_eq!([around.motor_encoder, around.output_encoder].map(|encoder| encoder.bits()), [Some(14), Some(17)]);
    assert_eq!(file("q1").profile.motor_torque_limit, 2.5);
}

#[test]
fn documented_example_is_valid() {
    let document = include_str!("../../../docs/reference/joint-file.md");
    let example = document.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    let file = read(example).expect("the example is good");
    assert_eq!(file.warnings, []);
    let torque_limit = file.profile.motor_torque_limit;
    let load_friction = Friction { stribeck_speed: 0.05, ..Friction::default() };
    assert_eq!(file.surroundings, Surroundings { torque_limit, load_friction, ..Surroundings::ideal() });
    assert_close(file.profile.drive_torque, 2.0, 1e-12);
    assert_close(file.profile.motor_torque_limit, 4.0, 1e-12);
}

/// The fraction of a control rate is dropped with a warning.
#[test]
fn fractional_control_rate_warns() {
    let text = preset("q1").expect("a preset").replace("control_rate_Hz = 10e3", "control_rate_Hz = 9999.5");
    let file = read(&text).expect("still a joint");
    assert_eq!(file.surroundings.control_rate, 9999);
    let messages: Vec<_> = file.warnings.into_iter().map(|warning| warning.message).collect();
    assert_eq!(messages, ["`control_rate_Hz` = 9999.5 is taken as 9999"]);
}
