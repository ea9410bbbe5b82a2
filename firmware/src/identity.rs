//! Identity of the board in its hello: everything that is constant between two resets, from the generated tables and
//! the start-up.

use heapless::String;
use link::PROTOCOL_VERSION;
use link::messages::{Clock, Hello, MemoryState};

use crate::protocol::Protocol;
use crate::queues::COMMAND_CAPACITY;
use crate::tables::{FORCED, JOINT_NAME, PLANETS, TABLES};

/// Findings of the start-up.
#[derive(Debug, Clone)]
pub struct StartUp {
    /// Board that the image was built for.
    pub board: &'static str,
    /// Timer counts a second [Hz].
    pub timer_rate: u32,
    /// Source and tolerance of the core clock.
    pub clock: Clock,
    /// Message that a panic left before the last reset.
    pub last_panic: Option<String<96>>,
    /// The last reset came from the watchdog.
    pub watchdog_reset: bool,
    /// Validity of the memory of earlier runs.
    pub memory: MemoryState,
}

/// Hello of a board in a role, with the digest of its controller's tables, if it has a controller.
pub fn hello<W: Protocol>(start_up: StartUp, control_digest: Option<u64>) -> Hello {
    Hello {
        protocol: PROTOCOL_VERSION,
        firmware_version: VERSION,
        role: W::ROLE,
        board: shortened(start_up.board),
        joint: shortened(JOINT_NAME),
        joint_digest: TABLES.digest,
        digest_good: TABLES.digest_is_good(),
        tick_rate: TABLES.tick_rate,
        timer_rate: start_up.timer_rate,
        clock: start_up.clock,
        planets: PLANETS as u8,
        queue_capacity: COMMAND_CAPACITY,
        last_panic: start_up.last_panic,
        watchdog_reset: start_up.watchdog_reset,
        control_digest,
        memory: start_up.memory,
        forced: FORCED,
    }
}

/// Major, minor, patch of this package.
const VERSION: [u8; 3] = [
    number(env!("CARGO_PKG_VERSION_MAJOR")),
    number(env!("CARGO_PKG_VERSION_MINOR")),
    number(env!("CARGO_PKG_VERSION_PATCH")),
];

const fn number(digits: &str) -> u8 {
    let digits = digits.as_bytes();
    let mut value = 0;
    let mut at = 0;
    while at < digits.len() {
        value = value * 10 + (digits[at] - b'0');
        at += 1;
    }
    value
}

/// Shortens a text to `LENGTH` bytes.
fn shortened<const LENGTH: usize>(text: &str) -> String<LENGTH> {
    let mut result = String::new();
    for character in text.chars() {
        if result.push(character).is_err() {
            break;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn version_number_parsed() {
        assert_eq!([number("0"), number("17"), number("255")], [0, 17, 255]);
    }

    #[test]
    fn long_name_cut_between_characters() {
        assert_eq!(shortened::<4>("joint").as_str(), "join");
        assert_eq!(shortened::<4>("abcä").as_str(), "abc");
    }
}
