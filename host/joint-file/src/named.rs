//! Finds a joint file by path or preset, and reads it. `diagnostic` draws its problems.

use std::path::Path;

use crate::{JointFile, PRESETS};

use super::diagnostic;
use report::failure::{Failure, Outcome};
use report::input;

/// Joint file with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// Path, or name of the preset.
    pub name: String,
    /// Text of the file.
    pub text: String,
    /// Content of the file.
    pub file: JointFile,
}

/// Reads a path or a preset; an existing file takes precedence.
pub fn load(file: &Path) -> Outcome<Loaded> {
    load_with(file, &[])
}

/// Reads a path or a preset with values changed, each as `key=value`.
pub fn load_with(file: &Path, changes: &[String]) -> Outcome<Loaded> {
    let (name, text) = text(file)?;
    read_changed(name, text, changes)
}

/// Reads a text under a name, with changed values. The text of the result contains the changes.
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
pub fn text(file: &Path) -> Outcome<(String, String)> {
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
