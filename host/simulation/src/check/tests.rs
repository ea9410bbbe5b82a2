//! Figures against the oracles of the model and the joints' data sheets, and messages for a bad file.

use model_core::gears::Mechanics;
use std::path::Path;

use joint_file::PRESETS;
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};
use model_core::gears::design::{Effort, Processor, StepSize};
use parameters::JointParameters;

use super::derive::arcmin;
use board::device::board::Board;

use super::{CheckSummary, layout, step, summary};
use joint_file::diagnostic;
use joint_file::named::{Loaded, load};
use report::output;

const RATE: u32 = 20_000;

fn preset(name: &str) -> CheckSummary {
    summary(&load(Path::new(name)).expect("a preset"), &Board::emulated(), RATE, None).expect("figures")
}

/// Reads Q1 with pieces of the text replaced.
fn changed(changes: &[(&str, &str)]) -> Loaded {
    let text = changes.iter().fold(joint_file::preset("q1").expect("a preset").to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text.replace(from, to)
    });
    let file = joint_file::read(&text).unwrap_or_else(|problems| panic!("{problems:#?}"));
    Loaded { name: "changed".to_owned(), text, file }
}

/// Equal within half a unit of the last printed digit.
#[track_caller]
fn assert_printed(value: f64, printed: f64, decimals: i32) {
    assert!((value - printed).abs() <= 0.5 * 10f64.powi(-decimals) * (1.0 + 1e-9), "{value} is not {printed}");
}

/// The two overall modes and the planets' mode of the gears alone, in closed form [Hz].
fn closed_form(parameters: &JointParameters) -> [f64; 3] {
    let n = parameters.geometry.planets as f64;
    let (sun, planet) = (parameters.bodies.sun_equivalent_mass, parameters.bodies.planet_equivalent_mass);
    let carrier = parameters.carrier_equivalent_mass();
    let (k_sun, k_ring) = (parameters.sun_planet.mean_stiffness, parameters.ring_planet.mean_stiffness);
    let both = k_sun + k_ring;
    let square = sun * planet * carrier;
    let linear = -(n * k_sun * planet * carrier + both * carrier * sun + n * both * planet * sun);
    let constant = n * k_sun * k_ring * (n * planet + carrier + 4.0 * sun);
    let root = (linear * linear - 4.0 * square * constant).sqrt();
    let overall = [-1.0, 1.0].map(|sign| (-linear + sign * root) / (2.0 * square));
    [overall[0], both / planet, overall[1]].map(|squared| squared.sqrt() / std::f64::consts::TAU)
}

#[test]
fn paper_preset_has_published_frequencies() {
    let paper = preset("paper");
    assert_printed(paper.frequencies.omega_n_rad_per_s, 20502.0, 0);
    let expected = [2082.85, 2881.84, 2881.84, 4997.09];
    assert_eq!(paper.frequencies.gears_alone_Hz.len(), 4);
    for (frequency, expected) in paper.frequencies.gears_alone_Hz.iter().zip(expected) {
        assert_printed(*frequency, expected, 2);
    }
    let carrier = |summary: CheckSummary| summary.equivalent_masses.expect("planets").carrier_with_planets_kg;
    assert_printed(carrier(paper), 10.0035, 4);
    assert_printed(carrier(preset("paper_printed")), 6.0239, 4);
}

#[test]
fn gear_frequencies_match_closed_form() {
    for name in PRESETS {
        let loaded = load(Path::new(name)).expect("a preset");
        if loaded.file.parameters.equivalent_gear().is_some() {
            continue;
        }
        let frequencies = summary(&loaded, &Board::emulated(), RATE, None).expect("figures").frequencies.gears_alone_Hz;
        let expected = closed_form(&loaded.file.parameters);
        let mut expected = vec![expected[0], expected[1], expected[1], expected[2]];
        expected.sort_by(f64::total_cmp);
        for (frequency, expected) in frequencies.iter().zip(expected) {
            assert!((frequency / expected - 1.0).abs() < 1e-9, "{name}: {frequency} is not {expected}");
        }
    }
}

