//! FMUs of a joint: structure of the archive, and their bits against the core's, by a master written in C.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use board::device::board::Board;
use c_library::library::{self, Library, Target};
use c_library::programs;
use fmu::archive::{self, File};
use fmu::export::contents;
use fmu::model::{Content, Fmi, Model};
use fmu::variables::{Kind, Role};
use host_tests::packages::{self, succeeded};
use model_core::compensation::{Command as Demand, Compensation, ImpedancePoint, Motion, Position};
use model_core::controller::design::ControlRequest;
use model_core::gears::Tables;
use model_core::numbers::digest::{START, chain};
use model_core::observer::{MAPPED, Observer};
use model_core::virtual_joint::{SurroundingsTable, VirtualJoint};
use parameters::{ContactState, Mesh};
use table_blob::{Blob, Gears};

static LIBRARY: LazyLock<Library> =
    LazyLock::new(|| library::build(Target::Host, "library", &|line| println!("{line}")).expect("a library"));

const TURN: f64 = std::f64::consts::TAU;

fn joint(name: &str) -> joint_file::JointFile {
    joint_file::named::load(Path::new(name)).expect("a joint").file
}

fn model(fmi: Fmi, content: Content, joint: &joint_file::JointFile) -> Model {
    Model::new(fmi, content, joint, ControlRequest::USUAL, &Board::emulated()).expect("tables")
}

fn text<'f>(files: &'f [File], name: &str) -> &'f str {
    let file = files.iter().find(|file| file.name == name).unwrap_or_else(|| panic!("no {name}"));
    std::str::from_utf8(&file.bytes).expect("a text")
}

/// Attributes of all elements of a name, in a well-formed document.
fn elements(xml: &str, name: &str) -> Vec<Vec<(String, String)>> {
    let mut reader = quick_xml::Reader::from_str(xml);
    let (mut found, mut depth) = (vec![], 0);
    loop {
        use quick_xml::events::Event;
        let event = reader.read_event().expect("well-formed");
        depth += match &event {
            Event::Start(_) => 1,
            Event::End(_) => -1,
            _ => 0,
        };
        match event {
            Event::Start(element) | Event::Empty(element) if element.name().as_ref() == name => {
                let attribute = |one: quick_xml::events::attributes::Attribute<'_>| {
                    (one.key.as_ref().to_owned(), one.value.clone().into_owned())
                };
                found.push(element.attributes().map(|one| attribute(one.expect("an attribute"))).collect());
            }
            Event::Eof => break,
            _ => {}
        }
    }
    assert_eq!(depth, 0, "every element is closed");
    found
}

fn value<'a>(attributes: &'a [(String, String)], name: &str) -> &'a str {
    attributes.iter().find(|(key, _)| key == name).map_or("", |(_, value)| value)
}

