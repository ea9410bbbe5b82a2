//! `joint new`: data sheets become joint files that state the source of every line and that every command accepts.
//! Missing, impossible and existing items are rejected.

mod command;
mod pseudo_terminal;

use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use command::{folder, joint, text, within};
use joint_file::sheet::{self, ARCMIN};
use joint_file::{JointFile, read};
use model_core::gears::Kinematics;
use parameters::MESH_KINDS;

/// Ratio, lost motion, stiffness, rated torque, rotor inertia, no-load torque, efficiency; further options.
type Sheet = ([f64; 7], &'static [&'static str]);

const ELBOW: Sheet = ([9.0, 15.0, 1.8, 8.0, 0.32, 0.05, 0.94], &[]);
const KNEE: Sheet = (
    [6.25, 8.0, 6.0, 40.0, 4.5, 0.2, 0.96],
    &["--link-inertia-kg-m2", "0.4", "--outer-diameter-mm", "110", "--motor-bits", "16", "--output-bits", "19"],
);
const PLASTIC: Sheet = (
    [4.5, 40.0, 0.02, 0.3, 0.012, 0.006, 0.85],
    &["--material", "plastic", "--planets", "4", "--gear-inertia-kg-cm2", "0.0003", "--gravity-torque-Nm", "0.1"],
);

const OPTIONS: [&str; 7] = [
    "--ratio",
    "--lost-motion-arcmin",
    "--stiffness-Nm-per-arcmin",
    "--rated-torque-Nm",
    "--rotor-inertia-kg-cm2",
    "--no-load-torque-Nm",
    "--efficiency",
];

fn line(name: &Path, (figures, more): Sheet, also: &[&str]) -> Vec<String> {
    let named = OPTIONS.iter().zip(figures).flat_map(|(option, figure)| [(*option).to_owned(), figure.to_string()]);
    let words = ["new".to_owned(), text(name).to_owned()].into_iter().chain(named);
    words.chain(more.iter().chain(also).map(ToString::to_string)).collect()
}

fn words(line: &[String]) -> Vec<&str> {
    line.iter().map(String::as_str).collect()
}

/// Creates a joint without measuring its assumptions.
fn made(place: &Path, sheet: Sheet) -> (String, JointFile) {
    let path = place.join("made.toml");
    joint(&words(&line(&place.join("made"), sheet, &["--no-measure"]))).succeeded();
    let text = fs::read_to_string(&path).expect("it was written");
    let file = read(&text).unwrap_or_else(|problems| panic!("{problems:#?}"));
    (text, file)
}

/// No command may warn about a file of `joint new`, and every line states its source.
#[test]
fn data_sheets_pass_check_budget_sim() {
    for (figures, more) in [ELBOW, KNEE, PLASTIC] {
        let place = folder();
        let (written, file) = made(place.path(), (figures, more));
        let [ratio, lost_motion, stiffness, rated, rotor, no_load, efficiency] = figures;
        let parameters = &file.parameters;
        let close =
            |value: f64, wanted: f64| assert!((value / wanted - 1.0).abs() < 1e-9, "{value}, {wanted}\n{written}");
        assert!((parameters.geometry.ratio_by_teeth() / ratio - 1.0).abs() <= 0.01);
        close(sheet::lost_motion(parameters), lost_motion * ARCMIN);
        let teeth =
            sheet::teeth_compliance(&parameters.geometry, MESH_KINDS.map(|kind| parameters.mesh(kind).mean_stiffness));
        close(1.0 / (teeth + 1.0 / parameters.compliance.expect("a compliance").stiffness), stiffness / ARCMIN);
        close(parameters.rated_output_torque, rated);
        close(1e4 * parameters.rotor_inertia, rotor);
        let around = &file.surroundings;
        let load = around.load_friction.coulomb / (parameters.geometry.ratio_by_teeth() * efficiency);
        close(around.motor_friction.coulomb + load, no_load);
        assert_eq!(file.warnings, [], "{written}");
        for line in written.lines().filter(|line| line.contains(" = ")) {
            let known = ["# data sheet: ", "# derived from ", "# assumed: "];
            assert!(line.starts_with('#') || known.iter().any(|word| line.contains(word)), "{line}");
        }
        let path = place.path().join("made.toml");
        let (path, out) = (text(&path), place.path().join("out"));
        assert!(!joint(&["check", path]).succeeded().out.contains("without a source"));
        joint(&["budget", path]).succeeded();
        joint(&["sim", path, "--duration", "0.02", "--out", text(&out)]).succeeded();
    }
}

