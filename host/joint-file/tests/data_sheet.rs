//! Keys with data-sheet figures: their conversion, exclusions and rejections.

use joint_file::sheet::{self, ARCMIN};
use joint_file::{JointFile, change, preset, read};
use model_core::gears::Kinematics;

fn q1() -> &'static str {
    preset("q1").expect("a preset")
}

/// Q1 with keys set, each replacing other forms of its quantity.
fn with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(q1().to_owned(), |text, (key, value)| change(&text, key, value).expect("a known key"))
}

fn joint(text: &str) -> JointFile {
    read(text).unwrap_or_else(|problems| panic!("{problems:#?}"))
}

#[track_caller]
fn refused(text: &str, words: &[&str]) {
    let problems = read(text).expect_err("refused");
    let says = |problem: &joint_file::Problem| {
        let all = format!("{} {}", problem.message, problem.help);
        words.iter().all(|word| all.contains(word))
    };
    assert!(problems.iter().any(says), "{words:?}: {problems:#?}");
}

#[track_caller]
fn assert_close(value: f64, expected: f64) {
    assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{value} is not {expected}");
}

#[test]
fn lost_motion_sets_half_backlash() {
    let file = joint(&with(&[("mesh.lost_motion_arcmin", "15")]));
    let joint = &file.parameters;
    assert_close(sheet::lost_motion(joint), 15.0 * ARCMIN);
    let half_backlash = 0.5 * 15.0 * (std::f64::consts::PI / 10_800.0) * joint.geometry.carrier_base_radius();
    for mesh in [&joint.sun_planet, &joint.ring_planet] {
        assert!(mesh.half_backlash.iter().all(|b| (b / half_backlash - 1.0).abs() < 1e-12), "{mesh:?}");
    }
}

#[test]
fn total_stiffness_is_teeth_and_shafts() {
    let file = joint(&with(&[("total_stiffness_N_m_per_arcmin", "2.5")]));
    let joint = &file.parameters;
    let teeth = sheet::teeth_compliance(&joint.geometry, [1e8; 2]);
    // Computed by hand: three planets, two meshes of 1e8 N/m each, on twice the lever.
    let lever = joint.geometry.carrier_base_radius();
    assert_close(teeth, 2.0 / 1e8 / (4.0 * 3.0 * lever * lever));
    let shafts = joint.compliance.expect("a compliance").stiffness;
    assert_close(1.0 / (1.0 / shafts + teeth), 2.5 / ARCMIN);
    assert!(shafts > 2.5 / ARCMIN);
}

#[test]
fn teeth_softer_than_total_are_rejected() {
    let text = with(&[("total_stiffness_N_m_per_arcmin", "2.5"), ("mesh.mean_stiffness_N_per_m", "2e6")]);
    refused(&text, &["`total_stiffness_N_m_per_arcmin` is 2.5000", "the teeth alone give 1.56", "N m/arcmin"]);
    // A figure in N m/rad would be stiffer than any teeth.
    refused(&with(&[("total_stiffness_N_m_per_arcmin", "10.3e3")]), &["the teeth alone give 78.", "mean_stiffness"]);
}

#[test]
fn input_inertia_is_sun_planets_carrier() {
    let file = joint(&with(&[("gear_inertia_at_input_kg_cm2", "0.05")]));
    let (geometry, bodies) = (&file.parameters.geometry, &file.parameters.bodies);
    assert_close(sheet::inertia_at_input(bodies, geometry), 0.05e-4);
    // Kinetic energy at 1 rad/s of the input, with the textbook terms of a planetary gear.
    let cosine = geometry.working_pressure_angle.cos();
    let carrier_speed = 1.0 / geometry.ratio_by_teeth();
    let along_line = geometry.carrier_base_radius() * carrier_speed;
    let planets = 3.0;
    let energy = 0.5 * bodies.sun_equivalent_mass * geometry.sun_base_radius.powi(2)
        + 0.5 * planets * bodies.planet_equivalent_mass * along_line.powi(2)
        + 0.5 * planets * bodies.planet_mass * (along_line / cosine).powi(2)
        + 0.5 * bodies.carrier_inertia_over_radius_squared * (along_line / cosine).powi(2);
    assert_close(2.0 * energy, 0.05e-4);
    // Discs of one thickness: masses go with the squares of the radii, inertias with their fourth powers.
    let [sun, planet] = [geometry.sun_base_radius, geometry.planet_base_radius];
    let inertia = |mass: f64, radius: f64| mass * radius * radius;
    let over = inertia(bodies.planet_equivalent_mass, planet) / inertia(bodies.sun_equivalent_mass, sun);
    assert_close(over, 2f64.powi(4));
    assert_close(bodies.planet_equivalent_mass / bodies.planet_mass, 0.5 / (cosine * cosine));
}