/// Description, binary and sources of both models and both versions belong together, and a second export gives equal bytes.
#[test]
fn archive_holds_what_its_description_names() {
    let q1 = joint("q1");
    let folder = tempfile::tempdir().expect("a folder");
    for (fmi, version) in [(Fmi::Two, "2.0"), (Fmi::Three, "3.0")] {
        for content in [Content::Plant, Content::Controller] {
            let model = model(fmi, content, &q1);
            let files = contents(&model, &LIBRARY).expect("an FMU");
            assert_eq!(files, contents(&model, &LIBRARY).expect("an FMU"), "equal bytes");
            let xml = text(&files, "modelDescription.xml");
            let root = &elements(xml, "fmiModelDescription")[0];
            assert_eq!(value(root, "fmiVersion"), version);
            let token = value(root, if fmi == Fmi::Two { "guid" } else { "instantiationToken" });
            assert!(
                text(&files, "extra/lostmotion/description.h").contains(token),
                "binary and description have one token"
            );
            let unit = &elements(xml, "CoSimulation")[0];
            let name = format!("/{}.so", value(unit, "modelIdentifier"));
            assert_eq!(
                files.iter().filter(|file| file.name.starts_with("binaries/") && file.name.ends_with(&name)).count(),
                1
            );
            let units: Vec<String> = elements(xml, "Unit").iter().map(|unit| value(unit, "name").to_owned()).collect();
            let variables: Vec<_> = ["ScalarVariable", "Float64", "Int32", "Boolean"]
                .iter()
                .flat_map(|name| elements(xml, name))
                .filter(|one| !value(one, "name").is_empty())
                .collect();
            assert_eq!(variables.len(), model.variables.len());
            assert!(variables.iter().all(|one| !value(one, "description").is_empty()));
            for real in ["Real", "Float64Type"].iter().flat_map(|name| elements(xml, name)) {
                assert!(units.iter().any(|unit| unit == value(&real, "unit")), "{real:?}");
            }
            let types = elements(xml, "Float64Type");
            for real in elements(xml, "Float64") {
                assert!(types.iter().any(|it| value(it, "name") == value(&real, "declaredType")), "{real:?}");
            }
            assert_structure(fmi, xml, &model);
            for name in ["rust/Cargo.toml", "rust/bindings/c/src/lib.rs", "CMakeLists.txt"] {
                text(&files, &format!("extra/lostmotion/{name}"));
            }
            assert!(
                !files.iter().any(|file| file.name.starts_with("sources/")),
                "no sources that C compilers build alone"
            );
            assert_eq!(value(root, "license"), "", "the license is the software's, not the joint's");
            assert!(
                text(&files, "documentation/licenses/license.txt").starts_with("This license applies to the software")
            );
            let archive = archive::pack(&files).expect("an archive");
            assert!(archive.starts_with(b"PK\x03\x04") && archive.len() < 4_000_000, "{} B", archive.len());
            let path = folder.path().join("joint.fmu");
            fs::write(&path, archive).expect("room");
            succeeded(Command::new("python3").args(["-m", "zipfile", "-t"]).arg(&path));
            let listed = succeeded(Command::new("python3").args(["-m", "zipfile", "-l"]).arg(&path));
            // A heading, then a line a file.
            assert_eq!(listed.lines().count(), files.len() + 1, "{listed}");
        }
    }
}

/// The model structure names the outputs in their order: by index from 1 in FMI 2, by value reference in FMI 3.
fn assert_structure(fmi: Fmi, xml: &str, model: &Model) {
    let (names, key, first) = match fmi {
        Fmi::Two => (["Unknown"].as_slice(), "index", 1),
        Fmi::Three => (["Output", "InitialUnknown"].as_slice(), "valueReference", 0),
    };
    let named: Vec<String> =
        names.iter().flat_map(|name| elements(xml, name)).map(|element| value(&element, key).to_owned()).collect();
    let outputs = || model.variables.iter().enumerate().filter(|(_, it)| it.role == Role::Output);
    let once: Vec<String> = outputs().map(|(index, _)| (index + first).to_string()).collect();
    assert_eq!(named, [once.clone(), once].concat());
}

/// Variables of equal name are connected from one FMU to the other: a name means one quantity in each direction.
#[test]
fn names_occur_once_per_direction() {
    let q1 = joint("q1");
    let all: Vec<_> = [Content::Plant, Content::Controller]
        .into_iter()
        .flat_map(|content| model(Fmi::Two, content, &q1).variables)
        .collect();
    for role in ["input", "output"] {
        let mut names: Vec<&str> = all
            .iter()
            .filter(|it| if role == "input" { matches!(it.role, Role::Input(_)) } else { it.role == Role::Output })
            .map(|it| it.name.as_str())
            .collect();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count, "{role}");
    }
    assert!(!all.iter().any(|it| it.name == "load_torque"), "two quantities: external_torque, estimated_load_torque");
}