/// A cycloidal gear with unknown teeth.
const CYCLOID: Sheet = ([59.0, 3.0, 20.0, 100.0, 1.0, 0.1, 0.85], &["--equivalent", "--gravity-torque-Nm", "15"]);

#[test]
fn sheet_without_teeth_equivalent_gear() {
    let place = folder();
    let (written, file) = made(place.path(), CYCLOID);
    let gear = file.parameters.equivalent_gear().expect("an equivalent gear");
    let close = |value: f64, wanted: f64| assert!((value / wanted - 1.0).abs() < 1e-9, "{value}, {wanted}\n{written}");
    close(file.parameters.geometry.ratio_by_teeth(), 59.0);
    close(gear.lost_motion, 3.0 * ARCMIN);
    close(gear.stiffness, 20.0 / ARCMIN);
    close(file.parameters.rated_output_torque, 100.0);
    assert!(written.contains("gear_inertia_at_input_kg_cm2 = 0.5 # assumed: half of the rotor's"), "{written}");
    assert!(written.contains("without preload or hysteresis") && !written.contains("teeth"), "{written}");
    assert_eq!(file.warnings, [], "{written}");
    for line in written.lines().filter(|line| line.contains(" = ")) {
        assert!(["# data sheet: ", "# derived from ", "# assumed: "].iter().any(|word| line.contains(word)), "{line}");
    }
    let path = place.path().join("made.toml");
    joint(&["check", text(&path)]).succeeded();
    joint(&["budget", text(&path)]).succeeded();
    let name = place.path().join("other");
    let with = |also: &[&str]| joint(&words(&line(&name, CYCLOID, also)));
    with(&["--planets", "4"]).refused(&["--equivalent", "--planets"]);
    with(&["--ratio-tolerance", "2"]).refused(&["--equivalent", "--ratio-tolerance"]);
    joint(&["new", text(&name), "--equivalent", "--ratio", "0.5"]).refused(&["--ratio: 0.5 is not between 1"]);
}

#[test]
fn optional_values_marked_data_sheet() {
    let place = folder();
    let (knee, file) = made(place.path(), KNEE);
    assert!(knee.contains("link_inertia_kg_m2 = 0.4 # data sheet"), "{knee}");
    let encoders = [file.surroundings.motor_encoder, file.surroundings.output_encoder];
    assert_eq!(encoders.map(|encoder| encoder.bits()), [Some(16), Some(19)]);
    let ring = file.parameters.geometry.sun_base_radius / file.parameters.geometry.working_pressure_angle.cos()
        * f64::from(file.parameters.geometry.ring_teeth)
        / f64::from(file.parameters.geometry.sun_teeth);
    assert!(2.0 * ring < 0.110 && 2.0 * ring > 0.08, "{ring}");
    let place = folder();
    let (plastic, file) = made(place.path(), PLASTIC);
    assert!(plastic.contains("gear_inertia_at_input_kg_cm2 = 3e-4 # data sheet"), "{plastic}");
    assert_eq!(file.parameters.geometry.planets, 4);
    let [geometry, bodies] = [(); 2].map(|()| &file.parameters).map(|joint| (&joint.geometry, &joint.bodies));
    assert!((1e4 * sheet::inertia_at_input(bodies.1, geometry.0) / 0.0003 - 1.0).abs() < 1e-9);
}

