//! Finds a joint file, by path or as a preset, and reads it. What is wrong with it is drawn by `diagnostic`.

use std::path::Path;

use crate::{JointFile, PRESETS};

use super::diagnostic;
use report::failure::{Failure, Outcome};
use report::input;

/// A joint file and where it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// Its path, or the name of the preset.
    pub name: String,
    /// Its text.
    pub text: String,
    /// What it says.
    pub file: JointFile,
}

/// Reads a path or a preset. A file of that name goes before a preset.
pub fn load(file: &Path) -> Outcome<Loaded> {
    load_with(file, &[])
}

/// Reads a path or a preset with values changed, each as `key=value`.
pub fn load_with(file: &Path, changes: &[String]) -> Outcome<Loaded> {
    let (name, text) = text(file)?;
    read_changed(name, text, changes)
}

/// Reads a text that was found under a name, with values changed. The text of the result has the changes.
pub fn read_changed(name: String, mut text: String, changes: &[String]) -> Outcome<Loaded> {
    for assignment in changes {
        let Some((key, value)) = assignment.split_once('=') else {
            return Err(Failure::new(format!("`{assignment}` sets nothing")).with_help(
                "write key=value, such as sun_planet.half_backlash_um=60; an empty value leaves a key out",
            ));
        };
        text = crate::change(&text, key, value)
            .map_err(|refused| Failure::new(format!("{assignment}: {}", refused.message)).with_help(refused.help))?;
    }
    match crate::read(&text) {
        Ok(file) => Ok(Loaded { name, text, file }),
        Err(problems) => {
            let changed = changes.iter().map(|change| format!(" with {change}")).collect::<String>();
            Err(Failure::from_report(diagnostic::report(&(name + &changed), &text, &problems)))
        }
    }
}

/// Name and text of a path or a preset.
fn text(file: &Path) -> Outcome<(String, String)> {
    let name = file.display().to_string();
    let text = match input::preset(file, crate::preset) {
        Some(text) => text.to_owned(),
        None => read(file)?,
    };
    Ok((name, text))
}

fn read(file: &Path) -> Outcome<String> {
    input::text(file, input::LARGEST_TYPED).map_err(|why| {
        let help = format!("give the path of a joint file, or one of the presets {}", PRESETS.join(", "));
        Failure::new(format!("cannot read the joint file {}: {why}", file.display())).with_help(help)
    })
}
