//! Identity of a board and its image: the first message of a session.

use heapless::String;
use serde::{Deserialize, Serialize};

use super::MemoryState;

/// Who the board is and what it runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// The board's [`crate::PROTOCOL_VERSION`].
    pub protocol: u16,
    /// Major, minor, patch.
    pub firmware_version: [u8; 3],
    /// What the image is for.
    pub role: Role,
    /// Board that the image was built for: the name in its board file, such as `olimex-h405`.
    pub board: String<16>,
    /// Name of the joint that the image was built from.
    pub joint: String<32>,
    /// Digest over parameters and tables.
    pub joint_digest: u64,
    /// The board's own check of its tables against that digest.
    pub digest_good: bool,
    /// Fixed steps a second [Hz].
    pub tick_rate: u32,
    /// Timer counts a second, the unit of every time in [`Statistics`] [Hz].
    pub timer_rate: u32,
    /// What the core clock is made of.
    pub clock: Clock,
    /// Number of planets.
    pub planets: u8,
    /// Commands that the queue can hold.
    pub queue_capacity: u16,
    /// Message left by a panic before the last reset.
    pub last_panic: Option<String<96>>,
    /// The last reset came from the watchdog.
    pub watchdog_reset: bool,
    /// Digest over the tables of observer, compensation and surroundings, for the roles that have them.
    pub control_digest: Option<u64>,
    /// Validity of the memory that it keeps of earlier runs.
    pub memory: MemoryState,
    /// Its worst tick outlasts what the role may take of a period: it was built by force.
    pub forced: bool,
}

/// What an image is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Role {
    /// The joint is simulated; torques in, motion out.
    Plant,
    /// Observer and compensation beside a motor controller; samples and set-points in, estimates and torques out.
    Observer,
    /// The joint, its motor and both of them on one chip; a trajectory in, the motion out.
    Loop,
}

/// What the core clock is made of, and how exact it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock {
    /// Where it comes from.
    pub source: ClockSource,
    /// The core clock, and with it every tick and time of the board, is exact to this [ppm]; 0 where it is not known.
    pub tolerance: u32,
}

impl Clock {
    /// A clock of which nothing is known.
    pub const fn of(source: ClockSource) -> Self {
        Self { source, tolerance: 0 }
    }
}

/// Where the core clock comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ClockSource {
    /// The board's crystal and the PLL, as its board file says.
    Crystal,
    /// A signal from elsewhere and the PLL, as its board file says.
    Signal,
    /// Internal oscillator and PLL: the board file names nothing else.
    Internal,
    /// Internal oscillator and PLL: the crystal or signal of the board file did not start.
    DidNotStart,
    /// Internal oscillator and PLL: what came has another frequency than the board file says.
    OtherFrequency {
        /// As measured by the internal oscillator, 0 if too slow to be measured [Hz].
        measured: u32,
    },
    /// No PLL came up: the tick rate is not the stated one.
    Failed,
    /// No clock controller is there: an emulated board.
    NotModelled,
}

impl ClockSource {
    /// It is what the board file says of the world outside of the chip.
    pub const fn is_external(self) -> bool {
        matches!(self, Self::Crystal | Self::Signal)
    }
}
