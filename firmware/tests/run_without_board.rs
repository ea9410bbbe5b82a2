//! Tests of whole runs over the line on a board without hardware: results equal the model's, nothing is lost, and
//! faults lead to the safe state. The emulator tests cover timing.

#[allow(dead_code, reason = "shared with the host's tests of boards")]
mod test_board;

use firmware::tables::{PLANETS, TABLES};
use link::messages::{COMMANDS_PER_SCHEDULE, FromBoard, RunMode, Sample, Statistics, ToBoard, Trip};
use model_core::gears::{Model, Torques};
use model_core::numbers::digest;
use test_board::{NO_TIMEOUT, PERIOD, TestBoard};

fn samples(said: &[FromBoard]) -> Vec<Sample> {
    let batches = said.iter().filter_map(|message| match message {
        FromBoard::Samples(batch) => Some(batch),
        _ => None,
    });
    let mut samples = Vec::new();
    for (sequence, batch) in batches.enumerate() {
        assert_eq!(usize::from(batch.sequence), sequence, "a batch is missing");
        samples.extend(batch.samples.iter().cloned());
    }
    samples
}

fn trips(said: &[FromBoard]) -> Vec<Trip> {
    let fault = |message: &FromBoard| match message {
        FromBoard::Tripped(fault) => Some(*fault),
        _ => None,
    };
    said.iter().filter_map(fault).collect()
}

fn accepted(said: &[FromBoard]) -> Vec<u16> {
    let sequence = |message: &FromBoard| match message {
        FromBoard::Accepted(accepted) => Some(accepted.sequence),
        _ => None,
    };
    said.iter().filter_map(sequence).collect()
}

fn statistics(board: &mut TestBoard, reset: bool) -> Statistics {
    board.send(&ToBoard::Statistics { reset });
    board.run(2);
    let statistics = board.said().into_iter().find_map(|message| match message {
        FromBoard::Statistics(statistics) => Some(statistics),
        _ => None,
    });
    statistics.expect("an answer")
}

/// No sample is lost.
#[test]
fn lockstep_run_bit_identical_to_model() {
    let torques = [(0, 0.2, 0.0), (100, -0.3, 1.0), (250, 0.1, -1.0)];
    let mut board = TestBoard::new();
    board.start(RunMode::Lockstep, 7, NO_TIMEOUT);
    board.schedule(0, 400, &torques);
    board.run(1000);
    let samples = samples(&board.said());
    assert_eq!(samples.iter().map(|sample| sample.tick).collect::<Vec<_>>(), (7..=400).step_by(7).collect::<Vec<_>>());

    let mut twin = Model::<f32, PLANETS>::new(&TABLES);
    let mut running = digest::START;
    let mut expected = samples.iter();
    for tick in 0..400 {
        let &(_, drive, load) = torques.iter().rfind(|command| command.0 <= tick).unwrap();
        twin.step(Torques { drive, load });
        running = digest::chain(running, twin.state_digest());
        if (tick + 1) % 7 == 0 {
            let sample = expected.next().unwrap();
            assert_eq!((sample.tick, sample.state_digest), (tick + 1, running));
            assert_eq!(sample.gap.to_bits(), twin.outputs().gap.to_bits());
        }
    }
    assert_eq!(statistics(&mut board, false).ticks, 400);
}

/// No sample is lost.
#[test]
fn lockstep_waits_for_slow_host() {
    let mut board = TestBoard::new();
    board.start(RunMode::Lockstep, 1, NO_TIMEOUT);
    board.schedule(0, 500, &[(0, 0.2, 0.0)]);
    board.settle();
    board.wire.borrow_mut().blocked = true;
    board.run(1000);
    board.wire.borrow_mut().blocked = false;
    board.run(1000);
    assert_eq!(samples(&board.said()).len(), 500);
    let statistics = statistics(&mut board, false);
    assert!(statistics.waited > 0);
    assert_eq!((statistics.ticks, statistics.lost_samples), (500, 0));
}

#[test]
fn realtime_counts_samples_lost_to_slow_host() {
    let mut board = TestBoard::new();
    board.start(RunMode::Realtime, 1, 1000);
    board.schedule(0, 500, &[]);
    board.settle();
    board.wire.borrow_mut().blocked = true;
    board.run(500);
    board.wire.borrow_mut().blocked = false;
    let statistics = statistics(&mut board, false);
    assert!(statistics.lost_samples > 0);
    assert!(statistics.ticks >= 500);
}