#[test]
fn lost_motion_and_wind_up_match_data_sheets() {
    let output = preset("q1").output;
    assert_printed(1e3 * output.lost_motion_rad, 3.78, 2);
    assert_printed(output.lost_motion_arcmin, 13.0, 1);
    assert_printed(output.wind_up_of_compliance_rad, 12.0 / 10.3e3, 12);
    assert_printed(preset("s1").output.lost_motion_arcmin, 3.0, 3);
    assert_printed(preset("s1").output.wind_up_arcmin, 10.0, 2);
    assert_printed(preset("d2").output.lost_motion_arcmin, 7.0, 3);
}

/// An equivalent gear is described by its data sheet, without planets, sun or meshes.
#[test]
fn equivalent_gear_has_no_tooth_figures() {
    let c1 = preset("c1");
    let gear = c1.equivalent_gear.as_ref().expect("an equivalent gear");
    assert_eq!((gear.motor_turns, gear.link_turns), (59, 1));
    let at_link = 59.0 * 59.0 * (1.0e-4 + 0.25e-4);
    assert_printed(gear.motor_inertia_at_link_kg_m2, at_link, 12);
    // 20 N m/arcmin between both inertias, computed by hand.
    let stiffness = 20.0 * 180.0 * 60.0 / std::f64::consts::PI;
    let omega = (stiffness * (1.0 / at_link + 1.0 / 0.8)).sqrt();
    assert_printed(c1.frequencies.omega_n_rad_per_s / omega, 1.0, 12);
    assert_eq!(c1.frequencies.whole_joint_Hz.len(), 1);
    assert_printed(c1.output.lost_motion_arcmin, 3.0, 9);
    assert_printed(c1.output.wind_up_arcmin, 5.0, 9);
    assert!(c1.geometry.is_none() && c1.meshes.is_empty() && c1.output.mesh_force_N.is_none());
    let page = layout(&c1);
    assert!(page.contains("preload and hysteresis") && !page.contains("planet") && !page.contains("sun"), "{page}");
}

#[test]
fn self_locking_gear_is_named() {
    let worm = |efficiency: &str| {
        let text = changed(&[("efficiency = 0.97", &format!("efficiency = {efficiency}"))]);
        summary(&text, &Board::emulated(), RATE, None).expect("figures")
    };
    let words = "self-locking";
    assert!(worm("0.45").output.self_locking && layout(&worm("0.45")).contains(words));
    assert!(!worm("0.5").output.self_locking && !layout(&worm("0.5")).contains(words));
}

#[test]
fn static_deflections_carry_rated_torque() {
    for name in PRESETS {
        let summary = preset(name);
        let Some(geometry) = &summary.geometry else { continue };
        let (sun, ring) = (&summary.meshes[0], &summary.meshes[1]);
        let planets = geometry.planets as f64;
        let at_sun =
            planets * sun.mean_stiffness_N_per_m * sun.deflection_at_rated_torque_m * geometry.sun_base_radius_m;
        assert!((at_sun / summary.output.balancing_drive_torque_N_m - 1.0).abs() < 1e-12, "{name}");
        // X = u_s - 2 u_c is the sum of both deflections; the sun is at rest.
        let turned = (sun.deflection_at_rated_torque_m + ring.deflection_at_rated_torque_m)
            / (2.0 * geometry.carrier_base_radius_m);
        assert!((turned / summary.output.wind_up_of_teeth_rad - 1.0).abs() < 1e-12, "{name}");
    }
}

#[test]
fn gap_follows_tightest_planet() {
    let ring = "[mesh.ring_planet]\nhalf_backlash_um = [40.0, 10.0, 50.0]\n\n[contact]";
    let summary = summary(&changed(&[("[contact]", ring)]), &Board::emulated(), RATE, None).expect("figures");
    assert_printed(1e6 * summary.output.gap_m, 2.0 * (40.0 + 10.0), 9);
    assert!(layout(&summary).contains("40.000, 10.000, 50.000 um"));
}