/// A joint that cannot be exported gets a remedy that `joint export` accepts.
#[test]
fn impossible_design_names_accepted_remedy() {
    let mut slow = joint("q1");
    slow.surroundings.control_rate = 20;
    // Too slow for the plant, and not for observer and compensation.
    let mut coarse = joint("q1");
    coarse.surroundings.control_rate = 2000;
    for (joint, content, remedy) in [
        (&slow, Content::Plant, "`--rate`"),
        (&slow, Content::Controller, "`--rate` and `--bandwidth`"),
        (&coarse, Content::Plant, "--model controller"),
    ] {
        let failure =
            Model::new(Fmi::Two, content, joint, ControlRequest::USUAL, &Board::emulated()).expect_err("no design");
        let help = failure.help().expect("a remedy");
        assert!(help.contains(remedy), "{failure}");
        assert!(!help.contains("--without-plant"), "{failure}");
        assert!(content == Content::Controller || !help.contains("--bandwidth"), "{failure}");
    }
}

/// Token in a description.
fn token(model: &Model) -> String {
    let files = contents(model, &LIBRARY).expect("an FMU");
    let root = &elements(text(&files, "modelDescription.xml"), "fmiModelDescription")[0];
    value(root, if model.fmi == Fmi::Two { "guid" } else { "instantiationToken" }).to_owned()
}

/// Joints, rates, parts, versions and descriptions that differ never share a token.
#[test]
fn other_contents_get_other_token() {
    let [q1, mut other, mut faster] = [joint("q1"), joint("q1"), joint("q1")];
    other.parameters.sun_planet.half_backlash[0] *= 1.5;
    faster.surroundings.control_rate = 20_000;
    let mut described = model(Fmi::Two, Content::Plant, &q1);
    described.variables[1].description += ".";
    let mut tokens = [
        model(Fmi::Two, Content::Plant, &q1),
        model(Fmi::Two, Content::Plant, &other),
        model(Fmi::Two, Content::Plant, &faster),
        model(Fmi::Two, Content::Controller, &q1),
        model(Fmi::Three, Content::Plant, &q1),
        described,
    ]
    .map(|model| token(&model))
    .to_vec();
    tokens.sort_unstable();
    tokens.dedup();
    assert_eq!(tokens.len(), 6, "{tokens:?}");
}

/// Requirements of the command reach the controller of an FMU.
#[test]
fn controller_is_designed_as_requested() {
    let design = |request| {
        let model =
            Model::new(Fmi::Two, Content::Controller, &joint("q1"), request, &Board::emulated()).expect("tables");
        let blob = Blob::open(&model.tables.words).expect("tables");
        let bandwidth = model.tables.made_from[1].contains("bandwidth 40 rad/s");
        (blob.observer().expect("a part").counts.has_output, bandwidth)
    };
    let usual = ControlRequest::USUAL;
    assert_eq!(design(usual), (true, false));
    assert_eq!(design(ControlRequest { output_encoder: false, ..usual }), (false, false));
    assert_eq!(design(ControlRequest { bandwidth: Some(40.0), ..usual }), (true, true));
}

/// A byte that moves from a name to a content, or to the next file, changes the token.
#[test]
fn moved_byte_changes_token() {
    let model = model(Fmi::Two, Content::Controller, &joint("q1"));
    let tokens = [[("ab", "c"), ("d", "")], [("a", "bc"), ("d", "")], [("ab", ""), ("c", "d")]]
        .map(|files| model.token(&files.map(|(name, bytes)| File::text(name, bytes))));
    assert!(tokens[0] != tokens[1] && tokens[1] != tokens[2] && tokens[0] != tokens[2], "{tokens:?}");
}

/// References of the variables for the master, as a header.
fn references(plant: &Model, controller: &Model) -> String {
    let mut out = format!("#define RATE_HZ {:?}\nenum {{\n", f64::from(plant.rate));
    for (prefix, model) in [("PLANT", plant), ("CONTROLLER", controller)] {
        for (index, variable) in model.variables.iter().enumerate().filter(|(_, it)| !it.name.contains('[')) {
            out += &format!("    {prefix}_{} = {index},\n", variable.name);
        }
    }
    let outputs = || plant.variables.iter().enumerate().filter(|(_, it)| it.role == Role::Output);
    let kind = |kind| match kind {
        Kind::Real(_) => 'r',
        Kind::Integer => 'i',
        Kind::Boolean => 'b',
    };
    out += "};\nstatic const unsigned plant_outputs[] = {";
    out += &outputs().map(|(index, _)| format!("{index}, ")).collect::<String>();
    out += "};\nstatic const char plant_kinds[] = {";
    out += &outputs().map(|(_, it)| format!("'{}', ", kind(it.kind))).collect::<String>();
    out + "};\n"
}

