//! Moves a joint by a named scheme and shows every tick to whoever asked. What is kept of a tick, and for how long, is
//! the observer's business.

use std::ops::ControlFlow;

use cpu_time::ThreadTime;
use link::messages::Command;
use model_core::gears::design::{DesignError, Effort, design_scheme};
use model_core::gears::{Model, Scheme, Tables, Torques};
use model_core::numbers::Real;
use parameters::{DeadZone, JointParameters};
use reference::joint::{Reference, ReferenceError, Start};

use super::moment::{Moment, Reader, Teeth};
use super::scheme::SchemeName;
use super::start::core_state;
use report::failure::{Failure, Outcome};

/// A run, whichever scheme makes it.
#[derive(Debug, Clone, Copy)]
pub struct Run<'a> {
    /// The joint.
    pub joint: &'a JointParameters,
    /// Steps a second [Hz].
    pub tick_rate: u32,
    /// Length in ticks.
    pub ticks: u32,
    /// Torques by tick, in rising order from tick 0; each holds until the next.
    pub torques: &'a [Command],
    /// State at tick 0.
    pub start: &'a Start,
    /// The core in f64 in place of the board's f32.
    pub double: bool,
    /// How many sub-steps a tick may have.
    pub effort: Effort,
}

/// A mesh that is deflected by more than this has left all teeth behind: the scheme has failed, finite or not [m].
const ABSURD: f64 = 0.1;

/// How a run came to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// All its ticks are done.
    Whole,
    /// The observer wanted no more.
    Stopped,
    /// The state is infinite, not a number or absurd after so many ticks.
    Diverged(u32),
}

/// What is shown every tick: the start, then the joint after each tick.
pub type Observer<'o> = dyn FnMut(&Moment) -> Outcome<ControlFlow<()>> + 'o;

/// Runs a scheme under an observer.
pub fn follow(run: &Run<'_>, scheme: SchemeName, observer: &mut Observer<'_>) -> Outcome<End> {
    match scheme.of_core() {
        Some(core) => with_core(run, FollowCore { run, scheme: core, observer }),
        None => follow_reference(run, 0.0, observer),
    }
}

/// The reference, with torques wrong by a part of themselves, up and down in turn from tick to tick.
pub fn follow_reference(run: &Run<'_>, disturbance: f64, observer: &mut Observer<'_>) -> Outcome<End> {
    let mut reference = Reference::start(run.joint, run.start).map_err(|error| not_referable(run.joint, &error))?;
    let mut torques = Schedule::new(run.torques);
    let mut factor = 1.0 + disturbance;
    for tick in 0..=run.ticks {
        let command = torques.at(tick);
        let mut moment = Moment::of_reference(tick, run.joint, &reference.observe());
        (moment.drive, moment.load) = (command.drive_torque.into(), command.load_torque.into());
        if observer(&moment)?.is_break() {
            return Ok(End::Stopped);
        }
        if tick < run.ticks {
            let end = f64::from(tick + 1) / f64::from(run.tick_rate);
            match reference.advance(end, factor * moment.drive, factor * moment.load) {
                Ok(()) => {}
                Err(ReferenceError::Integration(_)) => return Ok(End::Diverged(tick + 1)),
                Err(error) => return Err(not_referable(run.joint, &error)),
            }
        }
        factor = 2.0 - factor;
    }
    Ok(End::Whole)
}

/// What a scheme costs: processor time of its ticks alone, and sub-steps a tick (none stand for the reference's own).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Processor seconds for a simulated second.
    pub per_second: f64,
    /// Sub-steps a tick.
    pub substeps: Option<u32>,
}

/// Measures a scheme over some ticks of a run.
pub fn cost(run: &Run<'_>, scheme: SchemeName, ticks: u32) -> Outcome<Cost> {
    let ticks = ticks.clamp(1, run.ticks.max(1));
    match scheme.of_core() {
        Some(core) => with_core(run, CostOfCore { run, scheme: core, ticks }),
        None => {
            let mut reference =
                Reference::start(run.joint, run.start).map_err(|error| not_referable(run.joint, &error))?;
            let mut torques = Schedule::new(run.torques);
            let clock = ThreadTime::now();
            for tick in 0..ticks {
                let command = torques.at(tick);
                let end = f64::from(tick + 1) / f64::from(run.tick_rate);
                // A run that breaks off has its cost too.
                if reference.advance(end, command.drive_torque.into(), command.load_torque.into()).is_err() {
                    break;
                }
            }
            Ok(Cost { per_second: per_second(&clock, run, ticks), substeps: None })
        }
    }
}

fn per_second(clock: &ThreadTime, run: &Run<'_>, ticks: u32) -> f64 {
    clock.elapsed().as_secs_f64() * f64::from(run.tick_rate) / f64::from(ticks)
}

