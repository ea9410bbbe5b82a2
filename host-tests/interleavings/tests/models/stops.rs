//! A stop is never unseen, and no reset overtakes it.

use link::messages::{FromBoard, ToBoard, Trip};
use loom::thread;

use crate::board::{Idle, SETTINGS, Tick, board, explore, frame, line, running};

#[test]
fn whoever_sees_the_frame_of_a_stop_sees_the_stop() {
    explore(3, || {
        let (mut interrupt, tick, _) = board();
        let heard = tick.heard;
        let line = thread::spawn(move || {
            interrupt.hear(&ToBoard::Stop);
            interrupt.hear(&ToBoard::Stop);
        });
        let frames = heard.frames();
        assert!(heard.stops() >= frames);
        line.join().unwrap();
        assert_eq!((heard.frames(), heard.stops()), (2, 2));
    });
}

#[test]
fn whoever_sees_a_stop_finds_every_byte_that_came_before_its_last() {
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

#[test]
fn the_tick_that_finds_a_stop_ends_the_run_and_so_does_the_one_after_it() {
    explore(3, || {
        let (mut interrupt, mut tick, _) = running();
        let line = thread::spawn(move || interrupt.hear(&ToBoard::Stop));
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

#[test]
fn no_run_begins_in_a_tick_that_can_know_of_the_stop_behind_its_reset() {
    explore(3, || {
        let (mut interrupt, mut tick, mut idle) = board();
        interrupt.hear(&ToBoard::Reset(SETTINGS));
        idle.poll();
        let line = thread::spawn(move || {
            interrupt.hear(&ToBoard::Stop);
            interrupt
        });
        for _ in 0..2 {
            let stopped = tick.heard.frames() == 2;
            tick.tick();
            assert!(!(stopped && tick.is_on()), "a run was begun, or goes on, after a stop");
        }
        let mut interrupt = line.join().unwrap();
        settle(&mut tick, &mut idle);
        let said = interrupt.said();
        assert!(matches!(said[..], [FromBoard::Hello(_)] | [FromBoard::Tripped(Trip::Overtaken)]), "{said:?}");
    });
}

#[test]
fn idle_knows_which_of_the_stops_that_were_heard_it_has_read() {
    explore(3, || {
        let (mut interrupt, mut tick, mut idle) = board();
        // The last byte of the reset, and the stop behind it, come while idle listens: no tick in between.
        let reset = frame(&ToBoard::Reset(SETTINGS));
        let (end, most) = reset.split_last().unwrap();
        interrupt.receive(most);
        let end = *end;
        let line = thread::spawn(move || {
            interrupt.receive(&[end]);
            interrupt.hear(&ToBoard::Stop);
            interrupt
        });
        idle.poll();
        idle.poll();
        let mut interrupt = line.join().unwrap();
        settle(&mut tick, &mut idle);
        assert_eq!(interrupt.said(), [FromBoard::Tripped(Trip::Overtaken)]);
    });
}

/// What is left to be done when the stop has been heard: the output is off all the while.
fn settle(tick: &mut Tick, idle: &mut Idle) {
    for _ in 0..4 {
        tick.tick();
        assert!(!tick.is_on(), "a run was begun, or goes on, after a stop");
        idle.poll();
    }
}
