//! Random conversations: whatever a host sends, omits or does not read, a stop takes effect, a silent host's run ends
//! in time, every answer belongs to a request and answers keep their order, and no run continues after a fault.

#[allow(dead_code, reason = "shared with the host's tests of boards")]
mod test_board;
#[allow(dead_code, reason = "shared with the tests of the roles")]
mod test_roles;

use std::collections::VecDeque;
use std::sync::atomic::Ordering::Relaxed;

use link::messages::{FromBoard, MemoryRequest, RunMode, RunSettings, ToBoard, Trip};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestCaseResult, TestRunner};
use test_board::TestBoard;
use test_roles::{LoopWork, ObserverWork, PlantWork, TestRole};

/// Command timeout of every run [ticks].
const TIMEOUT: u32 = 30;

/// Action or omission of a host.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "a few dozen of them at a time")]
enum Action {
    Hello,
    Reset {
        mode: RunMode,
        good: bool,
    },
    /// The next schedule: number of ticks, and of commands among them.
    Schedule {
        ticks: u32,
        commands: u32,
    },
    /// A schedule with a wrong number or a wrong horizon.
    WrongSchedule {
        sequence: u16,
        horizon: u32,
    },
    /// A schedule for another role.
    WrongRole,
    Stop,
    Statistics,
    Memory(MemoryRequest),
    Garbage(Vec<u8>),
    /// Number of hellos.
    Flood(usize),
    /// Sets if the host reads the board's messages.
    Read(bool),
    /// Ticks with idle in between.
    Run(u32),
    /// Ticks without idle.
    Busy(u32),
}

fn action() -> impl Strategy<Value = Action> {
    let mode = prop_oneof![3 => Just(RunMode::Lockstep), 2 => Just(RunMode::Realtime)];
    let memory = prop_oneof![
        Just(MemoryRequest::Save),
        Just(MemoryRequest::Read { part: 1 }),
        Just(MemoryRequest::Write),
        Just(MemoryRequest::Erase),
    ];
    prop_oneof![
        2 => Just(Action::Hello),
        6 => (mode, prop::bool::weighted(0.9)).prop_map(|(mode, good)| Action::Reset { mode, good }),
        6 => (1_u32..60, 0_u32..30).prop_map(|(ticks, commands)| Action::Schedule { ticks, commands }),
        1 => (any::<u16>(), 0_u32..1000).prop_map(|(sequence, horizon)| Action::WrongSchedule { sequence, horizon }),
        1 => Just(Action::WrongRole),
        2 => Just(Action::Stop),
        1 => Just(Action::Statistics),
        2 => memory.prop_map(Action::Memory),
        1 => vec(any::<u8>(), 1..40).prop_map(Action::Garbage),
        1 => (1_usize..200).prop_map(Action::Flood),
        2 => any::<bool>().prop_map(Action::Read),
        8 => (1..2 * TIMEOUT).prop_map(Action::Run),
        3 => (1..2 * TIMEOUT).prop_map(Action::Busy),
    ]
}

/// Board with its externally visible state.
struct Case<W: TestRole> {
    board: TestBoard<W>,
    /// Requests that may still be answered, in order.
    asked: VecDeque<ToBoard>,
    /// Number and first tick of the next schedule.
    next: (u16, u32),
    /// A reset has been sent since the last stop.
    may_run: bool,
    /// Ticks since the last good frame.
    quiet: u32,
    /// State after the last tick: in the safe state, steps.
    before: (bool, u32),
    /// Longest time that the output was on after the last good frame, and number of times that it was switched on.
    seen: (u32, u32),
}

impl<W: TestRole> Case<W> {
    fn new() -> Self {
        Self {
            board: TestBoard::with(W::work()),
            asked: VecDeque::new(),
            next: (0, 0),
            may_run: false,
            quiet: 0,
            before: (false, 0),
            seen: (0, 0),
        }
    }

