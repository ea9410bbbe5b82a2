//! Gears that do not fit together, and radii stated twice. Single values are in `values`.

use joint_file::{Severity, preset, read};

use crate::{problems, refused, spoilt};

#[test]
fn module_and_radii_conflict() {
    let text = spoilt("module_mm = 1.0", "module_mm = 1.0\ncarrier_radius_mm = 22.5");
    refused(&text, "`carrier_radius_mm` and `module_mm` both set the radii", "22.5", "keep the module, or all radii");
}

/// Q1 with its radii stated; `carrier` is the carrier's line.
fn by_radii(carrier: &str) -> String {
    let radii = format!("sun_base_radius_mm = 7.0476947\nplanet_base_radius_mm = 14.0953893\n{carrier}");
    spoilt("module_mm = 1.0", &radii)
}

#[test]
fn radii_equal_module() {
    let stated = read(&by_radii("carrier_radius_mm = 22.5")).expect("coherent radii").parameters.geometry;
    let lever = read(&by_radii("carrier_base_radius_mm = 21.143084")).expect("coherent radii").parameters.geometry;
    let derived = read(preset("q1").expect("a preset")).expect("q1").parameters.geometry;
    for geometry in [stated, lever] {
        assert!((geometry.sun_base_radius / derived.sun_base_radius - 1.0).abs() < 1e-7);
        assert!((geometry.carrier_radius / derived.carrier_radius - 1.0).abs() < 1e-7);
    }
}

/// A lever given as carrier radius would count the cosine twice.
#[test]
fn lever_as_carrier_radius_is_rejected() {
    let text = by_radii("carrier_radius_mm = 21.143");
    let message = "this carrier radius is r_c cos(alpha) = 21.1431 mm: cos(alpha) would count twice";
    refused(&text, message, "21.143", "write carrier_base_radius_mm for it, or carrier_radius_mm = 22.5000");
}

#[test]
fn misfit_carrier_radius_is_rejected() {
    let text = by_radii("carrier_radius_mm = 23.0");
    let message = "r_c cos(alpha) = 21.6129 mm, but the base radii of sun and planet sum to 21.1431 mm";
    refused(&text, message, "23.0", "r_c is 22.5000 mm");
}

#[test]
fn radius_in_metres_is_rejected() {
    let text = by_radii("carrier_radius_mm = 0.0225");
    let message = "`carrier_radius_mm` must be between 0.5 and 5000, not 0.0225";
    refused(&text, message, "0.0225", "in mm");
}

#[test]
fn missing_carrier_radius_names_both() {
    let message = "[geometry] needs one of `carrier_radius_mm` and `carrier_base_radius_mm`";
    refused(&by_radii(""), message, "[geometry]", "not r_c cos(alpha)");
}

#[test]
fn not_coaxial_names_fitting_teeth() {
    let text = spoilt("ring_teeth = 75", "ring_teeth = 78");
    let found: Vec<_> = problems(&text).into_iter().map(|p| (p.message, text[p.span].to_owned(), p.help)).collect();
    let message = "not coaxial: the ring has 78 teeth, sun and planets need 15 + 2 x 30 = 75";
    assert_eq!(found[0], (message.to_owned(), "78".to_owned(), "ring_teeth = 75".to_owned()));
    assert_eq!(found[1].0, "the ratio is 6.00000 by base radii and 6.20000 by teeth");
    assert_eq!(found.len(), 2);
}

#[test]
fn not_assembling_is_rejected() {
    let text = spoilt("planets = 3", "planets = 4");
    let message = "4 equally spaced planets do not assemble: (15 + 75) / 4 is not whole";
    let (found, place, help) = only_among(&text, "assemble");
    assert_eq!((found.as_str(), place.as_str()), (message, "4"));
    assert_eq!(help, "these teeth take 3 planets, or choose others");
}

/// Returns message, underlined text and help of the only problem whose message contains `part`.
fn only_among(text: &str, part: &str) -> (String, String, String) {
    let found: Vec<_> = problems(text).into_iter().filter(|problem| problem.message.contains(part)).collect();
    assert_eq!(found.len(), 1, "{found:#?}");
    (found[0].message.clone(), text[found[0].span.clone()].to_owned(), found[0].help.clone())
}

#[test]
fn colliding_planets_are_rejected() {
    let text = spoilt("planets = 3", "planets = 5");
    let (message, place, _) = only_among(&text, "collide");
    assert_eq!(
        message,
        "neighbouring planets collide: their axes are 26.450 mm apart, their pitch diameter is 30.000 mm"
    );
    assert_eq!(place, "5");
}

#[test]
fn touching_tips_warn() {
    let text = preset("q1").expect("a preset").replace("planets = 3 ", "planets = 5 ");
    let text = text.replace("sun_teeth = 15", "sun_teeth = 25").replace("planet_teeth = 30", "planet_teeth = 35");
    let text =
        text.replace("ring_teeth = 75", "ring_teeth = 95").replace("drive_torque_N_m = 2.0", "drive_torque_N_m = 2.4");
    let file = read(&text).expect("pitch circles stay apart");
    let messages: Vec<_> = file.warnings.iter().map(|warning| warning.message.as_str()).collect();
    let message =
        "neighbouring planets touch at the tips: axes 35.267 mm apart, tip diameter 37.000 mm at full tooth height";
    assert_eq!(messages, [message]);
}

#[test]
fn radii_against_teeth_are_rejected() {
    let text =
        by_radii("carrier_radius_mm = 22.5").replace("7.0476947", "8.0476947").replace("14.0953893", "13.0953893");
    let message = "the ratio is 5.25444 by base radii and 6.00000 by teeth";
    refused(&text, message, "13.0953893", "r_bp / r_bs must be planet_teeth / sun_teeth");
}

#[test]
fn coherence_warn_downgrades_misfits() {
    let text =
        spoilt("ring_teeth = 75", "ring_teeth = 78").replace("description =", "coherence = \"warn\"\ndescription =");
    let file = read(&text).expect("only warnings");
    assert_eq!(file.warnings.len(), 2);
    assert!(file.warnings.iter().all(|warning| warning.severity == Severity::Warning));
}
