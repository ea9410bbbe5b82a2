//! The messages. Every physical field is SI; times are ticks of the board's own fixed step or of its timer, never
//! wall-clock time. Sequence numbers wrap and rise by one, so that a gap can be counted.

use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use crate::controller::{Answered, EXCHANGES_PER_SCHEDULE, Exchange};
use crate::virtual_joint::{KNOTS_PER_SCHEDULE, Knot, LoopBatch, WireUpset};

/// Most commands in one [`Schedule`].
pub const COMMANDS_PER_SCHEDULE: usize = 24;
/// Most samples in one [`SampleBatch`].
pub const SAMPLES_PER_BATCH: usize = 4;
/// Most meshes of a joint: two for each of five planets.
pub const MAX_MESHES: usize = 10;
/// Bytes of log in one frame.
pub const LOG_BYTES: usize = 96;
/// Bins of the computation-time histogram.
pub const HISTOGRAM_BINS: usize = 32;

/// From the host to the board.
#[allow(clippy::large_enum_variant, reason = "a board has no allocator to box with")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ToBoard {
    /// Who are you? Answered by [`FromBoard::Hello`] in every state, also to an unknown protocol version.
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
    /// End of the run: torque zero, enable off.
    Stop,
    /// Samples and set-points, for the role that observes.
    Exchanges(Schedule<Exchange, EXCHANGES_PER_SCHEDULE>),
    /// Motion to come, for the role that runs the whole loop.
    Course(Schedule<Knot, KNOTS_PER_SCHEDULE>),
    /// Keep what the controller has learnt, in flash: between runs only. Answered by [`FromBoard::Kept`].
    Keep,
    /// A fault between the virtual joint and its controller, for the same role, between a reset and the first motion.
    /// Answered by [`FromBoard::Upset`].
    Upset(WireUpset),
}

/// How a run goes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RunSettings {
    /// Who waits for whom.
    pub mode: RunMode,
    /// A sample every so many ticks; at least 1.
    pub decimation: u16,
    /// Safe state after so many ticks without a schedule (realtime only); 0 is refused.
    pub command_timeout: u32,
    /// The controller goes on from what the board keeps of earlier runs, if it keeps anything good; else it begins as it was
    /// designed.
    pub from_memory: bool,
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
    /// Everything before this tick is now known.
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
    /// How the board's time was spent.
    Statistics(Statistics),
    /// The board has gone to, or is in, its safe state.
    Fault(Fault),
    /// Encoded defmt bytes.
    Log(Log),
    /// What observer and compensation make of an exchange.
    Answer(Answered),
    /// What joint and controller did.
    Loop(LoopBatch),
    /// What became of what was to be kept.
    Kept(Kept),
    /// Whether a fault was taken: there is room for some, before the first period only, in one role only.
    Upset {
        /// It was.
        taken: bool,
    },
}

/// Who the board is and what it runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// The board's [`crate::PROTOCOL_VERSION`].
    pub protocol: u16,
    /// Major, minor, patch.
    pub firmware_version: [u8; 3],
    /// What the image is for.
    pub role: Role,
    /// Board that the image was built for, such as `stm32f405`.
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
    /// Where the core clock comes from.
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
    /// What it keeps of earlier runs.
    pub remembered: Remembered,
}

/// What a board found where it keeps what its controller has learnt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Remembered {
    /// Nothing: its role learns nothing, or nothing was kept yet.
    Nothing,
    /// What can be gone on from.
    Good,
    /// Something that was never a memory.
    NotAMemory,
    /// A memory of another version.
    WrongVersion,
    /// A memory of which some was lost.
    Damaged,
    /// A memory of another joint or of other encoders.
    OtherJoint,
    /// A memory with a number that is none.
    NotFinite,
}

/// What became of what was to be kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kept {
    /// It is in flash, and reads as it was written.
    Stored,
    /// The role learns nothing.
    Nothing,
    /// A run goes on: stop it first, since writing flash may hold the board up for a second.
    Running,
    /// It does not read as it was written: there is no such flash, or it is worn.
    NotWritten,
}

