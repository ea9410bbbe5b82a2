//! `joint release`: arguments, refusals, order of the builds, and writing of all files at the end.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

use board::device::board::Board;
use board::device::tool;
use board::device::toolchain::Toolchain;
use clap::ValueEnum;
use clap::builder::PossibleValuesParser;
use joint_file::PRESETS;
use report::failure::{Failure, Outcome};
use report::interruption::UninterruptedWork;
use report::progress::Progress;
use report::workspace::{require_sources, workspace};
use report::{folder, write};

use crate::contents::{self, DIGESTS, File, LeftOut};
use crate::parts::{self, Builds};
use crate::sbom::Materials;
use crate::source::Source;
use crate::tools;

/// Purpose of the command.
pub const ABOUT: &str =
    "Build everything that users are given: wheel, command, C archives, images, book, digests, SBOM";

/// Arguments of `joint release`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint release --out dist                                everything: an hour or two from nothing on two cores
  joint release --out dist --only wheel,command           a part, with its lists
  joint release --out dist --only images --joints q1 --boards nucleo-g474re

The folder holds the Python wheel, the command for this kind of machine, the C archives of all targets, the images of
the presets for all boards, the pages as a book, licences and SBOM of all packages, contents.json and SHA256SUMS. Check
it by `sha256sum --check SHA256SUMS`. Two builds of one commit by one compiler give the same bytes, in any folder. Nothing
is written before everything is built. docs/release.md says how a release is made.")]
pub struct Arguments {
    /// Folder for the release; it must be empty or not exist
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Parts to build [default: all]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "PART")]
    pub only: Vec<Part>,
    /// Presets that images are built of [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAME", value_parser = PossibleValuesParser::new(PRESETS))]
    pub joints: Vec<String>,
    /// Boards that images are built for: names of boards/ [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAME", value_parser = Board::parse)]
    pub boards: Vec<Board>,
}

/// Part of a release.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// Python wheel
    Wheel,
    /// Command `joint` for this kind of machine
    Command,
    /// Library for C and C++, all targets
    Libraries,
    /// Images of the presets for all boards
    Images,
    /// Pages of docs
    Book,
}

/// Builds a release, writes it, and returns the lines for the user.
pub fn run(arguments: &Arguments) -> Outcome<String> {
    require_sources("a release")?;
    refuse_filled(&arguments.out)?;
    refuse_unused(arguments)?;
    let source = Source::read(&workspace())?;
    let (files, left_out) = Progress::during(|progress| build(arguments, &source, progress))?;
    // The commit could have changed during the builds, which take an hour.
    if Source::read(&workspace())? != source {
        return Err(Failure::new(format!("the work tree was at {} and is at another commit now", source.commit))
            .with_help("start again, in a work tree that nothing else changes"));
    }
    refuse_filled(&arguments.out)?;
    write_all(&arguments.out, &files)?;
    Ok(summary(&arguments.out, &files, &left_out))
}

