//! `joint completions`: prints a shell's completion script for the command line.

use clap::Command;
use clap_complete::{Shell, generate};

use report::failure::Outcome;
use report::output;

/// Arguments of `joint completions`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  joint completions bash > ~/.local/share/bash-completion/completions/joint
  joint completions zsh > ~/.zfunc/_joint               with fpath+=~/.zfunc before compinit in ~/.zshrc
  joint completions fish > ~/.config/fish/completions/joint.fish")]
pub struct Arguments {
    /// Shell that the script is for
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

/// Prints the completion script of a command line.
pub fn run(arguments: &Arguments, mut command: Command) -> Outcome<()> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut command, "joint", &mut script);
    output::print(&String::from_utf8_lossy(&script))
}
