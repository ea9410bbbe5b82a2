//! Tests of the enable output: silence of the host and a stop switch it off in every state in which it is on.

#[allow(dead_code, reason = "shared with the host's tests of boards")]
mod test_board;
#[allow(dead_code, reason = "shared with the tests of the roles")]
mod test_roles;

use firmware::queues::COMMAND_CAPACITY;
use link::messages::{FromBoard, MemoryOutcome, MemoryRequest, RunMode, RunSettings, TIMEOUTS_AHEAD, ToBoard, Trip};
use test_board::TestBoard;
use test_roles::{LoopWork, ObserverWork, PlantWork, TestRole};

/// Ticks without a frame after which a run of these tests ends.
const TIMEOUT: u32 = 200;
const MODES: [RunMode; 2] = [RunMode::Lockstep, RunMode::Realtime];

fn reset(mode: RunMode) -> ToBoard {
    ToBoard::Reset(RunSettings { mode, decimation: 1, command_timeout: TIMEOUT, from_memory: false })
}

/// Returns a board in a run, if its role has runs of this mode.
fn started<W: TestRole>(mode: RunMode) -> Option<TestBoard<W>> {
    let mut board = TestBoard::with(W::work());
    board.send(&reset(mode));
    board.run(2);
    board.said();
    board.enable.get().then_some(board)
}

/// Last messages of the host before it falls silent.
fn last_words<W: TestRole>() -> Vec<(&'static str, Vec<ToBoard>)> {
    let hello = ToBoard::Hello { protocol: link::PROTOCOL_VERSION };
    let short = W::schedule(0, 1, 0..1);
    let far = W::schedule(0, TIMEOUTS_AHEAD * TIMEOUT, 0..1);
    let gap = W::schedule(7, 9, 8..9);
    vec![
        ("nothing but a reset", vec![]),
        ("a hello", vec![hello.clone()]),
        ("a short schedule", vec![short.clone()]),
        ("a schedule as far as is accepted", vec![far.clone()]),
        ("the same and a hello", vec![far.clone(), hello]),
        ("a schedule after a gap", vec![short, gap]),
    ]
}

fn silence_ends_a_run<W: TestRole>() {
    for mode in MODES {
        for (what, words) in last_words::<W>() {
            for reads in [true, false] {
                let Some(mut board) = started::<W>(mode) else { continue };
                board.wire.borrow_mut().blocked = !reads;
                words.iter().for_each(|word| board.send(word));
                board.settle();
                board.run(TIMEOUT / 2);
                assert!(board.enable.get(), "{mode:?}, {what}, reads {reads}: too early");
                board.run(TIMEOUT / 2 + 1);
                assert!(!board.enable.get(), "{mode:?}, {what}, reads {reads}: the run goes on");
                board.wire.borrow_mut().blocked = false;
                board.run(3);
                let lost = |said: &FromBoard| matches!(said, FromBoard::Tripped(Trip::CommandLoss { .. }));
                assert!(board.said().iter().any(lost), "{mode:?}, {what}: the reason is told");
            }
        }
    }
}

/// Whatever the host sent before.
#[test]
fn silent_host_ends_run_in_time() {
    silence_ends_a_run::<PlantWork>();
    silence_ends_a_run::<ObserverWork>();
    silence_ends_a_run::<LoopWork>();
}

/// Queue that is full when the stop arrives.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Filling {
    Nothing,
    /// The host does not read: the bytes to send, the samples and the events back up.
    Replies,
    /// Every place for commands.
    Commands,
    /// Received, unread bytes, because the host does not read.
    Inbox,
}

/// Knowledge of the board about future ticks.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Known {
    Nothing,
    Schedules,
    /// A schedule that waits for room.
    Held,
    /// A schedule after a lost one.
    Late,
}

const FILLINGS: [Filling; 4] = [Filling::Nothing, Filling::Replies, Filling::Commands, Filling::Inbox];
const KNOWN: [Known; 4] = [Known::Nothing, Known::Schedules, Known::Held, Known::Late];

