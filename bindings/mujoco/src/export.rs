//! Writes a joint as an actuator plug-in with a model that uses it.

use std::path::{Path, PathBuf};

use board::device::board::Board;
use c_library::library::{self, Library, Target};
use c_library::shared_object::{self, Sources};
use c_library::tables::{self, CTables};
use joint_file::JointFile;
use model_core::controller::design::NominalPlant;
use model_core::gears::Kinematics;
use report::failure::{Failure, Outcome};
use report::progress::Progress;
use report::workspace::workspace;
use report::write;

use crate::mjcf;
use crate::package::Package;

/// Plug-in to be written.
#[derive(Debug)]
pub struct Plugin<'a> {
    /// Joint, with the control rate of the plug-in.
    pub joint: &'a JointFile,
    /// What the controller is designed for, with the same control rate.
    pub nominal: NominalPlant<'a>,
    /// Board whose time the plant's sub-steps are chosen for.
    pub board: &'a Board,
    /// Folder of MuJoCo's Python package; `None` for the one that `python3` imports.
    pub package: Option<PathBuf>,
    /// File for the plug-in; the model stands beside it.
    pub out: &'a Path,
}

/// Writes plug-in and model and returns the lines for the user.
pub fn run(plugin: &Plugin) -> Outcome<String> {
    let model = plugin.out.with_extension("xml");
    if model == plugin.out {
        return Err(Failure::new(format!("{}: the model for MuJoCo has this name", plugin.out.display()))
            .with_help("give the plug-in another ending, such as .so"));
    }
    let package = Package::find(plugin.package.as_deref())?;
    let tables = tables_of(plugin.joint, &plugin.nominal, plugin.board)?;
    let bytes = Progress::during(|progress| {
        progress.stage("building the library");
        let library = library::build(Target::Host, "library", &|line: &str| progress.print_message(line))?;
        progress.stage("compiling the plug-in");
        build(plugin.joint, &tables, &package, &library)
    })?;
    write::write_bytes(plugin.out, &bytes)?;
    let file = plugin.out.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    write::write_text(&model, &self::model(plugin.joint, &tables, &file))?;
    Ok(format!(
        "{}: {} B, plug-in {}, for {}; {} uses it\n",
        plugin.out.display(),
        bytes.len(),
        name_of(&tables),
        package.library.file_name().unwrap_or_default().to_string_lossy(),
        model.display()
    ))
}

/// Name of the plug-in in a model.
pub fn name_of(tables: &CTables) -> String {
    format!("lostmotion.{}", tables.name)
}

/// Model that uses the plug-in in a file, with the link of a joint.
pub fn model(link: &JointFile, tables: &CTables, file: &str) -> String {
    mjcf::model(link, &name_of(tables), file)
}

/// Tables of the plant and of the controller for the nominal plant.
pub fn tables_of(joint: &JointFile, nominal: &NominalPlant<'_>, board: &Board) -> Outcome<CTables> {
    tables::make(joint, nominal, true, board).map_err(|failure| {
        failure.with_help(
            "`joint check` shows the limits that follow from the file; change the requirements with `--rate` and `--bandwidth`",
        )
    })
}

/// Bytes of the plug-in.
pub fn build(joint: &JointFile, tables: &CTables, package: &Package, library: &Library) -> Outcome<Vec<u8>> {
    let read = |path: PathBuf| {
        std::fs::read(&path).map_err(|error| {
            Failure::new(format!("{}: {error}", path.display()))
                .with_help("restore this file of the project, or clone it again")
        })
    };
    let source = read(workspace().join("bindings/mujoco/c/plugin.c"))?;
    let header = read(library::header())?;
    let (table_source, table_header) = (tables.source(), tables.header());
    let [source_name, header_name] = ["c", "h"].map(|ending| format!("{}_tables.{ending}", tables.name));
    let description = description(joint, tables);
    let sources = Sources {
        files: vec![
            ("plugin.c", &source),
            ("description.h", description.as_bytes()),
            (&source_name, table_source.as_bytes()),
            (&header_name, table_header.as_bytes()),
            ("include/lostmotion/joint.h", &header),
        ],
        c_files: vec!["plugin.c".to_owned(), source_name.clone()],
        flags: [vec!["-isystem".to_owned(), package.include.display().to_string()], package.flags.clone()].concat(),
        objects: vec![&package.library, Path::new("-lm")],
    };
    shared_object::build(&sources, library)
}

/// `description.h`: constants of the joint.
fn description(joint: &JointFile, tables: &CTables) -> String {
    format!(
        "/* Constants of a joint, written by `joint export`. */\n#ifndef DESCRIPTION_H\n#define DESCRIPTION_H\n\n\
         #include \"{name}_tables.h\"\n\n#define PLUGIN_NAME \"{plugin}\"\n#define CONTROL_RATE_HZ {rate:?}\n\
         #define RATIO {ratio:?}\n#define tables {name}_tables\n\n#endif\n",
        name = tables.name,
        plugin = name_of(tables),
        rate = f64::from(joint.surroundings.control_rate),
        ratio = joint.parameters.geometry.ratio_by_teeth(),
    )
}
