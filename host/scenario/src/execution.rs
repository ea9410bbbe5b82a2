//! One run of a test file: a case on the rig under a controller, for the test's duration.

use std::time::Instant;

pub use live::Watch;
use model_core::compensation::CompensationTables;
use model_core::compensation::design::design_compensation;
use model_core::observer::design::observer_settings;

use super::case::{Case, Designed};
use super::controller::ControllerName;
use super::file::TestFile;
use super::plant::PlantName;
use super::port::{ControllerPort, HostPort, Translator};
use super::random::RandomStream;
use super::rig::{ActiveController, Rig, RunError, Setup, TrueStateCompensation};
use super::run_history::RunHistory;
use super::set_point_source::SetPointSource;
use parameters::JointParameters;
use reference::joint::{RelativeState, Start, mean_half_backlash};
use report::failure::{Failure, Outcome};
use report::interruption;
use simulation::sim::live_view::description;

/// Controller and plant of a run.
#[derive(Debug, Clone, Copy)]
pub struct RunSpec {
    /// Controller.
    pub controller: ControllerName,
    /// Plant.
    pub plant: PlantName,
    /// Runs without backlash and without faults, as the reference of an impedance's deviation.
    pub without_gap: bool,
}

/// Share of the runs that start on a flank [-]; the others start in the open gap.
const ON_FLANK_SHARE: f64 = 0.33;

/// Control periods between checks of the deadline.
const PERIODS_BETWEEN_CHECKS: u64 = 500;

/// Creates the port to observer and compensation of a run.
pub type MakePort<'p> = &'p dyn for<'d> Fn(&'d Designed) -> Outcome<Box<dyn ControllerPort + 'd>>;

/// Runs one controller in one case on the host.
pub fn execute(
    file: &TestFile,
    case: &Case,
    seed: u64,
    spec: RunSpec,
    watch: Watch<'_>,
) -> Result<RunHistory, RunError> {
    execute_with(file, case, seed, spec, watch, &host_port)
}

/// Runs a compensation in one case on the host with given tables; cases that differ only in seed or true joint can
/// share the tables.
pub fn execute_designed(
    file: &TestFile,
    case: &Case,
    seed: u64,
    spec: RunSpec,
    deadline: Instant,
    designed: &Designed,
) -> Result<RunHistory, RunError> {
    run(file, case, seed, spec, Watch::until(deadline), Some(designed), &host_port)
}

/// Port to observer and compensation in this process.
fn host_port(designed: &Designed) -> Outcome<Box<dyn ControllerPort + '_>> {
    Ok(Box::new(HostPort::new(designed)))
}

/// Runs one controller in one case, with observer and compensation behind the given port.
pub fn execute_with(
    file: &TestFile,
    case: &Case,
    seed: u64,
    spec: RunSpec,
    watch: Watch<'_>,
    port: MakePort<'_>,
) -> Result<RunHistory, RunError> {
    let designed = if spec.controller.is_compensation() { Some(case.design(file)?) } else { None };
    run(file, case, seed, spec, watch, designed.as_ref(), port)
}

fn run(
    file: &TestFile,
    case: &Case,
    seed: u64,
    spec: RunSpec,
    watch: Watch<'_>,
    designed: Option<&Designed>,
    port: MakePort<'_>,
) -> Result<RunHistory, RunError> {
    let from_truth = (spec.controller == ControllerName::TrueStateCompensation)
        .then(|| design_from_truth(file, case))
        .transpose()?;
    let mut controller = match (designed, &from_truth) {
        (Some(designed), _) => compensation_controller(spec.controller, file, case, designed, port)?,
        (None, Some(tables)) => {
            ActiveController::TrueState(Box::new(TrueStateCompensation::new(tables, &case.truth.parameters)))
        }
        (None, None) => ActiveController::rival(spec.controller, case.knowledge(), case.bandwidth(file)?),
    };
    let run = RunContext { file, case, spec, designed, watch, mounting_seed: None };
    if file.from_memory && spec.controller.is_compensation() {
        // The first run has other noise and another place in the gap, so that the memory holds the joint alone.
        RunContext { watch: watch.named(None), mounting_seed: Some(seed), ..run }.execute(&mut controller, !seed)?;
        let memory_at_start = controller.restart_from_memory()?;
        return Ok(RunHistory { memory_at_start, ..run.execute(&mut controller, seed)? });
    }
    run.execute(&mut controller, seed)
}

