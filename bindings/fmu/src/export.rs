//! Writes a joint as an FMU.

use std::path::Path;

use board::device::board::Board;
use c_library::library::{self, Target};
use joint_file::JointFile;
use model_core::controller::design::ControlRequest;
use report::failure::Outcome;
use report::progress::Progress;
use report::workspace::workspace;
use report::write;

use crate::archive::{self, File};
use crate::model::{Content, Fmi, Model};
use crate::{binary, description, sources};

/// FMU to be written.
#[derive(Debug)]
pub struct Request<'a> {
    /// Version of the standard.
    pub fmi: Fmi,
    /// Part of the joint.
    pub content: Content,
    /// Joint, with the control rate of the FMU.
    pub joint: &'a JointFile,
    /// Requirements on the controller.
    pub control: ControlRequest,
    /// Board whose time a plant's sub-steps are chosen for.
    pub board: &'a Board,
    /// File for the FMU.
    pub out: &'a Path,
}

/// Writes the FMU and returns the line for the user.
pub fn run(request: &Request) -> Outcome<String> {
    let model = Model::new(request.fmi, request.content, request.joint, request.control, request.board)?;
    let files = Progress::during(|progress| {
        progress.stage("building the library");
        let library = library::build(Target::Host, "library", &|line: &str| progress.print_message(line))?;
        progress.stage("compiling the FMU");
        contents(&model, &library)
    })?;
    let archive = archive::pack(&files)?;
    write::write_bytes(request.out, &archive)?;
    Ok(format!(
        "{}: {} B, {} variables, control period {:?} s, binary for {}\n",
        request.out.display(),
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
