//! Command line of `joint replay`.

use std::num::NonZeroU16;
use std::path::PathBuf;

use log_reader::column_map::parse_renaming;
use log_reader::units::{self, Unit};

/// Arguments of `joint replay`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "LOG is an MCAP log of `joint hil TEST`, complete in itself, or any log for `joint identify`:
  time_s, motor_counts, output_counts, motor_torque_N_m, a row each control period.

Examples:
  joint replay joint-out/hil/tests/t2/runs/t2-seed1-preview.mcap       does the observer repeat the run, in every bit?
  joint replay joint-out/hil/tests/t2/runs/t2-seed1-preview.mcap q1    what would the observer of the preset have estimated?
  joint replay my_log.csv my_joint.toml --out results                  the observer's estimates of a recorded test
  joint replay drive.csv my_joint.toml --map moteus --set control_rate_Hz=1000

Exit code: 0 if a run is repeated, or for a log of no run; 1 if a run is not repeated; 2 for bad input or a wiring that contradicts the joint file, 130 after Ctrl-C.")]
pub struct ReplayArguments {
    /// Log of a run, or a recorded test
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
    /// Joint file (TOML) or preset of the observer [default: the joint file in the log of a run]
    #[arg(value_name = "JOINT")]
    pub joint: Option<PathBuf>,
    /// Changes a value of the joint file first, such as control_rate_Hz=1000; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", requires = "joint")]
    pub set: Vec<String>,
    /// Gives the observer the motor's encoder alone
    #[arg(long, requires = "joint")]
    pub motor_only: bool,
    /// Topic of an MCAP log [default: the only one with motor, output and torque]
    #[arg(long, value_name = "TOPIC", requires = "joint")]
    pub topic: Option<String>,
    /// Reads a column under another name, such as motor_counts=pos_raw; may be repeated
    #[arg(long, value_name = "COLUMN=NAME", value_parser = parse_renaming, requires = "joint")]
    pub column: Vec<(String, String)>,
    /// Unit of a column that is named by its quantity alone, such as motor_angle=turns; may be repeated
    #[arg(long, value_name = "QUANTITY=UNIT", value_parser = units::parse, requires = "joint")]
    pub unit: Vec<Unit>,
    /// Names and units of a maker's columns: a file, or ros2-joint-states, moteus, odrive, vesc-tool, feetech
    #[arg(long, value_name = "MAP", requires = "joint")]
    pub map: Option<PathBuf>,
    /// Joint of a map with several joints
    #[arg(long, value_name = "NAME", requires = "map")]
    pub map_joint: Option<String>,
    /// Writes one of N control periods to estimates.csv and estimates.mcap [default: about a thousand a second]
    #[arg(long, value_name = "N")]
    pub every: Option<NonZeroU16>,
    /// Folder for report.html, record.json, estimates.csv and estimates.mcap; files that this command did not write are
    /// not overwritten [default: joint-out/replay/<log>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Writes the record as JSON to this file too ("-" is standard output; everything else then goes to standard error)
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
}

impl ReplayArguments {
    /// Returns true if the log's own run is to be repeated.
    pub fn repeats_run(&self) -> bool {
        self.joint.is_none()
    }
}