    /// Sends a message; the line's interrupt receives it at once.
    fn send(&mut self, message: ToBoard) {
        self.board.send(&message);
        self.board.hear();
        self.quiet = 0;
        self.may_run = match message {
            ToBoard::Stop => false,
            ToBoard::Reset(_) => true,
            _ => self.may_run,
        };
        self.asked.push_back(message);
    }

    fn tick(&mut self) -> TestCaseResult {
        let (was_on, switched_on) = (self.board.enable.get(), self.board.switched_on.get());
        self.board.tick();
        let (on, progress) = (self.board.enable.get(), self.board.progress);
        let (tripped, steps) = (progress.tripped.load(Relaxed), progress.steps.load(Relaxed));
        prop_assert!(on || self.board.switched_on.get() == switched_on, "the output was on for a part of a tick");
        prop_assert_eq!(on, progress.running.load(Relaxed), "the output is on in a run only");
        prop_assert!(self.may_run || !on, "a stop was not heard, or a run began without a reset");
        self.quiet += 1;
        prop_assert!(!on || self.quiet <= TIMEOUT, "a silent host's run goes on after {} ticks", self.quiet);
        prop_assert!(!(on && tripped), "the output is on in the safe state");
        if self.before.0 {
            prop_assert!(steps == self.before.1 || steps <= 1, "a step was made after a fault");
        }
        self.before = (tripped, steps);
        self.seen =
            (if on { self.seen.0.max(self.quiet) } else { self.seen.0 }, self.seen.1 + u32::from(on && !was_on));
        Ok(())
    }

    /// Checks that every answer belongs to the first request it can answer, and that no earlier request is answered
    /// later.
    fn take_answers(&mut self) -> TestCaseResult {
        for answer in self.board.said() {
            let is_answered = |request: &ToBoard| match (&answer, request) {
                (FromBoard::Hello(_), ToBoard::Hello { .. } | ToBoard::Reset(_)) => true,
                (FromBoard::Tripped(Trip::BadSettings | Trip::Overtaken), ToBoard::Reset(_)) => true,
                (FromBoard::Statistics(_), ToBoard::Statistics { .. }) => true,
                (FromBoard::MemoryOutcome(_), ToBoard::Memory(_)) => true,
                (FromBoard::Memory(told), ToBoard::Memory(MemoryRequest::Read { part })) => told.part == *part,
                (FromBoard::Accepted(accepted), ToBoard::Schedule(schedule)) => schedule.sequence == accepted.sequence,
                (FromBoard::Accepted(accepted), ToBoard::Exchanges(schedule)) => schedule.sequence == accepted.sequence,
                (FromBoard::Accepted(accepted), ToBoard::Trajectory(schedule)) => {
                    schedule.sequence == accepted.sequence
                }
                _ => false,
            };
            match answer {
                FromBoard::Tripped(Trip::BadSettings | Trip::Overtaken) => {}
                // Belongs to the run, not to a request.
                FromBoard::Tripped(_) | FromBoard::Samples(_) | FromBoard::Answer(_) | FromBoard::Loop(_) => continue,
                _ => {}
            }
            let place = self.asked.iter().position(is_answered);
            prop_assert!(place.is_some(), "{:?} answers nothing of {:?}", answer, self.asked);
            let skipped: Vec<ToBoard> = self.asked.drain(..=place.unwrap_or(0)).collect();
            self.none_is_owed(&skipped[..skipped.len() - 1])?;
        }
        Ok(())
    }

    /// Checks that no request was passed over that must be answered, unless the line was too full for it.
    fn none_is_owed(&self, passed: &[ToBoard]) -> TestCaseResult {
        let is_owed = |of: &&ToBoard| {
            matches!(of, ToBoard::Hello { .. } | ToBoard::Reset(_) | ToBoard::Statistics { .. } | ToBoard::Memory(_))
        };
        let owed = passed.iter().find(is_owed).filter(|_| self.board.heard.lost() == 0);
        prop_assert!(owed.is_none(), "{:?} was never answered", owed);
        Ok(())
    }

