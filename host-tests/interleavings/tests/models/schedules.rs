//! Commands and the horizon behind which they lie.

use link::messages::{FromBoard, ToBoard};
use loom::thread;

use crate::board::{SETTINGS, explore, running, schedule};

#[test]
fn every_step_uses_the_command_of_its_tick_and_none_is_lost() {
    explore(2, || {
        let (mut interrupt, mut tick, mut idle) = running();
        interrupt.hear(&schedule(0, 0, &[1.0, 2.0]));
        interrupt.hear(&schedule(1, 2, &[3.0]));
        idle.poll();
        tick.tick();
        let listening = thread::spawn(move || idle.poll());
        for _ in 0..2 {
            tick.tick();
        }
        listening.join().unwrap();
        tick.tick();
        tick.tick();
        assert_eq!(*tick.used.lock().unwrap(), [1.0, 2.0, 3.0]);
        assert!(tick.is_on());
    });
}

#[test]
fn a_run_that_follows_another_begins_with_its_own_commands_at_once() {
    explore(3, || {
        let (mut interrupt, mut tick, mut idle) = running();
        interrupt.hear(&schedule(0, 0, &[1.0, 2.0]));
        idle.poll();
        tick.tick();
        tick.tick();
        interrupt.hear(&ToBoard::Stop);
        idle.poll();
        tick.tick();
        idle.poll();
        interrupt.hear(&ToBoard::Reset(SETTINGS));
        interrupt.hear(&schedule(0, 0, &[3.0]));
        idle.poll();
        let talking = thread::spawn(move || {
            for _ in 0..3 {
                idle.poll();
            }
            idle
        });
        tick.tick();
        tick.tick();
        let mut idle = talking.join().unwrap();
        for _ in 0..2 {
            idle.poll();
            tick.tick();
        }
        let said = interrupt.said();
        assert!(!said.iter().any(|message| matches!(message, FromBoard::Tripped(_))), "{said:?}");
        assert_eq!(*tick.used.lock().unwrap(), [1.0, 2.0, 3.0]);
    });
}
