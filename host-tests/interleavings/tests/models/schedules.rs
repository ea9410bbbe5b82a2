//! Commands and the horizon up to which they are known.

use link::messages::{FromBoard, ToBoard};
use loom::thread;

use crate::board::{SETTINGS, explore, running, schedule};

/// Every step uses the command of its tick, and no command is lost.
#[test]
fn every_step_uses_the_command_of_its_tick() {
    explore(2, || {
        let (mut interrupt, mut tick, mut idle) = running();
        interrupt.receive_message(&schedule(0, 0, &[1.0, 2.0]));
        interrupt.receive_message(&schedule(1, 2, &[3.0]));
        idle.poll();
        tick.tick();
        let idle_thread = thread::spawn(move || idle.poll());
        for _ in 0..2 {
            tick.tick();
        }
        idle_thread.join().unwrap();
        tick.tick();
        tick.tick();
        assert_eq!(*tick.used.lock().unwrap(), [1.0, 2.0, 3.0]);
        assert!(tick.is_on());
    });
}

/// A run after another one starts with its own commands at once.
#[test]
fn next_run_uses_its_own_commands() {
    explore(3, || {
        let (mut interrupt, mut tick, mut idle) = running();
        interrupt.receive_message(&schedule(0, 0, &[1.0, 2.0]));
        idle.poll();
        tick.tick();
        tick.tick();
        interrupt.receive_message(&ToBoard::Stop);
        idle.poll();
        tick.tick();
        idle.poll();
        interrupt.receive_message(&ToBoard::Reset(SETTINGS));
        interrupt.receive_message(&schedule(0, 0, &[3.0]));
        idle.poll();
        let idle_thread = thread::spawn(move || {
            for _ in 0..3 {
                idle.poll();
            }
            idle
        });
        tick.tick();
        tick.tick();
        let mut idle = idle_thread.join().unwrap();
        for _ in 0..2 {
            idle.poll();
            tick.tick();
        }
        let sent_messages = interrupt.sent_messages();
        assert!(!sent_messages.iter().any(|message| matches!(message, FromBoard::Tripped(_))), "{sent_messages:?}");
        assert_eq!(*tick.used.lock().unwrap(), [1.0, 2.0, 3.0]);
    });
}
