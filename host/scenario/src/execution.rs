//! One run: a plant, a controller, faults between them, period by period. What happened is kept by `ran`, what it is worth is
//! `figures`' business.

use std::fmt;
use std::time::Instant;

use reference::closed_loop::rivals::Knowledge;

use super::case::{Case, Designed};
use super::controller::{ControllerName, Driver};
use super::faults::HostFaults;
use super::file::TestFile;
use super::plant::{PlantName, plant};
use super::port::{ControllerPort, HostPort, Translator};
use super::ran::Ran;
use super::sender::Sender;
use report::failure::{Failure, Outcome};
use report::interruption;

/// Why a run ended early.
#[derive(Debug)]
pub enum RunError {
    /// It cannot even begin.
    Refused(Failure),
    /// Plant or controller left what is finite: a fault of what is tested.
    Broke(String),
    /// The test's time on the clock was up.
    TimedOut,
    /// By the user.
    Interrupted,
}

impl fmt::Display for RunError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(failure) => formatter.write_str(failure.message()),
            Self::Broke(why) => formatter.write_str(why),
            Self::TimedOut => formatter.write_str("the test's time on the clock was up"),
            Self::Interrupted => formatter.write_str("stopped by the user"),
        }
    }
}

impl From<Failure> for RunError {
    fn from(failure: Failure) -> Self {
        Self::Refused(failure)
    }
}

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
    let mut driver = driver(order.controller, case, designed.as_ref(), file.bandwidth, port)?;
    let run = Pass { file, case, order, designed: designed.as_ref(), deadline };
    if file.from_memory && order.controller.is_ours() {
        // Learning has noise of its own: what is remembered is the joint, not the noise.
        run.pass(&mut driver, !seed)?;
        driver.begin_again()?;
    }
    run.pass(&mut driver, seed)
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
        let joint = if order.without_gap { case.joint_without_gap() } else { case.truth.parameters.clone() };
        let mut plant = plant(order.plant, &joint, &case.train, case.disturbances.clone(), seed)?;
        let faults = if order.without_gap { &[] } else { file.faults.as_slice() };
        let mut faults = HostFaults::new(faults, seed, case);
        let mut sender = Sender::new(file, case, order.controller, designed);
        let rate = f64::from(case.truth.surroundings.control_rate);
        let period = 1.0 / rate;
        let periods = (file.duration * rate).round() as u64;
        let mut ran = Ran::begin(period, periods);
        for index in 0..periods {
            if index % LOOK == 0 {
                if Instant::now() > deadline {
                    return Err(RunError::TimedOut);
                }
                if interruption::requested() {
                    return Err(RunError::Interrupted);
                }
            }
            let time = index as f64 * period;
            let joint = plant.joint().clone();
            faults.wear(time, &joint, plant.inside().as_mut());
            let (number, set_point) = sender.at(time, index);
            let set_point = faults.receive(time, number, set_point);
            let seen = faults.sense(&plant.measure());
            let (command, answer) = driver.period(&seen, &set_point)?;
            if !command.is_finite() {
                return Err(RunError::Broke(format!("the controller's torque is not finite at t = {time:.4} s")));
            }
            plant
                .advance(faults.torque(time, command))
                .map_err(|error| RunError::Broke(format!("the plant at t = {time:.4} s: {error}")))?;
            ran.note(&plant, case, &faults, command, answer.as_ref());
            if ran.run.samples.last().is_some_and(|sample| !(sample.link + sample.mesh_force).is_finite()) {
                return Err(RunError::Broke(format!("the joint's motion is not finite at t = {time:.4} s")));
            }
        }
        Ok(ran)
    }
}

fn driver<'d>(
    name: ControllerName,
    case: &Case,
    designed: Option<&'d Designed>,
    bandwidth: f64,
    port: MakePort<'_>,
) -> Outcome<Driver<'d>> {
    let knowledge: Knowledge = case.knowledge();
    Ok(match designed {
        Some(designed) => {
            let around = &case.told_surroundings;
            let bits = [around.motor_encoder.bits, around.output_encoder.bits];
            let translator = Translator::new(designed.ticks, bits);
            match name {
                ControllerName::Probe => Driver::Probe(port(designed)?, translator),
                _ => Driver::Ours(port(designed)?, translator),
            }
        }
        None => Driver::rival(name, knowledge, bandwidth),
    })
}
