//! The end of a run, and what the board says of it.

use link::messages::{FromBoard, Trip};
use loom::thread;

use crate::board::{explore, running, schedule};

#[test]
fn a_run_that_breaks_down_is_said_to_have_ended_after_its_last_sample() {
    explore(3, || {
        let (mut interrupt, mut tick, mut idle) = running();
        interrupt.hear(&schedule(0, 0, &[1.0, 13.0]));
        idle.poll();
        tick.tick();
        let talking = thread::spawn(move || {
            idle.poll();
            idle.poll();
            idle
        });
        tick.tick();
        assert!(!tick.is_on());
        let mut idle = talking.join().unwrap();
        for _ in 0..4 {
            idle.poll();
        }
        let said = interrupt.said();
        let samples: Vec<u8> = said
            .iter()
            .flat_map(|message| if let FromBoard::Log(log) = message { log.bytes.to_vec() } else { vec![] })
            .collect();
        assert_eq!(samples, [1, 2], "{said:?}");
        assert_eq!(said.last(), Some(&FromBoard::Tripped(Trip::NotFinite { tick: 2 })), "{said:?}");
    });
}