fn side(contact: ContactState) -> f64 {
    match contact {
        ContactState::Separated => 0.0,
        ContactState::DriveSide => 1.0,
        ContactState::BackSide => -1.0,
    }
}

/// Outputs of the plant in the order of its variables, in f64 from the core's f32.
fn outputs<const N: usize>(joint: &VirtualJoint<'_, f32, N>, ratio: f64, meshes: [&Mesh; 2]) -> Vec<f64> {
    let (motion, acting, samples) = (joint.outputs(), joint.acting(), joint.samples());
    let output = samples.output.expect("a reading");
    let carrier = (f64::from(motion.carrier_turns) + f64::from(motion.carrier_fraction) / 4_294_967_296.0) * TURN;
    let mut all = vec![
        ratio * carrier + f64::from(motion.motor_offset),
        carrier + f64::from(motion.link_offset),
        joint.motor_speed().into(),
        joint.link_speed().into(),
        motion.carrier_speed.into(),
        motion.gap.into(),
        motion.wind_up.into(),
        acting.air_gap.into(),
        acting.drive.into(),
        acting.load.into(),
        samples.motor.counts.into(),
        samples.time.wrapping_sub(samples.motor.time).into(),
        1.0,
        output.counts.into(),
        samples.time.wrapping_sub(output.time).into(),
    ];
    for (kind, mesh) in meshes.into_iter().enumerate() {
        all.extend(motion.deflections[kind].iter().zip(&mesh.half_backlash).map(|(deflection, half)| {
            let deflection = f64::from(*deflection);
            mesh.mean_stiffness * (deflection - deflection.clamp(-half, *half))
        }));
        all.extend(motion.contacts[kind].iter().map(|contact| side(*contact)));
    }
    all
}

fn add(digest: u64, values: &[f64]) -> u64 {
    values.iter().fold(digest, |digest, value| chain(digest, value.to_bits()))
}

/// Torque of the master in a period [N m].
fn torque(period: i32) -> f64 {
    f64::from(period * 37 % 101 - 50) * 0.02
}

/// Digest of the plant alone, with outputs every `many` periods.
fn plant_digest<const N: usize>(
    gears: &Tables<f32, N>,
    around: &SurroundingsTable<f32>,
    file: &joint_file::JointFile,
    ratio: f64,
    many: i32,
) -> u64 {
    let mut joint = VirtualJoint::new(gears, around);
    let meshes = [&file.parameters.sun_planet, &file.parameters.ring_planet];
    (0..2000).step_by(many as usize).fold(START, |digest, period| {
        (0..many).for_each(|_| joint.advance(torque(period) as f32, torque(period / 7) as f32));
        add(digest, &outputs(&joint, ratio, meshes))
    })
}

/// Digest of the closed loop: torque, estimated gap, angle of the link.
fn loop_digest<const N: usize>(gears: &Tables<f32, N>, around: &SurroundingsTable<f32>, blob: &Blob<'_>) -> u64 {
    let mut joint = VirtualJoint::new(gears, around);
    let mut observer = Observer::<f32, MAPPED>::new(blob.observer().expect("a table"));
    let mut compensation = Compensation::new(blob.compensation().expect("a table"));
    (0..6000_i32).fold(START, |digest, period| {
        let place = period % 1000;
        let angle = 0.3 * f64::from(if place < 500 { place } else { 1000 - place }) / 500.0;
        let turns = angle / TURN;
        let position = Position { turns: turns as i32, fraction: (turns - f64::from(turns as i32)) as f32 };
        let demand = if period / 2000 % 2 == 0 {
            Demand::Position { now: Motion { position, speed: 0.0, acceleration: 0.0 }, ahead: None }
        } else {
            Demand::Impedance(ImpedancePoint { position, speed: 0.0, torque: 0.0, stiffness: 100.0, damping: 3.0 })
        };
        let mut samples = joint.samples();
        if place >= 900 {
            samples.output = None;
        }
        let estimates = *observer.step(&samples);
        let shaped = compensation.step(&estimates, &demand);
        joint.advance(shaped.torque, 0.0);
        let motion = joint.outputs();
        let carrier = (f64::from(motion.carrier_turns) + f64::from(motion.carrier_fraction) / 4_294_967_296.0) * TURN;
        let link = carrier + f64::from(motion.link_offset);
        add(digest, &[shaped.torque.into(), estimates.gap.value.into(), link])
    })
}

