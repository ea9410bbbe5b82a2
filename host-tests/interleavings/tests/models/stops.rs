//! A stop is never overlooked, and no reset overtakes it.

use link::messages::{FromBoard, ToBoard, Trip};
use loom::thread;

use crate::board::{Idle, SETTINGS, Tick, board, explore, frame, line, running};

/// A thread that sees the frame of a stop sees the stop.
#[test]
fn stop_frame_makes_the_stop_visible() {
    explore(3, || {
        let (mut interrupt, tick, _) = board();
        let heard = tick.heard;
        let line = thread::spawn(move || {
            interrupt.receive_message(&ToBoard::Stop);
            interrupt.receive_message(&ToBoard::Stop);
        });
        let frames = heard.frames();
        assert!(heard.stops() >= frames);
        line.join().unwrap();
        assert_eq!((heard.frames(), heard.stops()), (2, 2));
    });
}

/// A thread that sees a stop finds every byte before the last byte of the stop.
#[test]
fn stop_makes_earlier_bytes_visible() {
    explore(3, || {
        let (mut interrupt, mut end) = line();
        let stop = frame(&ToBoard::Stop);
        let before = stop.len() - 1;
        let sending = thread::spawn(move || interrupt.receive(&stop));
        let stops = end.heard().stops();
        let found = std::iter::from_fn(|| end.read()).count();
        assert!(stops == 0 || found >= before, "{found} bytes");
        sending.join().unwrap();
    });
}

/// The tick that sees a stop ends the run, and the next tick keeps it ended.
#[test]
fn tick_that_sees_a_stop_ends_the_run() {
    explore(3, || {
        let (mut interrupt, mut tick, _) = running();
        let line = thread::spawn(move || interrupt.receive_message(&ToBoard::Stop));
        let before = tick.heard.frames();
        for _ in 0..2 {
            let stopped = tick.heard.frames() != before;
            tick.tick();
            assert!(!(stopped && tick.is_on()), "a stop was seen and the output is on");
        }
        line.join().unwrap();
        tick.tick();
        assert!(!tick.is_on());
    });
}

/// A tick that can see a stop behind a reset starts no run.
#[test]
fn stop_behind_reset_prevents_the_run() {
    explore(3, || {
        let (mut interrupt, mut tick, mut idle) = board();
        interrupt.receive_message(&ToBoard::Reset(SETTINGS));
        idle.poll();
        let line = thread::spawn(move || {
            interrupt.receive_message(&ToBoard::Stop);
            interrupt
        });
        for _ in 0..2 {
            let stopped = tick.heard.frames() == 2;
            tick.tick();
            assert!(!(stopped && tick.is_on()), "a run was begun, or goes on, after a stop");
        }
        let mut interrupt = line.join().unwrap();
        settle(&mut tick, &mut idle);
        let sent_messages = interrupt.sent_messages();
        assert!(
            matches!(sent_messages[..], [FromBoard::Hello(_)] | [FromBoard::Tripped(Trip::Overtaken)]),
            "{sent_messages:?}"
        );
    });
}

/// Idle knows which of the received stops it has read.
#[test]
fn idle_tells_read_stops_from_unread_ones() {
    explore(3, || {
        let (mut interrupt, mut tick, mut idle) = board();
        // The last byte of the reset and the stop behind it arrive while idle listens, without a tick in between.
        let reset = frame(&ToBoard::Reset(SETTINGS));
        let (end, head) = reset.split_last().unwrap();
        interrupt.receive(head);
        let end = *end;
        let line = thread::spawn(move || {
            interrupt.receive(&[end]);
            interrupt.receive_message(&ToBoard::Stop);
            interrupt
        });
        idle.poll();
        idle.poll();
        let mut interrupt = line.join().unwrap();
        settle(&mut tick, &mut idle);
        assert_eq!(interrupt.sent_messages(), [FromBoard::Tripped(Trip::Overtaken)]);
    });
}

/// Completes the handling of a stop, with the output off throughout.
fn settle(tick: &mut Tick, idle: &mut Idle) {
    for _ in 0..4 {
        tick.tick();
        assert!(!tick.is_on(), "a run was begun, or goes on, after a stop");
        idle.poll();
    }
}
