//! Runs a program of this project: parses its command line with clap and turns its outcome into an exit code. Each
//! program defines its own options.

use std::env;
use std::error::Error;
use std::ffi::OsString;
use std::process::ExitCode;

use clap::{ArgMatches, Command};

use crate::escape::{escaped, is_plain};
use crate::failure::{EXIT_BAD_INPUT, Outcome};
use crate::interruption::UninterruptedWork;
use crate::output;
use crate::workspace::has_sources;

/// Parses the command line of this process by `command`, runs the program and turns the outcome into an exit code;
/// prints a failure.
pub fn main<T>(
    command: Command,
    read: impl Fn(&ArgMatches) -> Result<T, clap::Error>,
    run: impl FnOnce(&T) -> Outcome<()>,
) -> ExitCode {
    ExitCode::from(run_with(&env::args_os().collect::<Vec<_>>(), command, read, run))
}

/// Runs a program as [`main`] does, with the command line of a caller; the first argument is the program's name. Returns
/// the exit code.
pub fn run_with<T>(
    arguments: &[OsString],
    command: Command,
    read: impl Fn(&ArgMatches) -> Result<T, clap::Error>,
    run: impl FnOnce(&T) -> Outcome<()>,
) -> u8 {
    let mut command = with_negative_numbers(command);
    let asked = match command.try_get_matches_from_mut(arguments).and_then(|found| read(&found)) {
        Ok(asked) => asked,
        Err(error) => {
            show(&error, arguments, &mut command, &read);
            return if error.use_stderr() { EXIT_BAD_INPUT } else { 0 };
        }
    };
    let outcome = run(&asked);
    let _uninterrupted = UninterruptedWork::begin();
    match outcome {
        Ok(()) => 0,
        Err(failure) => {
            failure.show();
            failure.exit_code()
        }
    }
}

/// Prints a clap error. clap styles its own words but prints arguments verbatim: for arguments with control characters,
/// the error is created again from escaped arguments. A closed pipe is ignored.
fn show<T>(
    error: &clap::Error,
    arguments: &[OsString],
    command: &mut Command,
    read: impl Fn(&ArgMatches) -> Result<T, clap::Error>,
) {
    let arguments: Vec<String> = arguments.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    let all_plain = arguments.iter().all(|word| is_plain(word));
    let again = (!all_plain).then(|| {
        let escaped = arguments.iter().map(|word| escaped(word).into_owned());
        command.try_get_matches_from_mut(escaped).and_then(|found| read(&found)).err()
    });
    let again = again.flatten();
    let has_plain_arguments = all_plain || again.is_some();
    let error = again.as_ref().unwrap_or(error);
    let is_plain_error = error.source().is_none_or(|source| is_plain(&source.to_string()));
    if has_plain_arguments && is_plain_error {
        let _ = error.print();
    } else {
        // Without styles, which could not be distinguished from those in a file.
        output::remark(error.render().to_string().trim_end());
    }
}

/// Words that start this command: `cargo joint` in the workspace, `joint` of an installed program.
pub fn program() -> &'static str {
    if has_sources() { "cargo joint" } else { "joint" }
}

/// Quotes a word for a shell.
pub fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./=:,+@%".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// Lets every option take a negative number as its value, so that the option's own check explains the error.
fn with_negative_numbers(command: Command) -> Command {
    let names: Vec<String> = command.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    let command = names.into_iter().fold(command, |command, name| command.mut_subcommand(name, with_negative_numbers));
    command.mut_args(|option| {
        let takes_one = option.get_action().takes_values() && !option.is_positional();
        option.allow_negative_numbers(takes_one)
    })
}