/// Periods of the step that begins with a period, in the uneven loop.
fn many(period: i32) -> i32 {
    if period % 12 == 9 { 3 } else { 1 }
}

/// Digest of a closed loop whose every tenth step has three periods, with readings of some age, motion ahead and a torque at the link.
fn uneven_loop_digest<const N: usize>(
    gears: &Tables<f32, N>,
    around: &SurroundingsTable<f32>,
    blob: &Blob<'_>,
    ticks: u32,
) -> u64 {
    let mut joint = VirtualJoint::new(gears, around);
    let mut observer = Observer::<f32, MAPPED>::new(blob.observer().expect("a table"));
    let mut compensation = Compensation::new(blob.compensation().expect("a table"));
    let (mut command, mut moved) = (0.0_f32, 0);
    let begins = std::iter::successors(Some(0_i32), |period| Some(period + many(*period)));
    let digest = begins.take_while(|period| *period < 6000).fold(START, |digest, period| {
        let place = period % 1000;
        let angle = 0.3 * f64::from(if place < 500 { place } else { 1000 - place }) / 500.0;
        let position = |angle: f64| {
            let turns = angle / TURN;
            Position { turns: turns as i32, fraction: (turns - f64::from(turns as i32)) as f32 }
        };
        let demand = if period / 3000 % 2 == 0 {
            let ahead = Motion { position: position(angle + 0.01), speed: 0.5, acceleration: 2.0 };
            Demand::Position {
                now: Motion { position: position(angle), speed: 0.25, acceleration: 1.0 },
                ahead: (period / 1500 % 2 != 0).then_some(ahead),
            }
        } else {
            Demand::Impedance(ImpedancePoint {
                position: position(angle),
                speed: 0.25,
                torque: 0.5,
                stiffness: 100.0,
                damping: 3.0,
            })
        };
        let began = joint.samples();
        let mut gap = 0.0;
        for later in 0..many(period) as u32 {
            let mut samples = began;
            samples.time = began.time.wrapping_add(later * ticks);
            samples.motor.time = began.time.wrapping_sub(period as u32 % 300);
            samples.output.as_mut().expect("a reading").time = began.time.wrapping_sub(period as u32 % 200 * 2);
            samples.torque = command;
            let estimates = *observer.step(&samples);
            command = compensation.step(&estimates, &demand).torque;
            gap = estimates.gap.value;
        }
        moved += i32::from(command != 0.0);
        (0..many(period)).for_each(|_| joint.advance(command, (0.1 * torque(period / 7)) as f32));
        let motion = joint.outputs();
        let carrier = (f64::from(motion.carrier_turns) + f64::from(motion.carrier_fraction) / 4_294_967_296.0) * TURN;
        add(digest, &[command.into(), gap.into(), carrier + f64::from(motion.link_offset)])
    });
    assert!(moved >= 20, "torque in {moved} of 5000 steps");
    digest
}

