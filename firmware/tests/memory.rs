//! Tests of the stored parameters: they survive a reset of the board and a power cut at any moment. They are stored in
//! flash between runs, checked at the start, and loaded when a run requests it. Other tests cover the quality of the
//! parameters.

#[allow(dead_code, reason = "shared with the tests of the roles")]
mod test_board;

use firmware::kept_memory::{KeptMemory, NOTHING, RECORD_BYTES};
use firmware::learnt::memory_state;
use firmware::observer::Observing;
use firmware::port::Direct;
use firmware::tables::{PLANETS, TABLES};
use firmware::work::Work;
use link::controller::Exchange;
use link::messages::{
    FromBoard, MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, PART_BYTES, RunMode, RunSettings,
    Schedule, ToBoard,
};
use model_core::compensation::{Command, Motion, Position};
use model_core::controller::{Answer, Controller};
use model_core::observer::{MEMORY_BYTES, Memory};
use model_core::virtual_joint::VirtualJoint;
use test_board::{Flash, TestBoard};

mod control {
    #![allow(missing_docs, dead_code, clippy::all, clippy::excessive_precision, reason = "generated numbers")]
    include!(concat!(env!("OUT_DIR"), "/control.rs"));
}

fn controller() -> Direct<'static> {
    Direct(Controller::with_tables(&control::OBSERVER, &control::COMPENSATION))
}

/// Motion to and fro through the gap, for the estimator.
fn command(tick: u32) -> Command<f32> {
    let (sine, cosine) = (core::f32::consts::TAU * 4.0 * 1e-4 * tick as f32).sin_cos();
    let position = Position { turns: 0, fraction: 0.01 * sine };
    Command::Position { now: Motion { position, speed: 1.6 * cosine, acceleration: -40.0 * sine }, ahead: None }
}

/// Runs exchanges with a virtual joint at the other end of the line; returns the last answer.
fn run(board: &mut TestBoard<Observing<Direct<'static>>>, from_memory: bool, ticks: u32) -> Answer<f32> {
    board.send(&ToBoard::Reset(RunSettings {
        mode: RunMode::Lockstep,
        decimation: 1,
        command_timeout: 1000,
        from_memory,
    }));
    board.run(2);
    assert!(matches!(board.said()[..], [FromBoard::Hello(_)]));
    let mut joint = VirtualJoint::<f32, PLANETS>::new(&TABLES, &control::SURROUNDINGS);
    let mut last = None;
    for tick in 0..ticks {
        let commands = [Exchange::new(tick, &joint.samples(), &command(tick))].into_iter().collect();
        board.send(&ToBoard::Exchanges(Schedule { sequence: tick as u16, horizon: tick + 1, commands }));
        board.run(2);
        let said = board.said();
        let answer = said.iter().find_map(|message| match message {
            FromBoard::Answer(answered) => answered.answer(),
            _ => None,
        });
        last = answer.or(last);
        joint.advance(answer.map_or(0.0, |answer| answer.shaped.torque), 0.0);
    }
    last.expect("answers")
}

fn saved(board: &mut TestBoard<Observing<Direct<'static>>>) -> MemoryOutcome {
    board.send(&ToBoard::Memory(MemoryRequest::Save));
    board.run(3);
    let kept = |message: FromBoard| if let FromBoard::MemoryOutcome(kept) = message { Some(kept) } else { None };
    board.said().into_iter().find_map(kept).expect("an answer")
}

fn stop(board: &mut TestBoard<Observing<Direct<'static>>>) {
    board.send(&ToBoard::Stop);
    board.run(3);
}

/// Starts a board with this flash; returns its verdict, too.
fn started_with(flash: Flash) -> (TestBoard<Observing<Direct<'static>>>, MemoryState) {
    let mut work = Observing::new(controller(), true);
    let mut kept = KeptMemory::open(flash.clone());
    let judged = kept.load().map(|memory| work.remember(&memory));
    (TestBoard::with_flash(work, flash), memory_state(judged))
}

/// Starts a board with this memory in flash; returns its verdict, too.
fn started(memory: Memory) -> (TestBoard<Observing<Direct<'static>>>, MemoryState) {
    started_with(Flash::holding(&memory))
}

#[test]
fn learning_continues_after_restart() {
    let (mut board, nothing) = started(NOTHING);
    assert_eq!(nothing, MemoryState::Nothing);
    let learnt = run(&mut board, false, 12_000).estimates;
    assert_eq!(saved(&mut board), MemoryOutcome::Running, "flash is not written while a motor runs");
    stop(&mut board);
    assert_eq!((saved(&mut board), saved(&mut board)), (MemoryOutcome::Stored, MemoryOutcome::Stored));
    assert_eq!(board.flash.cells().erased, 1, "the same is not written twice");
    let (mut again, found) = started_with(board.flash.clone());
    assert_eq!(found, MemoryState::Good);
    // Long enough to publish the loaded parameters, too short to estimate them.
    let [fresh, remembered] = [false, true].map(|from_memory| run(&mut again, from_memory, 50).estimates);
    assert_ne!(learnt.half_backlash.value, fresh.half_backlash.value, "there was something to learn");
    assert_eq!(remembered.half_backlash.value, learnt.half_backlash.value);
    assert_ne!(remembered.compliance.value, fresh.compliance.value);
}

