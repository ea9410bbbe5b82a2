//! Streams a torque profile: schedules are sent as far ahead as the board's queue and buffers allow, and samples are
//! received. The window follows from the ticks that the board has reported as done.

use std::time::{Duration, Instant};

use link::messages::{COMMANDS_PER_SCHEDULE, Command, FromBoard, RunMode, RunSettings, Schedule, ToBoard};

use super::{ANSWER_TIMEOUT, KEEP_ALIVE_INTERVAL, KEEP_ALIVES_IN_FLIGHT, SCHEDULES_IN_FLIGHT, Session};
use crate::profile::TorqueProfile;
use crate::trip;
use report::failure::{Failure, Outcome};

/// Time without progress of the ticks after which a board that still answers has lost a schedule.
const STALL_TIMEOUT: Duration = Duration::from_secs(4);

/// State of a stream.
struct StreamProgress<'p> {
    profile: &'p TorqueProfile,
    settings: RunSettings,
    horizon_after_last: u32,
    next_command: usize,
    next_sequence: u16,
    sent_any: bool,
    board_tick: u32,
    last_message: Instant,
    last_sent: Instant,
    last_advance: Instant,
}

impl Session<'_> {
    /// Runs a profile to its last sample; `progress` receives the ticks done.
    pub fn stream(&mut self, profile: &TorqueProfile, progress: &mut dyn FnMut(u32)) -> Outcome<()> {
        let settings = self.recording.settings.ok_or_else(|| Failure::new("a stream needs a reset before it"))?;
        let capacity = self.recording.hello.as_ref().map_or(0, |hello| usize::from(hello.queue_capacity));
        let tick_rate = self.recording.hello.as_ref().map_or(1, |hello| hello.tick_rate);
        if capacity == 0 {
            return Err(Failure::new("the board reports a command queue of length 0"));
        }
        let last_sample = profile.ticks - profile.ticks % u32::from(settings.decimation);
        let mut stream = StreamProgress::new(profile, settings, tick_rate);
        while self.recording.last_tick() < last_sample || stream.board_tick < last_sample {
            while let Some(schedule) = stream.next_schedule(capacity, self.unacknowledged.count()) {
                self.unacknowledged.add(schedule.sequence, &schedule.commands);
                self.send(&ToBoard::Schedule(schedule))?;
            }
            for message in self.receive()? {
                stream.last_message = Instant::now();
                match message {
                    FromBoard::Accepted(accepted) => stream.advance(accepted.tick),
                    FromBoard::Samples(batch) => {
                        stream.advance(batch.samples.last().map_or(0, |sample| sample.tick));
                    }
                    FromBoard::Tripped(raised) => return Err(trip::failure(&raised)),
                    FromBoard::Hello(_) => {
                        return Err(Failure::check_failed("the board restarted during the run")
                            .with_help("brown-out, watchdog or panic: see last_panic in the report's record"));
                    }
                    FromBoard::Statistics(_)
                    | FromBoard::Log(_)
                    | FromBoard::Answer(_)
                    | FromBoard::Loop(_)
                    | FromBoard::FaultTaken { .. }
                    | FromBoard::MemoryOutcome(_)
                    | FromBoard::Memory(_)
                    | FromBoard::MemoryChecked(_) => {}
                }
            }
            progress(stream.board_tick.min(profile.ticks));
            if stream.last_message.elapsed() > ANSWER_TIMEOUT {
                return Err(self.silence("nothing valid came"));
            }
            if stream.last_advance.elapsed() > STALL_TIMEOUT {
                return Err(self.stalled(&stream));
            }
        }
        Ok(())
    }

    fn stalled(&self, stream: &StreamProgress<'_>) -> Failure {
        let message = format!(
            "the board on {} answers, but stays at tick {} of {} ({} schedules unanswered)",
            self.line.name(),
            stream.board_tick,
            stream.profile.ticks,
            self.unacknowledged.count()
        );
        Failure::check_failed(message).with_help("a schedule or a sample was lost on the line: check it and run again")
    }
}

