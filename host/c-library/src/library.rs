//! Builds the functions declared in the header: for each target one archive with one object, whose only global names
//! are those of the header. The compiler's own libraries (core, mathematics) are linked in as far as they are used;
//! only `memcpy` and similar functions, which every C toolchain has, stay undefined.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use board::device::compile::{compile_library, compile_library_for_host};
use board::device::toolchain::{Toolchain, target_directory};
use board::device::{Say, packages, tool};
use clap::ValueEnum;
use object::read::archive::ArchiveFile;
use report::failure::{Failure, Outcome};
use report::workspace::{require_sources, workspace};

/// Package of the library.
const PACKAGE: &str = "c-bindings";
/// Soname of the shared library. The number grows when programs must be linked again.
pub const SONAME: &str = "liblostmotion.so.0";
/// Packages to build C programs for boards.
const CROSS_PACKAGES: [&str; 2] = ["gcc-arm-none-eabi", "libnewlib-arm-none-eabi"];
/// Packages to build C programs for this machine.
const NATIVE_PACKAGES: [&str; 1] = ["g++"];

/// Inline threshold of the size-optimised library: observer and compensation take a fifth to a third more instructions
/// and a third less flash than in the firmware's images. Without it the observer's worst case would double.
const INLINE_THRESHOLD: &str = "-Cllvm-args=-inline-threshold=20";

/// Exported names of the core's own steps, in a library for measuring.
const BARE_STEPS: [&str; 7] = [
    "joint_bare_samples",
    "joint_bare_command",
    "joint_bare_observer",
    "joint_bare_estimates",
    "joint_bare_compensation",
    "joint_bare_observer_step",
    "joint_bare_compensation_step",
];

/// Target of a library.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// Cortex-M4 with FPU, hard-float ABI
    M4f,
    /// Cortex-M33 with FPU and DSP extension, hard-float ABI
    M33,
    /// Cortex-M7 with FPU, hard-float ABI
    M7,
    /// This machine
    Host,
}

impl Target {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::M4f => "m4f",
            Self::M33 => "m33",
            Self::M7 => "m7",
            Self::Host => "host",
        }
    }

    /// Flags of the C compiler.
    pub fn c_flags(self) -> &'static [&'static str] {
        match self {
            Self::M4f => &["-mthumb", "-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"],
            Self::M33 => &["-mthumb", "-mcpu=cortex-m33", "-mfpu=fpv5-sp-d16", "-mfloat-abi=hard"],
            Self::M7 => &["-mthumb", "-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-mfloat-abi=hard"],
            Self::Host => &[],
        }
    }

    /// Name of a program of the C toolchain, such as gcc.
    pub fn tool(self, name: &str) -> String {
        if self == Self::Host { name.to_owned() } else { format!("arm-none-eabi-{name}") }
    }

    /// Installs the C toolchain if it is missing.
    pub fn prepare(self, say: Say<'_>) -> Outcome<()> {
        let (probe, needed) = match self {
            Self::Host => ("g++", &NATIVE_PACKAGES[..]),
            _ => ("arm-none-eabi-gcc", &CROSS_PACKAGES[..]),
        };
        if tool::find(probe).is_some() {
            return Ok(());
        }
        packages::ensure(needed, "to build C programs", say)
    }
}

/// Library built for a target.
#[derive(Debug)]
pub struct Library {
    /// Target of the library.
    pub target: Target,
    /// `liblostmotion.a`.
    pub archive: Vec<u8>,
    /// `liblostmotion.so`, for a host.
    pub shared: Option<Vec<u8>>,
    /// Version of the compiler.
    pub compiler: String,
}

/// Folder of the headers.
pub fn include() -> PathBuf {
    workspace().join("bindings/c/include")
}

/// Path of the header.
pub fn header() -> PathBuf {
    include().join("lostmotion/joint.h")
}

/// Prefixes of the lines that declare a function; the header's inline functions begin differently.
const DECLARATIONS: [&str; 3] = ["JointStatus joint_", "uint32_t joint_", "const char *joint_"];

/// Functions declared by the header, in alphabetical order.
pub fn functions() -> Outcome<Vec<String>> {
    let path = header();
    let text = fs::read_to_string(&path).map_err(|error| Failure::new(format!("{}: {error}", path.display())))?;
    let mut found: Vec<String> = text
        .lines()
        .map(|line| line.strip_prefix("JOINT_MUST_USE ").unwrap_or(line))
        .filter(|line| DECLARATIONS.iter().any(|declaration| line.starts_with(declaration)))
        .filter_map(|line| Some(line[line.find("joint_")?..].split_once('(')?.0.to_owned()))
        .collect();
    found.sort();
    Ok(found)
}