#[test]
fn no_load_torque_splits_into_frictions() {
    let file = joint(&with(&[("no_load_torque_N_m", "0.09")]));
    assert_close(file.surroundings.motor_friction.coulomb, 0.09 - 0.3 / (6.0 * 0.97));
    refused(
        &with(&[("no_load_torque_N_m", "0.05")]),
        &["`no_load_torque_N_m` is 0.05", "alone takes 0.0515 N m", "load_coulomb_friction_N_m"],
    );
}

/// A data sheet's key beside the key it replaces is rejected with both names.
#[test]
fn duplicate_quantity_names_both_keys() {
    let beside = |from: &str, line: &str| {
        assert_eq!(q1().matches(from).count(), 1, "{from}");
        q1().replace(from, &format!("{line}\n{from}"))
    };
    let pairs = [
        ("half_backlash_um = 40.0", "lost_motion_arcmin = 13", "half_backlash_um", "lost_motion_arcmin"),
        (
            "stiffness_N_m_per_rad = 10.3e3",
            "total_stiffness_N_m_per_arcmin = 2.8",
            "stiffness_N_m_per_rad",
            "total_stiffness",
        ),
        (
            "planet_mass_kg = 0.05",
            "gear_inertia_at_input_kg_cm2 = 0.05",
            "planet_mass_kg",
            "gear_inertia_at_input_kg_cm2",
        ),
        (
            "motor_coulomb_friction_N_m = 0.03",
            "no_load_torque_N_m = 0.1",
            "motor_coulomb_friction_N_m",
            "no_load_torque_N_m",
        ),
    ];
    for (from, line, one, other) in pairs {
        refused(&beside(from, line), &[&format!("`{one}"), &format!("`{other}"), "keep"]);
    }
    let family = "[mesh.ring_planet]\nbacklash_um = 80.0\n\n[contact]";
    let own = with(&[("lost_motion_arcmin", "13")]).replace("[contact]", family);
    refused(&own, &["`backlash_um` of [mesh.ring_planet]", "`lost_motion_arcmin` of [mesh]"]);
    let family = "[mesh.ring_planet]\nlost_motion_arcmin = 13\n\n[contact]";
    refused(&q1().replace("[contact]", family), &["for all meshes together", "[mesh.ring_planet]"]);
}

#[test]
fn found_values_replace_sheet_values() {
    let sheet = with(&[
        ("mesh.lost_motion_arcmin", "15"),
        ("total_stiffness_N_m_per_arcmin", "2.5"),
        ("no_load_torque_N_m", "0.09"),
    ]);
    let found = [("half_backlash_um", "55"), ("stiffness_N_m_per_rad", "9e3"), ("motor_coulomb_friction_N_m", "0.02")];
    let text = found.iter().fold(sheet, |text, (key, value)| change(&text, key, value).expect("a known key"));
    let file = joint(&text);
    assert_close(file.parameters.ring_planet.half_backlash[1], 55e-6);
    assert_close(file.parameters.compliance.expect("a compliance").stiffness, 9e3);
    assert_close(file.surroundings.motor_friction.coulomb, 0.02);
}

#[test]
fn slips_name_data_sheet_keys() {
    let warned = |key: &str, value: &str, words: &[&str]| {
        let all: Vec<String> = match read(&with(&[(key, value)])) {
            Ok(file) => file.warnings.iter().map(ToString::to_string).collect(),
            Err(problems) => problems.iter().map(ToString::to_string).collect(),
        };
        assert!(all.iter().any(|said| words.iter().all(|word| said.contains(word))), "{key}: {all:#?}");
    };
    warned("mesh.lost_motion_arcmin", "300", &["lost_motion_arcmin", "module of 1.00 mm", "1 deg is 60 arcmin"]);
    warned("total_stiffness_N_m_per_arcmin", "0.002", &["total_stiffness_N_m_per_arcmin", "3 N m/arcmin"]);
    warned("no_load_torque_N_m", "90", &["no_load_torque_N_m", "typed in mN m"]);
}