/// What the reference refuses, with the mend where there is one on the command line.
fn not_referable(joint: &JointParameters, error: &ReferenceError) -> Failure {
    let failure = Failure::new(format!("the reference does not take joint `{}`: {error}", joint.name));
    match joint.dead_zone {
        DeadZone::Tanh { .. } => {
            failure.with_help("add --set sharpness= --set dead_zone=sharp, or choose another scheme")
        }
        DeadZone::Sharp => failure,
    }
}

/// Torques as they come due.
struct Schedule<'a> {
    next: std::iter::Peekable<std::slice::Iter<'a, Command>>,
    now: Command,
}

impl<'a> Schedule<'a> {
    fn new(commands: &'a [Command]) -> Self {
        Self { next: commands.iter().peekable(), now: Command { tick: 0, drive_torque: 0.0, load_torque: 0.0 } }
    }

    /// Torques during a tick; ticks are asked for in rising order.
    fn at(&mut self, tick: u32) -> Command {
        while let Some(command) = self.next.next_if(|command| command.tick <= tick) {
            self.now = *command;
        }
        self.now
    }
}

/// Work that is written for any scalar and number of planets.
trait CoreWork {
    type Result;
    fn run<T: Real, const N: usize>(self) -> Outcome<Self::Result>;
}

fn with_core<W: CoreWork>(run: &Run<'_>, work: W) -> Outcome<W::Result> {
    match (run.joint.geometry.planets, run.double) {
        (3, false) => work.run::<f32, 3>(),
        (4, false) => work.run::<f32, 4>(),
        (5, false) => work.run::<f32, 5>(),
        (3, true) => work.run::<f64, 3>(),
        (4, true) => work.run::<f64, 4>(),
        (5, true) => work.run::<f64, 5>(),
        (other, _) => Err(Failure::new(format!("joint `{}` has {other} planets", run.joint.name))
            .with_help("a joint may have 3, 4 or 5 planets")),
    }
}

fn tables<T: Real, const N: usize>(run: &Run<'_>, scheme: Scheme) -> Outcome<Tables<T, N>> {
    design_scheme(run.joint, run.tick_rate, scheme, run.effort).map_err(|error| {
        let name = &run.joint.name;
        let failure = Failure::new(format!("joint `{name}` cannot be designed for {} Hz: {error}", run.tick_rate));
        match error {
            DesignError::RateTooLow { lowest, .. } => failure.with_help(format!("add --rate {lowest} or more")),
            _ => failure,
        }
    })
}

struct FollowCore<'a, 'o> {
    run: &'a Run<'a>,
    scheme: Scheme,
    observer: &'a mut Observer<'o>,
}

impl CoreWork for FollowCore<'_, '_> {
    type Result = End;

    fn run<T: Real, const N: usize>(self) -> Outcome<End> {
        let run = self.run;
        let tables = tables::<T, N>(run, self.scheme)?;
        let reader = Reader::new(run.joint, &tables);
        let mut model = Model::new(&tables);
        model.set_state(core_state(run.joint, &tables, run.start));
        let mut torques = Schedule::new(run.torques);
        for tick in 0..=run.ticks {
            let command = torques.at(tick);
            let mut moment = reader.read(tick, &model);
            let sound = |teeth: &Teeth| teeth.deflection.abs() < ABSURD;
            if !model.is_finite() || !moment.teeth.iter().all(sound) {
                return Ok(End::Diverged(tick));
            }
            (moment.drive, moment.load) = (command.drive_torque.into(), command.load_torque.into());
            if (self.observer)(&moment)?.is_break() {
                return Ok(End::Stopped);
            }
            model.step(Torques { drive: T::from_f64(moment.drive), load: T::from_f64(moment.load) });
        }
        Ok(End::Whole)
    }
}

struct CostOfCore<'a> {
    run: &'a Run<'a>,
    scheme: Scheme,
    ticks: u32,
}

impl CoreWork for CostOfCore<'_> {
    type Result = Cost;

    fn run<T: Real, const N: usize>(self) -> Outcome<Cost> {
        let run = self.run;
        let tables = tables::<T, N>(run, self.scheme)?;
        let mut model = Model::new(&tables);
        model.set_state(core_state(run.joint, &tables, run.start));
        let mut torques = Schedule::new(run.torques);
        let clock = ThreadTime::now();
        for tick in 0..self.ticks {
            let command = torques.at(tick);
            let (drive, load) = (command.drive_torque.into(), command.load_torque.into());
            model.step(Torques { drive: T::from_f64(drive), load: T::from_f64(load) });
        }
        let per_second = per_second(&clock, run, self.ticks);
        // The result must be wanted, or nothing is computed.
        std::hint::black_box(model.state_digest());
        Ok(Cost { per_second, substeps: Some(tables.substeps) })
    }
}
