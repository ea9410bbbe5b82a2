//! `joint library`: header, library, files for build systems, costs and a test program, as one archive.

use std::fs;
use std::path::{Path, PathBuf};

use board::device::Say;
use board::device::board::Board;
use board::device::emulator;
use report::failure::{Failure, Outcome};
use report::folder::Folder;
use report::progress::Progress;
use report::workspace::workspace;

use crate::library::{self, Library, SONAME, Target};
use crate::programs;
use crate::tarball::{self, Entry};
use crate::{build_files, costs, run, tables};

/// Patterns of the written files.
const FILES: [&str; 1] = ["lostmotion-*.tar"];
/// Name under which a linker finds the shared library.
const LINKED_NAME: &str = "lib/liblostmotion.so";
/// Version of the library, equal to the workspace's.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Control periods of the test program.
const PERIODS: u32 = 20_000;
/// Control rate of the test program [Hz].
const RATE: u32 = 10_000;

/// Arguments of `joint library`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint library --target m4f --out vendor        vendor/lostmotion-VERSION-m4f.tar, for STM32F4 and STM32G4
  joint library --target m33 --out vendor        for RP2350, STM32H5 and STM32U5
  joint library --target host                    for unit tests on this machine: static and shared

The archive holds headers for C and C++, library, CMake and pkg-config files, library.properties for Arduino,
library.json for PlatformIO, module.yml for Zephyr, the licence, a table of costs and a test program. Two builds of one checkout give the same bytes. Tables of a joint come from
`joint tables`.")]
pub struct Arguments {
    /// Target of the library
    #[arg(long, value_enum)]
    pub target: Target,
    /// Folder for the archive [default: joint-out/library/TARGET]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Builds the archive, writes it, and returns the line for the user.
pub fn run(arguments: &Arguments) -> Outcome<String> {
    let target = arguments.target;
    let folder = Folder::prepare(arguments.out.as_deref(), "library", target.name(), &FILES)?;
    let (library, archive) = Progress::during(|progress| {
        progress.stage("building the library");
        let say = |line: &str| progress.print_message(line);
        let library = library::build(target, "library", &say)?;
        progress.stage("counting costs");
        let archive = archive(&library, &say)?;
        Ok((library, archive))
    })?;
    let name = format!("{}.tar", prefix(target));
    folder.write_with(&name, |file| std::io::Write::write_all(file, &archive))?;
    Ok(format!(
        "{}: {} B, liblostmotion.a {} B, built by {}\n",
        folder.file(&name).display(),
        archive.len(),
        library.archive.len(),
        library.compiler
    ))
}

/// Name of the archive and of the folder in it.
pub fn prefix(target: Target) -> String {
    format!("lostmotion-{VERSION}-{}", target.name())
}

/// Packs the archive; equal libraries give equal bytes.
pub fn archive(library: &Library, say: Say<'_>) -> Outcome<Vec<u8>> {
    let files = contents(library, say)?.into_iter().map(|(name, bytes)| (name, Entry::File(bytes)));
    let link = library.shared.iter().map(|_| (LINKED_NAME.to_owned(), Entry::Link(SONAME)));
    tarball::pack(&prefix(library.target), files.chain(link).collect())
}

/// Names and contents of all files, in the order of the archive.
fn contents(library: &Library, say: Say<'_>) -> Outcome<Vec<(String, Vec<u8>)>> {
    let target = library.target;
    let joint = tables::joint_at(Path::new("q1"), RATE)?;
    let test_tables = tables::for_tests(&joint, true, &Board::emulated())?;
    let expected = run::digest(&test_tables.words, PERIODS)?;
    let header = read(&library::header())?;
    let text = |text: &str| text.as_bytes().to_vec();
    let mut files = vec![
        ("README.md".to_owned(), text(&readme(target))),
        ("COSTS.md".to_owned(), text(&costs_page(library, &joint, say)?)),
        ("LICENSE".to_owned(), read(&workspace().join("LICENSE"))?),
        ("include/lostmotion/joint.h".to_owned(), header.clone()),
        ("include/lostmotion/joint.hpp".to_owned(), read(&library::include().join("lostmotion/joint.hpp"))?),
        ("include/joint.h".to_owned(), read(&library::include().join("joint.h"))?),
        ("lib/liblostmotion.a".to_owned(), library.archive.clone()),
        ("test/test_tables.h".to_owned(), text(&test_tables.header())),
        ("test/test_tables.c".to_owned(), text(&test_tables.source())),
        (
            "test/tables_of_test.h".to_owned(),
            text(&format!(
                "#include \"test_tables.h\"\n#define tables_of_test test_tables\n#define PERIODS {PERIODS}u\n\
                 #define EXPECTED_DIGEST {expected:#018x}ull\n"
            )),
        ),
    ];
    if let Some(shared) = &library.shared {
        files.push((format!("lib/{SONAME}"), shared.clone()));
    }
    let board = [
        "board/start.c",
        "board/memory.c",
        "board/sections.ld",
        "board/netduinoplus2.ld",
        "board/mps2.ld",
        "board/mps2-an505.ld",
    ];
    let own: &[&str] = match target {
        Target::Host => &["host.c"],
        Target::M4f | Target::M33 | Target::M7 => &board,
    };
    for name in ["test_joint.c", "run.h", "say.h"].iter().chain(own) {
        files.push((format!("test/{name}"), read(&programs::folder().join(name))?));
    }
    let build_files = build_files::all(target, VERSION).into_iter();
    files.extend(build_files.map(|(name, text)| (name.to_owned(), text.into_bytes())));
    if let Some(folder) = build_files::arduino_folder(target) {
        files.push((format!("{folder}/liblostmotion.a"), library.archive.clone()));
        files.push(("src/lostmotion/joint.h".to_owned(), header));
        files.push(("src/lostmotion.h".to_owned(), text(build_files::ARDUINO_HEADER)));
    }
    Ok(files)
}

fn read(path: &Path) -> Outcome<Vec<u8>> {
    fs::read(path).map_err(|error| Failure::new(format!("{}: {error}", path.display())))
}

/// README: building a program with the library, and running the test program.
fn readme(target: Target) -> String {
    let flags = target.c_flags().join(" ");
    let (title, test, with_cmake) = match build_files::linker_script(target) {
        None => (
            "A program for this kind of machine",
            "cd test && cc -I../include test_joint.c test_tables.c host.c ../lib/liblostmotion.a -o test_joint && ./test_joint"
                .to_owned(),
            "cmake -S test -B build && cmake --build build && build/test_joint".to_owned(),
        ),
        Some(script) => {
            let machine = match target {
                Target::M33 => "mps2-an505",
                Target::M7 => "mps2-an500",
                _ => "netduinoplus2",
            };
            let run = format!("qemu-system-arm -M {machine} -nographic -semihosting -kernel");
            (
                "Firmware",
                format!(
                    "cd test && arm-none-eabi-gcc {flags} -O2 -nostartfiles -I../include -L board -T board/{script} \\\n    \
                     test_joint.c test_tables.c board/start.c ../lib/liblostmotion.a -o test_joint.elf\n{run} test_joint.elf"
                ),
                format!(
                    "cmake -S test -B build -DCMAKE_TOOLCHAIN_FILE=board/toolchain.cmake && cmake --build build\n\
                     {run} build/test_joint"
                ),
            )
        }
    };
    let flags = if flags.is_empty() { "none in particular" } else { &flags };
    format!(
        "# lostmotion {VERSION} for C and C++, target {}\n\n\
         Observer, compensation, width probe and plant of a geared joint with backlash. `include/lostmotion/joint.h` documents\n\
         the interface; `include/lostmotion/joint.hpp` is a C++ interface over it. COSTS.md has flash, RAM, stack and\n\
         instructions of each call.\n\n\
         ## {title}\n\n\
         1. Write the tables of your joint: `joint tables my_joint.toml --out tables`, where this archive was written.\n\
         2. Compile `tables/*_tables.c` with your sources; flags: `{flags}`.\n\
         3. Give the compiler `-Iinclude` and the linker `lib/liblostmotion.a`, or let a build system do so:\n   \
         - CMake: `find_package(lostmotion CONFIG REQUIRED)` with this folder in `CMAKE_PREFIX_PATH`, or `add_subdirectory` of it;\n     \
         then `target_link_libraries(... lostmotion::joint)`.\n   \
         - pkg-config: `PKG_CONFIG_PATH=lib/pkgconfig pkg-config --cflags --libs lostmotion` (static);\n     `lostmotion-shared` on a host is the shared library.\n   \
         - Zephyr: this folder in `ZEPHYR_EXTRA_MODULES`.\n   \
         - PlatformIO: this folder in the project's `lib`.\n   \
         - Arduino, for boards of STM32duino: this folder in the sketchbook's `libraries`.\n\n\
         ## The test program\n\n\
         It compares this library with the core bit for bit; it prints `as expected`.\n\n\
         ```\n{test}\n```\n\nOr:\n\n```\n{with_cmake}\n```\n",
        target.name(),
    )
}

/// COSTS: flash, RAM, stack and instructions.
fn costs_page(library: &Library, joint: &joint_file::JointFile, say: Say<'_>) -> Outcome<String> {
    let mut page = format!("# Costs, target {}\n\nBuilt by {}.\n", library.target.name(), library.compiler);
    page += &match costs::machine_for(library.target) {
        None => "\nNothing is counted on a host: its compiler and processor decide.\n".to_owned(),
        Some(machine) => {
            emulator::ensure(say)?;
            costs::section(&costs::Costs::measure(library, joint, machine)?, joint, machine)
        }
    };
    Ok(page)
}
