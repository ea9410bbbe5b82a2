//! The joint that a run is about: a file or a preset, read once. What follows from it is `joint check`'s business.

use std::path::{Path, PathBuf};

use joints::JointFile;

use crate::failure::{Failure, Outcome};

/// A joint file in use.
#[derive(Debug, Clone)]
pub struct Source {
    /// As the user named it.
    pub name: String,
    /// The file, unless it is a preset.
    pub path: Option<PathBuf>,
    /// What it says.
    pub file: JointFile,
}

impl Source {
    /// Reads a file, or a preset by its name.
    pub fn load(file: &Path) -> Outcome<Self> {
        let name = file.display().to_string();
        let preset = joints::preset(&name).filter(|_| !file.exists());
        let (text, path) = match preset {
            Some(text) => (text.to_owned(), None),
            None => (read(file)?, Some(file.to_owned())),
        };
        let file = joints::read(&text).map_err(|problems| {
            let all = problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
            Failure::new(format!("{name}: {all}"))
        })?;
        Ok(Self { name, path, file })
    }
}

fn read(file: &Path) -> Outcome<String> {
    std::fs::read_to_string(file).map_err(|error| {
        Failure::new(format!("cannot read the joint file {}: {error}", file.display()))
            .with_help(format!("name a TOML file, or one of the presets {}", joints::PRESETS.join(", ")))
    })
}
