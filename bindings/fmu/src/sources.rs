//! Sources in an FMU: the C files of `bindings/fmu/c`, tables and variables of the joint as C, the header of the C library and
//! the Rust crates that it consists of, with a CMakeLists.txt that builds the binary anew.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use c_library::library;
use report::failure::{Failure, Outcome};
use report::workspace::workspace;

use crate::archive::File;
use crate::model::{Content, Fmi, Model};
use crate::variables::{Kind, ONE, Role};

/// Folders of the crates that the C library consists of, in the workspace.
const CRATES: [&str; 6] =
    ["parameters", "model-core", "bindings/tables", "bindings/plant", "bindings/fp-mode", "bindings/c"];

/// Names of the C files to compile.
pub fn c_files(model: &Model) -> Vec<String> {
    let front = match model.fmi {
        Fmi::Two => "fmi2.c",
        Fmi::Three => "fmi3.c",
    };
    vec![
        front.to_owned(),
        "instance.c".to_owned(),
        format!("{}.c", model.content.name()),
        format!("{}_tables.c", model.tables.name),
    ]
}

/// C sources and headers without `description.h`, which has the token.
pub fn c_sources(model: &Model) -> Outcome<Vec<File>> {
    let name = &model.tables.name;
    let mut files = vec![
        File::text(format!("{name}_tables.c"), model.tables.source()),
        File::text(format!("{name}_tables.h"), model.tables.header()),
        read("include/lostmotion/joint.h", &library::header())?,
    ];
    let header = match model.fmi {
        Fmi::Two => "fmi2.h",
        Fmi::Three => "fmi3.h",
    };
    let own = c_files(model);
    for name in own[..3].iter().map(String::as_str).chain(["instance.h", header]) {
        files.push(read(name, &workspace().join("bindings/fmu/c").join(name))?);
    }
    Ok(files)
}

fn read(name: &str, path: &Path) -> Outcome<File> {
    let bytes = fs::read(path).map_err(|error| unreadable(path, &error))?;
    Ok(File { name: name.to_owned(), bytes })
}

/// Failure of a source of this project.
pub fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::new(format!("{}: {error}", path.display()))
        .with_help("restore this file of the project, or clone it again")
}

/// Name of a variable in C: without the index of a planet; `None` for all planets but the first.
fn c_name(name: &str) -> Option<&str> {
    match name.split_once('[') {
        None => Some(name),
        Some((base, "1]")) => Some(base),
        Some(_) => None,
    }
}

/// `description.h`: variables, constants of the joint and the library's objects.
pub fn description(model: &Model, token: &str) -> String {
    let mut out = format!(
        "/* Variables and constants of this FMU, written by `joint export`. */\n#ifndef DESCRIPTION_H\n#define DESCRIPTION_H\n\n\
         #include <lostmotion/joint.h>\n\n#include \"{tables}_tables.h\"\n\n#define MODEL_TOKEN \"{token}\"\n\
         #define CONTROL_RATE_HZ {:?}\n#define TICKS_PER_PERIOD {}u\n#define RATIO {:?}\n#define tables {tables}_tables\n\n",
        f64::from(model.rate),
        model.ticks,
        model.ratio,
        tables = model.tables.name,
    );
    out += match model.content {
        Content::Plant => "typedef struct {\n    JointPlant plant;\n} Objects;\n\n",
        Content::Controller => {
            "typedef struct {\n    JointObserver observer;\n    JointCompensation compensation;\n    JointTorque torque;\n\
             } Objects;\n\n"
        }
    };
    if model.content == Content::Plant {
        let _ = writeln!(out, "#define PLANETS {}u", model.meshes[0].half_backlash.len());
        for mesh in &model.meshes {
            let half: Vec<String> = mesh.half_backlash.iter().map(|half| format!("{half:?}")).collect();
            let _ = writeln!(
                out,
                "#define {}_STIFFNESS_N_PER_M {:?}\nstatic const double {}_half_backlash_m[] = {{{}}};",
                mesh.name.to_uppercase(),
                mesh.stiffness,
                mesh.name,
                half.join(", ")
            );
        }
        out.push('\n');
    }
    out += "typedef enum { REAL, INTEGER, BOOLEAN } Kind;\n\ntypedef struct {\n    const char *name;\n    const char *unit;\n    \
            Kind kind;\n    int is_input;\n    double start;\n    \
            /* Numbers that an input accepts. */\n    double min;\n    double max;\n} Variable;\n\nenum {\n";
    for (index, variable) in model.variables.iter().enumerate() {
        if let Some(name) = c_name(&variable.name) {
            let _ = writeln!(out, "    VALUE_{name} = {index},");
        }
    }
    let _ = write!(
        out,
        "    VARIABLES = {}\n}};\n\nstatic const Variable variables[VARIABLES] = {{\n",
        model.variables.len()
    );
    for variable in &model.variables {
        let (kind, unit) = match variable.kind {
            Kind::Real(unit) => ("REAL", unit.0),
            Kind::Integer => ("INTEGER", ONE.0),
            Kind::Boolean => ("BOOLEAN", ONE.0),
        };
        let (is_input, start) = match variable.role {
            Role::Input(start) => (1, start),
            Role::Independent | Role::Output => (0, 0.0),
        };
        let range = variable.range();
        let (min, max) = (range.start(), range.end());
        let _ = writeln!(
            out,
            "    {{\"{}\", \"{unit}\", {kind}, {is_input}, {start:?}, {min:e}, {max:e}}},",
            variable.name
        );
    }
    out += "};\n\n#endif\n";
    out
}