#[test]
fn input_inertia_slip_names_its_key() {
    // Q1's own masses are 0.061 kg cm^2 at the input.
    let own = joint(q1()).parameters;
    assert!((1e4 * sheet::inertia_at_input(&own.bodies, &own.geometry) - 0.0608).abs() < 5e-5);
    for (value, foil) in [("900", false), ("1e-5", true)] {
        let text = with(&[("gear_inertia_at_input_kg_cm2", value)]);
        let said = read(&text).map_or_else(|problems| problems.0, |file| file.warnings);
        let named = said.iter().filter(|problem| problem.message.contains("`gear_inertia_at_input_kg_cm2`"));
        let named: Vec<String> = named.map(ToString::to_string).collect();
        assert!(
            named.iter().any(|said| said.contains("foil") == foil && said.contains("kg cm^2")),
            "{value}: {said:#?}"
        );
    }
}

/// C1 with one line replaced.
fn c1(line: &str, by: &str) -> String {
    let text = preset("c1").expect("a preset");
    assert!(text.contains(line), "{line}");
    text.replacen(line, by, 1)
}

#[test]
fn equivalent_gear_matches_data_sheet() {
    let joint = joint(preset("c1").expect("a preset")).parameters;
    let gear = joint.equivalent_gear().expect("an equivalent gear");
    assert_eq!(gear.ratio, [59, 1]);
    assert_close(gear.lost_motion, 3.0 * ARCMIN);
    assert_close(gear.stiffness, 20.0 / ARCMIN);
    assert_close(gear.inertia_at_input, 0.25e-4);
    assert_close(sheet::lost_motion(&joint), 3.0 * ARCMIN);
    assert_close(joint.geometry.ratio_by_radii(), 59.0);
    let ratio =
        |by: &str| read(&c1("ratio = 59", by)).expect("a ratio").parameters.equivalent_gear().map(|gear| gear.ratio);
    assert_eq!(ratio("ratio = 47.5"), Some([95, 2]));
    assert_eq!(ratio("motor_turns = 178\nlink_turns = 6"), Some([89, 3]));
    let other = c1("lost_motion_arcmin = 3.0", "lost_motion_mrad = 0.5");
    assert_close(sheet::lost_motion(&read(&other).expect("mrad").parameters), 0.5e-3);
}

#[test]
fn rounded_ratio_warns() {
    let warned = joint(&c1("ratio = 59", "ratio = 58.333"));
    assert!(warned.warnings[0].message.contains("58333/1000"), "{:?}", warned.warnings);
    let read_as = |typed: &str| {
        let file = joint(&c1("ratio = 59", &format!("ratio = {typed}")));
        let of_ratio = file.warnings.iter().filter(|warning| warning.message.contains("`ratio`"));
        let said = of_ratio.map(ToString::to_string).collect::<String>();
        (file.parameters.equivalent_gear().expect("an equivalent gear").ratio, said)
    };
    // Six decimals are a rounded fraction; the simplest matching fraction is taken.
    for (typed, ratio) in
        [("58.3333333", [175, 3]), ("9.333333", [28, 3]), ("1296.714286", [9077, 7]), ("6.142857", [43, 7])]
    {
        let (read, said) = read_as(typed);
        assert!(read == ratio && said.contains(&format!("is taken as {}/{}", ratio[0], ratio[1])), "{read:?}: {said}");
    }
    // Two decimals are taken as typed, with a warning if a fraction of few teeth rounds to them.
    let (ratio, said) = read_as("9.33");
    assert_eq!(ratio, [933, 100]);
    assert!(said.contains("28/3") && said.contains("`motor_turns` = 28 and `link_turns` = 3"), "{said}");
    for exact in ["9.34", "27.5", "12.25", "720", "1440"] {
        assert_eq!(read_as(exact).1, "", "{exact}");
    }
    refused(&c1("ratio = 59", "ratio = 100000"), &["ratio", "less than"]);
    refused(&c1("ratio = 59", "motor_turns = 59"), &["link_turns", "missing"]);
    refused(&c1("ratio = 59", "ratio = 59\nlink_turns = 1"), &["both state", "keep `ratio`"]);
    refused(&c1("ratio = 59", "motor_turns = 3\nlink_turns = 29"), &["3/29", "faster"]);
    refused(&c1("ratio = 59", "ratio = 0.5"), &["ratio", "greater than 1"]);
}

