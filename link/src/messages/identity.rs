//! Identity of a board and its image: the first message of a session.

use heapless::String;
use serde::{Deserialize, Serialize};

use super::MemoryState;

/// Identity of a board and of its image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// [`crate::PROTOCOL_VERSION`] of the board.
    pub protocol: u16,
    /// Firmware version: major, minor, patch.
    pub firmware_version: [u8; 3],
    /// Role of the image.
    pub role: Role,
    /// Board of the image: the name in its board file, such as `olimex-h405`.
    pub board: String<16>,
    /// Joint of the image.
    pub joint: String<32>,
    /// Digest over the joint's parameters and tables.
    pub joint_digest: u64,
    /// Result of the board's check of its tables against `joint_digest`.
    pub digest_good: bool,
    /// Rate of fixed steps [Hz].
    pub tick_rate: u32,
    /// Timer rate; its count is the unit of every time in [`super::Statistics`] [Hz].
    pub timer_rate: u32,
    /// Source and tolerance of the core clock.
    pub clock: Clock,
    /// Number of planets.
    pub planets: u8,
    /// Capacity of the command queue.
    pub queue_capacity: u16,
    /// Message that a panic left before the last reset.
    pub last_panic: Option<String<96>>,
    /// The last reset came from the watchdog.
    pub watchdog_reset: bool,
    /// Digest over the tables of observer, compensation and surroundings, in roles with a controller.
    pub control_digest: Option<u64>,
    /// Validity of the saved memory of earlier runs.
    pub memory: MemoryState,
    /// The worst-case tick exceeds the role's share of a period; the image was built with `--force`.
    pub forced: bool,
}

/// Role of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Role {
    /// Simulated joint; torques in, motion out.
    Plant,
    /// Observer and compensation for a motor controller; samples and set-points in, estimates and torques out.
    Observer,
    /// Joint, motor, observer and compensation on one chip; a trajectory in, the motion out.
    Loop,
}

/// Source of the core clock and its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock {
    /// Source.
    pub source: ClockSource,
    /// Tolerance of the core clock and thus of every tick and time of the board [ppm]; 0 if unknown.
    pub tolerance: u32,
}

impl Clock {
    /// Clock of unknown tolerance.
    pub const fn of(source: ClockSource) -> Self {
        Self { source, tolerance: 0 }
    }
}

/// Source of the core clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ClockSource {
    /// Crystal of the board file, with the PLL.
    Crystal,
    /// External signal of the board file, with the PLL.
    Signal,
    /// Internal oscillator and PLL: the board file names no external clock.
    Internal,
    /// Internal oscillator and PLL: the crystal or signal of the board file did not start.
    DidNotStart,
    /// Internal oscillator and PLL: the external frequency differs from the board file.
    OtherFrequency {
        /// Frequency measured with the internal oscillator, 0 if too low to be measured [Hz].
        measured: u32,
    },
    /// No PLL started: the tick rate is not the stated one.
    Failed,
    /// No clock controller: an emulated board.
    NotModelled,
}

impl ClockSource {
    /// Returns `true` for the external clock of the board file.
    pub const fn is_external(self) -> bool {
        matches!(self, Self::Crystal | Self::Signal)
    }
}
