//! Arguments of `joint twin`.

use std::path::PathBuf;

use board::device::board::Board;
use clap::{Args, value_parser};
use live::{LiveOptions, parse_speed};
use scenario::plant::PlantName;

use crate::protocol::DriveName;
use wires::WireName;

/// Arguments of `joint twin`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  joint twin --drive moteus                              q1 behind a moteus; prints the port for moteus.Fdcanusb
  joint twin q1 --drive odrive --link /tmp/q1            the same port name at every start
  joint twin hil/motor-faults.toml --drive damiao        plant and faults of a test file
  joint twin --drive moteus --id 1=q1 --id 2=k9.toml     two joints on one bus
  joint twin --drive odrive --lockstep 1 --seed 7        1 ms of the joint's time for each frame of the client
  joint twin --live                                      a page that shows the joint and commands it
  joint twin --drive odrive3 --lockstep 1 --image odrive-3.6
                                                         the frames of that image: joint image --role drive
  joint twin --control /tmp/q1.sock                      commands of the socket change load, backlash and faults

docs/reference/twin.md describes clients, wires and the commands of the control socket, docs/reference/live.md the
live view.")]
pub struct Arguments {
    /// Joint file, preset, or test file with the plant and its faults [default: q1]
    #[arg(value_name = "FILE", conflicts_with = "ids")]
    pub file: Option<PathBuf>,
    /// Drive in front of the joint
    #[arg(long, value_enum, default_value = "moteus")]
    pub drive: DriveName,
    /// Joint on the bus with an identifier of the drive; repeat it for several joints
    #[arg(long = "id", value_name = "ID=FILE")]
    pub ids: Vec<String>,
    /// Form of the frames on the line [default: fdcanusb for moteus, serial for feetech, else slcan]
    #[arg(long, value_enum)]
    pub wire: Option<WireName>,
    /// Bit rate of the CAN bus, whose frames then take time [bit/s] [default: frames take no time]
    #[arg(long, value_name = "BIT/S", value_parser = bit_rate)]
    pub bitrate: Option<f64>,
    /// Lets joints have one identifier, so that their frames collide
    #[arg(long)]
    pub same_id: bool,
    /// TCP port of socketcand on 127.0.0.1; 0 lets the system choose
    #[arg(long, value_name = "PORT", default_value_t = 29536)]
    pub port: u16,
    /// Symbolic link to the pseudo-terminal, so that its name stays the same
    #[arg(long, value_name = "PATH")]
    pub link: Option<PathBuf>,
    /// Speed of the simulated time over that of the clock
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = parse_speed, conflicts_with = "lockstep")]
    pub speed: f64,
    /// Simulated time advances by so many milliseconds for each frame of the client, and only then: reproducible
    #[arg(long, value_name = "MS", value_parser = value_parser!(f64))]
    pub lockstep: Option<f64>,
    /// Seed of noise, start in the gap and zeros of the encoders
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Model of the joint
    #[arg(long, value_enum, default_value = "reference")]
    pub plant: PlantName,
    /// Joint and drive as the image of role `drive` for this board runs them, bit for bit: no noise, faults or seed
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse)]
    #[arg(conflicts_with_all = ["plant", "seed", "compensation", "control"])]
    pub image: Option<Board>,
    /// Observer and compensation of this project act in the drive, in place of its own law
    #[arg(long)]
    pub compensation: bool,
    /// Drive whose motor and encoders are not calibrated yet
    #[arg(long)]
    pub uncalibrated: bool,
    /// Voltage of the supply without a load [V] [default: 12 for feetech, 24 for damiao and cybergear, else 48]
    #[arg(long, value_name = "V", value_parser = supply)]
    pub supply: Option<f32>,
    /// Unix socket that takes commands as lines of JSON
    #[arg(long, value_name = "PATH")]
    pub control: Option<PathBuf>,
    /// Live view.
    #[command(flatten)]
    pub live: LiveOptions,
    /// Log of truth, drives and frames as MCAP; an older file of that name is overwritten
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    /// Simulated time after which the command ends [s]; without it, Ctrl-C ends it
    #[arg(long = "for", value_name = "SECONDS", value_parser = duration)]
    pub duration: Option<f64>,
    /// Figures at the end as JSON; `-` for standard output
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
}

fn within(text: &str, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (low..=high).contains(value));
    value.ok_or_else(|| format!("write a number from {low} to {high}{unit}"))
}

fn duration(text: &str) -> Result<f64, String> {
    within(text, 0.001, 1e6, " s")
}

fn bit_rate(text: &str) -> Result<f64, String> {
    within(text, 1e4, 1e6, " bit/s")
}

fn supply(text: &str) -> Result<f32, String> {
    within(text, 5.0, 100.0, " V").map(|value| value as f32)
}
