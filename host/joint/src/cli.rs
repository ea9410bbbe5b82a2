//! The command line: subcommands, their help, exit codes. Each subcommand has its own module.

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use board::device::packages::{self, Install};
use report::failure::Outcome;
use report::{command_line, output};
use tasks::program;

use crate::{
    board as board_files, budget, check, completions, export, flash, hil, identify, image, library, memory, merge, new,
    replay, research, sim, sweep, tables, task, twin,
};

/// Simulates a planetary robot joint with backlash on a microcontroller, drives it and checks it
#[derive(Debug, Parser)]
#[command(name = "joint", version = env!("JOINT_VERSION"), disable_help_subcommand = true)]
struct Cli {
    /// Answer to the question whether apt-get may install missing packages (compiler, emulator, C toolchain) as root
    /// [default: JOINT_INSTALL of the environment, else ask]
    #[arg(long, value_enum, value_name = "DECISION", global = true)]
    install: Option<Install>,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a joint on the emulated board or on a real one, check it and write a report
    Hil(hil::Arguments),
    /// Write a joint file from the numbers of a data sheet
    New(new::Arguments),
    /// Read a joint file and print the derived quantities
    Check(check::Arguments),
    /// Compare the step with other integration methods: error against cost, on the emulated core and on the host
    Bench(research::Arguments),
    /// Predict error, instructions, memory and limits of the fixed step on a board, with a verdict
    Budget(budget::Arguments),
    /// Reproduce the paper, or run its study on another joint: attractors, bifurcation diagram, figures
    Paper(research::Arguments),
    /// Simulate a joint on the host by a named scheme: history, report, comparison of schemes
    Sim(sim::Arguments),
    /// Simulate every joint of a grid in tasks: on all cores, on Dask workers or in a SLURM array
    Sweep(sweep::Arguments),
    /// Run one task of a sweep or of tests, as a worker of a cluster does
    Task(task::Arguments),
    /// Removed command of older versions
    #[command(hide = true)]
    Merge(merge::Arguments),
    /// Put joints behind drives on a bus of this machine, for clients of finished drives: CAN or serial
    Twin(twin::Arguments),
    /// Find backlash, compliance, damping, friction and encoder errors in a recorded reversal test
    Identify(identify::Arguments),
    /// Run the observer over a log: reproduce the run that wrote it, or estimate from any other log
    Replay(replay::Arguments),
    /// Read, show, write or erase the parameters that a board has estimated
    Memory(memory::Arguments),
    /// Check a board file: pins, clock, memory; or list the boards that come with the program
    Board(board_files::Arguments),
    /// Build the firmware image of a joint and print its path
    Image(image::Arguments),
    /// Build the firmware image of a joint and write it to a real board by probe-rs or over USB
    Flash(flash::Arguments),
    /// Write a joint's tables as C source and bytes, for programs that use the C library
    Tables(tables::Arguments),
    /// Package the library for C and C++ in one archive: header, library, build files, costs, test program
    Library(library::Arguments),
    /// Write a joint as a co-simulation unit (FMU) for other simulators: plant, or observer and compensation
    Export(export::Arguments),
    /// Build everything that users are given: wheel, command, C archives, images, book, digests, SBOM
    Release(research::Arguments),
    /// Print a completion script for a shell: bash, zsh, fish and others
    Completions(completions::Arguments),
}

/// Parses the command line, runs the subcommand and turns the outcome into an exit code.
pub fn main() -> ExitCode {
    command_line::main(Cli::command(), Cli::from_arg_matches, run_subcommand)
}

/// Runs a command line that a caller gives, the program's name first; returns the exit code.
pub fn run(arguments: &[OsString]) -> u8 {
    command_line::run_with(arguments, Cli::command(), Cli::from_arg_matches, run_subcommand)
}