#[test]
fn bad_memory_reported_and_unused() {
    let (mut board, _) = started(NOTHING);
    run(&mut board, false, 100);
    stop(&mut board);
    assert_eq!(saved(&mut board), MemoryOutcome::Stored);
    let good = board.flash.kept().expect("it was stored");
    let changed = |at: usize| {
        let mut memory = good;
        memory[at] ^= 1;
        memory
    };
    let cases = [
        (changed(0), MemoryState::NotAMemory),
        (changed(4), MemoryState::WrongVersion),
        (changed(200), MemoryState::Damaged),
        (of_another_joint(good), MemoryState::OtherJoint),
    ];
    for (memory, expected) in cases {
        let (mut board, found) = started(memory);
        assert_eq!(found, expected);
        let asked_for = run(&mut board, true, 50);
        let (mut other, _) = started(NOTHING);
        assert_eq!(asked_for, run(&mut other, false, 50), "{found:?}: it begins as it was designed");
    }
}

/// Returns the memory with another identity and a matching digest.
fn of_another_joint(mut memory: Memory) -> Memory {
    use model_core::numbers::digest;
    memory[8] ^= 1;
    let (content, stored) = memory.split_at_mut(MEMORY_BYTES - 8);
    let digest = content.iter().fold(digest::START, |running, byte| digest::chain(running, (*byte).into()));
    stored.copy_from_slice(&digest.to_le_bytes());
    memory
}

/// Memories that differ in every byte.
fn memories() -> [Memory; 3] {
    [1_usize, 2, 3].map(|salt| std::array::from_fn(|at| (at * 7 + salt * 31 + 1) as u8))
}

#[test]
fn power_cut_leaves_old_or_new_memory() {
    let [first, second, third] = memories();
    for has_check_bits in [true, false] {
        // Memories stored before, in this order; `None` at the end is an erase.
        let histories: [&[Option<Memory>]; 5] = [
            &[],
            &[Some(first)],
            &[Some(first), Some(second)],
            &[Some(first), None],
            &[Some(first), Some(second), None],
        ];
        for (history, asked) in histories.into_iter().flat_map(|history| [(history, Some(third)), (history, None)]) {
            let mut whole = 0;
            for cut in 0.. {
                let flash = Flash::empty();
                let mut board = KeptMemory::open(flash.clone());
                let mut put = |memory: &Option<Memory>| match memory {
                    Some(memory) => board.store(memory),
                    None => board.erase(),
                };
                history.iter().for_each(|memory| assert_eq!(put(memory), MemoryOutcome::Stored));
                let old = history.last().copied().flatten();
                {
                    let mut cells = flash.cells();
                    (cells.until_cut, cells.has_check_bits) = (Some(cut), has_check_bits);
                }
                put(&asked);
                let was_cut = flash.cells().until_cut == Some(0);
                flash.cells().until_cut = None;
                let mut again = KeptMemory::open(flash.clone());
                let found = again.load();
                assert!(found == old || found == asked, "cut {cut}: neither the old memory nor the new one is left");
                assert!(found.is_none() || !again.is_damaged());
                // After any remains the next memory is stored.
                assert_eq!(again.store(&first), MemoryOutcome::Stored);
                assert_eq!(flash.kept(), Some(first));
                if !was_cut {
                    break;
                }
                whole += 1;
            }
            let nothing_to_do = asked.is_none() && history.last().copied().flatten().is_none();
            assert!(nothing_to_do || whole > MEMORY_BYTES / 8, "{whole} cuts");
        }
    }
}

/// Unreadable flash is reported, and repaired by the next memory.
#[test]
fn unreadable_memory_repaired_by_next_write() {
    let [first, second, _] = memories();
    let flash = Flash::with([None, None]);
    let mut board = KeptMemory::open(flash.clone());
    assert_eq!((board.load(), board.is_damaged()), (None, true));
    assert_eq!((board.store(&first), board.is_damaged()), (MemoryOutcome::Stored, false));
    assert_eq!(flash.kept(), Some(first));
    flash.cells().is_starved = true;
    assert_eq!(board.store(&second), MemoryOutcome::LowSupply);
    assert_eq!(flash.kept(), Some(first), "it was not touched");
}

#[test]
fn newest_memory_found_in_any_slot() {
    let [first, second, third] = memories();
    let flash = Flash::empty();
    let mut board = KeptMemory::open(flash.clone());
    for memory in [first, second, third].iter().cycle().take(7) {
        assert_eq!(board.store(memory), MemoryOutcome::Stored);
        assert_eq!(flash.kept(), Some(*memory));
    }
}