#[test]
fn equivalent_gear_rejects_teeth() {
    let with = |section: &str| format!("{}\n{section}\n", preset("c1").expect("a preset"));
    refused(&with("[mesh]\nmean_stiffness_N_per_m = 1e8"), &["`mesh`", "[equivalent_gear] has none"]);
    refused(&with("[contact]\ndamping_law = \"paper\""), &["`contact`", "leave one of the two out"]);
    refused(&c1("[bodies]", "[bodies]\nplanet_mass_kg = 0.1"), &["`planet_mass_kg`", "at its input"]);
    refused(&c1("link_inertia_kg_m2 = 0.80", "# link_inertia_kg_m2 = 0.80"), &["needs a link"]);
    refused(&c1("total_stiffness_N_m_per_arcmin", "total_stiffnes_N_m_per_arcmin"), &["did you mean `total_stiffness"]);
    refused(&c1("total_stiffness_N_m_per_arcmin = 20.0", "stiffness_N_m_per_rad = 20.0"), &["N m/arcmin"]);
}

#[test]
fn equivalent_gear_keys_are_set() {
    let text = preset("c1").expect("a preset");
    let set = |key, value| change(text, key, value).expect("a known key");
    let wide = read(&set("equivalent_gear.lost_motion_mrad", "2")).expect("another form takes its place").parameters;
    assert_close(sheet::lost_motion(&wide), 2e-3);
    let geared = read(&set("ratio", "45.5")).expect("a ratio").parameters;
    assert_close(geared.geometry.ratio_by_teeth(), 45.5);
    // Without a section the short key is the one of the joint's kind of gears.
    let narrow = read(&set("lost_motion_arcmin", "2")).expect("the gear's own").parameters;
    assert_close(sheet::lost_motion(&narrow), 2.0 * ARCMIN);
    let refused = change(text, "mesh.lost_motion_arcmin", "2").expect_err("of teeth");
    assert!(refused.message.contains("an equivalent gear"), "{refused:?}");
    assert_eq!(refused.help, "write equivalent_gear.lost_motion_arcmin");
}

#[test]
fn weak_motor_drives_with_its_limit() {
    let rated = |limit: &str| c1("motor_torque_limit_N_m = 4.0", &format!("motor_torque_limit_N_m = {limit}"));
    let file = joint(&rated("0.6"));
    assert_eq!((file.profile.drive_torque, file.profile.motor_torque_limit), (0.6, 0.6));
    assert_eq!((file.parameters.rated_output_torque, file.warnings), (100.0, vec![]));
    // A motor with a hundredth of the gears' torque has another unit.
    let said = read(&rated("0.02")).expect_err("frictions alone take more");
    assert!(said.iter().any(|problem| problem.message.contains("1.18 N m at the link")), "{said:#?}");
}

#[test]
fn input_inertia_slip_blames_one_key() {
    let said = |value: &str| {
        let text = c1("gear_inertia_at_input_kg_cm2 = 0.25", &format!("gear_inertia_at_input_kg_cm2 = {value}"));
        read(&text).map_or_else(|problems| problems.0, |file| file.warnings)
    };
    let all = said("30600");
    let text: String = all.iter().map(ToString::to_string).collect();
    assert!(text.contains("`gear_inertia_at_input_kg_cm2` = 30600: 30600 times the inertia of the rotor"), "{text}");
    assert!(!text.contains("`link_inertia_kg_m2`"), "{text}");
    assert!(said("900").iter().any(|problem| problem.help.contains("typed in g cm^2")), "{:?}", said("900"));
    // A clamping hub with ten times the rotor's inertia is no slip, with or without teeth behind it.
    assert_eq!(said("10"), []);
    let hub = joint(&with(&[("gear_inertia_at_input_kg_cm2", "0.9")]));
    assert_eq!(hub.warnings, []);
    let foil = read(&with(&[("gear_inertia_at_input_kg_cm2", "1e-7")])).expect_err("a foil");
    assert_eq!(foil.len(), 1, "{foil:#?}");
}

#[test]
fn counts_per_turn_replace_bits() {
    let counts = |by: &str| c1("[drive_train.motor_encoder]\nbits = 17", &format!("[drive_train.motor_encoder]\n{by}"));
    for turn in [4000, 7200, 24] {
        let file = read(&counts(&format!("counts_per_turn = {turn}"))).expect("counts in a turn");
        assert_eq!(file.surroundings.motor_encoder.counts_per_turn, turn);
    }
    refused(&counts("bits = 12\ncounts_per_turn = 4000"), &["`bits` and `counts_per_turn` state one quantity twice"]);
    refused(&counts(""), &["needs one of `bits` and `counts_per_turn`"]);
    let set = change(preset("c1").expect("a preset"), "motor_encoder.counts_per_turn", "4000").expect("a known key");
    assert_eq!(joint(&set).surroundings.motor_encoder.counts_per_turn, 4000);
}