/// The master's output for a joint: digests of the FMUs.
fn master(fmi: Fmi, joint: &joint_file::JointFile) -> (Vec<String>, Model) {
    let folder = tempfile::tempdir().expect("a folder");
    let [plant, controller] = [Content::Plant, Content::Controller].map(|content| model(fmi, content, joint));
    let path = |name: &str| folder.path().join(name);
    let mut arguments = vec![];
    for model in [&plant, &controller] {
        let files = contents(model, &LIBRARY).expect("an FMU");
        let binary = files.iter().find(|file| file.name.starts_with("binaries/")).expect("a binary");
        let place = path(&model.identifier);
        fs::write(&place, &binary.bytes).expect("room");
        let root = elements(text(&files, "modelDescription.xml"), "fmiModelDescription");
        let token = value(&root[0], if fmi == Fmi::Two { "guid" } else { "instantiationToken" });
        arguments.extend([place.to_str().expect("a text").to_owned(), token.to_owned()]);
    }
    fs::write(path("references.h"), references(&plant, &controller)).expect("room");
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut compiler = Command::new("gcc");
    compiler.args(programs::WARNINGS).args(["-std=c11", "-O1", "-Wno-pedantic", "-Wno-unused-function"]);
    compiler.arg(if fmi == Fmi::Two { "-DFMI=2" } else { "-DFMI=3" }).arg("-I").arg(folder.path());
    compiler.arg("-I").arg(own.join("c")).arg(own.join("tests/master.c")).args(["-ldl", "-o"]).arg(path("master"));
    let compiled = compiler.output().expect("gcc");
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let lines = programs::run(&path("master"), &arguments).expect("no call is answered wrongly");
    (lines, plant)
}

/// Wrong calls are refused with their reason, a saved state is repeated, a thousand instances do not disturb one another, and
/// plant and closed loop have the core's bits, for each kind of gear.
#[test]
fn fmus_match_core_bitwise() {
    for (name, fmi) in [("q1", Fmi::Two), ("q1", Fmi::Three), ("s1", Fmi::Two), ("d2", Fmi::Three)] {
        let file = joint(name);
        let (lines, plant) = master(fmi, &file);
        let blob = Blob::open(&plant.tables.words).expect("tables");
        let (gears, around) = blob.plant().expect("a plant");
        let digests = match gears {
            Gears::One(gears) => all_digests(gears, around, &file, &plant, &blob),
            Gears::Three(gears) => all_digests(gears, around, &file, &plant, &blob),
            Gears::Four(gears) => all_digests(gears, around, &file, &plant, &blob),
            Gears::Five(gears) => all_digests(gears, around, &file, &plant, &blob),
        };
        let found: Vec<_> =
            ["single ", "tens ", "loop ", "uneven "].map(|word| programs::value_after(&lines, word)).into();
        assert_eq!(found, digests.map(|digest| Some(format!("{digest:016x}"))), "{name}: {lines:?}");
    }
}

fn all_digests<const N: usize>(
    gears: &Tables<f32, N>,
    around: &SurroundingsTable<f32>,
    file: &joint_file::JointFile,
    plant: &Model,
    blob: &Blob<'_>,
) -> [u64; 4] {
    [
        plant_digest(gears, around, file, plant.ratio, 1),
        plant_digest(gears, around, file, plant.ratio, 10),
        loop_digest(gears, around, blob),
        uneven_loop_digest(gears, around, blob, plant.ticks),
    ]
}

/// FMPy finds no problem, simulates, repeats a saved state, holds 1,000 instances, and reads the core's bits.
#[test]
#[ignore = "installs 90 MB: cargo test -p fmu -- --ignored"]
fn fmpy_reads_the_core_bits() {
    let (lists, all) = (Path::new(env!("CARGO_MANIFEST_DIR")).join("tests"), Path::new(env!("CARGO_TARGET_TMPDIR")));
    let python = packages::python(all, &lists, "fmpy");
    let q1 = joint("q1");
    let folder = tempfile::tempdir().expect("a folder");
    for (fmi, version) in [(Fmi::Two, "2"), (Fmi::Three, "3")] {
        let models = [Content::Plant, Content::Controller].map(|content| model(fmi, content, &q1));
        let paths = models.each_ref().map(|model| {
            let path = folder.path().join(format!("{}_{version}.fmu", model.identifier));
            let archive = archive::pack(&contents(model, &LIBRARY).expect("an FMU")).expect("an archive");
            fs::write(&path, archive).expect("room");
            path
        });
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fmpy_importer.py");
        let said = succeeded(Command::new(&python).arg(script).arg(version).args(&paths));
        println!("{said}");
        let blob = Blob::open(&models[0].tables.words).expect("tables");
        let (Gears::Three(gears), around) = blob.plant().expect("a plant") else { panic!("Q1 has three planets") };
        let expected = plant_digest(gears, around, &q1, models[0].ratio, 1);
        assert!(said.contains(&format!("single {expected:016x}\n")), "{said}");
        assert!(said.contains("1000 instances"), "{said}");
    }
}