impl<'p> StreamProgress<'p> {
    fn new(profile: &'p TorqueProfile, settings: RunSettings, tick_rate: u32) -> Self {
        let now = Instant::now();
        // In real time the board runs until it is stopped: the last torque is valid until then.
        let hold_after = match settings.mode {
            RunMode::Lockstep => 0,
            RunMode::Realtime => 4 * tick_rate,
        };
        Self {
            profile,
            settings,
            horizon_after_last: profile.ticks.saturating_add(hold_after),
            next_command: 0,
            next_sequence: 0,
            sent_any: false,
            board_tick: 0,
            last_message: now,
            last_sent: now,
            last_advance: now,
        }
    }

    fn advance(&mut self, tick: u32) {
        if tick > self.board_tick {
            self.board_tick = tick;
            self.last_advance = Instant::now();
        }
    }

    /// Returns the next schedule if the board has room for it in addition to the schedules in flight. An empty schedule
    /// requests the board's tick when the stream waits for it, and keeps the command timeout from expiring.
    fn next_schedule(&mut self, capacity: usize, in_flight: usize) -> Option<Schedule> {
        let commands = &self.profile.commands;
        // A command leaves the queue with the step that it is for.
        let queued = commands[..self.next_command].iter().rev().take_while(|sent| sent.tick >= self.board_tick).count();
        let room = capacity.saturating_sub(queued).min(COMMANDS_PER_SCHEDULE);
        let left = commands.len() - self.next_command;
        let worth_a_frame = left.min(COMMANDS_PER_SCHEDULE).min(capacity.div_ceil(2));
        let reach = self.settings.farthest_horizon(self.board_tick);
        let within = commands[self.next_command..].iter().take(room).take_while(|next| next.tick < reach).count();
        let is_due = !self.sent_any || self.last_sent.elapsed() >= KEEP_ALIVE_INTERVAL;
        let is_worth_it = left > 0 && room >= worth_a_frame && (within >= worth_a_frame || is_due);
        let count = if is_worth_it && in_flight < SCHEDULES_IN_FLIGHT { within } else { 0 };
        if count == 0 && (!is_due || in_flight >= SCHEDULES_IN_FLIGHT + KEEP_ALIVES_IN_FLIGHT) {
            return None;
        }
        let chosen: &[Command] = &commands[self.next_command..self.next_command + count];
        self.next_command += count;
        let horizon = commands.get(self.next_command).map_or(self.horizon_after_last, |next| next.tick).min(reach);
        let sequence = self.next_sequence;
        self.next_sequence = sequence.wrapping_add(1);
        self.sent_any = true;
        self.last_sent = Instant::now();
        Some(Schedule { sequence, horizon, commands: heapless::Vec::from_slice(chosen).unwrap_or_default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A profile with seconds between its torques: every schedule stays within the board's reach, horizons never go
    /// back, and the stream ends.
    #[test]
    fn sparse_stream_stays_within_reach() {
        for mode in [RunMode::Lockstep, RunMode::Realtime] {
            let settings = RunSettings { mode, decimation: 1, command_timeout: 2000, from_memory: false };
            let commands =
                [0, 50_000, 50_001, 99_000].map(|tick| Command { tick, drive_torque: 0.1, load_torque: 0.0 });
            let profile = TorqueProfile { name: "sparse".into(), commands: commands.into(), ticks: 100_000 };
            let mut stream = StreamProgress::new(&profile, settings, 20_000);
            let (mut horizon, mut sent) = (0, Vec::new());
            let now = Instant::now();
            while stream.board_tick < profile.ticks {
                assert!(now.elapsed() < ANSWER_TIMEOUT, "it stays at tick {}", stream.board_tick);
                // Advances the keep-alive clock without waiting.
                stream.last_sent -= KEEP_ALIVE_INTERVAL;
                assert!(stream.next_schedule(127, SCHEDULES_IN_FLIGHT + KEEP_ALIVES_IN_FLIGHT).is_none());
                let schedule = stream.next_schedule(127, 0).expect("the host says that it is there");
                assert!(
                    schedule.horizon >= horizon && schedule.horizon <= settings.farthest_horizon(stream.board_tick)
                );
                assert!(schedule.commands.iter().all(|command| (horizon..schedule.horizon).contains(&command.tick)));
                horizon = schedule.horizon;
                sent.extend(schedule.commands);
                stream.advance(horizon);
            }
            assert_eq!(sent, commands);
        }
    }
}
