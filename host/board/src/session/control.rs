//! Runs of the roles with a controller: one exchange per control period with an observer, or a motion streamed to a
//! board that runs the whole loop. Every wait has a timeout.

use std::time::Instant;

use link::controller::{Answered, Exchange};
use link::messages::{FromBoard, RunMode, Schedule, ToBoard};
use link::virtual_joint::{KNOTS_PER_SCHEDULE, Knot, LoopSample};
use model_core::virtual_joint::fault::{Fault, FixedPoint};

use super::{ANSWER_TIMEOUT, KEEP_ALIVE_INTERVAL, KEEP_ALIVES_IN_FLIGHT, SCHEDULES_IN_FLIGHT, Session};
use crate::recording::lost_frames;
use crate::trip;
use report::failure::{Failure, Outcome};

impl Session<'_> {
    /// Sends the samples and set-point of a control period and waits for the answer.
    pub fn exchange(&mut self, exchange: Exchange) -> Outcome<Answered> {
        let tick = exchange.tick;
        let (horizon, commands) = (tick.wrapping_add(1), [exchange].into_iter().collect());
        let exchanges = ToBoard::Exchanges(Schedule { sequence: tick as u16, horizon, commands });
        self.request(
            &exchanges,
            &format!("answer to control period {tick}"),
            ANSWER_TIMEOUT,
            |message| match message {
                FromBoard::Answer(answered) if answered.tick == horizon => Some(Ok(answered)),
                FromBoard::Hello(_) => Some(Err(restarted())),
                _ => None,
            },
        )?
    }

    /// Sends faults between joint and controller to the board, before the motion begins.
    pub fn add_faults(&mut self, faults: &[Fault<FixedPoint<f32>>]) -> Outcome<()> {
        for fault in faults {
            let taken =
                self.request(&ToBoard::Fault(*fault), "answer to a fault of the test", ANSWER_TIMEOUT, |message| {
                    if let FromBoard::FaultTaken { taken } = message { Some(taken) } else { None }
                })?;
            if !taken {
                return Err(Failure::check_failed("the board rejects a fault of the test")
                    .with_help("in real time the run may have begun already: use --mode lockstep"));
            }
        }
        Ok(())
    }

    /// Streams a motion to its last period and returns the samples. In real time the last knot holds until the end.
    pub fn stream_motion(&mut self, knots: &[Knot], periods: u32) -> Outcome<Vec<LoopSample>> {
        let settings = self.recording.settings.ok_or_else(|| Failure::new("a motion needs a reset before it"))?;
        let capacity = self.recording.hello.as_ref().map_or(0, |hello| usize::from(hello.queue_capacity));
        let hold_after = if settings.mode == RunMode::Realtime { periods } else { 0 };
        let last = periods - periods % u32::from(settings.decimation);
        let (mut samples, mut next_batch) = (Vec::<LoopSample>::new(), 0_u16);
        let (mut next, mut sequence, mut board_tick) = (0, 0_u16, 0);
        let (mut last_received, mut last_sent) = (Instant::now(), Instant::now());
        while samples.last().map_or(0, |sample| sample.tick) < last {
            loop {
                let in_flight = self.unacknowledged.count();
                let farthest_horizon = settings.farthest_horizon(board_tick);
                let waiting = knots[..next].iter().rev().take_while(|knot| knot.tick >= board_tick).count();
                let free_places = capacity.saturating_sub(waiting).min(KNOTS_PER_SCHEDULE);
                let room = if in_flight < SCHEDULES_IN_FLIGHT { free_places } else { 0 };
                let count = knots[next..].iter().take(room).take_while(|knot| knot.tick < farthest_horizon).count();
                let is_full = count == KNOTS_PER_SCHEDULE || (count > 0 && count == knots.len() - next);
                let may_keep_alive = in_flight < SCHEDULES_IN_FLIGHT + KEEP_ALIVES_IN_FLIGHT;
                if !is_full && (last_sent.elapsed() < KEEP_ALIVE_INTERVAL || !may_keep_alive) {
                    break;
                }
                let commands = knots[next..next + count].iter().copied().collect();
                next += count;
                let horizon = knots.get(next).map_or(periods + hold_after, |knot| knot.tick).min(farthest_horizon);
                self.unacknowledged.add(sequence, &[]);
                self.send(&ToBoard::Trajectory(Schedule { sequence, horizon, commands }))?;
                sequence = sequence.wrapping_add(1);
                last_sent = Instant::now();
            }
            for message in self.receive()? {
                last_received = Instant::now();
                match message {
                    FromBoard::Accepted(accepted) => board_tick = accepted.tick.max(board_tick),
                    FromBoard::Loop(batch) => {
                        let Some(lost) = lost_frames(next_batch, batch.sequence) else { continue };
                        if lost > 0 {
                            return Err(Failure::check_failed("samples of the loop were lost on the line")
                                .with_help("check the line, or run with a larger --decimation"));
                        }
                        next_batch = next_batch.wrapping_add(1);
                        samples.extend(batch.samples);
                        board_tick = samples.last().map_or(board_tick, |sample| sample.tick.max(board_tick));
                    }
                    FromBoard::Tripped(raised) => return Err(trip::failure(&raised)),
                    FromBoard::Hello(_) => return Err(restarted()),
                    _ => {}
                }
            }
            if last_received.elapsed() > ANSWER_TIMEOUT {
                return Err(self.silence("nothing valid came"));
            }
        }
        samples.retain(|sample| sample.tick <= last);
        Ok(samples)
    }
}

fn restarted() -> Failure {
    Failure::check_failed("the board restarted during the run")
        .with_help("brown-out, watchdog or panic: check the board's supply and run again")
}
