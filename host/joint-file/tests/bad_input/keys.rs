//! Keys, sections and syntax: unknown, missing, misplaced, of the wrong type, or no TOML. Values out of bounds are in
//! `values`.

use joint_file::{preset, read};

use crate::{only, problems, refused, spoilt};

#[test]
fn misspelt_key_gets_suggestion() {
    let text = spoilt("cogging_torque_N_m", "coging_torque_N_m");
    let message = "unknown key `coging_torque_N_m` in [drive_train]";
    refused(&text, message, "coging_torque_N_m", "did you mean `cogging_torque_N_m`?");
}

/// A key in another unit gets a suggestion, and the missing key is named.
#[test]
fn key_in_other_unit_gets_suggestion() {
    let text = spoilt("half_backlash_um = 40.0", "half_backlash_mm = 0.04");
    let found: Vec<_> = problems(&text).into_iter().map(|p| (p.message, text[p.span].to_owned(), p.help)).collect();
    assert_eq!(found[0].0, "[mesh] needs one of `half_backlash_um` and `backlash_um`");
    assert_eq!(
        (found[1].0.as_str(), found[1].1.as_str()),
        ("unknown key `half_backlash_mm` in [mesh]", "half_backlash_mm")
    );
    assert!(found[1].2.starts_with("did you mean `half_backlash_um`? "), "{}", found[1].2);
    assert_eq!(found.len(), 2);
}

#[test]
fn misplaced_key_names_its_section() {
    let text = spoilt("[excitation]", "[excitation]\nlink_inertia_kg_m2 = 0.2");
    refused(&text, "unknown key `link_inertia_kg_m2` in [excitation]", "link_inertia_kg_m2", "it belongs in [bodies]");
}

#[test]
fn strange_key_lists_known_keys() {
    let text = spoilt("[excitation]", "[excitation]\ncolour = 1");
    refused(&text, "unknown key `colour` in [excitation]", "colour", "known here: `mode`, `mesh_frequency_rad_per_s`");
}

#[test]
fn misspelt_section_gets_suggestion() {
    let text = spoilt("[contact]", "[contacts]");
    refused(&text, "unknown key `contacts` in a joint file", "contacts", "did you mean `contact`?");
}

#[test]
fn missing_key_underlines_section() {
    let text = spoilt("mean_stiffness_N_per_m = 1e8", "");
    refused(&text, "`mean_stiffness_N_per_m` is missing from [mesh]", "[mesh]", "K_m in N/m");
}

#[test]
fn missing_section_underlines_first_line() {
    let text = preset("q1").expect("a preset");
    let (start, end) = (text.find("[bodies]").expect("bodies"), text.find("[compliance]").expect("compliance"));
    let text = format!("{}{}", &text[..start], &text[end..]);
    refused(&text, "the section [bodies] is missing", "name = \"Q1\"", "sun_equivalent_mass_kg");
}

#[test]
fn empty_file_lists_all_missing() {
    let messages: Vec<_> = problems("").into_iter().map(|problem| problem.message).collect();
    assert_eq!(
        messages,
        [
            "`name` is missing from the top of the file",
            "`rated_output_torque_N_m` is missing from the top of the file",
            "the section [geometry] is missing",
            "the section [bodies] is missing",
            "the section [mesh] is missing",
        ]
    );
}

#[test]
fn wrong_type_names_both_types() {
    let text = spoilt("planets = 3", "planets = \"3\"");
    refused(&text, "`planets` must be a whole number, not a string", "\"3\"", "3, 4 or 5");
    let text = spoilt("sun_teeth = 15", "sun_teeth = 15.0");
    refused(&text, "`sun_teeth` must be a whole number, not a number with a fraction", "15.0", "teeth of the sun");
    let text = spoilt("stiffness_ratio = 0.15", "stiffness_ratio = [0.15]");
    refused(&text, "`stiffness_ratio` must be a number, not a list", "[0.15]", "K_a / K_m");
    let text = spoilt("name = \"Q1\"", "name = 1");
    refused(&text, "`name` must be a string, not a whole number", "1", "name = \"Q1\"");
}

