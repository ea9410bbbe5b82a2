//! Headers and library in MuJoCo's Python package.

use std::path::{Path, PathBuf};
use std::process::Command;

use report::failure::{Failure, Outcome};

/// Program that prints the folder of the package.
const FIND: &str =
    "import importlib.util, pathlib; print(pathlib.Path(importlib.util.find_spec('mujoco').origin).parent)";

/// MuJoCo's Python package.
#[derive(Debug)]
pub struct Package {
    /// Folder of the headers.
    pub include: PathBuf,
    /// The library.
    pub library: PathBuf,
    /// Flags that say what the headers have.
    pub flags: Vec<String>,
}

impl Package {
    /// Package in a folder, or the one that `python3` imports.
    pub fn find(folder: Option<&Path>) -> Outcome<Self> {
        let found = match folder {
            Some(folder) => folder.to_owned(),
            None => imported()?,
        };
        // An absolute path, since the compiler runs in another folder.
        let folder = std::path::absolute(&found).unwrap_or(found);
        let missing = |what: &str| {
            Failure::new(format!("{} has no {what}", folder.display())).with_help(
                "`--mujoco=FOLDER` is the folder `mujoco` of the Python package: python3 -c 'import mujoco; print(mujoco.__path__[0])'",
            )
        };
        let include = folder.join("include");
        let header = std::fs::read_to_string(include.join("mujoco/mjmodel.h"))
            .map_err(|_| missing("include/mujoco/mjmodel.h"))?;
        let entries = std::fs::read_dir(&folder).map_err(|_| missing("libmujoco.so"))?;
        let is_library = |path: &PathBuf| {
            path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.starts_with("libmujoco.so"))
        };
        let mut libraries: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(is_library).collect();
        libraries.sort();
        let library = libraries.pop().ok_or_else(|| missing("libmujoco.so"))?;
        let flags =
            header.contains("actuator_outadr").then(|| "-DACTUATORS_HAVE_OUTPUTS".to_owned()).into_iter().collect();
        Ok(Self { include, library, flags })
    }
}

/// Folder of the package that `python3` imports.
fn imported() -> Outcome<PathBuf> {
    let failure = |what: String| {
        Failure::new(what)
            .with_help("run it in an environment with `pip install mujoco`, or name the package: --mujoco=FOLDER")
    };
    let output = Command::new("python3")
        .args(["-c", FIND])
        .output()
        .map_err(|error| failure(format!("cannot run python3, which finds MuJoCo's headers: {error}")))?;
    match output.status.success() {
        true => Ok(PathBuf::from(String::from_utf8_lossy(&output.stdout).trim())),
        false => {
            Err(failure("python3 has no package mujoco, whose headers the plug-in is compiled against".to_owned()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn failure_of(folder: &Path) -> String {
        format!("{:?}", Package::find(Some(folder)).unwrap_err())
    }

    #[test]
    fn incomplete_package_is_named() {
        let folder = tempfile::tempdir().unwrap();
        assert!(failure_of(folder.path()).contains("include/mujoco/mjmodel.h"));
        std::fs::create_dir_all(folder.path().join("include/mujoco")).unwrap();
        std::fs::write(folder.path().join("include/mujoco/mjmodel.h"), "int* actuator_outadr;").unwrap();
        assert!(failure_of(folder.path()).contains("libmujoco.so"));
        std::fs::write(folder.path().join("libmujoco.so.4.0.0"), "").unwrap();
        let package = Package::find(Some(folder.path())).unwrap();
        assert!(package.library.ends_with("libmujoco.so.4.0.0"));
        assert_eq!(package.flags, ["-DACTUATORS_HAVE_OUTPUTS"]);
    }
}
