//! Test files of a command: one file, or all of a folder, each checked with its joint before any run. A file that
//! cannot run does not prevent the others in its folder. Also distinguishes test files from joint files.

use std::fs;
use std::path::{Path, PathBuf};

use link::messages::Role;

use super::case::{Case, check_changes};
use super::faults::check_broken_tooth;
use super::file::{self, TestFile, Trajectory};
use super::plant::{PlantName, reject_effects};
use super::record::NotRun;
use super::recorded::RecordedMotion;
use board::profile::check_length;
use joint_file::diagnostic;
use joint_file::named::{self, Loaded};
use joint_file::warnings;
use report::digest::sha256;
use report::failure::{Failure, Outcome};
use report::input;

/// A test that has been checked with its joint.
pub struct Test {
    /// Path as the user named it.
    pub name: String,
    /// SHA-256 of the file's text.
    pub sha256: String,
    /// Contents of the file.
    pub file: TestFile,
    /// Joint of the test.
    pub joint: Loaded,
    /// Recorded motion, if the test has one.
    pub motion: Option<RecordedMotion>,
    /// Texts of the test file, of the joint file and of the recorded motion, if the test has one.
    pub inputs: Vec<String>,
}

/// Returns true for a folder, or for a file that is not a joint file.
pub fn holds_tests(path: &Path) -> bool {
    path.is_dir() || input::text(path, input::LARGEST_TYPED).is_ok_and(|text| file::is_test_file(&text))
}

/// Choice among the files of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// All files except those for full runs only.
    Short,
    /// All files.
    Full,
    /// Files of the run without a file, in this role of a board.
    OnBoard(Role),
}

impl Choice {
    fn includes(self, file: &TestFile) -> bool {
        match self {
            Self::Short => !file.only_with_full,
            Self::Full => true,
            Self::OnBoard(role) => file.short_run == Some(role),
        }
    }
}

/// Tests of a path.
pub struct Suite {
    /// Tests that can run.
    pub tests: Vec<Test>,
    /// Files of a folder that cannot run.
    pub not_run: Vec<NotRun>,
    /// A single file was named, so a file that cannot run ends the command.
    alone: bool,
}

impl Suite {
    /// Keeps the tests that pass a check.
    pub fn keep(&mut self, mut check_test: impl FnMut(&Test) -> Outcome<()>) -> Outcome<()> {
        for test in std::mem::take(&mut self.tests) {
            match check_test(&test) {
                Ok(()) => self.tests.push(test),
                Err(failure) if self.alone => return Err(failure),
                Err(failure) => self.not_run.push(NotRun::new(test.name, &failure)),
            }
        }
        Ok(())
    }
}

/// Reads a file, or the chosen files of a folder.
pub fn load(path: &Path, choice: Choice, plant: PlantName) -> Outcome<Suite> {
    if !path.is_dir() {
        return Ok(Suite { tests: vec![load_one(path, plant)?], not_run: Vec::new(), alone: true });
    }
    let mut suite = Suite { tests: Vec::new(), not_run: Vec::new(), alone: false };
    for path in test_paths(path)? {
        let test = match read(&path) {
            Ok((_, file)) if !choice.includes(&file) => continue,
            Ok(_) => load_one(&path, plant),
            Err(failure) => Err(failure),
        };
        match test {
            Ok(test) => suite.tests.push(test),
            Err(failure) => suite.not_run.push(NotRun::new(path.display().to_string(), &failure)),
        }
    }
    if suite.tests.is_empty() && suite.not_run.is_empty() {
        let help =
            "a test file is TOML, as docs/reference/hil-file.md tells; those with only_with_full run with --full";
        return Err(Failure::new(format!("there is no test to run in {}", path.display())).with_help(help));
    }
    Ok(suite)
}

/// Files of a folder without a board's role, which a run without `--full` skips.
pub fn skipped_without_full(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let left = |path: &PathBuf| read(path).is_ok_and(|(_, file)| file.short_run.is_none());
    Ok(test_paths(folder)?.into_iter().filter(left).collect())
}

