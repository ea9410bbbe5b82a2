//! A board in a thread behind a line that is disturbed by a seed.

mod bad_line;
#[allow(dead_code, reason = "every test binary uses its own part of it")]
mod thread_board;

use std::os::unix::net::UnixStream;
use std::time::Duration;

use bad_line::trial::{Trial, seeds};
use thread_board::{Misbehaviour, TICK_RATE};

/// A disturbed run reports every loss, and the link recovers with the first frame. Long form: `PROXY_SEEDS=200`.
#[test]
fn bad_line_losses_reported_link_recovers() {
    let (ours, theirs) = UnixStream::pair().expect("a pair of sockets");
    theirs.set_read_timeout(Some(Duration::from_millis(2))).expect("an option");
    drop(thread_board::start(theirs, Misbehaviour::None));
    let trial = Trial::start(ours, TICK_RATE);
    seeds(6).for_each(|seed| trial.seed(seed));
}
