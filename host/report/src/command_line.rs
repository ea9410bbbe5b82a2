//! Runs a program of this project: parses its command line with clap and turns its outcome into an exit code. Each
//! program defines its own options.

use std::env;
use std::error::Error;
use std::process::ExitCode;

use clap::{ArgMatches, Command};

use crate::escape::{escaped, is_plain};
use crate::failure::{EXIT_BAD_INPUT, Outcome};
use crate::interruption::InOrder;
use crate::output;

/// Reads the command line by `command`, runs it and turns the outcome into an exit code; a failure is shown.
pub fn main<T>(
    command: Command,
    read: impl Fn(&ArgMatches) -> Result<T, clap::Error>,
    run: impl FnOnce(&T) -> Outcome<()>,
) -> ExitCode {
    let mut command = with_negative_numbers(command);
    let asked = match command.try_get_matches_from_mut(env::args_os()).and_then(|found| read(&found)) {
        Ok(asked) => asked,
        Err(error) => {
            show(&error, &mut command, &read);
            return ExitCode::from(if error.use_stderr() { EXIT_BAD_INPUT } else { 0 });
        }
    };
    let outcome = run(&asked);
    let _in_order = InOrder::begin();
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.show();
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Shows what clap makes of a command line. It styles its own words around arguments that it shows as they are: of arguments
/// that a terminal would obey, the same error is had with escaped ones. A reader that has gone away is no further error.
fn show<T>(error: &clap::Error, command: &mut Command, read: impl Fn(&ArgMatches) -> Result<T, clap::Error>) {
    let arguments: Vec<String> = env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
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
        // Without styles, of which none can be told from those of a file.
        output::remark(error.render().to_string().trim_end());
    }
}

/// As a shell takes it for one word.
pub fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./=:,+@%".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// Has every option take a number below zero as its value: the option's own check then explains why it is refused.
fn with_negative_numbers(command: Command) -> Command {
    let names: Vec<String> = command.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    let command = names.into_iter().fold(command, |command, name| command.mut_subcommand(name, with_negative_numbers));
    command.mut_args(|option| {
        let takes_one = option.get_action().takes_values() && !option.is_positional();
        option.allow_negative_numbers(takes_one)
    })
}
