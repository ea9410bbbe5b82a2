//! The messages. Every physical field is SI; times are ticks of the board's own fixed step or of its timer, never
//! wall-clock time. Sequence numbers rise by one and wrap, so that a gap can be counted. Identity, motion, timing statistics
//! and memory have files of their own.

mod identity;
mod memory;
mod motion;
mod statistics;

use heapless::Vec;
pub use identity::{Clock, ClockSource, Hello, Role};
pub use memory::{MEMORY_PARTS, MemoryOutcome, MemoryPart, MemoryRequest, MemoryState, PART_BYTES};
use model_core::virtual_joint::fault::{Fault, FixedPoint};
pub use motion::{MAX_MESHES, SAMPLES_PER_BATCH, Sample, SampleBatch};
use serde::{Deserialize, Serialize};
pub use statistics::{HISTOGRAM_BINS, Statistics, Timing};

use crate::controller::{Answered, EXCHANGES_PER_SCHEDULE, Exchange};
use crate::scanner::Scanned;
use crate::virtual_joint::{KNOTS_PER_SCHEDULE, Knot, LoopBatch};

/// Most commands in one [`Schedule`].
pub const COMMANDS_PER_SCHEDULE: usize = 24;
/// A schedule reaches so many command timeouts ahead of the ticks done, and no farther.
pub const TIMEOUTS_AHEAD: u32 = 10;
/// Bytes of log in one frame.
pub const LOG_BYTES: usize = 96;

/// From the host to the board.
#[allow(clippy::large_enum_variant, reason = "a board has no allocator to box with")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ToBoard {
    /// Asks for the board's identity. Answered by [`FromBoard::Hello`] in every state, also to an unknown protocol version.
    Hello {
        /// The host's [`crate::PROTOCOL_VERSION`].
        protocol: u16,
    },
    /// Back to rest at tick 0, queues and digest cleared, then [`FromBoard::Hello`].
    Reset(RunSettings),
    /// Torques to come.
    Schedule(Schedule),
    /// Send [`FromBoard::Statistics`]; then clear what it counts if asked to.
    Statistics {
        /// Clear minima, maxima, histogram and counters after reporting them.
        reset: bool,
    },
    /// End of the run: enable off, no further torque sent. Heard with the next tick whatever else the board has to do, and
    /// before whatever was sent before it and has not been looked at: a reset among that is answered by [`Trip::Overtaken`].
    Stop,
    /// Samples and set-points, for the role that observes.
    Exchanges(Schedule<Exchange, EXCHANGES_PER_SCHEDULE>),
    /// The trajectory to come, for the role that runs the whole loop.
    Trajectory(Schedule<Knot, KNOTS_PER_SCHEDULE>),
    /// A request about the memory of what the controller has learnt: between runs only.
    Memory(MemoryRequest),
    /// A fault between the virtual joint and its controller, for the same role, between a reset and the first motion.
    /// Answered by [`FromBoard::FaultTaken`].
    Fault(Fault<FixedPoint<f32>>),
}

impl ToBoard {
    /// Whether a frame that went by carries [`ToBoard::Stop`]: the one message of a single byte that says so.
    pub fn is_stop(frame: Scanned) -> bool {
        frame == Scanned { length: 1, first: 4 }
    }
}

/// Settings of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RunSettings {
    /// Who waits for whom.
    pub mode: RunMode,
    /// A sample every so many ticks; at least 1.
    pub decimation: u16,
    /// Safe state in the so many'th tick in a row of the board's own clock without a good frame of the host, whatever it was,
    /// in either mode. The same for ticks without a schedule: in real time, and for a role that answers a controller. 0 is
    /// refused.
    pub command_timeout: u32,
    /// The controller begins from the memory that the board keeps of earlier runs, if that is valid; else as it was designed.
    pub from_memory: bool,
}

