//! Runs a program of this project: parses its command line with clap and turns its outcome into an exit code. Each
//! program defines its own options.

use std::process::ExitCode;

use clap::{ArgMatches, Command};

use crate::failure::{EXIT_BAD_INPUT, Outcome};
use crate::interruption::InOrder;

/// Reads the command line by `command`, runs it and turns the outcome into an exit code; a failure is shown.
pub fn main<T>(
    command: Command,
    read: impl FnOnce(&ArgMatches) -> Result<T, clap::Error>,
    run: impl FnOnce(&T) -> Outcome<()>,
) -> ExitCode {
    let asked = match with_negative_numbers(command).try_get_matches().and_then(|found| read(&found)) {
        Ok(asked) => asked,
        Err(error) => {
            // A reader that has gone away is no further error.
            let _ = error.print();
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