/// fmi-sim, an importer with no code of FMPy's, steps the plant under constant torques; each of its lines has the core's bits.
#[test]
#[ignore = "builds fmi-sim from its sources, some minutes: cargo test -p fmu fmi_sim -- --ignored"]
fn fmi_sim_reads_the_core_bits() {
    const PERIODS: usize = 3000;
    let list = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fmi-sim.txt");
    let package = fs::read_to_string(&list).expect("a list");
    let place = packages::packages(Path::new(env!("CARGO_TARGET_TMPDIR")), "fmi-sim", &list, "bin/fmi-sim", |place| {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut install = Command::new(cargo);
        install.args(["install", "--quiet", "--locked", package.trim(), "--root"]).arg(place);
        succeeded(install.arg("--target-dir").arg(place.join("build")));
        fs::remove_dir_all(place.join("build")).expect("a folder of ours");
    });
    let (q1, folder) = (joint("q1"), tempfile::tempdir().expect("a folder"));
    let period = 1.0 / f64::from(q1.surroundings.control_rate);
    for (fmi, version) in [(Fmi::Two, "2"), (Fmi::Three, "3")] {
        let model = model(fmi, Content::Plant, &q1);
        let [unit, found] = ["fmu", "csv"].map(|kind| folder.path().join(format!("{version}.{kind}")));
        let archive = archive::pack(&contents(&model, &LIBRARY).expect("an FMU")).expect("an archive");
        fs::write(&unit, archive).expect("room");
        let mut simulate = Command::new(place.join("bin/fmi-sim"));
        simulate.arg("--model").arg(&unit).arg("--output-file").arg(&found).args(["co-simulation", "--init-values"]);
        simulate.args(["motor_torque=0.75", "--init-values", "external_torque=-0.5", "--output-interval"]);
        succeeded(simulate.arg(period.to_string()).arg("-f").arg((PERIODS as f64 * period).to_string()));
        let found = fs::read_to_string(found).expect("a table");
        let mut lines = found.lines();
        let names: Vec<&str> = lines.next().expect("a heading").split(',').skip(1).collect();
        let wanted: Vec<&str> =
            model.variables.iter().filter(|it| it.role == Role::Output).map(|it| it.name.as_str()).collect();
        assert_eq!(names, wanted);
        let blob = Blob::open(&model.tables.words).expect("tables");
        let (Gears::Three(gears), around) = blob.plant().expect("a plant") else { panic!("Q1 has three planets") };
        let mut joint = VirtualJoint::new(gears, around);
        let meshes = [&q1.parameters.sun_planet, &q1.parameters.ring_planet];
        let number = |text: &str| match text {
            "true" => 1.0,
            "false" => 0.0,
            _ => text.parse().unwrap_or_else(|_| panic!("{text} is no number")),
        };
        for (step, line) in lines.by_ref().take(PERIODS + 1).enumerate() {
            let values: Vec<f64> = line.split(',').skip(1).map(number).collect();
            assert_eq!(values, outputs(&joint, model.ratio, meshes), "FMI {version}, step {step}: {line}");
            joint.advance(0.75, -0.5);
        }
        assert!(joint.outputs().carrier_speed != 0.0, "the joint moved");
        assert_eq!(found.lines().count(), PERIODS + 2, "a heading, the start, a line a period");
    }
}