impl RunSettings {
    /// The farthest horizon of a schedule that is accepted when so many ticks are done: what is asked of the far future
    /// is asked in time by a host that must be heard of anyway.
    pub fn farthest_horizon(&self, ticks: u32) -> u32 {
        ticks.saturating_add(self.command_timeout.saturating_mul(TIMEOUTS_AHEAD))
    }
}

/// Who waits for whom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum RunMode {
    /// The tick counter waits until the schedule for the next tick has arrived.
    Lockstep,
    /// The board's clock rules; ticks past the horizon are counted as starved and hold the last torque.
    Realtime,
}

/// Commands by tick number, in rising order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Schedule<C = Command, const MOST: usize = COMMANDS_PER_SCHEDULE> {
    /// Rises by one with every schedule of a run, from 0 after a reset.
    pub sequence: u16,
    /// Everything before this tick is now known. At most [`RunSettings::farthest_horizon`].
    pub horizon: u32,
    /// What changes before the horizon.
    pub commands: Vec<C, MOST>,
}

/// Torques from a tick on, held until the next command.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// First tick whose step uses these torques.
    pub tick: u32,
    /// Torque on the sun shaft [N m].
    pub drive_torque: f32,
    /// Torque that brakes the link [N m].
    pub load_torque: f32,
}

/// From the board to the host.
#[allow(clippy::large_enum_variant, reason = "a board has no allocator to box with")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum FromBoard {
    /// Who the board is.
    Hello(Hello),
    /// A schedule was taken; more may be sent.
    Accepted(Accepted),
    /// Measured motion.
    Samples(SampleBatch),
    /// Timing statistics.
    Statistics(Statistics),
    /// The board has gone to, or is in, its safe state.
    Tripped(Trip),
    /// Encoded defmt bytes.
    Log(Log),
    /// The outputs of observer and compensation for an exchange.
    Answer(Answered),
    /// Motion of joint and controller in the whole loop.
    Loop(LoopBatch),
    /// Outcome of a request about the memory, or why nothing was done.
    MemoryOutcome(MemoryOutcome),
    /// Whether a fault was accepted: a limited number, before the first period only, in the role `loop` only.
    FaultTaken {
        /// It was.
        taken: bool,
    },
    /// A part of what the flash page holds, valid or not.
    Memory(MemoryPart),
    /// Validity of a memory that the host has loaded.
    MemoryChecked(MemoryState),
}

/// A schedule was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Accepted {
    /// Its number.
    pub sequence: u16,
    /// Places free in the command queue now.
    pub queue_free: u16,
    /// Ticks done so far.
    pub tick: u32,
}

/// Why a run ended in the safe state, or why a message was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trip {
    /// No frame, or no schedule, for the stated number of ticks.
    CommandLoss {
        /// When.
        tick: u32,
    },
    /// The state is not finite.
    NotFinite {
        /// When.
        tick: u32,
    },
    /// A commanded torque is not finite; the command was not applied.
    BadCommand {
        /// Its tick.
        tick: u32,
    },
    /// Commands out of order or for a tick that has passed.
    LateCommand {
        /// Its tick.
        tick: u32,
    },
    /// The tables do not match their digest.
    BadDigest,
    /// More commands than the queue holds.
    QueueFull,
    /// Settings that cannot be run with, such as a decimation of 0.
    BadSettings,
    /// A schedule came before any reset, or after a trip.
    NotRunning,
    /// A schedule for another role than the board's.
    WrongRole,
    /// A schedule that reaches farther than [`RunSettings::farthest_horizon`].
    FarHorizon {
        /// Its horizon.
        tick: u32,
    },
    /// A reset that was not carried out: a stop came after it, it came while flash was written, or it waited for longer than
    /// its command timeout and nothing came after it. Reset again.
    Overtaken,
}

/// Encoded defmt bytes, in order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Log {
    /// Rises by one with every log frame.
    pub sequence: u16,
    /// defmt's own encoding (rzcobs); decode with the image's ELF file.
    pub bytes: Vec<u8, LOG_BYTES>,
}
