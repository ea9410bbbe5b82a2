//! The compensation in closed loop with the drive train, against the rivals, on a few seeds: tests of `hil/`, some with another joint, held
//! to tighter bounds than those of the files. The long forms are ignored by default. The observer alone is tested in `observer`.

mod bad_input;
mod blow;
mod braking;
mod coarse_encoder;
mod control_rate;
mod holding;
mod impedance;
mod monte_carlo;
mod page;
mod plain;
mod position;
mod power_up;
mod stepping;
mod width;

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use parameters::{JointParameters, Surroundings};
use reference::closed_loop::Figures;
use reference::drive_train::DriveTrainParameters;
use scenario::case::Case;
use scenario::controller::ControllerName;
use scenario::execution::{RunSpec, Watch, execute};
use scenario::plant::PlantName;
use scenario::run_history::RunHistory;
use scenario::suite::{Test, from_text};

/// Time limit of a run, which takes seconds.
const RUN_TIME_MAX: Duration = Duration::from_secs(3600);

/// Test of `hil/` by name, unchanged.
fn shipped(name: &str) -> Test {
    changed(name, "", "")
}

/// Test of `hil/` with lines above it, such as another joint, and below it, such as further known parameters.
fn changed(name: &str, above: &str, below: &str) -> Test {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../hil");
    let name = format!("{name}.toml");
    let text = fs::read_to_string(folder.join(&name)).expect("a shipped test");
    from_text(&name, &format!("{above}\n{text}\n{below}\n"), &folder, PlantName::Reference).expect("a good test")
}

/// Case of a seed with a joint of `scenarios` and a drive train in place of the file's. Dry friction and weight of the link stay those of
/// the file. Such joints have no ripple and no errors except those of the test, and their encoder errors start at the start angle: bounds
/// that separate causes were set on them.
fn case_of(test: &Test, seed: u64, joint: &JointParameters, train: &DriveTrainParameters) -> Case {
    let mut case = test.case(seed).expect("a case of the test");
    let mut train = train.clone();
    let file_surroundings = &case.train.surroundings;
    train.surroundings.load_friction.coulomb = file_surroundings.load_friction.coulomb;
    train.surroundings.gravity_torque = file_surroundings.gravity_torque;
    case.truth.parameters = joint.clone();
    case.nominal = joint.clone();
    for mesh in [&mut case.nominal.sun_planet, &mut case.nominal.ring_planet] {
        mesh.half_backlash.iter_mut().for_each(|half| *half *= case.width_guess);
    }
    case.nominal_surroundings = train.surroundings;
    case.train = train;
    case
}

/// Drive train of L1: no friction, weight or errors; one period of delay; L1's torque limit.
fn l1_train() -> DriveTrainParameters {
    Surroundings { delay: 1.0, torque_limit: 120.0, ..Surroundings::ideal() }.into()
}

/// Runs a controller through a test on the reference.
fn run(test: &Test, seed: u64, controller: ControllerName) -> RunHistory {
    run_in(test, &test.case(seed).expect("a case of the test"), seed, on_reference(controller))
}

/// Runs a controller through a test on a given case.
fn run_in(test: &Test, case: &Case, seed: u64, spec: RunSpec) -> RunHistory {
    execute(&test.file, case, seed, spec, Watch::until(Instant::now() + RUN_TIME_MAX)).expect("the test runs")
}

fn on_reference(controller: ControllerName) -> RunSpec {
    RunSpec { controller, plant: PlantName::Reference, without_gap: false }
}

fn on_core(controller: ControllerName) -> RunSpec {
    RunSpec { controller, plant: PlantName::Core, without_gap: false }
}

/// Figures of a controller from the test's settling time on.
fn figures(test: &Test, seed: u64, controller: ControllerName) -> Figures {
    Figures::of(&run(test, seed, controller).run, test.file.settle)
}

/// Figures of a controller on a given case.
fn figures_in(test: &Test, case: &Case, seed: u64, controller: ControllerName) -> Figures {
    Figures::of(&run_in(test, case, seed, on_reference(controller)).run, test.file.settle)
}
