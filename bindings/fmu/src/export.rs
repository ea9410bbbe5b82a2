//! `joint export`: a joint for other simulators.

use std::path::PathBuf;

use board::device::board::Board;
use c_library::library::{self, Target};
use joint_file::{named, warnings};
use report::failure::Outcome;
use report::progress::Progress;
use report::workspace::workspace;
use report::{folder, write};

use crate::archive::{self, File};
use crate::model::{Content, Fmi, Model};
use crate::{binary, description, sources};

/// Arguments of `joint export`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint export q1 --fmu 2 --out q1_plant.fmu       torques [N m] in; angles [rad], gap [m], contacts, mesh forces [N] out
  joint export q1 --fmu 3 --model controller --out q1_controller.fmu      encoder counts and set-point in, torque out
  joint export my_joint.toml --fmu 3 --rate 20000 --out my_joint.fmu      20 kHz in place of the joint file's rate

Communication steps are multiples of the control period [s]; others are refused. The archive holds a binary for this
machine, and its sources with a CMakeLists.txt for other machines. Two exports of one joint give the same bytes.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
    #[arg(value_name = "FILE", default_value = "q1")]
    pub file: PathBuf,
    /// Version of the Functional Mock-up Interface
    #[arg(long, value_enum, value_name = "VERSION")]
    pub fmu: Fmi,
    /// Part of the joint
    #[arg(long, value_enum, value_name = "PART", default_value = "plant")]
    pub model: Content,
    /// File for the FMU; its folder must exist
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Control rate, in Hz [default: from the joint file]
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1..))]
    pub rate: Option<u32>,
    /// Board whose time a plant's sub-steps are chosen for: a name of boards/, or the path of a board file
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse, default_value = board_file::DEFAULT)]
    pub board: Board,
}

/// Writes the FMU and returns the line for the user.
pub fn run(arguments: &Arguments) -> Outcome<String> {
    folder::check_file("out", &arguments.out, &[&arguments.file])?;
    let loaded = named::load(&arguments.file)?;
    warnings::print(&loaded);
    let mut joint = loaded.file;
    joint.surroundings.control_rate = arguments.rate.unwrap_or(joint.surroundings.control_rate);
    let model = Model::new(arguments.fmu, arguments.model, &joint, &arguments.board)
        .map_err(|failure| failure.while_doing(format_args!("tables of {}", loaded.name)))?;
    let files = Progress::during(|progress| {
        progress.stage("building the library");
        let library = library::build(Target::Host, "library", &|line: &str| progress.print_message(line))?;
        progress.stage("compiling the FMU");
        contents(&model, &library)
    })?;
    let archive = archive::pack(&files)?;
    write::write_bytes(&arguments.out, &archive)?;
    Ok(format!(
        "{}: {} B, {} variables, control period {:?} s, binary for {}\n",
        arguments.out.display(),
        archive.len(),
        model.variables.len(),
        1.0 / f64::from(model.rate),
        binary::platform(model.fmi)
    ))
}

/// Folder of the CMake project in the archive. FMI 3 demands a buildDescription.xml in `sources`, by which importers compile C
/// files alone; the core is Rust.
const PROJECT: &str = "extra/lostmotion";

/// Scope of the license, before its text.
const LICENSE_SCOPE: &str = "This license applies to the software in this archive. It does not apply to the parameters of the \
                             joint, which belong to the author of the joint file.\n\n";

/// Files of an FMU in the order of the archive.
pub fn contents(model: &Model, library: &library::Library) -> Outcome<Vec<File>> {
    let mut c_sources = sources::c_sources(model)?;
    let mut others = vec![File::text("CMakeLists.txt", sources::cmake(model))];
    others.extend(sources::rust_sources()?);
    // The token stands for everything that it does not stand in.
    let without_token = [
        File::text("description.h", sources::description(model, "")),
        File::text("modelDescription.xml", description::model_description(model, "")),
    ];
    let token = model.token(&[&c_sources[..], &others, &without_token].concat());
    c_sources.push(File::text("description.h", sources::description(model, &token)));
    let binary = binary::build(model, &c_sources, library)?;
    let license = workspace().join("LICENSE");
    let license = std::fs::read_to_string(&license).map_err(|error| sources::unreadable(&license, &error))?;
    let mut files = vec![
        File::text("modelDescription.xml", description::model_description(model, &token)),
        File { name: format!("binaries/{}/{}.so", binary::platform(model.fmi), model.identifier), bytes: binary },
        File::text("documentation/licenses/license.txt", format!("{LICENSE_SCOPE}{license}")),
    ];
    let inside = |file: File| File { name: format!("{PROJECT}/{}", file.name), ..file };
    files.extend(c_sources.into_iter().chain(others).map(inside));
    Ok(files)
}