/// The board has no time for this joint at the default rate.
#[test]
fn slow_joint_written_with_rate_note() {
    let place = folder();
    let light: Sheet =
        ([4.0, 20.0, 0.3, 2.0, 0.05, 0.02, 0.9], &["--planets", "5", "--outer-diameter-mm", "30", "--no-measure"]);
    let made = joint(&words(&line(&place.path().join("light"), light, &[]))).succeeded();
    assert!(made.out.contains("note: ") && made.out.contains("--rate "), "{}", made.out);
    joint(&["check", text(&place.path().join("light.toml"))]).succeeded();
    joint(&["budget", text(&place.path().join("light.toml"))]).refused(&["--rate"]);
}

#[test]
#[ignore = "half a minute and more: .ci/attack"]
fn assumptions_have_measured_effect() {
    let place = folder();
    let made = joint(&words(&line(&place.path().join("elbow"), ELBOW, &[]))).succeeded();
    let file = fs::read_to_string(place.path().join("elbow.toml")).expect("it was written");
    let assumed: Vec<&str> = file.lines().filter(|line| line.contains("# assumed: ")).collect();
    assert!(assumed.len() > 20, "{file}");
    for line in &assumed {
        let measured = line.contains("moves the standard test by ") && line.ends_with('%');
        assert!(measured || line.starts_with("planets = "), "{line}");
    }
    // The link inertia dominates the effort of T2; the noise of the current is negligible beside it.
    let of = |key: &str| {
        let line = assumed.iter().find(|line| line.starts_with(key)).unwrap_or_else(|| panic!("{key}\n{file}"));
        let moved = line.rsplit("by ").next().and_then(|words| words.trim_end_matches(" %").parse::<f64>().ok());
        moved.unwrap_or(0.0)
    };
    assert!(of("link_inertia_kg_m2") > 10.0, "{file}");
    assert!(
        file.contains("The standard test is motion T2 of `joint hil`") && file.contains("mrad for this file"),
        "{file}"
    );
    assert!(made.out.contains("standard test: ") && made.out.contains("3 planets, teeth 18, 63, 144"), "{}", made.out);
}

#[test]
fn missing_values_named_without_terminal() {
    let place = folder();
    let name = place.path().join("elbow");
    let lacks = ["lacks --lost-motion-arcmin, --stiffness-Nm-per-arcmin", "a terminal session asks for them"];
    joint(&["new", text(&name), "--ratio", "9"]).refused(&lacks);
    assert_eq!(command::contents(place.path()), []);
}

#[test]
fn impossible_sheet_writes_nothing() {
    let place = folder();
    let name = place.path().join("elbow");
    let with = |also: &[&str]| {
        let mut line = line(&name, ELBOW, &["--no-measure"]);
        for pair in also.chunks(2) {
            match line.iter().position(|word| word == pair[0]) {
                Some(at) => line[at + 1] = pair[1].to_owned(),
                None => line.extend(pair.iter().map(ToString::to_string)),
            }
        }
        joint(&words(&line))
    };
    with(&["--ratio", "9", "--planets", "5"]).refused(&["5 planets", "fewer planets"]);
    with(&["--ratio", "-9"]).refused(&["--ratio: -9 is not between"]);
    with(&["--efficiency", "94"]).refused(&["--efficiency: 94 is not between 0.1 and 1"]);
    with(&["--lost-motion-arcmin", "NaN"]).refused(&["--lost-motion-arcmin: NaN"]);
    with(&["--outer-diameter-mm", "20"]).refused(&["ring of 144 teeth does not fit 20 mm", "module 0.2"]);
    with(&["--stiffness-Nm-per-arcmin", "6188"]).refused(&[
        "alone have a stiffness of",
        "N m/arcmin",
        "the sheet states 6188",
    ]);
    let of_option = "was not written; `no_load_torque_N_m` is --no-load-torque-Nm";
    with(&["--no-load-torque-Nm", "50"]).refused(&["no_load_torque_N_m", "typed in mN m", of_option]);
    let bad = place.path().join("my \"elbow\"");
    joint(&words(&line(&bad, ELBOW, &["--no-measure"]))).refused(&["cannot be called", "letters, digits"]);
    assert_eq!(command::contents(place.path()), []);
}