fn run_subcommand(cli: &Cli) -> Outcome<()> {
    packages::set_decision(cli.install);
    program::set_version(env!("JOINT_VERSION"));
    match &cli.command {
        None => show_help(),
        Some(Command::Hil(arguments)) => hil::run(arguments),
        Some(Command::New(arguments)) => new::run(arguments),
        Some(Command::Check(arguments)) => check::run(arguments),
        Some(Command::Bench(arguments)) => research::run("benchmark", &arguments.rest),
        Some(Command::Budget(arguments)) => budget::run(arguments),
        Some(Command::Paper(arguments)) => research::run("paper", &arguments.rest),
        Some(Command::Sim(arguments)) => sim::run(arguments),
        Some(Command::Sweep(arguments)) => sweep::run(arguments),
        Some(Command::Task(arguments)) => task::run(arguments),
        Some(Command::Merge(arguments)) => merge::run(arguments),
        Some(Command::Twin(arguments)) => twin::run(arguments),
        Some(Command::Identify(arguments)) => identify::run(arguments),
        Some(Command::Replay(arguments)) => replay::run(arguments),
        Some(Command::Memory(arguments)) => memory::run(arguments),
        Some(Command::Board(arguments)) => board_files::run(arguments),
        Some(Command::Image(arguments)) => image::run(arguments),
        Some(Command::Flash(arguments)) => flash::run(arguments),
        Some(Command::Tables(arguments)) => tables::run(arguments),
        Some(Command::Library(arguments)) => library::run(arguments),
        Some(Command::Export(arguments)) => export::run(arguments),
        Some(Command::Release(arguments)) => research::run("release", &arguments.rest),
        Some(Command::Completions(arguments)) => completions::run(arguments, Cli::command()),
    }
}

fn show_help() -> Outcome<()> {
    output::print(&Cli::command().render_long_help().to_string())
}

#[cfg(test)]
mod tests {
    use clap::error::ErrorKind;
    use clap::{ArgAction, Command};

    use super::*;

    /// Values of which at least one fits each argument.
    const VALUES: [&str; 9] =
        ["odrive-3.6", "1", "q1", "10", "a=1", "1..2", "motor_angle=turns", "127.0.0.1:1", "1=q1"];

    /// Words that give an argument a value which it accepts.
    fn words(command: &Command, id: &str) -> Vec<String> {
        let argument = command.get_arguments().find(|argument| argument.get_id() == id).expect("an argument");
        let option = argument.get_long().map(|long| format!("--{long}"));
        if !matches!(argument.get_action(), ArgAction::Set | ArgAction::Append) {
            return option.into_iter().collect();
        }
        let possible = argument.get_possible_values();
        let accepted = |value: &str| {
            let line = option.iter().map(|option| format!("{option}={value}"));
            let line: Vec<String> = if option.is_some() { line.collect() } else { vec![value.to_owned()] };
            (!matches!(outcome(command, &line), Err(ErrorKind::InvalidValue | ErrorKind::ValueValidation)))
                .then_some(line)
        };
        possible.first().map(|value| value.get_name()).into_iter().chain(VALUES).find_map(accepted).unwrap_or_default()
    }

    fn outcome(command: &Command, words: &[String]) -> Result<(), ErrorKind> {
        let line = std::iter::once(command.get_name().to_owned()).chain(words.iter().cloned());
        command.clone().try_get_matches_from(line).map(|_| ()).map_err(|error| error.kind())
    }

    /// Options that an option needs and that conflict with another one: clap then takes the option without what it needs,
    /// so that it has no effect, unless it conflicts as well.
    fn ignored(command: &Command) -> Vec<String> {
        let all: Vec<Vec<String>> = command
            .get_arguments()
            .map(|argument| words(command, argument.get_id().as_str()))
            .filter(|words| !words.is_empty() && words[0] != "--help")
            .collect();
        let bases = std::iter::once(Vec::new()).chain(all.iter().cloned());
        let Some(base) = bases.into_iter().find(|base| outcome(command, base).is_ok()) else { return Vec::new() };
        let mut found = Vec::new();
        for option in all.iter().filter(|words| words[0].starts_with("--")) {
            let with = |others: &[&Vec<String>]| {
                let words = others
                    .iter()
                    .fold([base.clone(), option.clone()].concat(), |all, other| [all, (*other).clone()].concat());
                outcome(command, &words)
            };
            if with(&[]) != Err(ErrorKind::MissingRequiredArgument) {
                continue;
            }
            let accepted: Vec<&Vec<String>> = all.iter().filter(|other| with(&[other]).is_ok()).collect();
            for (place, one) in accepted.iter().enumerate() {
                for other in &accepted[place + 1..] {
                    let both = [base.clone(), (*one).clone(), (*other).clone()].concat();
                    if outcome(command, &both) == Err(ErrorKind::ArgumentConflict) {
                        found.push(format!("{} {} with {} or {}", command.get_name(), option[0], one[0], other[0]));
                    }
                }
            }
        }
        found
    }

    #[test]
    fn no_option_is_ignored_for_want_of_another() {
        let mut command = Cli::command();
        command.build();
        let mut commands: Vec<Command> = command.get_subcommands().cloned().collect();
        let inner: Vec<Command> = commands.iter().flat_map(|outer| outer.get_subcommands().cloned()).collect();
        commands.extend(inner);
        let found: Vec<String> = commands.iter().flat_map(ignored).collect();
        assert!(found.is_empty(), "{found:#?}");
    }
}