/// CMakeLists.txt: cargo builds the library, the C compiler the FMU's binary.
pub fn cmake(model: &Model) -> String {
    CMAKE.replace("@MODEL@", &model.identifier).replace("@SOURCES@", &c_files(model).join(" "))
}

const CMAKE: &str = "# Builds the binary of this FMU for the machine on which it runs; needs a C compiler and cargo:
#   cmake -S extra/lostmotion -B build -DCMAKE_BUILD_TYPE=Release && cmake --build build
# The result, build/@MODEL@ with the system's ending, belongs into the FMU's folder `binaries`.
cmake_minimum_required(VERSION 3.13)
project(@MODEL@ C)
find_program(CARGO cargo)
if(NOT CARGO)
  message(FATAL_ERROR \"cargo is missing: install Rust from https://rustup.rs\")
endif()
set(library \"${CMAKE_CURRENT_BINARY_DIR}/rust/firmware/${CMAKE_STATIC_LIBRARY_PREFIX}c_bindings${CMAKE_STATIC_LIBRARY_SUFFIX}\")
add_custom_command(OUTPUT \"${library}\"
  COMMAND \"${CMAKE_COMMAND}\" -E env CARGO_PROFILE_FIRMWARE_DEBUG=0 \"${CARGO}\" rustc --manifest-path \"${CMAKE_CURRENT_SOURCE_DIR}/rust/Cargo.toml\" --target-dir \"${CMAKE_CURRENT_BINARY_DIR}/rust\"
          --package c-bindings --lib --profile firmware --crate-type staticlib --features library)
add_custom_target(lostmotion DEPENDS \"${library}\")
add_library(@MODEL@ SHARED @SOURCES@)
add_dependencies(@MODEL@ lostmotion)
target_include_directories(@MODEL@ PRIVATE . include)
target_link_libraries(@MODEL@ PRIVATE \"${library}\")
set_target_properties(@MODEL@ PROPERTIES PREFIX \"\" C_STANDARD 99 C_VISIBILITY_PRESET hidden)
if(NOT MSVC)
  target_compile_options(@MODEL@ PRIVATE -ffp-contract=off)
endif()
if(CMAKE_SYSTEM_NAME STREQUAL \"Linux\")
  target_link_options(@MODEL@ PRIVATE -Wl,--exclude-libs,ALL)
endif()
";

/// Crates of the C library as a workspace of their own.
pub fn rust_sources() -> Outcome<Vec<File>> {
    let root = workspace();
    let manifest = text(&root.join("Cargo.toml"))?;
    let mut files = vec![
        File::text("rust/Cargo.toml", workspace_manifest(&manifest)),
        read("rust/Cargo.lock", &root.join("Cargo.lock"))?,
        read("rust/LICENSE", &root.join("LICENSE"))?,
    ];
    for folder in CRATES {
        let manifest = text(&root.join(folder).join("Cargo.toml"))?;
        files.push(File::text(
            format!("rust/{folder}/Cargo.toml"),
            without_sections(&manifest, &["[dev-dependencies]"]),
        ));
        add_folder(&root, &format!("{folder}/src"), &mut files)?;
    }
    Ok(files)
}

fn text(path: &Path) -> Outcome<String> {
    fs::read_to_string(path).map_err(|error| unreadable(path, &error))
}

/// Adds all files of a folder in the order of their names.
fn add_folder(root: &Path, folder: &str, files: &mut Vec<File>) -> Outcome<()> {
    let failure = |error: std::io::Error| unreadable(&root.join(folder), &error);
    let mut names = fs::read_dir(root.join(folder))
        .map_err(failure)?
        .map(|entry| entry.map(|entry| entry.file_name().to_string_lossy().into_owned()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(failure)?;
    names.sort();
    for name in names {
        let inner = format!("{folder}/{name}");
        if root.join(&inner).is_dir() {
            add_folder(root, &inner, files)?;
        } else if name.ends_with(".rs") {
            files.push(read(&format!("rust/{inner}"), &root.join(&inner))?);
        }
    }
    Ok(())
}

/// Manifest of the workspace with the crates of the library as its only members.
fn workspace_manifest(text: &str) -> String {
    let members: Vec<String> = CRATES.iter().map(|folder| format!("\"{folder}\"")).collect();
    let members = format!("members = [{}]", members.join(", "));
    let lines = text.lines().filter(|line| !line.starts_with("default-members") && !line.starts_with('#'));
    let kept: String = lines
        .map(|line| if line.starts_with("members") { format!("{members}\n") } else { format!("{line}\n") })
        .collect();
    without_sections(&kept, &["[profile.dev"])
}

/// Text of a TOML file without the sections whose heading begins with one of the words.
fn without_sections(text: &str, headings: &[&str]) -> String {
    let mut is_kept = true;
    let mut kept = String::new();
    for line in text.lines() {
        if line.starts_with('[') {
            is_kept = !headings.iter().any(|heading| line.starts_with(heading));
        }
        if is_kept {
            kept += line;
            kept.push('\n');
        }
    }
    kept
}