/// Returns a board in a run in this state; `None` if the state ends the run or the mode has no such run.
fn brought_to<W: TestRole>(mode: RunMode, filling: Filling, known: Known) -> Option<TestBoard<W>> {
    let mut board = started::<W>(mode)?;
    let hello = ToBoard::Hello { protocol: link::PROTOCOL_VERSION };
    let mut sequence = 0;
    let mut send_until = |board: &mut TestBoard<W>, last: u32| {
        while sequence * W::MOST < last {
            let first = sequence * W::MOST;
            board.send(&W::schedule(sequence as u16, first + W::MOST, first..first + W::MOST));
            board.settle();
            sequence += 1;
        }
    };
    let capacity = u32::from(COMMAND_CAPACITY);
    match (filling, known) {
        // Few enough that no schedule is held.
        (Filling::Commands, _) => send_until(&mut board, capacity - W::MOST),
        (_, Known::Nothing) => {}
        _ => send_until(&mut board, 4 * W::MOST),
    }
    match known {
        Known::Nothing | Known::Schedules => {}
        // Enough that a schedule is still held after the ticks below.
        Known::Held => send_until(&mut board, capacity + 40 + W::MOST),
        Known::Late => board.send(&W::schedule(1000, 1900, 1800..1801)),
    }
    board.run(2);
    match filling {
        Filling::Nothing | Filling::Commands => {}
        Filling::Replies | Filling::Inbox => {
            board.wire.borrow_mut().blocked = true;
            let bytes = if filling == Filling::Inbox { 400 } else { 40 };
            (0..bytes).for_each(|_| board.send(&hello));
            board.settle();
            (0..20).for_each(|_| board.tick());
            board.settle();
        }
    }
    board.enable.get().then_some(board)
}

/// Returns the number of states in which the output was on.
fn stop_is_heard<W: TestRole>() -> usize {
    let mut states = 0;
    for mode in MODES {
        for filling in FILLINGS {
            for known in KNOWN {
                let Some(mut board) = brought_to::<W>(mode, filling, known) else { continue };
                board.send(&ToBoard::Stop);
                // Only the serial interrupt and the tick run: idle may be busy.
                board.hear();
                board.tick();
                assert!(!board.enable.get(), "{mode:?}, {filling:?}, {known:?}: the stop was not heard");
                board.wire.borrow_mut().blocked = false;
                board.run(50);
                assert!(!board.enable.get(), "{mode:?}, {filling:?}, {known:?}: the run goes on");
                board.said();
                board.send(&reset(RunMode::Lockstep));
                board.run(3);
                assert!(board.enable.get(), "{mode:?}, {filling:?}, {known:?}: the next run does not begin");
                states += 1;
            }
        }
    }
    states
}

/// In every state in which the output is on.
#[test]
fn stop_obeyed_within_a_tick() {
    // In real time no schedule is held: a schedule without room ends the run. The role `observer` has no such runs.
    let (lockstep, realtime) = (FILLINGS.len() * KNOWN.len(), FILLINGS.len() * (KNOWN.len() - 1));
    assert_eq!(stop_is_heard::<PlantWork>(), lockstep + realtime);
    assert_eq!(stop_is_heard::<ObserverWork>(), lockstep);
    assert_eq!(stop_is_heard::<LoopWork>(), lockstep + realtime);
}

fn assert_far_horizon_rejected<W: TestRole>() {
    for mode in MODES {
        let reach = TIMEOUTS_AHEAD * TIMEOUT;
        for (horizon, refused) in [(reach, false), (reach + 1, true), (u32::MAX, true)] {
            let Some(mut board) = started::<W>(mode) else { continue };
            board.send(&W::schedule(0, horizon, 0..1));
            board.run(2);
            assert_eq!(board.enable.get(), !refused, "{mode:?}, horizon {horizon}");
            let far = FromBoard::Tripped(Trip::FarHorizon { tick: horizon });
            assert_eq!(board.said().contains(&far), refused, "{mode:?}, horizon {horizon}");
        }
    }
}