#[test]
fn unwritable_flash_detected() {
    let (mut board, _) = started(NOTHING);
    board.flash.cells().works = false;
    run(&mut board, false, 10);
    stop(&mut board);
    assert_eq!(saved(&mut board), MemoryOutcome::NotWritten);
}

/// Sends a memory request; returns the answers.
fn asked(board: &mut TestBoard<Observing<Direct<'static>>>, request: MemoryRequest) -> Vec<FromBoard> {
    board.send(&ToBoard::Memory(request));
    board.run(3);
    board.said()
}

fn told(board: &mut TestBoard<Observing<Direct<'static>>>) -> Vec<u8> {
    let part = |part| match asked(board, MemoryRequest::Read { part }).pop() {
        Some(FromBoard::Memory(told)) if told.part == part => told.bytes,
        other => panic!("{other:?}"),
    };
    (0..MEMORY_PARTS).flat_map(part).collect()
}

/// Sends a memory; returns the answers.
fn brought(board: &mut TestBoard<Observing<Direct<'static>>>, memory: &Memory) -> Vec<FromBoard> {
    let parts = memory.chunks(PART_BYTES).zip(0..);
    let part =
        |(bytes, part): (&[u8], u8)| MemoryRequest::Load(MemoryPart { part, bytes: bytes.iter().copied().collect() });
    parts.flat_map(|of| asked(board, part(of))).collect()
}

/// Returns a memory of parameters estimated on a board.
fn learnt() -> Memory {
    let (mut board, _) = started(NOTHING);
    run(&mut board, false, 3000);
    stop(&mut board);
    assert_eq!(saved(&mut board), MemoryOutcome::Stored);
    let memory = board.flash.kept().expect("it was stored");
    assert_eq!(told(&mut board), memory, "it is told as it lies there");
    memory
}

#[test]
fn memory_transferred_and_erased() {
    let memory = learnt();
    let (mut board, _) = started_with(Flash::with([Some([0; RECORD_BYTES]); 2]));
    assert_eq!(
        asked(&mut board, MemoryRequest::Write),
        [FromBoard::MemoryOutcome(MemoryOutcome::Nothing)],
        "there is nothing to write"
    );
    assert_eq!(brought(&mut board, &memory), [FromBoard::MemoryChecked(MemoryState::Good)]);
    let from_memory = run(&mut board, true, 50);
    assert_eq!(asked(&mut board, MemoryRequest::Write), [FromBoard::MemoryOutcome(MemoryOutcome::Running)]);
    stop(&mut board);
    assert_eq!(asked(&mut board, MemoryRequest::Write), [FromBoard::MemoryOutcome(MemoryOutcome::Stored)]);
    assert_eq!(board.flash.kept(), Some(memory));
    let (mut other, found) = started(memory);
    assert_eq!((found, run(&mut other, true, 50)), (MemoryState::Good, from_memory), "as if it had learnt it itself");
    stop(&mut board);
    assert_eq!(asked(&mut board, MemoryRequest::Erase), [FromBoard::MemoryOutcome(MemoryOutcome::Stored)]);
    assert_eq!(
        (board.flash.kept(), board.flash.cells().erased),
        (None, 3),
        "a record of nothing, and the old one is gone"
    );
    assert_eq!(asked(&mut board, MemoryRequest::Erase), [FromBoard::MemoryOutcome(MemoryOutcome::Stored)]);
    assert_eq!(board.flash.cells().erased, 3, "what is empty is not worn out");
    assert_ne!(run(&mut board, true, 50), from_memory, "nothing is left to begin from");
}

#[test]
fn bad_memory_never_written() {
    let memory = learnt();
    let (mut board, _) = started(NOTHING);
    let mut damaged = memory;
    damaged[200] ^= 1;
    let cases = [(damaged, MemoryState::Damaged), (of_another_joint(memory), MemoryState::OtherJoint)];
    for (memory, state) in cases {
        assert_eq!(brought(&mut board, &memory), [FromBoard::MemoryChecked(state)]);
        assert_eq!(asked(&mut board, MemoryRequest::Write), [FromBoard::MemoryOutcome(MemoryOutcome::Nothing)]);
    }
    let late = MemoryRequest::Load(MemoryPart { part: 1, bytes: memory[PART_BYTES..].iter().copied().collect() });
    assert_eq!(
        asked(&mut board, late),
        [FromBoard::MemoryChecked(MemoryState::NotAMemory)],
        "its first part never came"
    );
    assert_eq!(board.flash.cells().erased, 0);
}

#[test]
fn role_without_memory_reports_it() {
    let mut board = TestBoard::new();
    for request in [MemoryRequest::Save, MemoryRequest::Read { part: 0 }, MemoryRequest::Write, MemoryRequest::Erase] {
        board.send(&ToBoard::Memory(request));
        board.run(3);
        assert_eq!(board.said(), [FromBoard::MemoryOutcome(MemoryOutcome::Nothing)]);
    }
}
