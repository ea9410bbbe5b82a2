//! Steps a joint by a named scheme and calls a hook after every tick.

use cpu_time::ThreadTime;
use link::messages::Command;
use model_core::gears::design::{DesignError, Effort, StepSize, Substeps, design_scheme};
use model_core::gears::{Model, Scheme, Tables, Torques};
use model_core::numbers::Real;
use parameters::{DeadZone, JointParameters};
use reference::joint::{Reference, ReferenceError, Start};

use super::scheme::SchemeName;
use super::snapshot::{MeshSnapshot, Reader, Snapshot};
use super::start::core_state;
use report::failure::{Failure, Outcome};
use report::interruption;

/// A simulation, independent of the scheme.
#[derive(Debug, Clone)]
pub struct SimulationSpec {
    /// Joint.
    pub joint: JointParameters,
    /// Step rate [Hz].
    pub tick_rate: u32,
    /// Length in ticks.
    pub ticks: u32,
    /// Torques by tick, in rising order from tick 0; each holds until the next.
    pub torques: Vec<Command>,
    /// State at tick 0.
    pub start: Start,
    /// Runs the core in f64 in place of the board's f32.
    pub double: bool,
    /// Limit of the sub-steps of a tick.
    pub effort: Effort,
}

impl SimulationSpec {
    /// Sub-steps of a tick in which contacts change. `None` for the reference, which chooses its own steps, and for a
    /// joint that cannot be stepped.
    pub fn substeps(&self, scheme: SchemeName) -> Option<Substeps> {
        let step_size = StepSize::new(&self.joint);
        match scheme {
            SchemeName::Reference => None,
            SchemeName::Realtime => step_size.substeps(self.tick_rate, self.effort).ok(),
            SchemeName::Paper | SchemeName::RungeKutta4 | SchemeName::Euler => {
                step_size.corrected_substeps(self.tick_rate, self.effort).ok().map(Substeps::Corrected)
            }
        }
    }
}

/// Mesh deflection above which a scheme counts as diverged even if the state is finite [m].
const MAX_DEFLECTION: f64 = 0.1;

/// End of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunEnd {
    /// All ticks are done.
    Whole,
    /// The user stopped the run.
    Stopped,
    /// The state was not finite, or implausibly large, after this number of ticks.
    Diverged(u32),
}

impl RunEnd {
    /// Time at which the state stopped being finite, at a tick rate [Hz]; `None` if it stayed finite [s].
    pub fn diverged_at(self, tick_rate: u32) -> Option<f64> {
        match self {
            Self::Diverged(tick) => Some(f64::from(tick) / f64::from(tick_rate)),
            Self::Whole | Self::Stopped => None,
        }
    }
}

/// Callback with the initial state, then with the joint after each tick.
pub type TickHook<'o> = dyn FnMut(&Snapshot) -> Outcome<()> + 'o;

/// Runs a scheme to its end, or until the user stops it, with a hook after every tick. `disturbance` is a relative
/// error of the torques with alternating sign.
pub fn simulate(
    run: &SimulationSpec,
    scheme: SchemeName,
    disturbance: f64,
    hook: &mut TickHook<'_>,
) -> Outcome<RunEnd> {
    with_scheme(run, scheme, |joint| {
        let mut torques = TorqueSchedule::new(&run.torques);
        let mut factor = 1.0 + disturbance;
        for tick in 0..=run.ticks {
            let command = torques.at(tick);
            let Some(mut snapshot) = joint.read(tick) else { return Ok(RunEnd::Diverged(tick)) };
            (snapshot.drive, snapshot.load) = (command.drive_torque.into(), command.load_torque.into());
            hook(&snapshot)?;
            if interruption::requested() {
                return Ok(RunEnd::Stopped);
            }
            if tick < run.ticks && !joint.step(tick, factor * snapshot.drive, factor * snapshot.load)? {
                return Ok(RunEnd::Diverged(tick + 1));
            }
            factor = 2.0 - factor;
        }
        Ok(RunEnd::Whole)
    })
}

/// Processor time of a scheme's ticks for each simulated second [s], measured over some ticks of a run.
pub fn cost(run: &SimulationSpec, scheme: SchemeName, ticks: u32) -> Outcome<f64> {
    let ticks = ticks.clamp(1, run.ticks.max(1));
    with_scheme(run, scheme, |joint| {
        let mut torques = TorqueSchedule::new(&run.torques);
        let clock = ThreadTime::now();
        for tick in 0..ticks {
            let command = torques.at(tick);
            // A run that breaks off has a cost as well.
            if !joint.step(tick, command.drive_torque.into(), command.load_torque.into())? {
                break;
            }
        }
        let per_second = clock.elapsed().as_secs_f64() * f64::from(run.tick_rate) / f64::from(ticks);
        // Keeps the compiler from removing the computation.
        std::hint::black_box(&joint);
        Ok(per_second)
    })
}

/// Error: the reference rejects the joint; the help names an option if there is one.
fn reference_error(joint: &JointParameters, error: &ReferenceError) -> Failure {
    let failure = Failure::new(format!("the reference does not take joint `{}`: {error}", joint.name));
    match joint.dead_zone {
        DeadZone::Tanh { .. } => {
            failure.with_help("add --set sharpness= --set dead_zone=sharp, or choose another scheme")
        }
        DeadZone::Sharp => failure,
    }
}

