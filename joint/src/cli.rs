//! The command line: subcommands, their help, exit codes. What a subcommand does is in its own module.

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::failure::{EXIT_BAD_INPUT, Outcome};
use crate::{bench, budget, check, hil, identify, images, memory, output, paper, sim, sweep};

/// Simulates a planetary robot joint with backlash on a microcontroller, drives it and checks it
#[derive(Debug, Parser)]
#[command(name = "joint", version, disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a joint on the emulated board or on a real one, check it and write a report
    Hil(hil::Arguments),
    /// Read a joint file and print what follows from it
    Check(check::Arguments),
    /// Compare the step with what people use: error against cost, on the emulated core and on the host
    Bench(bench::Arguments),
    /// Predict error, instructions, memory and limits of the fixed step on a board, with a verdict
    Budget(budget::Arguments),
    /// Redo the paper, or the same study of another joint: attractors, bifurcation diagram, figures
    Paper(paper::Arguments),
    /// Simulate a joint on the host by a named scheme: history, report, comparison of schemes
    Sim(sim::Arguments),
    /// Simulate every joint of a grid in parallel: resumable, in shards for job arrays
    Sweep(sweep::Arguments),
    /// Put the shards of a sweep together, once none is missing
    Merge(sweep::MergeArguments),
    /// Find backlash, compliance, damping, friction and encoder errors in a recorded reversal test
    Identify(identify::Arguments),
    /// Read what a board has learnt, show it, write it to a board, erase it
    Memory(memory::Arguments),
    /// Build the firmware image of a joint and say where it is
    Image(images::ImageArguments),
    /// Build the firmware image of a joint and write it to a real board by probe-rs
    Flash(images::FlashArguments),
}

/// Parses the command line, runs it and turns the outcome into an exit code.
pub fn main() -> ExitCode {
    let cli =
        match with_negative_numbers(Cli::command()).try_get_matches().and_then(|found| Cli::from_arg_matches(&found)) {
            Ok(cli) => cli,
            Err(error) => {
                // A reader that has gone away is no further error.
                let _ = error.print();
                return ExitCode::from(if error.use_stderr() { EXIT_BAD_INPUT } else { 0 });
            }
        };
    let outcome = match &cli.command {
        None => show_help(),
        Some(Command::Hil(arguments)) => hil::run(arguments),
        Some(Command::Check(arguments)) => check::run(arguments),
        Some(Command::Bench(arguments)) => bench::run(arguments),
        Some(Command::Budget(arguments)) => budget::run(arguments),
        Some(Command::Paper(arguments)) => paper::run(arguments),
        Some(Command::Sim(arguments)) => sim::run(arguments),
        Some(Command::Sweep(arguments)) => sweep::run(arguments),
        Some(Command::Merge(arguments)) => sweep::merge(arguments),
        Some(Command::Identify(arguments)) => identify::run(arguments),
        Some(Command::Memory(arguments)) => memory::run(arguments),
        Some(Command::Image(arguments)) => images::image(arguments),
        Some(Command::Flash(arguments)) => images::flash(arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.show();
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Has every option take a number below zero as its value: that it cannot be is then said by who knows why.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let names: Vec<String> = command.get_subcommands().map(|command| command.get_name().to_owned()).collect();
    let command = names.into_iter().fold(command, |command, name| command.mut_subcommand(name, with_negative_numbers));
    command.mut_args(|option| {
        let takes_one = option.get_action().takes_values() && !option.is_positional();
        option.allow_negative_numbers(takes_one)
    })
}

fn show_help() -> Outcome<()> {
    output::print(&Cli::command().render_long_help().to_string())
}
