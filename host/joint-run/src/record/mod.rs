//! Record of one run, in SI units: identity and settings, commands, measurements and checks.

mod sample;
mod samples;
#[cfg(test)]
mod schema;
mod timing;

pub use sample::MotionSample;
pub use samples::{CloseUp, ErrorSeries, Reference, Samples};
pub use timing::{Counters, HistogramBin, MinMeanMax, TimingFigures};

use board::logs::LogLine;
use board::trip::FaultEntry;
use report::checks::{Check, Verdict};
use serde::{Deserialize, Serialize};

/// Version of the JSON format; raised with every change that may break a reader.
pub const SCHEMA_VERSION: u32 = 1;

/// One run, complete or not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RunRecord {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: u32,
    /// Identity of joint, board, image and host.
    pub identity: Identity,
    /// Figures of the joint that the plots need.
    pub joint: JointFigures,
    /// Settings of the run.
    pub settings: Settings,
    /// Completeness of the run.
    pub completeness: Completeness,
    /// Torques by tick number, in rising order; each holds until the next.
    pub schedule: Vec<TorqueCommand>,
    /// Measured motion.
    pub samples: Samples,
    /// Short stretch of the run at every tick, if the host could recompute it.
    pub close_up: Option<CloseUp>,
    /// f64 reference for the run's torques, if it was computed.
    pub reference: Option<Reference>,
    /// Timing of the board, if the board could still be asked.
    pub timing: Option<TimingFigures>,
    /// Faults that the board reported, in order.
    pub faults: Vec<FaultEntry>,
    /// Log lines of the board, in order.
    pub log: Vec<LogLine>,
    /// Checks, in any order; the report puts failed ones first.
    pub checks: Vec<Check>,
}

/// Identity of joint, board, image and host.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Identity {
    /// Name of the joint.
    pub joint: String,
    /// Joint file as named by the user, or the name of the preset.
    pub joint_file: String,
    /// Digest over parameters and tables, 16 hexadecimal digits.
    pub joint_digest: String,
    /// Role of the image, such as `plant`.
    pub role: String,
    /// Board of the image, by the name in its board file, such as `olimex-h405`.
    pub board: String,
    /// True for an emulated board: its timing figures say nothing about silicon.
    pub emulated: bool,
    /// The emulator's own version line, or the port of a real board.
    pub transport: String,
    /// Firmware version, such as `0.1.0`.
    pub firmware_version: String,
    /// Source of the core clock.
    pub clock: String,
    /// Message of a panic before the last reset.
    pub last_panic: Option<String>,
    /// True if the last reset came from the watchdog.
    pub watchdog_reset: bool,
    /// True if the worst-case tick exceeds the period and the image was built by force.
    #[serde(default)]
    pub forced: bool,
    /// Image, if this host built it or was given it.
    pub image: Option<Image>,
    /// Commit of the sources, if they were under git; with ` (changed)` if they differ from it.
    pub git_commit: Option<String>,
    /// Host: operating system and processor.
    pub host: String,
    /// Version of the host command.
    pub host_version: String,
    /// Start of the run, ISO 8601 with time zone, as the caller states it.
    pub date: String,
}

/// Firmware image.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Image {
    /// File name of the ELF.
    pub file: String,
    /// SHA-256 of the ELF file, 64 hexadecimal digits.
    pub elf_sha256: String,
    /// Flash used: code, constants and initial values [byte].
    pub flash_bytes: u64,
    /// RAM used by statics [byte].
    pub ram_bytes: u64,
    /// `rustc --version` of the compiler.
    pub compiler: String,
    /// Flags that change code: profile, optimisation, target.
    pub flags: String,
}

/// Figures of the joint that the plots need.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointFigures {
    /// Number of planets n.
    pub planets: usize,
    /// Motor angle over carrier angle [-].
    pub ratio: f64,
    /// Half-backlash b of every mesh, sun-planet first, then ring-planet [m].
    pub half_backlash_m: Vec<f64>,
    /// Gap coordinate within which every mesh can be free at once, lower and upper end [m]: 4b wide.
    pub gap_band_m: [f64; 2],
    /// Width of this band as an angle of the link, the lost motion [rad].
    pub lost_motion_rad: f64,
}

/// Settings of the run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Settings {
    /// `lockstep` or `realtime`.
    pub mode: String,
    /// Fixed steps per second [Hz].
    #[serde(rename = "tick_rate_Hz")]
    pub tick_rate_hz: u32,
    /// Method of the sub-steps of a tick with a change of contact: `corrected` or `leapfrog`.
    #[serde(default)]
    pub method: String,
    /// Sub-steps of a tick with a change of contact.
    #[serde(default)]
    pub substeps: u32,
    /// Ticks per sample.
    pub decimation: u32,
    /// Ticks of the planned run.
    pub ticks: u32,
    /// Ticks without a message of the host until the safe state; absent on the emulated board, whose timeout is
    /// practically unlimited.
    pub command_timeout_ticks: Option<u32>,
    /// Name of the built-in profile or path of the CSV.
    pub profile: String,
    /// Seed of the random parts of the profile.
    pub seed: u64,
    /// Command line that repeats the run.
    pub replay: String,
}

/// Completeness of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum Completeness {
    /// Complete.
    Complete,
    /// Interrupted; the record holds the run up to that point.
    Interrupted {
        /// Reason, as reported to the user.
        reason: String,
        /// Last known tick.
        tick: u32,
    },
}

/// Torques from a tick on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TorqueCommand {
    /// First tick whose step uses these torques.
    pub tick: u32,
    /// Torque on the sun shaft [N m].
    #[serde(rename = "drive_torque_Nm")]
    pub drive_torque: f32,
    /// Torque that brakes the link [N m].
    #[serde(rename = "load_torque_Nm")]
    pub load_torque: f32,
}

impl RunRecord {
    /// Record before the run: interrupted at tick 0 until the session reports otherwise.
    pub fn new(identity: Identity, joint: JointFigures, settings: Settings) -> Self {
        let samples = Samples::new(2 * joint.planets);
        Self {
            schema_version: SCHEMA_VERSION,
            identity,
            joint,
            settings,
            completeness: Completeness::Interrupted { reason: "the run has not started".into(), tick: 0 },
            schedule: Vec::new(),
            samples,
            close_up: None,
            reference: None,
            timing: None,
            faults: Vec::new(),
            log: Vec::new(),
            checks: Vec::new(),
        }
    }

    /// Returns true if the run is complete and no check failed.
    pub fn passed(&self) -> bool {
        self.completeness == Completeness::Complete && self.checks.iter().all(|check| check.verdict != Verdict::Failed)
    }
}
