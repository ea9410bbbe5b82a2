//! Command line of `joint identify`.

use std::path::PathBuf;

use super::quasi_static::Options;
use log_reader::column_map::{ColumnMap, parse_renaming};
use log_reader::columns::Columns;
use log_reader::log_file;
use log_reader::units::{self, Unit};
use report::failure::Outcome;

/// Standard deviation of an inertia in a joint file, relative; typical of inertias from drawings.
pub const INERTIA_ERROR: f64 = 0.015;

/// Options that have no meaning for a simulated log, which is written in place of LOG. An option that needs `--simulate` names
/// them, too: clap takes an option without what it needs if that conflicts with another one.
const NOT_SIMULATED: [&str; 12] = [
    "topic",
    "column",
    "unit",
    "map",
    "map_joint",
    "torque_error",
    "inertia_error",
    "out",
    "json",
    "quasi_static",
    "output_locked",
    "output_only",
];

/// Arguments of `joint identify`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = "LOG is a CSV file whose first line names the columns, or an MCAP log with a topic of such fields:
  time_s, motor_counts, output_counts, motor_torque_N_m and, if it was measured, output_torque_N_m
(time_ms, time_us, motor_angle_rad and output_angle_rad are accepted too; other names with --column).

Examples:
  joint identify my_log.csv --joint my_joint.toml --motor-bits 14 --output-bits 18
  joint identify lab.mcap --topic /joint_states --column motor_angle_rad=position[0] --column output_angle_rad=position[1]
    --column motor_torque_N_m=effort[0]
  joint identify drive.csv --column motor_angle=pos --unit motor_angle=turns --column motor_torque=iq
    --unit motor_torque=0.06*N_m
  joint identify virtual.csv --joint q1 --simulate --seed 7    makes a log on the f64 reference, without hardware
  joint identify virtual.csv --joint q1                        identifies the joint of that log
  joint identify sweeps.csv --quasi-static --gear-ratio 6      slow sweeps to and fro, without a joint file
  joint identify held.csv --joint my_joint.toml --output-locked    slow torque to and fro, the output clamped
  joint identify servo.csv --joint my_joint.toml --output-only     torque steps to and fro, no encoder at the motor

Exit code: 0 if something could be identified, 2 for bad input or a log that determines nothing, 130 after Ctrl-C."
)]
pub struct Arguments {
    /// Recorded reversal test; with --simulate, the new file to be written
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
    /// Topic of an MCAP log [default: the only one with motor, output and torque]
    #[arg(long, value_name = "TOPIC")]
    pub topic: Option<String>,
    /// Reads a column under another name, such as motor_counts=pos_raw; may be repeated
    #[arg(long, value_name = "COLUMN=NAME", value_parser = parse_renaming)]
    pub column: Vec<(String, String)>,
    /// Unit of a column that is named by its quantity alone, such as motor_angle=turns, motor_torque=mN_m,
    /// motor_torque=0.06*N_m for a current of 0.06 N m/A, motor_angle=turns@output; may be repeated
    #[arg(long, value_name = "QUANTITY=UNIT", value_parser = units::parse)]
    pub unit: Vec<Unit>,
    /// Names and units of a maker's columns: a file, or ros2-joint-states, moteus, odrive, vesc-tool, feetech
    #[arg(long, value_name = "MAP")]
    pub map: Option<PathBuf>,
    /// Joint of a map with several joints [default: every joint, a report each]
    #[arg(long, value_name = "NAME", requires = "map")]
    pub map_joint: Option<String>,
    /// Joint file (TOML) or preset that gives teeth, levers and inertias; the patched copy is written from it
    #[arg(long, value_name = "FILE", default_value = "q1")]
    pub joint: PathBuf,
    /// Changes a value of the joint file first, such as link_inertia_kg_m2=0.2; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Resolution of the motor encoder: 2^BITS counts a turn [default: as in the joint file]
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(8..=30))]
    pub motor_bits: Option<u32>,
    /// Resolution of the output encoder [default: as in the joint file]
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(8..=30))]
    pub output_bits: Option<u32>,
    /// Standard deviation of the motor's torque scale, in percent [default: torque_constant_error_ratio of the joint
    /// file]
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub torque_error: Option<f64>,
    /// Standard deviation of each inertia of the joint file (motor, link), in percent
    #[arg(long, value_name = "PERCENT", default_value_t = 100.0 * INERTIA_ERROR, value_parser = percent)]
    pub inertia_error: f64,
    /// Writes LOG instead of reading it: the recommended test, simulated by the f64 reference of the joint file
    #[arg(long, conflicts_with_all = NOT_SIMULATED)]
    pub simulate: bool,
    /// Seed of a simulated test's noise and encoder phases
    #[arg(long, value_name = "N", default_value_t = 1, requires = "simulate", conflicts_with_all = NOT_SIMULATED)]
    pub seed: u64,
    /// Adds the torque at the output to a simulated test
    #[arg(long, requires = "simulate", conflicts_with_all = NOT_SIMULATED)]
    pub with_output_torque: bool,
    /// Folder for report.html, joint.toml and findings.json; files that this command did not write are not overwritten
    /// [default: joint-out/identify/<joint>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Writes the findings as JSON to this file too ("-" is standard output; everything else then goes to standard
    /// error)
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
    /// Reads a log of a joint with a clamped output and a slowly alternating torque: lost motion, stiffness,
    /// half-backlash and friction from the motor's angle and torque
    #[arg(long, conflicts_with_all = ["quasi_static", "simulate", "inertia_error"])]
    pub output_locked: bool,
    /// Reads a log of a joint without a motor encoder and with alternating torque steps: inertia, friction, weight of
    /// the link and an upper bound of the lost motion from the output's angle and the motor's torque
    #[arg(long, conflicts_with_all = ["quasi_static", "simulate", "output_locked"])]
    pub output_only: bool,
    /// Slow logs.
    #[command(flatten)]
    pub slow: Options,
}

impl Arguments {
    /// Reads the log's columns and converts them to samples with `convert`. `ratio` is the gear's ratio; `accepts` accepts a
    /// topic or a file by its columns.
    pub fn read_log<T>(
        &self,
        ratio: f64,
        accepts: impl Fn(&Columns) -> bool,
        convert: impl FnOnce(&mut Columns) -> Outcome<T>,
    ) -> Outcome<T> {
        let path = self.log.as_path();
        let mut columns = log_file::read(path, self.topic.as_deref(), &self.column_map()?, ratio, accepts)?;
        let samples = convert(&mut columns);
        samples.map_err(|failure| columns.with_notes(failure).while_doing(path.display()))
    }

    /// Names and units of the log's columns, from the map and the command line.
    pub fn column_map(&self) -> Outcome<ColumnMap> {
        ColumnMap::new(self.map.as_deref(), self.map_joint.as_deref(), &self.column, &self.unit)
    }
}

fn percent(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "write a number in percent".to_owned())?;
    if (0.0..=50.0).contains(&value) { Ok(value) } else { Err("must be from 0 to 50 percent".to_owned()) }
}