/// Command line of the elbow's sheet with options replaced or added.
fn changed(name: &Path, changes: &[(&str, &str)]) -> Vec<String> {
    let mut line = line(name, ELBOW, &["--no-measure"]);
    for (option, value) in changes {
        match line.iter().position(|word| word == option) {
            Some(at) => line[at + 1] = (*value).to_owned(),
            None => line.extend([option, value].map(ToString::to_string)),
        }
    }
    line
}

#[test]
fn rating_above_motor_noted() {
    let place = folder();
    let rated = [("--rated-torque-Nm", "40"), ("--stiffness-Nm-per-arcmin", "8"), ("--motor-peak-torque-Nm", "1.5")];
    let made = joint(&words(&changed(&place.path().join("elbow"), &rated))).succeeded();
    assert!(made.out.contains("note: --motor-peak-torque-Nm 1.5 acts before --rated-torque-Nm 40"), "{}", made.out);
    let file = read(&fs::read_to_string(place.path().join("elbow.toml")).expect("written")).expect("a joint");
    assert_eq!((file.profile.drive_torque, file.profile.motor_torque_limit), (1.5, 1.5));
    assert_eq!((file.parameters.rated_output_torque, file.warnings), (40.0, vec![]));
}

#[test]
fn unreachable_ratio_names_equivalent_command() {
    let place = folder();
    let name = place.path().join("elbow");
    for (ratio, also) in [("27.5", None), ("30", None), ("13.77", Some(("--ratio-tolerance", "0.01")))] {
        let changes: Vec<_> = [("--ratio", ratio)].into_iter().chain(also).collect();
        let command = format!("joint new {} --equivalent --ratio {ratio} --lost-motion-arcmin 15", text(&name));
        let refused = joint(&words(&changed(&name, &changes)));
        refused.refused(&["--equivalent", &command]);
        let typed = refused.err.split("joint new ").last().expect("a command").trim().to_owned();
        // The proposed command succeeds as printed.
        let typed: Vec<&str> = ["new"].into_iter().chain(typed.split_whitespace()).collect();
        joint(&typed).succeeded();
        fs::remove_file(place.path().join("elbow.toml")).expect("written");
    }
    let refused = joint(&words(&changed(&name, &[("--ratio", "-9")])));
    refused.refused(&["--ratio"]);
    assert!(!refused.err.contains("--equivalent"), "{}", refused.err);
}

/// Most of a gearhead's inertia at its input may be a clamping hub on the motor's shaft, which is larger than a disc of
/// the sun's size.
#[test]
fn clamping_hub_inertia_not_warned() {
    let place = folder();
    let path = place.path().join("elbow.toml");
    let made = joint(&words(&changed(&place.path().join("elbow"), &[("--gear-inertia-kg-cm2", "0.3")]))).succeeded();
    assert!(!made.err.contains("warning"), "{}", made.err);
    assert_eq!(read(&fs::read_to_string(path).expect("written")).expect("a joint").warnings, []);
}

/// A value that the command derived from a diameter is not reported as the user's typing error.
#[test]
fn derived_stiffness_warning_names_source() {
    let place = folder();
    let small = [("--rated-torque-Nm", "35"), ("--stiffness-Nm-per-arcmin", "2"), ("--outer-diameter-mm", "40")];
    let made = joint(&words(&changed(&place.path().join("elbow"), &small))).succeeded();
    assert!(made.err.contains("`mean_stiffness_N_per_m`"), "{}", made.err);
    assert!(made.err.contains("it was derived from face width and material: "), "{}", made.err);
    let mut of_stiffness = made.err.lines().filter(|line| line.contains("mean_stiffness_N_per_m"));
    assert!(!of_stiffness.any(|line| line.contains("typed in")), "{}", made.err);
}