#[test]
fn realtime_without_commands_ends_safe() {
    let mut board = TestBoard::new();
    board.start(RunMode::Realtime, 10, 50);
    board.schedule(0, 100, &[(0, 0.2, 0.0)]);
    // The host sends frames, but no schedule.
    let mut heard_for = |ticks: u32| {
        for _ in 0..ticks / 10 {
            board.send(&ToBoard::Hello { protocol: link::PROTOCOL_VERSION });
            board.run(10);
        }
        board.enable.get()
    };
    assert!(heard_for(120));
    assert!(!heard_for(100));
    assert_eq!(trips(&board.said()), [Trip::CommandLoss { tick: 150 }]);
    assert_eq!(statistics(&mut board, false).starved, 50);
}

/// Lockstep waits for a missing schedule.
#[test]
fn missing_schedule_counted() {
    let mut board = TestBoard::new();
    board.start(RunMode::Lockstep, 10, NO_TIMEOUT);
    board.schedule(0, 100, &[(0, 0.2, 0.0)]);
    board.schedule(2, 300, &[(200, 0.1, 0.0)]);
    board.run(500);
    assert_eq!(accepted(&board.said()), [0]);
    let counted = statistics(&mut board, false);
    assert_eq!((counted.ticks, counted.lost_schedules), (100, 1));
    board.schedule(1, 200, &[(100, 0.1, 0.0)]);
    board.schedule(2, 300, &[(200, 0.1, 0.0)]);
    board.schedule(1, 200, &[(100, 0.1, 0.0)]);
    board.run(500);
    assert_eq!(accepted(&board.said()), [1, 2, 1]);
    assert_eq!(statistics(&mut board, false).ticks, 300);
}

/// A full queue makes the host wait in lockstep, and trips in realtime.
#[test]
fn full_queue_waits_or_trips() {
    let commands = |schedule: u32| -> Vec<(u32, f32, f32)> {
        (0..COMMANDS_PER_SCHEDULE as u32).map(|i| ((schedule * 24 + i) * 10, 0.1, 0.0)).collect()
    };
    for mode in [RunMode::Lockstep, RunMode::Realtime] {
        let mut board = TestBoard::new();
        board.start(mode, 100, NO_TIMEOUT);
        // As many as queue, intake and line hold, then the others.
        for schedules in [0..8, 8..12] {
            for i in schedules {
                board.schedule(i, (u32::from(i) + 1) * 240, &commands(i.into()));
                board.settle();
            }
            board.run(2000);
        }
        let said = board.said();
        match mode {
            RunMode::Lockstep => assert_eq!(accepted(&said), (0..12).collect::<Vec<_>>()),
            RunMode::Realtime => assert_eq!(trips(&said)[0], Trip::QueueFull),
        }
    }
}

#[test]
fn bad_commands_trip() {
    let cases = [
        (vec![(5, f32::NAN, 0.0)], Trip::BadCommand { tick: 5 }),
        (vec![(5, 0.0, f32::INFINITY)], Trip::BadCommand { tick: 5 }),
        (vec![(5, 0.1, 0.0), (5, 0.2, 0.0)], Trip::LateCommand { tick: 5 }),
        (vec![(5, 0.1, 0.0), (3, 0.2, 0.0)], Trip::LateCommand { tick: 3 }),
        (vec![(100, 0.1, 0.0)], Trip::LateCommand { tick: 100 }),
    ];
    for (commands, fault) in cases {
        let mut board = TestBoard::new();
        board.start(RunMode::Lockstep, 1, NO_TIMEOUT);
        board.schedule(0, 100, &commands);
        board.run(200);
        let said = board.said();
        assert_eq!(trips(&said), [fault]);
        assert!(samples(&said).is_empty() && !board.enable.get());
    }
}

#[test]
fn fault_lasts_until_reset() {
    let mut board = TestBoard::new();
    board.schedule(0, 10, &[]);
    board.run(2);
    assert_eq!(trips(&board.said()), [Trip::NotRunning]);
    board.start(RunMode::Lockstep, 1, NO_TIMEOUT);
    board.schedule(0, 10, &[(0, f32::NAN, 0.0)]);
    board.schedule(0, 10, &[]);
    board.run(10);
    assert_eq!(trips(&board.said()), [Trip::BadCommand { tick: 0 }, Trip::NotRunning]);
    board.start(RunMode::Lockstep, 1, NO_TIMEOUT);
    board.schedule(0, 10, &[]);
    board.run(20);
    assert_eq!(samples(&board.said()).len(), 10);
}