    fn act(&mut self, action: Action) -> TestCaseResult {
        let hello = ToBoard::Hello { protocol: link::PROTOCOL_VERSION };
        match action {
            Action::Hello => self.send(hello),
            Action::Reset { mode, good } => {
                self.next = (0, 0);
                let decimation = u16::from(good);
                self.send(ToBoard::Reset(RunSettings {
                    mode,
                    decimation,
                    command_timeout: TIMEOUT,
                    from_memory: false,
                }));
            }
            Action::Schedule { ticks, commands } => {
                let (sequence, first) = self.next;
                self.next = (sequence.wrapping_add(1), first + ticks);
                self.send(W::schedule(sequence, first + ticks, first..first + commands.min(ticks).min(W::MOST)));
            }
            Action::WrongSchedule { sequence, horizon } => self.send(W::schedule(sequence, horizon, 3..4)),
            Action::WrongRole => {
                let other = PlantWork::schedule(0, 1, 0..1);
                let is_mine = matches!(W::schedule(0, 1, 0..1), ToBoard::Schedule(_));
                self.send(if is_mine { LoopWork::schedule(0, 1, 0..1) } else { other });
            }
            Action::Stop => self.send(ToBoard::Stop),
            Action::Statistics => self.send(ToBoard::Statistics { reset: true }),
            Action::Memory(request) => self.send(ToBoard::Memory(request)),
            Action::Garbage(mut bytes) => {
                // The stop is a frame of its own and spoils no later frame.
                bytes.push(0);
                self.board.send_bytes(&bytes);
                self.board.hear();
            }
            Action::Flood(count) => (0..count).for_each(|_| self.send(hello.clone())),
            Action::Read(reads) => self.board.wire.borrow_mut().blocked = !reads,
            Action::Run(ticks) => {
                for _ in 0..ticks {
                    self.board.settle();
                    self.tick()?;
                }
                self.board.settle();
                self.take_answers()?;
            }
            Action::Busy(ticks) => (0..ticks).try_for_each(|_| self.tick())?,
        }
        Ok(())
    }

    /// Checks that, once the host reads again, everything is answered and the board works as before.
    fn end(mut self) -> Result<(u32, u32), TestCaseError> {
        self.act(Action::Read(true))?;
        self.act(Action::Run(TIMEOUT))?;
        // A dropped frame may still be answered: a frame without its last byte is ended by the next frame.
        let left: Vec<ToBoard> = self.asked.iter().cloned().collect();
        self.none_is_owed(&left)?;
        self.act(Action::Stop)?;
        self.act(Action::Run(2))?;
        self.act(Action::Reset { mode: RunMode::Lockstep, good: true })?;
        self.act(Action::Run(2))?;
        prop_assert!(self.board.enable.get(), "the next run does not begin");
        Ok(self.seen)
    }
}

fn converse<W: TestRole>(cases: u32, rng_seed: RngSeed) {
    let config = Config { cases, rng_seed, failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new(config);
    let seen = std::cell::Cell::new((0, 0));
    let outcome = runner.run(&vec(action(), 1..40), |actions| {
        let mut case = Case::<W>::new();
        actions.into_iter().try_for_each(|action| case.act(action))?;
        let (quiet, runs) = case.end()?;
        seen.set((seen.get().0.max(quiet), seen.get().1 + runs));
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
    let (quiet, runs) = seen.get();
    assert!(quiet == TIMEOUT && runs > cases, "no run came to its timeout, or none began: {quiet}, {runs}");
}

/// No conversation keeps the output on or mixes up its answers.
#[test]
fn conversations_safe_and_answered() {
    converse::<PlantWork>(150, RngSeed::Fixed(1));
    converse::<ObserverWork>(100, RngSeed::Fixed(1));
    converse::<LoopWork>(100, RngSeed::Fixed(1));
}

#[test]
#[ignore = "long: the same with many more conversations, others every time"]
fn many_conversations_safe_and_answered() {
    converse::<PlantWork>(40_000, RngSeed::Random);
    converse::<ObserverWork>(20_000, RngSeed::Random);
    converse::<LoopWork>(20_000, RngSeed::Random);
}
