//! Selects the command that is due and decides if the tick steps: by tick number, in lockstep with the host or in real
//! time.

use link::messages::{RunMode, RunSettings, Trip};

use crate::protocol::Timed;
use crate::sized_queue::SizedConsumer;

/// Next action of the tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TickAction<C> {
    /// Step; a command given here holds from now on.
    Step(Option<C>),
    /// Step with the old command although the host has fallen behind (realtime).
    StarvedStep,
    /// Do not step: the schedule for this tick is not known yet.
    Wait,
    /// Enter the safe state.
    Trip(Trip),
}

/// Progress through the commands of one run.
#[derive(Debug, Clone)]
pub struct Schedule {
    settings: RunSettings,
    starved_in_a_row: u32,
}

impl Schedule {
    /// State at the start of a run, with no command known.
    pub const fn new(settings: RunSettings) -> Self {
        Self { settings, starved_in_a_row: 0 }
    }

    /// Mode of the run.
    pub fn mode(&self) -> RunMode {
        self.settings.mode
    }

    /// Decides on the step from `tick` to `tick + 1`; all commands before `horizon` are known. Ticks rise strictly from
    /// command to command, so at most one command is due. In either mode a run begins with the first schedule. In
    /// lockstep without `waits_forever`, a run trips when no schedule arrives within the timeout.
    ///
    /// Idle fills the queue before it moves the horizon, and this function may interrupt in between. A due command
    /// therefore implies that its tick is known; a command that is not due stays in the queue.
    pub fn next_action<C: Timed, const PLACES: usize>(
        &mut self,
        tick: u32,
        horizon: u32,
        waits_forever: bool,
        commands: &mut SizedConsumer<'_, C, PLACES>,
    ) -> TickAction<C> {
        let next = commands.peek().map(Timed::tick);
        if let Some(late) = next.filter(|next| *next < tick) {
            return TickAction::Trip(Trip::LateCommand { tick: late });
        }
        let due = next == Some(tick);
        if due || tick < horizon {
            self.starved_in_a_row = 0;
            return TickAction::Step(if due { commands.take() } else { None });
        }
        let lockstep = self.settings.mode == RunMode::Lockstep;
        if horizon == 0 || (lockstep && waits_forever) {
            return TickAction::Wait;
        }
        self.starved_in_a_row = self.starved_in_a_row.saturating_add(1);
        if self.starved_in_a_row > self.settings.command_timeout {
            return TickAction::Trip(Trip::CommandLoss { tick });
        }
        if lockstep { TickAction::Wait } else { TickAction::StarvedStep }
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

    /// Drive torque of a step with a new command, if there is one.
    fn new(turn: TickAction<Command>) -> Option<f32> {
        match turn {
            TickAction::Step(due) => due.map(|command| command.drive_torque),
            other => panic!("{other:?}"),
        }
    }

    fn command(tick: u32, drive_torque: f32) -> Command {
        Command { tick, drive_torque, load_torque: 0.0 }
    }

    #[test]
    fn lockstep_waits_at_horizon() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = SizedConsumer::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Lockstep);
        assert_eq!(schedule.next_action(0, 0, true, &mut commands), TickAction::Wait);
        assert_eq!(schedule.next_action(0, 1, true, &mut commands), TickAction::Step(None));
        for _ in 0..10 * TIMEOUT {
            assert_eq!(schedule.next_action(1, 1, true, &mut commands), TickAction::Wait);
        }
    }

    #[test]
    fn lockstep_trips_after_timeout() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = SizedConsumer::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Lockstep);
        assert_eq!(schedule.next_action(0, 0, false, &mut commands), TickAction::Wait);
        assert_eq!(schedule.next_action(0, 1, false, &mut commands), TickAction::Step(None));
        for _ in 0..TIMEOUT {
            assert_eq!(schedule.next_action(1, 1, false, &mut commands), TickAction::Wait);
        }
        let lost = TickAction::Trip(Trip::CommandLoss { tick: 1 });
        assert_eq!(schedule.next_action(1, 1, false, &mut commands), lost);
    }

    #[test]
    fn command_applied_at_its_tick_only() {
        let mut queue = Queue::<Command, 4>::new();
        let (mut entry, commands) = queue.split();
        let mut commands = SizedConsumer::<_, 4>::new(commands);
        entry.enqueue(command(1, 2.0)).unwrap();
        entry.enqueue(command(3, -1.0)).unwrap();
        let mut schedule = schedule(RunMode::Lockstep);
        let given: Vec<_> = (0..5).map(|tick| new(schedule.next_action(tick, 5, true, &mut commands))).collect();
        assert_eq!(given, [None, Some(2.0), None, Some(-1.0), None]);
    }

    /// A command that is queued before the horizon moves is not lost.
    #[test]
    fn early_command_kept() {
        for (mode, waits_forever) in [(RunMode::Lockstep, false), (RunMode::Lockstep, true), (RunMode::Realtime, true)]
        {
            let mut queue = Queue::<Command, 4>::new();
            let (mut entry, commands) = queue.split();
            let mut commands = SizedConsumer::<_, 4>::new(commands);
            let mut schedule = schedule(mode);
            // Idle has queued the commands and is interrupted before it moves the horizon.
            entry.enqueue(command(0, 2.0)).unwrap();
            entry.enqueue(command(2, 3.0)).unwrap();
            assert_eq!(new(schedule.next_action(0, 0, waits_forever, &mut commands)), Some(2.0));
            assert_eq!(schedule.next_action(1, 0, waits_forever, &mut commands), TickAction::Wait);
            assert_eq!(schedule.next_action(1, 3, waits_forever, &mut commands), TickAction::Step(None));
            assert_eq!(new(schedule.next_action(2, 3, waits_forever, &mut commands)), Some(3.0));
        }
    }

    #[test]
    fn starved_run_trips_after_timeout() {
        let mut queue = Queue::<Command, 4>::new();
        let (mut entry, commands) = queue.split();
        let mut commands = SizedConsumer::<_, 4>::new(commands);
        entry.enqueue(command(0, 2.0)).unwrap();
        let mut schedule = schedule(RunMode::Realtime);
        assert_eq!(new(schedule.next_action(0, 1, true, &mut commands)), Some(2.0));
        for tick in 1..=TIMEOUT {
            assert_eq!(schedule.next_action(tick, 1, true, &mut commands), TickAction::StarvedStep);
        }
        let tick = TIMEOUT + 1;
        assert_eq!(schedule.next_action(tick, 1, true, &mut commands), TickAction::Trip(Trip::CommandLoss { tick }));
    }

    #[test]
    fn schedule_in_time_ends_starvation() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = SizedConsumer::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Realtime);
        for tick in (0..100).step_by(2) {
            assert_eq!(schedule.next_action(tick, tick + 1, true, &mut commands), TickAction::Step(None));
            assert_eq!(schedule.next_action(tick + 1, tick + 1, true, &mut commands), TickAction::StarvedStep);
        }
    }

    #[test]
    fn realtime_run_waits_for_first_schedule() {
        let mut queue = Queue::<Command, 4>::new();
        let (_, commands) = queue.split();
        let mut commands = SizedConsumer::<_, 4>::new(commands);
        let mut schedule = schedule(RunMode::Realtime);
        for _ in 0..10 * TIMEOUT {
            assert_eq!(schedule.next_action(0, 0, true, &mut commands), TickAction::Wait);
        }
    }

    #[test]
    fn command_for_past_tick_trips() {
        let mut queue = Queue::<Command, 4>::new();
        let (mut entry, commands) = queue.split();
        let mut commands = SizedConsumer::<_, 4>::new(commands);
        entry.enqueue(command(4, 2.0)).unwrap();
        let late = TickAction::Trip(Trip::LateCommand { tick: 4 });
        assert_eq!(schedule(RunMode::Realtime).next_action(5, 9, true, &mut commands), late);
    }
}
