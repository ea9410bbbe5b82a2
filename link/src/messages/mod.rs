//! Messages between host and board. Every physical field is SI; times are ticks of the board's fixed step or of its
//! timer, never wall-clock time. Sequence numbers rise by one and wrap, so that gaps can be counted. Identity, motion,
//! timing statistics and memory have files of their own.

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
/// Farthest reach of a schedule beyond the completed ticks [command timeouts].
pub const TIMEOUTS_AHEAD: u32 = 10;
/// Most log bytes in one frame.
pub const LOG_BYTES: usize = 96;

/// Message from the host to the board.
#[allow(clippy::large_enum_variant, reason = "a board has no allocator to box with")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ToBoard {
    /// Requests the board's identity. Answered by [`FromBoard::Hello`] in every state, for any protocol version.
    Hello {
        /// [`crate::PROTOCOL_VERSION`] of the host.
        protocol: u16,
    },
    /// Resets to rest at tick 0 and clears queues and digest; answered by [`FromBoard::Hello`].
    Reset(RunSettings),
    /// Schedules torques.
    Schedule(Schedule),
    /// Requests [`FromBoard::Statistics`].
    Statistics {
        /// Clear minima, maxima, histogram and counters after reporting them.
        reset: bool,
    },
    /// Ends the run: enable off, no further torque sent. Takes effect at the next tick, whatever the board is busy
    /// with, and before unread earlier messages: a reset among those is answered by [`Trip::Overtaken`].
    Stop,
    /// Sends samples and set-points to the role `observer`.
    Exchanges(Schedule<Exchange, EXCHANGES_PER_SCHEDULE>),
    /// Schedules the trajectory of the role `loop`.
    Trajectory(Schedule<Knot, KNOTS_PER_SCHEDULE>),
    /// Requests an operation on the memory (the controller's estimated parameters); between runs only.
    Memory(MemoryRequest),
    /// Injects a fault between the virtual joint and its controller in the role `loop`, between a reset and the first
    /// motion. Answered by [`FromBoard::FaultTaken`].
    Fault(Fault<FixedPoint<f32>>),
}

impl ToBoard {
    /// Returns `true` if a scanned frame is [`ToBoard::Stop`]: the only message of one byte with this variant number.
    pub fn is_stop(frame: Scanned) -> bool {
        frame == Scanned { length: 1, first: 4 }
    }
}

/// Settings of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RunSettings {
    /// Pacing of steps: by the host or by the board's clock.
    pub mode: RunMode,
    /// Ticks per sample; at least 1.
    pub decimation: u16,
    /// Command timeout: the board enters its safe state in this tick in a row (board's clock) without any good frame of
    /// the host, in either mode. It also limits ticks in a row without a schedule, in real time and in a role that
    /// answers a controller. 0 is refused.
    pub command_timeout: u32,
    /// Start the controller from the board's saved memory, if valid, else from the design values.
    pub from_memory: bool,
}

impl RunSettings {
    /// Farthest accepted horizon after `ticks` completed ticks. The host must send within the timeout anyway, so it
    /// need not schedule farther ahead.
    pub fn farthest_horizon(&self, ticks: u32) -> u32 {
        ticks.saturating_add(self.command_timeout.saturating_mul(TIMEOUTS_AHEAD))
    }
}

/// Pacing of steps: by the host or by the board's clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum RunMode {
    /// The tick waits until the schedule for the next tick has arrived.
    Lockstep,
    /// The tick follows the board's clock; ticks past the horizon are counted as starved and hold the last torque.
    Realtime,
}

/// Commands by tick number, in rising order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Schedule<C = Command, const MOST: usize = COMMANDS_PER_SCHEDULE> {
    /// Sequence number; rises by one per schedule of a run, from 0 after a reset.
    pub sequence: u16,
    /// Tick up to which all commands are known with this schedule. At most [`RunSettings::farthest_horizon`].
    pub horizon: u32,
    /// Commands before the horizon.
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

/// Message from the board to the host.
#[allow(clippy::large_enum_variant, reason = "a board has no allocator to box with")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum FromBoard {
    /// Identity of the board.
    Hello(Hello),
    /// A schedule was accepted; more may be sent.
    Accepted(Accepted),
    /// Motion of the simulated joint.
    Samples(SampleBatch),
    /// Timing statistics.
    Statistics(Statistics),
    /// The board has entered, or is in, its safe state; or a message was refused.
    Tripped(Trip),
    /// Encoded defmt bytes.
    Log(Log),
    /// Outputs of observer and compensation for an exchange.
    Answer(Answered),
    /// Motion of joint and controller in the whole loop.
    Loop(LoopBatch),
    /// Outcome of a memory request, or the reason for a refusal.
    MemoryOutcome(MemoryOutcome),
    /// Answer to [`ToBoard::Fault`]: a limited number of faults is accepted, before the first period and in the role
    /// `loop` only.
    FaultTaken {
        /// The fault was accepted.
        taken: bool,
    },
    /// Part of the flash content, valid or not.
    Memory(MemoryPart),
    /// Validity of a memory that the host has loaded.
    MemoryChecked(MemoryState),
}

/// Acceptance of a schedule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Accepted {
    /// Sequence number of the schedule.
    pub sequence: u16,
    /// Free places in the command queue.
    pub queue_free: u16,
    /// Completed ticks.
    pub tick: u32,
}

/// Reason for the safe state or for a refused message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trip {
    /// No frame, or no schedule, within the command timeout.
    CommandLoss {
        /// Tick of the event.
        tick: u32,
    },
    /// The state is not finite.
    NotFinite {
        /// Tick of the event.
        tick: u32,
    },
    /// A commanded torque is not finite; the command was not applied.
    BadCommand {
        /// Tick of the command.
        tick: u32,
    },
    /// Commands out of order or for a tick that has passed.
    LateCommand {
        /// Tick of the command.
        tick: u32,
    },
    /// The tables do not match their digest.
    BadDigest,
    /// More commands than the queue holds.
    QueueFull,
    /// Settings that cannot be run with, such as a decimation of 0.
    BadSettings,
    /// A schedule arrived before any reset, or after a trip.
    NotRunning,
    /// A schedule for another role than the board's.
    WrongRole,
    /// A schedule that reaches farther than [`RunSettings::farthest_horizon`].
    FarHorizon {
        /// Horizon of the schedule.
        tick: u32,
    },
    /// A reset was not carried out: a stop came after it, it arrived while flash was written, or it waited longer than
    /// its command timeout without a later frame. Send the reset again.
    Overtaken,
}

/// Encoded defmt bytes, in order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Log {
    /// Sequence number; rises by one per log frame.
    pub sequence: u16,
    /// Bytes in defmt's encoding (rzcobs); decode with the image's ELF file.
    pub bytes: Vec<u8, LOG_BYTES>,
}