#[test]
fn unequal_mesh_phases_shown_per_planet() {
    let five = [
        ("planets = 3 ", "planets = 5 "),
        ("sun_teeth = 15", "sun_teeth = 26"),
        ("planet_teeth = 30", "planet_teeth = 29"),
        ("ring_teeth = 75", "ring_teeth = 84"),
        ("drive_torque_N_m = 2.0", "drive_torque_N_m = 2.4"),
    ];
    let summary = summary(&changed(&five), &Board::emulated(), RATE, None).expect("figures");
    for (mesh, teeth) in summary.meshes.iter().zip([26.0, -84.0]) {
        for (i, phase) in mesh.stiffness_phase_periods.iter().enumerate() {
            assert_printed(*phase, (teeth * i as f64 / 5.0).rem_euclid(1.0), 9);
        }
    }
    assert!(layout(&summary).contains("0.0000, 0.2000, 0.4000, 0.6000, 0.8000 of a period"));
    assert_eq!(summary.frequencies.gears_alone_Hz.len(), 6);
}

/// The lowest stable rate has a step, one hertz less has none.
#[test]
fn lowest_rate_is_sharp() {
    for name in PRESETS {
        let parameters = load(Path::new(name)).expect("a preset").file.parameters;
        let lowest = StepSize::new(&parameters).lowest_rate(Effort::Board);
        assert!(step::step(&parameters, Processor::STM32F405, lowest).is_ok(), "{name}: {lowest}");
        assert!(step::step(&parameters, Processor::STM32F405, lowest - 1).is_err(), "{name}: {lowest}");
    }
}

#[test]
fn unstable_rate_is_rejected() {
    let failure =
        summary(&load(Path::new("q1")).expect("a preset"), &Board::emulated(), 100, None).expect_err("unstable");
    assert!(failure.message().contains("a tick rate of 100 Hz is too low"), "{failure}");
    assert_eq!(failure.exit_code(), 2);
}

/// Pages of parameters at their bounds hold neither NaN nor infinity.
#[test]
fn extreme_parameters_print_finite_numbers() {
    let ends: [&[(&str, &str)]; 4] = [
        &[("rated_output_torque_N_m = 12.0", "rated_output_torque_N_m = 1e-6"), ("drive_torque_N_m = 2.0", "")],
        &[("link_inertia_kg_m2 = 0.15", "link_inertia_kg_m2 = 1e6"), ("stiffness_ratio = 0.15", "stiffness_ratio = 0")],
        &[("half_backlash_um = 40.0", "half_backlash_um = 0"), ("damping_ratio = 0.05", "damping_ratio = 0")],
        &[("mean_stiffness_N_per_m = 1e8", "mean_stiffness_N_per_m = 1e4"), ("gravity_torque_N_m = 6.0", "")],
    ];
    let unlikely = |changes: &[(&'static str, &'static str)]| {
        let lenient = [("name = \"Q1\"", "name = \"Q1\"\ncoherence = \"warn\"")];
        changed(&[changes, &lenient].concat())
    };
    let pages = ends
        .iter()
        .map(|changes| layout(&summary(&unlikely(changes), &Board::emulated(), RATE, None).expect("figures")));
    for page in pages.chain(PRESETS.map(|name| layout(&preset(name)))) {
        assert!(!page.contains("NaN") && !page.contains("inf"), "{page}");
        assert!(page.lines().all(|line| line.trim_end() == line), "{page}");
    }
}

#[test]
fn non_finite_figure_is_named() {
    let mut loaded = load(Path::new("q1")).expect("a preset");
    loaded.file.parameters.rated_output_torque = f64::NAN;
    let failure = summary(&loaded, &Board::emulated(), RATE, None).expect_err("not a number");
    assert!(failure.message().contains("_at_rated_torque_m is not a finite number"), "{failure}");
}

