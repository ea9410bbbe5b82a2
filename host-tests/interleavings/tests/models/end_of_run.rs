//! End of a run, and its report by the board.

use link::messages::{FromBoard, Trip};
use loom::thread;

use crate::board::{explore, running, schedule};

/// A run that becomes non-finite is reported after its last sample.
#[test]
fn failed_run_reports_trip_after_last_sample() {
    explore(3, || {
        let (mut interrupt, mut tick, mut idle) = running();
        interrupt.receive_message(&schedule(0, 0, &[1.0, 13.0]));
        idle.poll();
        tick.tick();
        let idle_thread = thread::spawn(move || {
            idle.poll();
            idle.poll();
            idle
        });
        tick.tick();
        assert!(!tick.is_on());
        let mut idle = idle_thread.join().unwrap();
        for _ in 0..4 {
            idle.poll();
        }
        let sent_messages = interrupt.sent_messages();
        let samples: Vec<u8> = sent_messages
            .iter()
            .flat_map(|message| if let FromBoard::Log(log) = message { log.bytes.to_vec() } else { vec![] })
            .collect();
        assert_eq!(samples, [1, 2], "{sent_messages:?}");
        assert_eq!(sent_messages.last(), Some(&FromBoard::Tripped(Trip::NotFinite { tick: 2 })), "{sent_messages:?}");
    });
}