/// Test files of a folder, by name; joint files in the folder are ignored.
fn test_paths(path: &Path) -> Outcome<Vec<PathBuf>> {
    let unreadable = |error| Failure::new(format!("cannot read the folder {}: {error}", path.display()));
    let mut paths: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(path).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let is_joint = || input::text(&path, input::LARGEST_TYPED).is_ok_and(|text| !file::is_test_file(&text));
        if path.extension().is_some_and(|extension| extension == "toml") && !is_joint() {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Reads the text of a file and its contents.
fn read(path: &Path) -> Outcome<(String, TestFile)> {
    let name = path.display().to_string();
    let text =
        input::text(path, input::LARGEST_TYPED).map_err(|why| Failure::new(format!("cannot read {name}: {why}")))?;
    read_text(&name, &text).map(|file| (text, file))
}

fn read_text(name: &str, text: &str) -> Outcome<TestFile> {
    file::read(text).map_err(|problems| Failure::from_report(diagnostic::report(name, text, &problems)))
}

fn load_one(path: &Path, plant: PlantName) -> Outcome<Test> {
    let (text, file) = read(path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    checked_test(path.display().to_string(), text, file, folder, plant)
}

/// Test from a text, with a name and folder.
pub fn from_text(name: &str, text: &str, folder: &Path, plant: PlantName) -> Outcome<Test> {
    let file = read_text(name, text)?;
    checked_test(folder.join(name).display().to_string(), text.to_owned(), file, folder, plant)
}

/// Test from the texts of its [`Test::inputs`], without any file.
pub fn from_inputs(name: &str, inputs: &[&str], joint: &str, plant: PlantName) -> Outcome<Test> {
    let mut texts = inputs.iter().map(ToString::to_string);
    let [text, joint_text] = [texts.next().unwrap_or_default(), texts.next().unwrap_or_default()];
    let file = read_text(name, &text)?;
    let joint = named::read_changed(joint.to_owned(), joint_text, &[])?;
    with_joint(name.to_owned(), text, file, joint, texts.next(), plant)
}

/// Reads the files of a test, and checks it before any run.
fn checked_test(name: String, text: String, file: TestFile, folder: &Path, plant: PlantName) -> Outcome<Test> {
    let joint = load_joint(&file.joint, folder).map_err(|failure| failure.while_doing(&name))?;
    let motion = match &file.profile.trajectory {
        Trajectory::File(motion) => Some(RecordedMotion::text(&folder.join(motion))),
        _ => None,
    };
    let motion = motion.transpose().map_err(|failure| failure.while_doing(&name))?;
    with_joint(name, text, file, joint, motion, plant)
}

/// Checks a test with its joint and the text of its recorded motion before any run.
fn with_joint(
    name: String,
    text: String,
    file: TestFile,
    joint: Loaded,
    motion_text: Option<String>,
    plant: PlantName,
) -> Outcome<Test> {
    check_changes(&file, &joint.text)
        .map_err(|problems| Failure::from_report(diagnostic::report(&name, &text, &problems)))?;
    let help = "run it with --plant reference, with --host or --role observer";
    check_broken_tooth(&file.faults, &joint.file.parameters, plant, help)
        .map_err(|failure| failure.while_doing(&name))?;
    let motion = match (&file.profile.trajectory, &motion_text) {
        (Trajectory::File(path), Some(text)) => Some(RecordedMotion::parse(text).map_err(|failure| {
            failure.while_doing(Path::new(&name).with_file_name(path).display()).while_doing(&name)
        })?),
        _ => None,
    };
    if let Some(motion) = motion.as_ref().filter(|_| !file.states_duration) {
        check_length(motion.duration(), "duration_s").map_err(|failure| failure.while_doing(&name))?;
    }
    let file = match (&motion, file.states_duration) {
        // Without a stated duration, a run is as long as the recorded motion.
        (Some(motion), false) => TestFile { duration: motion.duration().max(file.settle + 0.1), ..file },
        _ => file,
    };
    let sha256 = sha256(&text);
    let inputs = [text, joint.text.clone()].into_iter().chain(motion_text).collect();
    let test = Test { name, sha256, file, joint, motion, inputs };
    test.check_design(plant)?;
    Ok(test)
}

/// Loads a joint file, preferably one beside the test file.
fn load_joint(name: &str, folder: &Path) -> Outcome<Loaded> {
    let beside = folder.join(name);
    let loaded = named::load(if beside.is_file() { &beside } else { Path::new(name) })?;
    warnings::print(&loaded);
    Ok(loaded)
}

impl Test {
    /// Case of a seed.
    pub fn case(&self, seed: u64) -> Outcome<Case> {
        Case::new(&self.file, &self.joint.text, seed, self.motion.as_ref()).map_err(|f| f.while_doing(&self.name))
    }

    /// Tries the design, and rejects effects that the plant does not model, before the first run.
    fn check_design(&self, plant: PlantName) -> Outcome<()> {
        let seed = self.file.seeds.first().copied().unwrap_or(1);
        let case = self.case(seed)?;
        reject_effects(plant, &case.truth.surroundings).map_err(|failure| failure.while_doing(&self.name))?;
        if self.file.controller.is_compensation() {
            case.design(&self.file).map_err(|failure| failure.while_doing(&self.name))?;
        }
        Ok(())
    }

    /// Files that the test was read from.
    pub fn files(&self) -> Vec<PathBuf> {
        let test = PathBuf::from(&self.name);
        let motion = match &self.file.profile.trajectory {
            Trajectory::File(name) => Some(test.with_file_name(name)),
            _ => None,
        };
        [test.clone(), test.with_file_name(&self.file.joint), PathBuf::from(&self.file.joint)]
            .into_iter()
            .chain(motion)
            .collect()
    }

    /// SHA-256 of the joint file's text.
    pub fn joint_sha256(&self) -> String {
        sha256(&self.joint.text)
    }

    /// Name of the file without folder and extension, for the names of logs.
    pub fn stem(&self) -> String {
        Path::new(&self.name).file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test(keys: &str, plant: PlantName) -> Outcome<Test> {
        from_text("a.toml", &format!("profile = \"real\"\n[plant]\n{keys}"), Path::new("."), plant)
    }

    #[test]
    fn dependent_keys_in_any_order() {
        let keys = "payload_inertia_share = [0.2, 0.6]\npayload_frequency_Hz = [8, 25]";
        assert!(test(keys, PlantName::Core).is_ok());
        assert!(test("payload_inertia_share = 0.2", PlantName::Core).is_err(), "one alone is refused");
    }

    #[test]
    fn missing_effect_rejected_before_run() {
        assert!(test("control_jitter_ratio = 0.05", PlantName::Reference).is_ok());
        let refused = test("control_jitter_ratio = 0.05", PlantName::Core).err().expect("refused");
        assert!(refused.message().contains("`control_jitter_ratio`"), "{refused}");
    }
}