/// What an image is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Role {
    /// The joint is simulated; torques in, motion out.
    Plant,
    /// Observer and compensation beside a motor controller; samples and set-points in, estimates and torques out.
    Observer,
    /// The joint, its motor and both of them on one chip; motion asked for in, motion made out.
    Loop,
}

/// Where the core clock comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Clock {
    /// External crystal and PLL, as wanted.
    External,
    /// The crystal did not start in time; internal oscillator and PLL.
    InternalFallback,
    /// No PLL came up: the tick rate is not the stated one.
    Failed,
    /// No clock controller is there: an emulated board.
    NotModelled,
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

/// Consecutive samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SampleBatch {
    /// Rises by one with every batch of a run, from 0 after a reset.
    pub sequence: u16,
    /// The samples, oldest first.
    pub samples: Vec<Sample, SAMPLES_PER_BATCH>,
}

/// The motion after a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Steps done since the reset.
    pub tick: u32,
    /// Running digest over the whole state after every step so far.
    pub state_digest: u64,
    /// Whole turns of the rigid-body carrier angle.
    pub carrier_turns: i32,
    /// The rest of it, in 2^-32 turns.
    pub carrier_fraction: u32,
    /// Rate of the rigid-body carrier angle [rad/s].
    pub carrier_speed: f32,
    /// Motor angle less ratio times rigid carrier angle [rad].
    pub motor_offset: f32,
    /// Link angle less rigid carrier angle [rad].
    pub link_offset: f32,
    /// Gap coordinate u_s - 2 u_c along the line of action [m].
    pub gap: f32,
    /// Wind-up between carrier and link along the line of action [m].
    pub wind_up: f32,
    /// Mesh deflections [m]: sun-planet of every planet, then ring-planet.
    pub deflections: Vec<f32, MAX_MESHES>,
    /// Two bits a mesh in the same order: 0 separated, 1 drive side, 2 back side.
    pub contacts: u32,
    /// Computation time of this step, in timer counts.
    pub computation: u16,
}

/// How the board's time was spent since the last clearing. Times are timer counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Steps done.
    pub ticks: u32,
    /// Computation time of the tick.
    pub computation: Timing,
    /// From the timer's expiry to the first instruction of the tick.
    pub lateness: Timing,
    /// Computation times: bin i counts steps in [i, i + 1) * `bin_width`; the last bin is open.
    pub histogram: [u32; HISTOGRAM_BINS],
    /// Width of a bin.
    pub bin_width: u32,
    /// Timer counts between two ticks.
    pub period: u32,
    /// Idle time, in thousandths of all time.
    pub idle_permille: u16,
    /// Ticks that ended after the next was due.
    pub overruns: u32,
    /// Ticks that found no schedule (realtime).
    pub starved: u32,
    /// Ticks that waited for the schedule (lockstep).
    pub waited: u32,
    /// Least number of commands in the queue while running.
    pub queue_low: u16,
    /// Schedules missing by sequence number.
    pub lost_schedules: u32,
    /// Frames dropped for a bad CRC, length or content.
    pub bad_frames: u32,
    /// Received bytes dropped because a buffer was full.
    pub lost_bytes: u32,
    /// Samples dropped because a buffer was full.
    pub lost_samples: u32,
    /// Log bytes dropped because a buffer was full.
    pub lost_log_bytes: u32,
    /// RAM in use by statics [byte].
    pub static_ram: u32,
    /// Deepest stack seen, by painting [byte].
    pub stack_used: u32,
}

/// Least, mean and greatest of a time, in timer counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Timing {
    /// Least.
    pub min: u32,
    /// Mean.
    pub mean: u32,
    /// Greatest.
    pub max: u32,
}

/// Why the safe state was entered: torque zero, enable off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// No schedule for the stated number of ticks.
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
    /// A schedule came before any reset, or after a fault.
    NotRunning,
    /// A schedule for another role than the board's.
    WrongRole,
}

/// Encoded defmt bytes, in order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Log {
    /// Rises by one with every log frame.
    pub sequence: u16,
    /// defmt's own encoding (rzcobs); decode with the image's ELF file.
    pub bytes: Vec<u8, LOG_BYTES>,
}