/// Refuses a folder with anything in it: files of two releases would be mixed.
fn refuse_filled(out: &Path) -> Outcome<()> {
    let help = "name a new folder by --out DIR, or remove this one";
    match fs::read_dir(out).map(|mut entries| entries.next().is_some()) {
        Ok(false) => Ok(()),
        Ok(true) => Err(Failure::new(format!("the folder {} is not empty", out.display())).with_help(help)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(Failure::new(format!("{}: {error}", out.display())).with_help(help)),
    }
}

/// Refuses options for images if none are built.
fn refuse_unused(arguments: &Arguments) -> Outcome<()> {
    let given = [("--joints", !arguments.joints.is_empty()), ("--boards", !arguments.boards.is_empty())];
    match given.into_iter().find(|(_, is_given)| *is_given && !arguments.builds(Part::Images)) {
        None => Ok(()),
        Some((option, _)) => Err(Failure::new(format!("{option} is for images, which --only leaves out"))
            .with_help(format!("add `images` to --only, or leave {option} out"))),
    }
}

impl Arguments {
    fn builds(&self, part: Part) -> bool {
        self.only.is_empty() || self.only.contains(&part)
    }
}

/// Files of the release with its lists, and images that cannot be built.
fn build(arguments: &Arguments, source: &Source, progress: &Progress) -> Outcome<(Vec<File>, Vec<LeftOut>)> {
    let say = |line: &str| progress.print_message(line);
    let builds = &Builds { source, folder: &parts::build_folder(), say: &say };
    let stage = |part: Part, what: &str| {
        let is_wanted = arguments.builds(part);
        if is_wanted {
            progress.stage(what);
            say(what);
        }
        is_wanted
    };
    let (mut files, mut left_out) = (Vec::new(), Vec::new());
    // The cheap parts come first, so that their failures do too.
    progress.stage("reading the packages");
    let materials = Materials::read()?;
    let notices = materials.notices()?;
    files.extend(stage(Part::Book, "building the book").then(|| parts::book(builds)).transpose()?);
    if stage(Part::Libraries, "building the libraries for C") {
        files.extend(parts::libraries(builds)?);
    }
    if stage(Part::Command, "building the command") {
        files.push(parts::program(builds, &notices.bytes)?);
    }
    files.extend(stage(Part::Wheel, "building the wheel").then(|| parts::wheel(builds)).transpose()?);
    if stage(Part::Images, "building the images") {
        let all = if arguments.boards.is_empty() { Board::presets()? } else { arguments.boards.clone() };
        let joints: Vec<&str> = match &arguments.joints[..] {
            [] => PRESETS.to_vec(),
            some => some.iter().map(String::as_str).collect(),
        };
        let (images, without) = parts::images(builds, &joints, &all)?;
        files.extend(images);
        left_out = without;
    }
    files.extend([notices, materials.sbom(source)?]);
    contents::add_lists(&mut files, &left_out, source, &compilers(arguments, builds)?)?;
    Ok((files, left_out))
}

/// Versions of compilers and linker that have built something.
fn compilers(arguments: &Arguments, builds: &Builds<'_>) -> Outcome<Vec<String>> {
    let mut found = Vec::new();
    if [Part::Wheel, Part::Command, Part::Libraries].into_iter().any(|part| arguments.builds(part)) {
        let version = tool::capture_output(Command::new("rustc").arg("--version").current_dir(workspace()))?;
        found.push(version.trim().to_owned());
    }
    if [Part::Images, Part::Libraries].into_iter().any(|part| arguments.builds(part)) {
        let board = Toolchain::prepare(builds.say)?.compiler().to_owned();
        found.extend((!found.contains(&board)).then_some(board));
    }
    if [Part::Wheel, Part::Command].into_iter().any(|part| arguments.builds(part)) {
        found.extend(tools::PACKAGES.map(|package| package.replace("==", " ")));
    }
    Ok(found)
}

/// Writes the files; the digests come last, so that a folder with them is complete.
fn write_all(out: &Path, files: &[File]) -> Outcome<()> {
    let _uninterrupted = UninterruptedWork::begin();
    debug_assert!(files.last().is_some_and(|file| file.path == DIGESTS));
    for file in files {
        let path = out.join(&file.path);
        folder::make(path.parent().unwrap_or(out))?;
        write::write_bytes(&path, &file.bytes)?;
    }
    Ok(())
}

fn summary(out: &Path, files: &[File], left_out: &[LeftOut]) -> String {
    let bytes: usize = files.iter().map(|file| file.bytes.len()).sum();
    let (images, others): (Vec<&File>, Vec<&File>) = files.iter().partition(|file| file.path.starts_with("images/"));
    let mut text: String = others.iter().map(|file| format!("{:>11} B  {}\n", file.bytes.len(), file.path)).collect();
    if !images.is_empty() {
        let bytes: usize = images.iter().map(|file| file.bytes.len()).sum();
        text += &format!("{bytes:>11} B  images/, {} files\n", images.len());
    }
    for LeftOut { path, why } in left_out {
        text += &format!("left out: {path}: {why}\n");
    }
    let out = out.display();
    text + &format!("{out}: {bytes} B; check it by `cd {out} && sha256sum --check --quiet {DIGESTS}`\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(out: &Path, only: &[Part]) -> Arguments {
        Arguments { out: out.to_path_buf(), only: only.to_vec(), joints: vec!["q1".into()], boards: Vec::new() }
    }

    /// A folder with a file is refused before any build, an empty or missing one is not.
    #[test]
    fn filled_folder_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        refuse_filled(folder.path()).expect("an empty folder");
        refuse_filled(&folder.path().join("new")).expect("no folder yet");
        fs::write(folder.path().join("thesis.txt"), "mine").expect("room");
        for out in [folder.path(), &folder.path().join("thesis.txt")] {
            let failure = run(&arguments(out, &[])).expect_err("files would be mixed");
            assert!(failure.message().contains("not empty") || failure.message().contains("thesis.txt"), "{failure}");
            assert!(failure.help().is_some_and(|help| help.contains("--out DIR")), "{failure}");
            assert_eq!(failure.exit_code(), 2);
        }
    }

    /// An option without effect is refused with its remedy.
    #[test]
    fn image_option_without_images_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        refuse_unused(&arguments(folder.path(), &[])).expect("all parts");
        let failure = run(&arguments(folder.path(), &[Part::Book])).expect_err("no images");
        assert!(failure.message().contains("--joints"), "{failure}");
        assert!(failure.help().is_some_and(|help| help.contains("add `images`")), "{failure}");
    }

    /// The digests are written last, and every file into its folder.
    #[test]
    fn digests_are_written_last() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |path: &str| File { path: path.into(), what: "".into(), target: "".into(), bytes: path.into() };
        write_all(folder.path(), &[file("images/a.elf"), file(DIGESTS)]).expect("room");
        assert_eq!(fs::read_to_string(folder.path().join("images/a.elf")).expect("a file"), "images/a.elf");
        // A file that cannot be written leaves no digests.
        let other = tempfile::tempdir().expect("a folder");
        fs::create_dir_all(other.path().join("a.txt")).expect("room");
        write_all(other.path(), &[file("a.txt"), file(DIGESTS)]).expect_err("a folder is in the way");
        assert!(!other.path().join(DIGESTS).exists());
    }
}