/// Torques by tick.
struct TorqueSchedule<'a> {
    next: std::iter::Peekable<std::slice::Iter<'a, Command>>,
    now: Command,
}

impl<'a> TorqueSchedule<'a> {
    fn new(commands: &'a [Command]) -> Self {
        Self { next: commands.iter().peekable(), now: Command { tick: 0, drive_torque: 0.0, load_torque: 0.0 } }
    }

    /// Torques during a tick; ticks must rise.
    fn at(&mut self, tick: u32) -> Command {
        while let Some(command) = self.next.next_if(|command| command.tick <= tick) {
            self.now = *command;
        }
        self.now
    }
}

/// A joint under a scheme.
trait SteppedJoint {
    /// Snapshot after a number of ticks; `None` if the state is not finite or implausibly large.
    fn read(&self, tick: u32) -> Option<Snapshot>;
    /// Runs the tick after `tick` under these torques [N m]; returns false if the scheme breaks off.
    fn step(&mut self, tick: u32, drive: f64, load: f64) -> Outcome<bool>;
}

/// Calls `work` with a joint under a scheme, at the start of a run.
fn with_scheme<R>(
    run: &SimulationSpec,
    scheme: SchemeName,
    work: impl FnOnce(&mut dyn SteppedJoint) -> Outcome<R>,
) -> Outcome<R> {
    let Some(scheme) = scheme.core_scheme() else {
        let reference =
            Reference::start(&run.joint, &run.start).map_err(|error| reference_error(&run.joint, &error))?;
        return work(&mut ReferenceJoint { run, reference });
    };
    match (run.joint.geometry.planets, run.double) {
        (1, false) => with_core::<f32, 1, R>(run, scheme, work),
        (3, false) => with_core::<f32, 3, R>(run, scheme, work),
        (4, false) => with_core::<f32, 4, R>(run, scheme, work),
        (5, false) => with_core::<f32, 5, R>(run, scheme, work),
        (1, true) => with_core::<f64, 1, R>(run, scheme, work),
        (3, true) => with_core::<f64, 3, R>(run, scheme, work),
        (4, true) => with_core::<f64, 4, R>(run, scheme, work),
        (5, true) => with_core::<f64, 5, R>(run, scheme, work),
        (other, _) => Err(Failure::new(format!("joint `{}` has {other} planets", run.joint.name))
            .with_help("a joint may have 3, 4 or 5 planets")),
    }
}

fn with_core<T: Real, const N: usize, R>(
    run: &SimulationSpec,
    scheme: Scheme,
    work: impl FnOnce(&mut dyn SteppedJoint) -> Outcome<R>,
) -> Outcome<R> {
    let tables = tables::<T, N>(run, scheme)?;
    let mut model = Model::new(&tables);
    model.set_state(core_state(&run.joint, &tables, &run.start));
    work(&mut CoreJoint { reader: Reader::new(&run.joint, &tables), model })
}

fn tables<T: Real, const N: usize>(run: &SimulationSpec, scheme: Scheme) -> Outcome<Tables<T, N>> {
    design_scheme(&run.joint, run.tick_rate, scheme, run.effort).map_err(|error| {
        let name = &run.joint.name;
        let failure = Failure::new(format!("joint `{name}` cannot be designed for {} Hz: {error}", run.tick_rate));
        match error {
            DesignError::RateTooLow { lowest, .. } => failure.with_help(format!("add --rate {lowest} or more")),
            _ => failure,
        }
    })
}

/// A joint stepped by the core.
struct CoreJoint<'a, T: Real, const N: usize> {
    reader: Reader<'a, T, N>,
    model: Model<'a, T, N>,
}

impl<T: Real, const N: usize> SteppedJoint for CoreJoint<'_, T, N> {
    fn read(&self, tick: u32) -> Option<Snapshot> {
        let snapshot = self.reader.read(tick, &self.model);
        let sound = |teeth: &MeshSnapshot| teeth.deflection.abs() < MAX_DEFLECTION;
        (self.model.is_finite() && snapshot.teeth.iter().all(sound)).then_some(snapshot)
    }

    fn step(&mut self, _: u32, drive: f64, load: f64) -> Outcome<bool> {
        self.model.step(Torques { drive: T::from_f64(drive), load: T::from_f64(load) });
        Ok(true)
    }
}

/// A joint stepped by the reference.
struct ReferenceJoint<'a> {
    run: &'a SimulationSpec,
    reference: Reference,
}

impl SteppedJoint for ReferenceJoint<'_> {
    fn read(&self, tick: u32) -> Option<Snapshot> {
        Some(Snapshot::from_reference(tick, &self.run.joint, &self.reference.observe()))
    }

    fn step(&mut self, tick: u32, drive: f64, load: f64) -> Outcome<bool> {
        let end = f64::from(tick + 1) / f64::from(self.run.tick_rate);
        match self.reference.advance(end, drive, load) {
            Ok(()) => Ok(true),
            Err(ReferenceError::Integration(_)) => Ok(false),
            Err(error) => Err(reference_error(&self.run.joint, &error)),
        }
    }
}
