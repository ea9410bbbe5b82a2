//! `joint tables`: a joint's tables as constant bytes, in a header, a source and a binary file.

use std::path::{Path, PathBuf};

use board::device::board::Board;
use joint_file::JointFile;
use joint_file::{named, warnings};
use model_core::controller::design::{ControlRequest, NominalPlant};
use report::failure::{Failure, Outcome};
use report::folder::{Folder, file_part};
use table_blob::{VERSION, Wanted, design};

/// Patterns of the written files.
const FILES: [&str; 3] = ["*_tables.h", "*_tables.c", "*_tables.bin"];

/// Arguments of `joint tables`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint tables joints/q1.toml --out firmware/q1          q1_tables.h, q1_tables.c and q1_tables.bin for the C library
  joint tables q1 --rate 20000 --bandwidth 80 --without-plant --out q1    20 kHz, without the plant
  joint tables my_joint.toml --told guess.toml --out test    plant of one joint, controller designed for another

Header and source are C99 and C++14; the binary file holds the same bytes, for a loader or a separate partition.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
    #[arg(value_name = "FILE", default_value = "q1")]
    pub file: PathBuf,
    /// Folder for the tables [default: joint-out/tables/JOINT]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Control rate, in Hz [default: from the joint file]
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(1..))]
    pub rate: Option<u32>,
    /// Controller.
    #[command(flatten)]
    pub controller: ControllerOptions,
    /// Joint file that observer and compensation are designed for [default: FILE]
    #[arg(long, value_name = "FILE")]
    pub told: Option<PathBuf>,
    /// Leaves out the tables of the plant, which firmware for a real joint does not need
    #[arg(long)]
    pub without_plant: bool,
    /// Board whose time a plant's sub-steps are chosen for: a name of boards/, or the path of a board file
    #[arg(long, value_name = "NAME|FILE", value_parser = Board::parse, default_value = board_file::DEFAULT)]
    pub board: Board,
}

/// Requirements on a controller.
#[derive(Debug, clap::Args)]
pub struct ControllerOptions {
    /// Bandwidth of the loop, in rad/s [default: 60, or as much as the joint allows]
    #[arg(long, value_name = "RAD/S", value_parser = bandwidth)]
    pub bandwidth: Option<f64>,
    /// Designs the observer without the output encoder
    #[arg(long)]
    pub motor_only: bool,
}

impl ControllerOptions {
    /// Requirements for the design.
    pub fn request(&self) -> ControlRequest {
        ControlRequest { bandwidth: self.bandwidth, output_encoder: !self.motor_only, ..ControlRequest::USUAL }
    }

    /// First option that was given.
    pub fn given(&self) -> Option<&'static str> {
        self.bandwidth.map(|_| "--bandwidth").or(self.motor_only.then_some("--motor-only"))
    }
}

/// Nominal plant of a joint file.
pub fn nominal(joint: &JointFile, request: ControlRequest) -> NominalPlant<'_> {
    NominalPlant { joint: &joint.parameters, surroundings: &joint.surroundings, request }
}

/// Parses a positive bandwidth.
fn bandwidth(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("a bandwidth is a positive number of rad/s, such as 60".to_owned()),
    }
}

/// Tables with their name in C.
#[derive(Debug)]
pub struct CTables {
    /// Identifier in C.
    pub name: String,
    /// Words of the blob.
    pub words: Vec<u64>,
    /// Origin of the tables, as lines for a comment.
    pub made_from: Vec<String>,
}

/// Writes the tables and returns the lines for the user.
pub fn run(arguments: &Arguments) -> Outcome<String> {
    let loaded = named::load(&arguments.file)?;
    warnings::print(&loaded);
    let told = arguments.told.as_deref().map(named::load).transpose()?;
    let [mut joint, mut told] = [&loaded.file, told.as_ref().map_or(&loaded.file, |told| &told.file)].map(Clone::clone);
    let rate = arguments.rate.unwrap_or(joint.surroundings.control_rate);
    [&mut joint, &mut told].into_iter().for_each(|it| it.surroundings.control_rate = rate);
    let nominal = nominal(&told, arguments.controller.request());
    let tables = make(&joint, &nominal, !arguments.without_plant, &arguments.board)
        .map_err(|failure| failure.while_doing(format_args!("tables of {}", loaded.name)))?;
    let folder = Folder::prepare(arguments.out.as_deref(), "tables", &joint.parameters.name, &FILES)?;
    let name = |extension: &str| format!("{}_tables.{extension}", tables.name);
    folder.write_text(&name("h"), &tables.header())?;
    folder.write_text(&name("c"), &tables.source())?;
    folder.write_with(&name("bin"), |file| std::io::Write::write_all(file, &tables.bytes()))?;
    Ok(format!(
        "{}: {} B of tables, version {VERSION}, digest {:#018x}\n{}\n",
        folder.file(&name("c")).display(),
        tables.bytes().len(),
        tables.digest(),
        tables.made_from.join("\n")
    ))
}