#[test]
fn warnings_name_their_line() {
    let paper = preset("paper");
    let text = joint_file::preset("paper").expect("a preset");
    let lines: Vec<&str> = paper.warnings.iter().filter_map(|warning| text.lines().nth(warning.line - 1)).collect();
    assert_eq!(lines.len(), 2);
    assert!(lines.iter().all(|line| line.starts_with("ring_teeth = 99")), "{lines:?}");
    assert!(layout(&paper).contains("not coaxial: the ring has 99 teeth, sun and planets need 27 + 2 x 35 = 97"));
}

#[test]
fn json_matches_summary() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("q1.json");
    let summary = preset("q1");
    output::deliver(&summary, "", Some(&out), &[]).expect("a folder that can be written to");
    let text = std::fs::read_to_string(out).expect("the file");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(json["schema"], "joint-check/2");
    assert_eq!(json["output"]["lost_motion_rad"], summary.output.lost_motion_rad);
    assert_eq!(json["frequencies"]["whole_joint_Hz"].as_array().map(Vec::len), Some(5));
    assert_eq!(json, serde_json::to_value(&summary).expect("JSON"));
}

#[test]
fn unwritable_output_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("none/q1.json");
    let failure = output::deliver(&preset("q1"), "", Some(&out), &[]).expect_err("no such folder");
    assert!(failure.message().contains("none"), "{failure}");
}

#[test]
fn unreadable_file_error_lists_presets() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = folder.path().join("bytes.toml");
    std::fs::write(&bytes, [0xff, 0xfe, 0x00]).expect("a file");
    for (path, part) in [
        (folder.path().join("none.toml"), "none.toml: No such file"),
        (folder.path().to_owned(), "it is a folder"),
        (bytes, "it is not text (UTF-8)"),
    ] {
        let failure = load(&path).expect_err("unreadable");
        assert!(failure.message().contains(part), "{failure}");
        assert!(failure.help().is_some_and(|help| help.contains("q1, s1, d2, l1, c1, paper, paper_printed")));
        assert_eq!(failure.exit_code(), 2);
    }
}

#[test]
fn arcmin_is_a_sixtieth_of_a_degree() {
    assert_printed(arcmin(std::f64::consts::PI), 180.0 * 60.0, 9);
}

/// Report of a bad file, without colours.
fn drawn(text: &str) -> String {
    let problems = joint_file::read(text).expect_err("a bad file");
    let report = diagnostic::report("bad.toml", text, &problems);
    let diagnostic: &dyn Diagnostic = report.as_ref();
    let mut page = String::new();
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(100);
    handler.render_report(&mut page, diagnostic).expect("a string takes everything");
    page.lines().map(|line| line.trim_end().to_owned() + "\n").collect()
}

#[test]
fn bad_file_report_underlines_every_problem() {
    let text = joint_file::preset("q1").expect("a preset");
    let text =
        text.replace("planets = 3 # common practice", "planets = 2").replace("= 1e8 # the paper, section 4", "= -1e8");
    let expected = "  × bad.toml cannot be used: 2 problems

Error:
  × `planets` must be between 3 and 5, not 2
    ╭─[bad.toml:10:11]
  9 │ [geometry]
 10 │ planets = 2
    ·           ─
 11 │ sun_teeth = 15 # chosen for the ratio 1 + 75/15 = 6
    ╰────
  help: number of equally spaced planets: 3, 4 or 5

Error:
  × `mean_stiffness_N_per_m` must be between 1e4 and 1e12, not -1e8
    ╭─[bad.toml:30:26]
 29 │ [mesh]
 30 │ mean_stiffness_N_per_m = -1e8
    ·                          ────
 31 │ stiffness_ratio = 0.15 # assumed: spur gears of contact ratio 1.6
    ╰────
  help: mean mesh stiffness K_m in N/m, about 1e8 for steel teeth; 100 N/um are 1e8 N/m
";
    assert_eq!(drawn(&text), expected);
}

#[test]
fn empty_file_report_names_missing_section() {
    assert!(drawn("").contains("the section [geometry] is missing"));
}
