//! `joint memory`: estimated parameters of a joint as a file, read from a board, shown, or written to a board; and the
//! commands to save or erase the parameters in the board's flash.
//!
//! `arguments` is the command line, `connected_board` connects to the board.

mod arguments;
mod connected_board;

use std::path::Path;

pub use arguments::Arguments;
use arguments::{BoardArguments, Command};
use connected_board::ConnectedBoard;
use identify::memory::Content;
use link::messages::{MemoryOutcome, MemoryState};
use model_core::observer::{MEMORY_BYTES, Memory, MemoryError};

use board::session::Session;
use joint_file::named::{self, Loaded};
use joint_file::warnings;
use report::failure::{Failure, Outcome};
use report::input;
use report::output;
use report::progress::Progress;
use report::write::write_bytes;

/// Command to the board about its flash.
type FlashCommand = fn(&mut Session<'static>) -> Outcome<MemoryOutcome>;

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome<()> {
    Progress::during(|progress| match &arguments.command {
        Command::Show { file, joint, json } => show(file, joint, json.as_deref()),
        Command::Read { file, place } => read(file, place, progress),
        Command::Write { file, place } => write(file, place, progress),
        Command::Keep { place } => {
            change_flash(place, progress, Session::save_memory, "has saved its estimated parameters in its flash")
        }
        Command::Erase { place } => change_flash(place, progress, Session::erase_memory, "has no memory now"),
    })
}

/// Loads a joint file and prints its warnings.
fn load_joint(file: &Path) -> Outcome<Loaded> {
    let loaded = named::load(file)?;
    warnings::print(&loaded);
    Ok(loaded)
}

fn show(file: &Path, joint: &Path, json: Option<&Path>) -> Outcome<()> {
    let (memory, loaded) = (load(file)?, load_joint(joint)?);
    let content = Content::read(&memory, &loaded).map_err(|error| rejection(&file.display().to_string(), error))?;
    let text = content.text(&file.display().to_string(), &loaded);
    output::deliver(&content, &text, json, &[file, joint])
}

fn read(file: &Path, place: &BoardArguments, progress: &Progress) -> Outcome<()> {
    let loaded = load_joint(&place.joint)?;
    let mut found = ConnectedBoard::connect(place, &loaded, progress)?;
    let memory = found.session.stored_memory()?;
    progress.clear();
    if memory.iter().all(|byte| *byte == 0xff) {
        return Err(found.no_memory_error());
    }
    let content = Content::read(&memory, &loaded);
    if let Err(error) = &content
        && *error != MemoryError::OtherJoint
    {
        let what = format!("{} does not use its stored memory", found.name);
        return Err(Failure::new(format!("{what}: {}", message_and_help(*error).0))
            .with_help(format!("erase it: joint memory erase{}", found.options)));
    }
    write_bytes(file, &memory)?;
    let name = file.display().to_string();
    match content {
        Ok(content) => output::print(&content.text(&name, &loaded)),
        Err(_) => output::print(&format!(
            "{name} written; it belongs to a joint or encoders other than {}: show it with its own --joint\n",
            loaded.name
        )),
    }
}

fn write(file: &Path, place: &BoardArguments, progress: &Progress) -> Outcome<()> {
    let (memory, loaded) = (load(file)?, load_joint(&place.joint)?);
    let name = file.display().to_string();
    // A file that is not a memory is rejected before a board is asked.
    match Content::read(&memory, &loaded) {
        Err(error) if error != MemoryError::OtherJoint => return Err(rejection(&name, error)),
        _ => {}
    }
    let mut found = ConnectedBoard::connect(place, &loaded, progress)?;
    if let Some(error) = memory_error(found.session.load_memory(&memory)?) {
        progress.clear();
        let joint = found.hello.joint.clone();
        return Err(rejection(&name, error).while_doing(format_args!("{}, joint {joint}", found.name)));
    }
    let kept = found.session.write_memory()?;
    progress.clear();
    match kept {
        MemoryOutcome::Stored => {
            output::print(&format!("{name} is in the flash of {}: runs can start from it\n", found.name))
        }
        _ if found.is_emulated() => output::print(&format!(
            "{name} is good: the firmware of {} accepts it; it is not stored, since that board has no flash\n",
            found.name
        )),
        outcome => Err(found.write_error(outcome)),
    }
}

/// Changes the flash of a board and prints the result.
fn change_flash(place: &BoardArguments, progress: &Progress, ask: FlashCommand, done: &str) -> Outcome<()> {
    let loaded = load_joint(&place.joint)?;
    let mut found = ConnectedBoard::connect(place, &loaded, progress)?;
    let kept = ask(&mut found.session)?;
    progress.clear();
    match kept {
        MemoryOutcome::Stored => output::print(&format!("{} {done}\n", found.name)),
        outcome => Err(found.write_error(outcome)),
    }
}

/// Help: command that creates a memory file.
const READ_HELP: &str = "read one off a board: joint memory read FILE --port PATH";

/// Reads the bytes of a memory file.
fn load(file: &Path) -> Outcome<Memory> {
    let name = file.display();
    let failed = |why: String| Failure::new(format!("cannot read the memory {name}: {why}")).with_help(READ_HELP);
    let bytes = input::bytes(file, input::LARGEST_TYPED).map_err(failed)?;
    let count = bytes.len();
    bytes.try_into().map_err(|_| {
        Failure::new(format!("{name} is not a memory: it has {count} bytes, and a memory has {MEMORY_BYTES}"))
            .with_help(READ_HELP)
    })
}

/// Error: the memory is rejected.
fn rejection(name: &str, error: MemoryError) -> Failure {
    let (what, help) = message_and_help(error);
    Failure::new(format!("{name}: {what}")).with_help(help)
}

/// Splits an error into message and help.
fn message_and_help(error: MemoryError) -> (String, String) {
    let text = error.to_string();
    let (what, help) = text.split_once(": ").unwrap_or((&text, ""));
    let help = match error {
        MemoryError::NotAMemory => READ_HELP.to_owned(),
        MemoryError::OtherJoint => format!("{help}; the same joint file, backlash included, and the same encoders"),
        _ => help.to_owned(),
    };
    (what.to_owned(), help)
}

/// Error that corresponds to a board's verdict on a memory; `None` for a good memory.
fn memory_error(judged: MemoryState) -> Option<MemoryError> {
    match judged {
        MemoryState::Good => None,
        MemoryState::Nothing | MemoryState::NotAMemory => Some(MemoryError::NotAMemory),
        MemoryState::WrongVersion => Some(MemoryError::WrongVersion),
        MemoryState::Damaged => Some(MemoryError::Damaged),
        MemoryState::OtherJoint => Some(MemoryError::OtherJoint),
        MemoryState::OutOfRange => Some(MemoryError::OutOfRange),
    }
}