#[test]
fn section_as_value_is_rejected() {
    let text =
        "contact = 3\n".to_owned() + &spoilt("[contact]\ndamping_law = \"contact\"\ndead_zone = \"sharp\"\n", "");
    refused(&text, "`contact` must be a section, not a whole number", "3", "[contact]");
}

/// Mass and inertia exclude each other, and one is needed.
#[test]
fn mass_and_inertia_conflict() {
    let text = spoilt("sun_equivalent_mass_kg = 0.02", "sun_equivalent_mass_kg = 0.02\nsun_inertia_kg_m2 = 1e-6");
    let message = "`sun_equivalent_mass_kg` and `sun_inertia_kg_m2` state one quantity twice";
    refused(&text, message, "1e-6", "keep one");
    let text = spoilt("planet_equivalent_mass_kg = 0.03", "");
    let message = "[bodies] needs one of `planet_equivalent_mass_kg` and `planet_inertia_kg_m2`";
    refused(&text, message, "[bodies]", "I / r^2 in kg");
}

#[test]
fn invalid_names_are_rejected() {
    let long = "a joint with a name that is much too long";
    let text = spoilt("name = \"Q1\"", &format!("name = \"{long}\""));
    refused(&text, "`name` has 41 letters", &format!("\"{long}\""), "up to 32");
    let text = spoilt("name = \"Q1\"", "name = \"Q\\u0007\"");
    assert!(only(&text).0.starts_with("`name` cannot be"));
    let text = spoilt("name = \"Q1\"", "name = \"  \"");
    refused(&text, "`name` cannot be \"  \"", "\"  \"", "letters, digits, spaces");
}

#[test]
fn syntax_error_is_underlined() {
    let text = spoilt("planets = 3", "planets == 3");
    let (message, place, help) = only(&text);
    assert!(message.starts_with("not TOML: "), "{message}");
    assert_eq!(place, "=");
    assert_eq!(help, "write lines of the form key = value");
    let text = spoilt("ring_teeth = 75", "sun_teeth = 75");
    let (message, place, _) = only(&text);
    assert_eq!((message.as_str(), place.as_str()), ("not TOML: duplicate key", "sun_teeth"));
}

#[test]
fn all_problems_in_order_of_text() {
    let text = spoilt("planets = 3", "planets = 2")
        .replace("planet_mass_kg = 0.05", "planet_mas_kg = 0.05")
        .replace("mean_stiffness_N_per_m = 1e8", "mean_stiffness_N_per_m = nan")
        .replace("bits = 14", "bits = 3");
    let messages: Vec<_> = problems(&text).into_iter().map(|problem| problem.message).collect();
    assert_eq!(
        messages,
        [
            "`planets` must be between 3 and 5, not 2",
            "`planet_mass_kg` is missing from [bodies]",
            "unknown key `planet_mas_kg` in [bodies]",
            "`mean_stiffness_N_per_m` must be a finite number, not nan",
            "`bits` must be between 8 and 32, not 3",
        ]
    );
}

#[test]
fn reader_never_panics() {
    let text = preset("q1").expect("a preset");
    for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)) {
        let _ = read(&text[..end]);
    }
    for garbage in
        ["\u{0}", "[[geometry]]\nplanets = 3", "geometry = []", "mesh.sun_planet = 1", "= = =", "\u{feff}name = 1"]
    {
        assert!(read(garbage).is_err(), "{garbage}");
    }
}

#[test]
fn compliance_without_link_is_rejected() {
    let text = spoilt("link_inertia_kg_m2 = 0.15", "link_inertia_kg_m2 = 0.0");
    refused(&text, "a compliance needs a link behind it", "[compliance]", "give `link_inertia_kg_m2` in [bodies]");
}