#[test]
fn far_horizon_rejected() {
    assert_far_horizon_rejected::<PlantWork>();
    assert_far_horizon_rejected::<ObserverWork>();
    assert_far_horizon_rejected::<LoopWork>();
}

fn a_stop_overtakes_a_reset<W: TestRole>() {
    // The stop arrives before idle has read the reset, or after idle and before the tick.
    for idle_is_ahead in [false, true] {
        let mut board = started::<W>(RunMode::Lockstep).expect("a run");
        board.send(&reset(RunMode::Lockstep));
        if idle_is_ahead {
            board.settle();
        }
        board.send(&ToBoard::Stop);
        board.hear();
        board.tick();
        assert!(!board.enable.get());
        for _ in 0..5 {
            board.run(1);
            assert!(!board.enable.get(), "the stop was the last that was said");
        }
        assert_eq!(board.said(), [FromBoard::Tripped(Trip::Overtaken)]);
        board.send(&reset(RunMode::Lockstep));
        board.run(2);
        assert!(board.enable.get());
    }
}

/// No run begins by a reset that a stop has overtaken.
#[test]
fn stop_overtakes_reset() {
    a_stop_overtakes_a_reset::<PlantWork>();
    a_stop_overtakes_a_reset::<ObserverWork>();
    a_stop_overtakes_a_reset::<LoopWork>();
}

fn a_run_begins_afresh<W: TestRole>() {
    let mut board = started::<W>(RunMode::Lockstep).expect("a run");
    board.send(&W::schedule(0, 100, 0..2));
    board.run(5);
    board.send(&reset(RunMode::Lockstep));
    board.run(10);
    let steps = board.progress.steps.load(std::sync::atomic::Ordering::Relaxed);
    assert!(steps == 0 && board.enable.get(), "{steps} steps on what was asked of the run before");
}

#[test]
fn old_schedules_not_used_in_next_run() {
    a_run_begins_afresh::<PlantWork>();
    a_run_begins_afresh::<ObserverWork>();
    a_run_begins_afresh::<LoopWork>();
}

#[test]
fn rejected_reset_leaves_run_unchanged() {
    let mut board = started::<ObserverWork>(RunMode::Lockstep).expect("a run");
    board.send(&ObserverWork::schedule(0, 4, 0..4));
    board.run(2);
    board.send(&reset(RunMode::Realtime));
    board.run(2);
    assert!(board.said().contains(&FromBoard::Tripped(Trip::BadSettings)) && board.enable.get());
    board.send(&ObserverWork::schedule(1, 8, 4..8));
    board.run(10);
    let answers = board.said().into_iter().filter(|said| matches!(said, FromBoard::Answer(_))).count();
    assert!(answers >= 4 && board.progress.steps.load(std::sync::atomic::Ordering::Relaxed) == 8, "{answers}");
}

#[test]
fn reset_during_flash_write_starts_no_run() {
    let mut board = started::<ObserverWork>(RunMode::Lockstep).expect("a run");
    board.run(1);
    board.send(&ToBoard::Stop);
    board.run(2);
    board.said();
    board.send(&ToBoard::Memory(MemoryRequest::Save));
    board.settle();
    // Idle writes flash after the reset below has arrived; a stop after the reset may have been lost.
    board.tick();
    board.send(&reset(RunMode::Lockstep));
    board.send(&ToBoard::Hello { protocol: link::PROTOCOL_VERSION });
    board.run(3);
    assert!(!board.enable.get());
    let said = board.said();
    assert!(
        matches!(
            said[..],
            [FromBoard::MemoryOutcome(MemoryOutcome::Stored), FromBoard::Tripped(Trip::Overtaken), FromBoard::Hello(_)]
        ),
        "{said:?}"
    );
    board.send(&reset(RunMode::Lockstep));
    board.run(2);
    assert!(board.enable.get(), "what was sent meanwhile is answered");
}
