//! Which torques the next step uses, and whether there is a next step: commands by tick number, in lockstep with the
//! host or by the board's own clock. Filling the queue, and refusing commands that are bad in themselves, is left to
//! `conversation`.

use link::messages::{Command, Fault, RunMode, RunSettings};
use model_core::realtime::Torques;

use crate::ends::Taker;

/// What a tick is to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turn {
    /// Step with the torques in force.
    Step,
    /// Step with the torques in force although the host has fallen behind (realtime).
    StarvedStep,
    /// Do not step: the schedule for this tick is not known yet.
    Wait,
    /// Go to the safe state.
    Trip(Fault),
}

/// Progress through the commands of one run.
#[derive(Debug, Clone)]
pub struct Schedule {
    settings: RunSettings,
    torques: Torques<f32>,
    starved_in_a_row: u32,
}

const NO_TORQUE: Torques<f32> = Torques { drive: 0.0, load: 0.0 };

impl Schedule {
    /// At the start of a run: no torque, nothing known.
    pub const fn new(settings: RunSettings) -> Self {
        Self { settings, torques: NO_TORQUE, starved_in_a_row: 0 }
    }

    /// Who waits for whom.
    pub fn mode(&self) -> RunMode {
        self.settings.mode
    }

    /// The torques in force.
    pub fn torques(&self) -> Torques<f32> {
        self.torques
    }

    /// Decides on the step from `tick` to `tick + 1`, everything before `horizon` being known. Ticks rise strictly
    /// from command to command, so at most one can be due. A run begins with the first schedule, in either mode.
    pub fn turn<const PLACES: usize>(
        &mut self,
        tick: u32,
        horizon: u32,
        commands: &mut Taker<'_, Command, PLACES>,
    ) -> Turn {
        let known = tick < horizon;
        if !known && (horizon == 0 || self.settings.mode == RunMode::Lockstep) {
            return Turn::Wait;
        }
        if let Some(command) = commands.peek() {
            let Command { tick: due, drive_torque, load_torque } = *command;
            if due < tick {
                return Turn::Trip(Fault::LateCommand { tick: due });
            }
            if due == tick {
                self.torques = Torques { drive: drive_torque, load: load_torque };
                commands.take();
            }
        }
        if known {
            self.starved_in_a_row = 0;
            return Turn::Step;
        }
        self.starved_in_a_row += 1;
        if self.starved_in_a_row > self.settings.command_timeout {
            self.torques = NO_TORQUE;
            return Turn::Trip(Fault::CommandLoss { tick });
        }
        Turn::StarvedStep
    }
}

#[cfg(test)]
mod tests {
    use heapless::spsc::Queue;

    use super::*;

    const TIMEOUT: u32 = 3;

    fn schedule(mode: RunMode) -> Schedule {
        Schedule::new(RunSettings { mode, decimation: 1, command_timeout: TIMEOUT })
    }

    fn command(tick: u32, drive_torque: f32) -> Command {
        Command { tick, drive_torque, load_torque: 0.0 }
    }

    #[test]
    fn lockstep_waits_at_the_horizon() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Lockstep);
        assert_eq!(schedule.turn(0, 0, &mut commands), Turn::Wait);
        assert_eq!(schedule.turn(0, 1, &mut commands), Turn::Step);
        for _ in 0..10 * TIMEOUT {
            assert_eq!(schedule.turn(1, 1, &mut commands), Turn::Wait);
        }
    }

    #[test]
    fn a_torque_holds_from_its_tick_to_the_next_command() {
        let mut queue = Queue::<Command, 4>::new();
        let (mut entry, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        entry.enqueue(command(1, 2.0)).unwrap();
        entry.enqueue(command(3, -1.0)).unwrap();
        let mut schedule = schedule(RunMode::Lockstep);
        let drive: Vec<f32> = (0..5)
            .map(|tick| {
                assert_eq!(schedule.turn(tick, 5, &mut commands), Turn::Step);
                schedule.torques().drive
            })
            .collect();
        assert_eq!(drive, [0.0, 2.0, 2.0, -1.0, -1.0]);
    }

    #[test]
    fn a_starved_run_holds_the_torque_until_the_timeout_and_then_trips() {
        let mut queue = Queue::<Command, 4>::new();
        let (mut entry, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        entry.enqueue(command(0, 2.0)).unwrap();
        let mut schedule = schedule(RunMode::Realtime);
        assert_eq!(schedule.turn(0, 1, &mut commands), Turn::Step);
        for tick in 1..=TIMEOUT {
            assert_eq!(schedule.turn(tick, 1, &mut commands), Turn::StarvedStep);
            assert_eq!(schedule.torques().drive, 2.0);
        }
        let tick = TIMEOUT + 1;
        assert_eq!(schedule.turn(tick, 1, &mut commands), Turn::Trip(Fault::CommandLoss { tick }));
        assert_eq!(schedule.torques().drive, 0.0);
    }

    #[test]
    fn a_schedule_in_time_ends_the_starvation() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Realtime);
        for tick in (0..100).step_by(2) {
            assert_eq!(schedule.turn(tick, tick + 1, &mut commands), Turn::Step);
            assert_eq!(schedule.turn(tick + 1, tick + 1, &mut commands), Turn::StarvedStep);
        }
    }

    #[test]
    fn a_realtime_run_does_not_begin_before_its_first_schedule() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Realtime);
        for _ in 0..10 * TIMEOUT {
            assert_eq!(schedule.turn(0, 0, &mut commands), Turn::Wait);
        }
    }

    #[test]
    fn a_command_for_a_past_tick_trips() {
        let mut queue = Queue::<Command, 4>::new();
        let (mut entry, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        entry.enqueue(command(4, 2.0)).unwrap();
        let late = Turn::Trip(Fault::LateCommand { tick: 4 });
        assert_eq!(schedule(RunMode::Realtime).turn(5, 9, &mut commands), late);
    }
}