/// Designs the tables.
pub fn make(joint: &JointFile, nominal: &NominalPlant<'_>, plant: bool, board: &Board) -> Outcome<CTables> {
    let plant = plant.then_some((&joint.parameters, &joint.surroundings));
    let wanted = Wanted { plant, nominal: *nominal, processor: board.chip().processor() };
    let words = design(&wanted).and_then(|words| Ok((words, nominal.bandwidth()?)));
    let (words, bandwidth) = words.map_err(|error| {
        let of_plant = plant.is_some() && design(&Wanted { plant: None, ..wanted }).is_ok();
        Failure::new(error.to_string()).with_help(match of_plant {
            true => "`--without-plant` leaves out the plant, which firmware for a real joint does not need",
            false => {
                "`joint check` shows the limits that follow from the file; change the requirements with `--rate` and `--bandwidth`"
            }
        })
    })?;
    let parts = match plant {
        Some(_) => {
            format!(
                "plant (sub-steps for {}), observer, width probe where one can be, compensation, wiring check",
                board.name()
            )
        }
        None => "observer, width probe where one can be, compensation, wiring check; no plant".to_owned(),
    };
    let made_from = vec![
        format!("joint {}, told {}", joint.parameters.name, nominal.joint.name),
        format!(
            "{} control periods a second, bandwidth {} rad/s, {}",
            nominal.surroundings.control_rate,
            bandwidth,
            if nominal.request.output_encoder { "both encoders" } else { "motor encoder alone" }
        ),
        parts,
    ];
    Ok(CTables { name: c_name(&joint.parameters.name), words, made_from })
}

/// Turns a joint's name into a C identifier: letters, digits and underscores, no leading digit.
fn c_name(joint: &str) -> String {
    let part = file_part(joint).to_lowercase();
    let name: String = part.chars().map(|it| if it.is_ascii_alphanumeric() { it } else { '_' }).collect();
    if name.starts_with(|first: char| first.is_ascii_alphabetic()) { name } else { format!("joint_{name}") }
}

impl CTables {
    /// Bytes of the tables.
    pub fn bytes(&self) -> Vec<u8> {
        self.words.iter().flat_map(|word| word.to_le_bytes()).collect()
    }

    /// Digest of the tables.
    pub fn digest(&self) -> u64 {
        table_blob::Blob::open(&self.words).map_or(0, |blob| blob.header().digest)
    }

    /// Text of the header.
    pub fn header(&self) -> String {
        let (name, upper) = (&self.name, self.name.to_uppercase());
        // A joint's name may hold anything, even the end of a comment.
        let plain = |line: &String| line.replace(char::is_control, " ").replace("*/", "* /");
        let remarks: String = self.made_from.iter().map(|line| format!(" * {}\n", plain(line))).collect();
        format!(
            "/*\n * Tables for the C library, written by `joint tables`; do not edit.\n{remarks} */\n\
             #ifndef {upper}_TABLES_H\n#define {upper}_TABLES_H\n\n#include <stdint.h>\n\n\
             /* Version of the layout, and digest. */\n\
             #define {upper}_TABLES_VERSION {VERSION}\n#define {upper}_TABLES_DIGEST {:#018x}ull\n\n\
             #if defined(JOINT_TABLES_VERSION) && JOINT_TABLES_VERSION != {VERSION}\n\
             #error \"{name}_tables.h is of another version than joint.h: generate it again with that library's `joint tables`\"\n\
             #endif\n\n\
             #ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n\
             /* Pass it with sizeof {name}_tables. */\nextern const uint64_t {name}_tables[{}];\n\n\
             #ifdef __cplusplus\n}}\n#endif\n\n#endif\n",
            self.digest(),
            self.words.len()
        )
    }

    /// Text of the source.
    pub fn source(&self) -> String {
        let name = &self.name;
        let rows: String = self
            .words
            .chunks(4)
            .map(|row| {
                let row: Vec<String> = row.iter().map(|word| format!("{word:#018x}ull")).collect();
                format!("    {},\n", row.join(", "))
            })
            .collect();
        format!(
            "/* Tables for the C library, written by `joint tables`; do not edit. */\n\
             #include \"{name}_tables.h\"\n\nconst uint64_t {name}_tables[{}] = {{\n{rows}}};\n",
            self.words.len()
        )
    }
}

/// Reads a joint with a control rate, for the test programs.
pub fn joint_at(name: &Path, rate: u32) -> Outcome<JointFile> {
    let mut joint = named::load(name)?.file;
    joint.surroundings.control_rate = rate;
    Ok(joint)
}

/// Tables called `test_tables`, for the test programs.
pub fn for_tests(joint: &JointFile, plant: bool, board: &Board) -> Outcome<CTables> {
    Ok(CTables { name: "test".to_owned(), ..make(joint, &nominal(joint, ControlRequest::USUAL), plant, board)? })
}

#[cfg(test)]
mod tests {
    use super::c_name;

    /// Every joint's name becomes a C identifier.
    #[test]
    fn joint_names_become_c_identifiers() {
        assert_eq!(c_name("Q1"), "q1");
        assert_eq!(c_name("left knee (v2)"), c_name("left knee (v2)"));
        for name in ["7 up", "", "Ellenbogen-3", "ä"] {
            let name = c_name(name);
            assert!(name.starts_with(|first: char| first.is_ascii_alphabetic()), "{name}");
            assert!(name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_'), "{name}");
        }
    }
}