/// Plant, motion and faults of a case.
pub fn setup(file: &TestFile, case: &Case, seed: u64, spec: RunSpec) -> Setup {
    let joint = if spec.without_gap { case.joint_without_gap() } else { case.truth.parameters.clone() };
    Setup {
        plant: spec.plant,
        start: Start::Relative(start_state(&joint, seed)),
        disturbances: case.disturbances.clone(),
        faults: if spec.without_gap { Vec::new() } else { file.faults.clone() },
        ..Setup::new(joint, case.train.clone(), case.motion.clone(), file.duration, seed)
    }
}

/// Start at rest at a random place in the gap, every third start on a flank, like a joint after power-off. Both meshes
/// of a planet share the gap.
fn start_state(joint: &JointParameters, seed: u64) -> RelativeState {
    let mut stream = RandomStream::new(seed, "start in the gap");
    let (on_flank, place) = (stream.uniform() < ON_FLANK_SHARE, 2.0 * stream.uniform() - 1.0);
    let mesh = mean_half_backlash(joint) * if on_flank { place.signum() } else { place };
    let centred = RelativeState::centred(joint.geometry.planets);
    RelativeState { sun_planet: centred.sun_planet.iter().map(|_| mesh).collect(), gap: 2.0 * mesh, ..centred }
}

/// A run from its first period to its last.
#[derive(Clone, Copy)]
struct RunContext<'r> {
    file: &'r TestFile,
    case: &'r Case,
    spec: RunSpec,
    designed: Option<&'r Designed>,
    watch: Watch<'r>,
    /// Seed of the place in the gap at which the encoders were mounted; `None` for that of the run.
    mounting_seed: Option<u64>,
}

impl RunContext<'_> {
    fn execute(&self, controller: &mut ActiveController<'_>, seed: u64) -> Result<RunHistory, RunError> {
        let Self { file, case, spec, designed, watch, mounting_seed } = *self;
        let mut setup = setup(file, case, seed, spec);
        setup.mounting = mounting_seed.map(|seed| Start::Relative(start_state(&setup.joint, seed)));
        let rig = Rig::new(&setup)?;
        let mut set_points = SetPointSource::new(file, case, spec.controller, designed);
        let mut history = RunHistory::begin(rig.period(), rig.periods());
        // The compensation has a translator of its own; this one logs the readings as they arrive.
        let mut translator = translator(file, case);
        let mut feed = watch.claim(|name| description(1, name, &case.truth.parameters));
        rig.run(controller, &mut set_points, &mut |period| {
            if period.index % PERIODS_BETWEEN_CHECKS == 0 && watch.is_over() {
                return Err(RunError::TimedOut);
            }
            if interruption::requested() {
                return Err(RunError::Interrupted);
            }
            history.add_period(period, &mut translator);
            if let Some(feed) = &mut feed {
                feed.publish(period.plant.joint().time, || period.live_sample());
            }
            Ok(())
        })?;
        history.memory = controller.memory();
        Ok(history)
    }
}

fn compensation_controller<'d>(
    name: ControllerName,
    file: &TestFile,
    case: &Case,
    designed: &'d Designed,
    port: MakePort<'_>,
) -> Outcome<ActiveController<'d>> {
    let translator = translator(file, case);
    Ok(match name {
        ControllerName::Probe => ActiveController::Probe(port(designed)?, translator),
        _ => ActiveController::Compensation(port(designed)?, translator),
    })
}

/// Translator to the samples of an observer of the nominal joint, and from the set-points of a file.
pub fn translator(file: &TestFile, case: &Case) -> Translator {
    let surroundings = &case.nominal_surroundings;
    let settings = observer_settings(surroundings);
    let turns = [surroundings.motor_encoder, surroundings.output_encoder].map(|encoder| encoder.counts_per_turn);
    Translator::new(settings.clock_rate / settings.control_rate, turns, &case.zeros, file.output_encoder)
}

/// Designs the compensation that is fed with the true state, for the true joint.
fn design_from_truth(file: &TestFile, case: &Case) -> Outcome<CompensationTables<f64>> {
    let joint = &case.truth.parameters;
    design_compensation(joint, &case.compensation_settings_for(file, case.bandwidth(file)?))
        .map_err(|error| Failure::new(format!("no compensation can be designed for joint `{}`: {error}", joint.name)))
}
