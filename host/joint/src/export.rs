//! `joint export`: a joint for other simulators.

use std::path::{Path, PathBuf};

use board::device::board::Board;
use c_library::tables::{ControllerOptions, nominal};
use fmu::export::Request;
use fmu::model::{Content, Fmi};
use joint_file::{named, warnings};
use mujoco_plugin::export::Plugin;
use report::failure::{Failure, Outcome};
use report::{folder, output};

/// Arguments of `joint export`.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("simulator").required(true).args(["fmu", "mujoco"]), after_help = "Examples:
  joint export q1 --fmu 2 --out q1_plant.fmu       torques [N m] in; angles [rad], gap [m], contacts, mesh forces [N] out
  joint export q1 --fmu 3 --model controller --out q1_controller.fmu      encoder counts and set-point in, torque out
  joint export my_joint.toml --fmu 3 --rate 20000 --out my_joint.fmu      20 kHz in place of the joint file's rate
  joint export q1 --mujoco --out q1.so             actuator plug-in for the MuJoCo that python3 imports, and q1.xml
  joint export worn.toml --mujoco --told q1 --out worn.so         a worn joint; its controller is designed for the new one

Communication steps of an FMU and steps of MuJoCo are multiples of the control period [s]; others are refused. An FMU holds
a binary for this machine, and its sources with a CMakeLists.txt for other machines. Two exports of one joint give the same
bytes. A plug-in has observer and compensation too: the key `controller` of an instance in the model puts them into the loop.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
    #[arg(value_name = "FILE", default_value = "q1")]
    file: PathBuf,
    /// FMU for this version of the Functional Mock-up Interface
    #[arg(long, value_enum, value_name = "VERSION")]
    fmu: Option<Fmi>,
    /// Actuator plug-in for MuJoCo, compiled for the Python package in this folder [default: the one that python3 imports]
    #[arg(long, value_name = "FOLDER", num_args = 0..=1, require_equals = true)]
    mujoco: Option<Option<PathBuf>>,
    /// Part of the joint; for an FMU
    #[arg(long, value_enum, value_name = "PART", default_value = "plant", conflicts_with = "mujoco")]
    model: Content,
    /// File for the FMU or the plug-in; its folder must exist
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    controller: ControllerOptions,
    /// Joint file that the plug-in's controller is designed for [default: FILE]
    #[arg(long, value_name = "FILE", conflicts_with = "fmu")]
    told: Option<PathBuf>,
    /// Control rate, in Hz [default: from the joint file]
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1..))]
    rate: Option<u32>,
    /// Board whose time a plant's sub-steps are chosen for: a name of boards/, or the path of a board file
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse, default_value = board_file::DEFAULT)]
    board: Board,
}

/// Writes the export and prints its path.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    let Arguments { out, board, .. } = arguments;
    let read: Vec<&Path> = std::iter::once(&arguments.file).chain(&arguments.told).map(PathBuf::as_path).collect();
    folder::check_file("out", out, &read)?;
    let loaded = named::load(&arguments.file)?;
    warnings::print(&loaded);
    let mut joint = loaded.file;
    joint.surroundings.control_rate = arguments.rate.unwrap_or(joint.surroundings.control_rate);
    let control = arguments.controller.request();
    let written = match (arguments.fmu, &arguments.mujoco) {
        (Some(fmi), _) => {
            let content = arguments.model;
            if let Some(option) = arguments.controller.given().filter(|_| content == Content::Plant) {
                return Err(Failure::new(format!("{option}: the FMU of a plant has no controller"))
                    .with_help("`--model controller` exports observer and compensation"));
            }
            fmu::export::run(&Request { fmi, content, joint: &joint, control, board, out })
        }
        (None, package) => {
            let mut told =
                arguments.told.as_deref().map(named::load).transpose()?.map_or(joint.clone(), |told| told.file);
            told.surroundings.control_rate = joint.surroundings.control_rate;
            let (nominal, package) = (nominal(&told, control), package.clone().flatten());
            mujoco_plugin::export::run(&Plugin { joint: &joint, nominal, board, package, out })
        }
    };
    output::print(&written.map_err(|failure| failure.while_doing(format_args!("export of {}", loaded.name)))?)
}