/// Builds the library in cargo's default folder.
pub fn build(target: Target, features: &str, say: Say<'_>) -> Outcome<Library> {
    build_in(None, target, features, say)
}

/// Builds the library in a folder; `None` is cargo's default one.
pub fn build_in(folder: Option<&Path>, target: Target, features: &str, say: Say<'_>) -> Outcome<Library> {
    require_sources("the library for C")?;
    target.prepare(say)?;
    let (all, shared, compiler) = match target {
        Target::Host => {
            let folder = folder.map_or_else(target_directory, Path::to_path_buf);
            let [all, shared] = compile_library_for_host(&folder, PACKAGE, features, SONAME, say)?;
            let version = tool::capture_output(Command::new("rustc").arg("--version").current_dir(workspace()))?;
            (all, Some(shared), version.trim().to_owned())
        }
        Target::M4f | Target::M33 | Target::M7 => {
            let toolchain = Toolchain::prepare(say)?;
            let toolchain = folder.map_or_else(|| toolchain.clone(), |folder| toolchain.in_folder(folder));
            // A Cortex-M33 executes every instruction of a Cortex-M4F, so both targets share one build.
            let processor = if target == Target::M7 { "cortex-m7" } else { "cortex-m4" };
            let flags = format!("-Ctarget-cpu={processor} {INLINE_THRESHOLD}");
            (compile_library(&toolchain, PACKAGE, features, &flags, say)?, None, toolchain.compiler().to_owned())
        }
    };
    let archive = link_single_object(target, &all, features.contains("measuring"))?;
    Ok(Library { target, archive, shared, compiler })
}

/// Archive with a single object, which exports only the functions of the header.
fn link_single_object(target: Target, all: &[u8], measuring: bool) -> Outcome<Vec<u8>> {
    let folder =
        tempfile::tempdir().map_err(|error| Failure::new(format!("cannot create a folder for a build: {error}")))?;
    let place = |name: &str| folder.path().join(name);
    let write_failure = |error: std::io::Error| Failure::new(format!("cannot write a part of the library: {error}"));
    let parse_failure = |error: object::Error| Failure::new(format!("the compiler's archive: {error}"));
    let own = ArchiveFile::parse(all)
        .map_err(parse_failure)?
        .members()
        .filter_map(Result::ok)
        .filter(|member| member.name().starts_with(PACKAGE.replace('-', "_").as_bytes()))
        .map(|member| member.data(all).map_err(parse_failure))
        .collect::<Outcome<Vec<_>>>()?;
    let mut names = functions()?;
    if measuring {
        names.extend(BARE_STEPS.map(str::to_owned));
    }
    fs::write(place("all.a"), all).map_err(write_failure)?;
    fs::write(place("names"), names.join("\n")).map_err(write_failure)?;
    let mut link = Command::new(target.tool("ld"));
    link.current_dir(folder.path()).args(["-r", "--gc-sections"]);
    names.iter().for_each(|name| {
        link.args(["-u", name]);
    });
    link.args(["-o", "linked.o"]);
    for (index, data) in own.iter().enumerate() {
        let name = format!("own{index}.o");
        fs::write(place(&name), data).map_err(write_failure)?;
        link.arg(name);
    }
    // On a board the helpers (`__aeabi_...`) come from its C compiler; on a host the rest of the archive supplies them.
    if target == Target::Host {
        link.arg("all.a");
    }
    tool::capture_output(&mut link)?;
    let mut copy = Command::new(target.tool("objcopy"));
    copy.current_dir(folder.path()).args([
        "--strip-debug",
        "--remove-section=.comment",
        "--remove-section=.llvmbc",
        "--remove-section=.llvmcmd",
    ]);
    tool::capture_output(copy.args(["--keep-global-symbols=names", "linked.o", "joint.o"]))?;
    let mut archive = Command::new(target.tool("ar"));
    tool::capture_output(archive.current_dir(folder.path()).args(["rcsD", "liblostmotion.a", "joint.o"]))?;
    read(&place("liblostmotion.a"))
}

fn read(path: &Path) -> Outcome<Vec<u8>> {
    fs::read(path).map_err(|error| Failure::new(format!("{}: {error}", path.display())))
}
