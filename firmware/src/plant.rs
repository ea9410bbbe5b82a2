//! Role `plant`: simulates the joint; torques in, motion out.

use core::convert::Infallible;

use link::messages::{Command, Role, SAMPLES_PER_BATCH, Schedule, ToBoard};
use model_core::gears::{Model, Tables, Torques};
use model_core::numbers::digest;

use crate::batcher::Batcher;
use crate::protocol::{Protocol, Timed};
use crate::telemetry::{PlantForm, RawSample};
use crate::work::Work;

/// Messages of the plant.
pub struct PlantProtocol<const N: usize>;

impl<const N: usize> Protocol for PlantProtocol<N> {
    const ROLE: Role = Role::Plant;
    type Command = Command;
    type Timetable = Schedule;
    type Sample = RawSample<N>;
    type Batch = Batcher<PlantForm<N>, SAMPLES_PER_BATCH>;
    type Learnt = Infallible;

    fn timetable(message: ToBoard) -> Option<Schedule> {
        if let ToBoard::Schedule(schedule) = message { Some(schedule) } else { None }
    }
}

impl Timed for Command {
    fn tick(&self) -> u32 {
        self.tick
    }

    fn is_sound(&self) -> bool {
        self.drive_torque.is_finite() && self.load_torque.is_finite()
    }
}

const NO_TORQUE: Torques<f32> = Torques { drive: 0.0, load: 0.0 };

/// Simulated joint; torques are held until the next command.
pub struct Plant<'a, const N: usize> {
    tables: &'a Tables<f32, N>,
    model: Model<'a, f32, N>,
    torques: Torques<f32>,
    digest: u64,
}

impl<'a, const N: usize> Plant<'a, N> {
    /// Joint at rest.
    pub fn new(tables: &'a Tables<f32, N>) -> Self {
        Self { tables, model: Model::new(tables), torques: NO_TORQUE, digest: digest::START }
    }
}

impl<const N: usize> Work for Plant<'_, N> {
    type Protocol = PlantProtocol<N>;
    const FREE_RUNNING: bool = true;

    fn is_sound(&self) -> bool {
        self.tables.digest_is_good()
    }

    fn reset(&mut self, _: bool) {
        self.model.reset();
        self.torques = NO_TORQUE;
        self.digest = digest::START;
    }

    fn take(&mut self, command: Command) {
        self.torques = Torques { drive: command.drive_torque, load: command.load_torque };
    }

    fn step(&mut self) {
        self.model.step(self.torques);
        self.digest = digest::chain(self.digest, self.model.state_digest());
    }

    fn is_finite(&self) -> bool {
        self.model.is_finite()
    }

    fn sample(&self, steps: u32, computation: u16) -> RawSample<N> {
        RawSample { tick: steps, state_digest: self.digest, outputs: self.model.outputs(), computation }
    }
}