#[test]
fn unusable_settings_rejected() {
    for (decimation, command_timeout) in [(0, 1), (1, 0)] {
        let mut board = TestBoard::new();
        let settings =
            link::messages::RunSettings { mode: RunMode::Realtime, decimation, command_timeout, from_memory: false };
        board.send(&ToBoard::Reset(settings));
        board.run(3);
        assert_eq!(trips(&board.said()), [Trip::BadSettings]);
        assert!(!board.enable.get());
    }
}

/// A stop switches the output off after all samples are sent.
#[test]
fn stop_sends_all_samples_first() {
    let mut board = TestBoard::new();
    board.start(RunMode::Lockstep, 1, NO_TIMEOUT);
    assert!(board.enable.get());
    board.schedule(0, 9, &[]);
    board.run(20);
    board.send(&ToBoard::Stop);
    board.run(3);
    assert!(!board.enable.get());
    assert_eq!(samples(&board.said()).len(), 9);
}

#[test]
fn tables_with_wrong_digest_never_run() {
    let mut tables = TABLES.clone();
    tables.tick_rate += 1;
    let mut board = TestBoard::with_tables(Box::leak(Box::new(tables)));
    board.send(&ToBoard::Reset(link::messages::RunSettings {
        mode: RunMode::Lockstep,
        decimation: 1,
        command_timeout: 1,
        from_memory: false,
    }));
    board.run(3);
    assert_eq!(trips(&board.said()), [Trip::BadDigest]);
    assert!(!board.enable.get());
}

/// The counts can be cleared.
#[test]
fn late_ticks_counted() {
    let mut board = TestBoard::new();
    board.start(RunMode::Lockstep, 1000, NO_TIMEOUT);
    board.schedule(0, 10, &[]);
    board.timing = (30, PERIOD);
    board.run(20);
    let before = statistics(&mut board, true);
    assert!(before.overruns >= 10, "{}", before.overruns);
    assert_eq!((before.lateness.min, before.computation.max), (20, PERIOD));
    board.timing = (25, 100);
    board.run(2);
    statistics(&mut board, true);
    board.run(5);
    let after = statistics(&mut board, false);
    assert_eq!((after.overruns, after.lateness.max, after.ticks), (0, 25, 0));
}

#[test]
fn garbage_counted_and_harmless() {
    let mut board = TestBoard::new();
    board.start(RunMode::Lockstep, 1, NO_TIMEOUT);
    board.send_bytes(&[1, 2, 3, 0, 9, 9, 0]);
    board.schedule(0, 5, &[]);
    board.run(10);
    assert_eq!(samples(&board.said()).len(), 5);
    assert_eq!(statistics(&mut board, false).bad_frames, 2);
}

#[test]
fn identity_sent_in_every_state() {
    let mut board = TestBoard::new();
    for _ in 0..3 {
        board.send(&ToBoard::Hello { protocol: 99 });
        board.settle();
        match &board.said()[..] {
            [FromBoard::Hello(hello)] => assert_eq!((hello.joint_digest, hello.digest_good), (TABLES.digest, true)),
            other => panic!("{other:?}"),
        }
        board.schedule(0, 5, &[]);
        board.run(2);
        board.said();
    }
}

#[test]
fn run_after_reset_equals_first() {
    let mut board = TestBoard::new();
    let mut runs = Vec::new();
    for _ in 0..2 {
        board.start(RunMode::Lockstep, 3, NO_TIMEOUT);
        board.schedule(0, 90, &[(0, 0.2, 0.0), (40, -0.2, 0.5)]);
        board.run(100);
        runs.push(samples(&board.said()).iter().map(|sample| (sample.tick, sample.state_digest)).collect::<Vec<_>>());
        board.send_bytes(&[1, 2, 3, 0]);
        board.run(2);
    }
    assert_eq!(runs[0].len(), 30);
    assert_eq!(runs[0], runs[1]);
    board.start(RunMode::Lockstep, 3, NO_TIMEOUT);
    let fresh = statistics(&mut board, false);
    assert_eq!((fresh.ticks, fresh.bad_frames), (0, 0));
}

#[test]
fn fault_sent_after_last_sample() {
    let mut board = TestBoard::new();
    board.start(RunMode::Realtime, 1, 8);
    board.schedule(0, 2, &[]);
    board.settle();
    (0..12).for_each(|_| board.tick());
    board.settle();
    let said = board.said();
    assert_eq!(samples(&said).len(), 8);
    assert_eq!(said.last(), Some(&FromBoard::Tripped(Trip::CommandLoss { tick: 8 })));
}
