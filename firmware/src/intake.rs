//! Checks commands from the host and queues them for the tick in order; holds them until there is room, or refuses them
//! with a reason.

use core::sync::atomic::Ordering::{Acquire, Release};

use link::messages::{Accepted, RunMode, RunSettings, Trip};

use crate::protocol::{Protocol, Timed, Timetable};
use crate::queues::{BEFORE_ANY_RUN, Progress};
use crate::shared::Producer;

/// Outcome of a schedule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Taken {
    /// The schedule is queued, now or by an earlier copy.
    Accepted(Accepted),
    /// No run goes on.
    NotRunning,
    /// The schedule cannot be executed: the run ends.
    Unfit(Trip),
    /// The schedule follows a gap or waits for room: no answer.
    Nothing,
}

/// Checks commands and queues them for the tick.
pub struct Intake<'a, W: Protocol> {
    commands: Producer<'a, W::Command>,
    progress: &'a Progress,
    settings: RunSettings,
    held: Option<W::Timetable>,
    next_sequence: u16,
    lost: u32,
}

impl<'a, W: Protocol> Intake<'a, W> {
    /// State before the first run.
    pub fn new(commands: Producer<'a, W::Command>, progress: &'a Progress) -> Self {
        Self { commands, progress, settings: BEFORE_ANY_RUN, held: None, next_sequence: 0, lost: 0 }
    }

    /// Begins a run.
    pub fn begin(&mut self, settings: RunSettings) {
        self.settings = settings;
        self.next_sequence = 0;
    }

    /// Returns `true` while a schedule waits for room; no further frame is to be read until it is queued.
    pub fn holds(&self) -> bool {
        self.held.is_some()
    }

    /// Retries the waiting schedule.
    pub fn take_held(&mut self) -> Taken {
        self.held.take().map_or(Taken::Nothing, |held| self.take(held))
    }

    /// Schedules missing by sequence number.
    pub fn lost(&self) -> u32 {
        self.lost
    }

    /// Returns `true` if all steps up to the horizon are done.
    pub fn has_caught_up(&self) -> bool {
        self.progress.steps.load(Acquire) >= self.progress.horizon.load(Acquire)
    }

    /// Queues a schedule's commands, or returns the reason for a refusal. In lockstep a schedule after a gap is
    /// ignored, so that no step uses torques that never arrived; the host can resend from the missing schedule on. In
    /// lockstep a schedule without room is held.
    pub fn take(&mut self, timetable: W::Timetable) -> Taken {
        if !self.progress.running.load(Acquire) {
            return Taken::NotRunning;
        }
        let lockstep = self.settings.mode == RunMode::Lockstep;
        let sequence = timetable.sequence();
        let gap = sequence.wrapping_sub(self.next_sequence);
        let is_repeated = gap > u16::MAX / 2;
        if is_repeated {
            return self.accepted(sequence);
        }
        if gap > 0 {
            self.lost = self.lost.saturating_add(gap.into());
            if lockstep {
                return Taken::Nothing;
            }
        }
        if let Err(trip) = self.check(&timetable) {
            return Taken::Unfit(trip);
        }
        if timetable.commands().len() > self.free() {
            if lockstep {
                self.held = Some(timetable);
                return Taken::Nothing;
            }
            return Taken::Unfit(Trip::QueueFull);
        }
        for command in timetable.commands() {
            let _ = self.commands.enqueue(command.clone());
        }
        self.next_sequence = sequence.wrapping_add(1);
        self.progress.horizon.store(timetable.horizon(), Release);
        self.accepted(sequence)
    }

    fn accepted(&self, sequence: u16) -> Taken {
        let tick = self.progress.steps.load(Acquire);
        Taken::Accepted(Accepted { sequence, queue_free: self.free() as u16, tick })
    }

    fn free(&self) -> usize {
        self.commands.capacity() - self.commands.len()
    }

    /// Checks that the horizon is within reach and that commands lie in rising order between the old and the new
    /// horizon. A command before the old horizon would be late; a command past the new horizon would block the queue.
    fn check(&self, timetable: &W::Timetable) -> Result<(), Trip> {
        let mut earliest = self.progress.horizon.load(Acquire);
        if timetable.horizon() < earliest {
            return Err(Trip::LateCommand { tick: timetable.horizon() });
        }
        if timetable.horizon() > self.settings.farthest_horizon(self.progress.steps.load(Acquire)) {
            return Err(Trip::FarHorizon { tick: timetable.horizon() });
        }
        for command in timetable.commands() {
            let tick = command.tick();
            if !command.is_sound() {
                return Err(Trip::BadCommand { tick });
            }
            if tick < earliest || tick >= timetable.horizon() {
                return Err(Trip::LateCommand { tick });
            }
            earliest = tick + 1;
        }
        Ok(())
    }
}
