//! One run of a test file: a case of it is put on the rig, with a controller by its name, until the test's time is up.

use std::time::Instant;

use model_core::compensation::CompensationTables;
use model_core::compensation::design::design_compensation;

use super::case::{Case, Designed};
use super::controller::ControllerName;
use super::file::TestFile;
use super::plant::PlantName;
use super::port::{ControllerPort, HostPort, Translator};
use super::ran::Ran;
use super::rig::{Driver, PerfectSight, Rig, RunError, Setup};
use super::sender::Sender;
use report::failure::{Failure, Outcome};
use report::interruption;

/// Who shall control what.
#[derive(Debug, Clone, Copy)]
pub struct Order {
    /// Who.
    pub controller: ControllerName,
    /// What.
    pub plant: PlantName,
    /// On teeth without a gap and without faults: what an impedance's deviation is measured from.
    pub without_gap: bool,
}

/// Periods between looks at the clock.
const LOOK: u64 = 500;

/// Makes the port to observer and compensation of a run.
pub type MakePort<'p> = &'p dyn for<'d> Fn(&'d Designed) -> Outcome<Box<dyn ControllerPort + 'd>>;

/// Runs one controller in one case, all of it on the host.
pub fn execute(file: &TestFile, case: &Case, seed: u64, order: Order, deadline: Instant) -> Result<Ran, RunError> {
    execute_with(file, case, seed, order, deadline, &|designed| Ok(Box::new(HostPort::new(designed))))
}

/// Runs one controller in one case; observer and compensation are where their port leads.
pub fn execute_with(
    file: &TestFile,
    case: &Case,
    seed: u64,
    order: Order,
    deadline: Instant,
    port: MakePort<'_>,
) -> Result<Ran, RunError> {
    let designed = if order.controller.is_ours() { Some(case.design(file)?) } else { None };
    let perfect = (order.controller == ControllerName::PerfectSight).then(|| design_perfect(file, case)).transpose()?;
    let mut driver = match (&designed, &perfect) {
        (Some(designed), _) => ours(order.controller, case, designed, port)?,
        (None, Some(tables)) => Driver::Perfect(Box::new(PerfectSight::new(tables, &case.truth.parameters))),
        (None, None) => Driver::rival(order.controller, case.knowledge(), file.bandwidth),
    };
    let run = Pass { file, case, order, designed: designed.as_ref(), deadline };
    if file.from_memory && order.controller.is_ours() {
        // Learning has noise of its own: what is remembered is the joint, not the noise.
        run.pass(&mut driver, !seed)?;
        driver.begin_again()?;
    }
    run.pass(&mut driver, seed)
}

/// What the loop of a case is closed around.
pub fn setup(file: &TestFile, case: &Case, seed: u64, order: Order) -> Setup {
    let joint = if order.without_gap { case.joint_without_gap() } else { case.truth.parameters.clone() };
    Setup {
        plant: order.plant,
        disturbances: case.disturbances.clone(),
        faults: if order.without_gap { Vec::new() } else { file.faults.clone() },
        ..Setup::new(joint, case.train.clone(), case.motion.clone(), file.duration, seed)
    }
}

/// A run from its first period to its last.
struct Pass<'r> {
    file: &'r TestFile,
    case: &'r Case,
    order: Order,
    designed: Option<&'r Designed>,
    deadline: Instant,
}

impl Pass<'_> {
    fn pass(&self, driver: &mut Driver<'_>, seed: u64) -> Result<Ran, RunError> {
        let Self { file, case, order, designed, deadline } = *self;
        let rig = Rig::new(&setup(file, case, seed, order))?;
        let mut sender = Sender::new(file, case, order.controller, designed);
        let mut ran = Ran::begin(rig.period(), rig.periods());
        rig.run(driver, &mut sender, &mut |period| {
            if period.index % LOOK == 0 {
                if Instant::now() > deadline {
                    return Err(RunError::TimedOut);
                }
                if interruption::requested() {
                    return Err(RunError::Interrupted);
                }
            }
            ran.note(period);
            Ok(())
        })?;
        Ok(ran)
    }
}

fn ours<'d>(name: ControllerName, case: &Case, designed: &'d Designed, port: MakePort<'_>) -> Outcome<Driver<'d>> {
    let around = &case.told_surroundings;
    let bits = [around.motor_encoder.bits, around.output_encoder.bits];
    let translator = Translator::new(designed.ticks, bits);
    Ok(match name {
        ControllerName::Probe => Driver::Probe(port(designed)?, translator),
        _ => Driver::Ours(port(designed)?, translator),
    })
}

/// Who sees the truth is designed to it.
fn design_perfect(file: &TestFile, case: &Case) -> Outcome<CompensationTables<f64>> {
    let joint = &case.truth.parameters;
    design_compensation(joint, &case.settings_of_law(file))
        .map_err(|error| Failure::new(format!("no compensation can be designed for joint `{}`: {error}", joint.name)))
}