/// A motor too weak for a link of ten times the rotor's inertia: the assumed link inertia is what half of the motor's
/// torque limit accelerates in the standard test. Servo of ratio 353.5.
#[test]
fn assumed_link_fits_motor() {
    const SERVO: Sheet =
        ([353.5, 15.0, 0.05, 1.0, 0.004, 0.0005, 0.6], &["--equivalent", "--motor-peak-torque-Nm", "0.016"]);
    let place = folder();
    let (written, file) = made(place.path(), SERVO);
    assert!(written.contains("assumed: what half of the motor's limit swings in the standard test"), "{written}");
    let around = &file.surroundings;
    let link = file.parameters.link_inertia;
    let acceleration = 0.5 * std::f64::consts::TAU * std::f64::consts::TAU;
    let at_motor = 353.5 * acceleration * 0.6e-6 + acceleration * link / (353.5 * 0.6) + 0.0005;
    assert!((at_motor / (0.5 * around.torque_limit) - 1.0).abs() < 1e-3, "{at_motor}");
    let heavy = [
        &line(&place.path().join("heavy"), SERVO, &["--no-measure"])[..],
        &["--link-inertia-kg-m2", "0.5"].map(String::from),
    ]
    .concat();
    let told = joint(&words(&heavy)).succeeded().out;
    assert!(
        told.contains("note: the standard test swings the link by 0.5 rad at 1 Hz, which takes 0.051 N m"),
        "{told}"
    );
}

#[test]
fn existing_file_never_overwritten() {
    let place = folder();
    let path = place.path().join("elbow.toml");
    fs::write(&path, "mine").expect("a file");
    for name in ["elbow", "elbow.toml"] {
        let line = line(&place.path().join(name), ELBOW, &["--no-measure"]);
        joint(&words(&line)).refused(&["elbow.toml exists already", "another name"]);
    }
    assert_eq!(fs::read_to_string(&path).expect("still there"), "mine");
}

/// Text on the standard error of `joint new` after these answers.
fn said(arguments: &[&str], answers: &[u8]) -> String {
    let (mut master, terminal, _) = pseudo_terminal::pair();
    let mut command = Command::new(env!("CARGO_BIN_EXE_joint"));
    command.args(["new", "--no-measure"]).args(arguments);
    let asked = command.stdin(terminal).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut asked = asked.expect("the command can be started");
    master.write_all(answers).expect("a terminal takes it");
    let ended = within(Duration::from_secs(60), "an end", || {
        // The terminal's echo must be read.
        let _ = master.read(&mut [0; 256]);
        asked.try_wait().expect("it was started here")
    });
    let mut said = String::new();
    asked.stderr.take().expect("piped").read_to_string(&mut said).expect("text");
    assert!(ended.success(), "{said}");
    said
}

#[test]
fn terminal_prompts_for_missing_values() {
    let place = folder();
    let name = place.path().join("elbow");
    let given = ["--ratio", "9", "--lost-motion-arcmin", "15", "--rated-torque-Nm", "8"];
    let more = ["--rotor-inertia-kg-cm2", "0.32", "--no-load-torque-Nm", "0.05"];
    let said = said(&[&[text(&name)], &given[..], &more].concat(), b"soft\n1.8\n0.94\n");
    for words in ["torsional stiffness at the output in N m/arcmin", "`soft` is not a number; try again", "efficiency"]
    {
        assert!(said.contains(words), "{said}");
    }
    assert!(!said.contains("gear ratio"), "{said}");
    let file = fs::read_to_string(place.path().join("elbow.toml")).expect("it was written");
    assert!(file.contains("total_stiffness_N_m_per_arcmin = 1.8 # data sheet"), "{file}");
}

#[test]
fn terminal_prompts_for_kind_without_ratio() {
    let place = folder();
    let name = place.path().join("wrist");
    let given = ["--lost-motion-arcmin", "3", "--stiffness-Nm-per-arcmin", "20", "--rated-torque-Nm", "100"];
    let more = ["--rotor-inertia-kg-cm2", "1", "--no-load-torque-Nm", "0.1", "--efficiency", "0.85"];
    let said = said(&[&[text(&name)], &given[..], &more].concat(), b"worm\nequivalent\n59\n");
    assert!(
        said.contains("`worm` is neither planetary nor equivalent; try again") && said.contains("gear ratio"),
        "{said}"
    );
    let file = fs::read_to_string(place.path().join("wrist.toml")).expect("it was written");
    assert!(file.contains("[equivalent_gear]\nratio = 59.0 # data sheet"), "{file}");
}
