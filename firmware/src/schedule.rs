//! Which command is due, and whether there is a next step: commands by tick number, in lockstep with the host or by the
//! board's own clock.

use link::messages::{RunMode, RunSettings, Trip};

use crate::ends::Taker;
use crate::words::Timed;

/// What a tick is to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turn<C> {
    /// Step, with this command from now on if there is one.
    Step(Option<C>),
    /// Step as before although the host has fallen behind (realtime).
    StarvedStep,
    /// Do not step: the schedule for this tick is not known yet.
    Wait,
    /// Go to the safe state.
    Trip(Trip),
}

/// Progress through the commands of one run.
#[derive(Debug, Clone)]
pub struct Schedule {
    settings: RunSettings,
    starved_in_a_row: u32,
}

impl Schedule {
    /// At the start of a run: nothing known.
    pub const fn new(settings: RunSettings) -> Self {
        Self { settings, starved_in_a_row: 0 }
    }

    /// Who waits for whom.
    pub fn mode(&self) -> RunMode {
        self.settings.mode
    }

    /// Decides on the step from `tick` to `tick + 1`, everything before `horizon` being known. Ticks rise strictly
    /// from command to command, so at most one can be due. A run begins with the first schedule, in either mode. In
    /// lockstep a run that does not wait for ever (`patient` is false) ends when no schedule has come for the timeout.
    ///
    /// The queue is filled before the horizon moves, and this may run in between: a command that is due says by itself
    /// that its tick is known, and one that is not due stays where it is.
    pub fn turn<C: Timed, const PLACES: usize>(
        &mut self,
        tick: u32,
        horizon: u32,
        patient: bool,
        commands: &mut Taker<'_, C, PLACES>,
    ) -> Turn<C> {
        let next = commands.peek().map(Timed::tick);
        if let Some(late) = next.filter(|next| *next < tick) {
            return Turn::Trip(Trip::LateCommand { tick: late });
        }
        let due = next == Some(tick);
        if due || tick < horizon {
            self.starved_in_a_row = 0;
            return Turn::Step(if due { commands.take() } else { None });
        }
        let lockstep = self.settings.mode == RunMode::Lockstep;
        if horizon == 0 || (lockstep && patient) {
            return Turn::Wait;
        }
        self.starved_in_a_row = self.starved_in_a_row.saturating_add(1);
        if self.starved_in_a_row > self.settings.command_timeout {
            return Turn::Trip(Trip::CommandLoss { tick });
        }
        if lockstep { Turn::Wait } else { Turn::StarvedStep }
    }
}

#[cfg(test)]
mod tests {
    use heapless::spsc::Queue;
    use link::messages::Command;

    use super::*;

    const TIMEOUT: u32 = 3;

    fn schedule(mode: RunMode) -> Schedule {
        Schedule::new(RunSettings { mode, decimation: 1, command_timeout: TIMEOUT, from_memory: false })
    }

    /// Drive torque of a step with a new command.
    fn new(turn: Turn<Command>) -> Option<f32> {
        match turn {
            Turn::Step(due) => due.map(|command| command.drive_torque),
            other => panic!("{other:?}"),
        }
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
        assert_eq!(schedule.turn(0, 0, true, &mut commands), Turn::Wait);
        assert_eq!(schedule.turn(0, 1, true, &mut commands), Turn::Step(None));
        for _ in 0..10 * TIMEOUT {
            assert_eq!(schedule.turn(1, 1, true, &mut commands), Turn::Wait);
        }
    }

    #[test]
    fn a_lockstep_run_that_may_not_wait_for_ever_trips_after_the_timeout() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Lockstep);
        assert_eq!(schedule.turn(0, 0, false, &mut commands), Turn::Wait);
        assert_eq!(schedule.turn(0, 1, false, &mut commands), Turn::Step(None));
        for _ in 0..TIMEOUT {
            assert_eq!(schedule.turn(1, 1, false, &mut commands), Turn::Wait);
        }
        let lost = Turn::Trip(Trip::CommandLoss { tick: 1 });
        assert_eq!(schedule.turn(1, 1, false, &mut commands), lost);
    }

    #[test]
    fn a_command_is_given_at_its_tick_and_only_then() {
        let mut queue = Queue::<Command, 4>::new();
        let (mut entry, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        entry.enqueue(command(1, 2.0)).unwrap();
        entry.enqueue(command(3, -1.0)).unwrap();
        let mut schedule = schedule(RunMode::Lockstep);
        let given: Vec<_> = (0..5).map(|tick| new(schedule.turn(tick, 5, true, &mut commands))).collect();
        assert_eq!(given, [None, Some(2.0), None, Some(-1.0), None]);
    }

    #[test]
    fn a_command_that_the_tick_sees_before_its_horizon_is_not_lost() {
        for (mode, patient) in [(RunMode::Lockstep, false), (RunMode::Lockstep, true), (RunMode::Realtime, true)] {
            let mut queue = Queue::<Command, 4>::new();
            let (mut entry, commands) = queue.split();
            let mut commands = Taker::<_, 4>::new(commands);
            let mut schedule = schedule(mode);
            // Idle has put the commands into the queue and is interrupted before it moves the horizon.
            entry.enqueue(command(0, 2.0)).unwrap();
            entry.enqueue(command(2, 3.0)).unwrap();
            assert_eq!(new(schedule.turn(0, 0, patient, &mut commands)), Some(2.0));
            assert_eq!(schedule.turn(1, 0, patient, &mut commands), Turn::Wait);
            assert_eq!(schedule.turn(1, 3, patient, &mut commands), Turn::Step(None));
            assert_eq!(new(schedule.turn(2, 3, patient, &mut commands)), Some(3.0));
        }
    }

    #[test]
    fn a_starved_run_goes_on_until_the_timeout_and_then_trips() {
        let mut queue = Queue::<Command, 4>::new();
        let (mut entry, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        entry.enqueue(command(0, 2.0)).unwrap();
        let mut schedule = schedule(RunMode::Realtime);
        assert_eq!(new(schedule.turn(0, 1, true, &mut commands)), Some(2.0));
        for tick in 1..=TIMEOUT {
            assert_eq!(schedule.turn(tick, 1, true, &mut commands), Turn::StarvedStep);
        }
        let tick = TIMEOUT + 1;
        assert_eq!(schedule.turn(tick, 1, true, &mut commands), Turn::Trip(Trip::CommandLoss { tick }));
    }

    #[test]
    fn a_schedule_in_time_ends_the_starvation() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Realtime);
        for tick in (0..100).step_by(2) {
            assert_eq!(schedule.turn(tick, tick + 1, true, &mut commands), Turn::Step(None));
            assert_eq!(schedule.turn(tick + 1, tick + 1, true, &mut commands), Turn::StarvedStep);
        }
    }

    #[test]
    fn a_realtime_run_does_not_begin_before_its_first_schedule() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Realtime);
        for _ in 0..10 * TIMEOUT {
            assert_eq!(schedule.turn(0, 0, true, &mut commands), Turn::Wait);
        }
    }

    #[test]
    fn a_command_for_a_past_tick_trips() {
        let mut queue = Queue::<Command, 4>::new();
        let (mut entry, commands) = queue.split();
        let mut commands = Taker::<_, 4>::new(commands);
        entry.enqueue(command(4, 2.0)).unwrap();
        let late = Turn::Trip(Trip::LateCommand { tick: 4 });
        assert_eq!(schedule(RunMode::Realtime).turn(5, 9, true, &mut commands), late);
    }
}
