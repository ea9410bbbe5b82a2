//! Folder of a sweep: `sweep.json`, its tasks, and `points.csv` with its page once all points are finished. A folder
//! with foreign files is rejected before any file is written.

use std::fs;
use std::path::{Path, PathBuf};

use super::grid::Grid;
use super::manifest::Manifest;
use super::page;
use super::points::Points;
use report::document::html;
use report::failure::{Failure, Outcome};
use report::folder::{self, Folder};
use report::write::write_text;

/// Manifest.
pub const MANIFEST: &str = "sweep.json";
/// Result.
pub const RESULT: &str = "points.csv";
/// Result as a page.
pub const REPORT: &str = "report.html";
/// Folder of the tasks.
pub const TASKS: &str = "tasks";
/// First letters of the journals of versions before tasks.
const JOURNAL: &str = "journal-";
/// Largest number of foreign files in a message.
const MAX_LISTED_FILES: usize = 3;

/// A sweep's folder.
#[derive(Debug)]
pub struct SweepFolder {
    folder: Folder,
}

impl SweepFolder {
    /// Creates or opens the folder of a sweep; rejects the folder of another sweep, and any folder with other files.
    pub fn prepare(path: &Path, manifest: &Manifest) -> Outcome<Self> {
        folder::make(path)?;
        // Foreign files are reported before another sweep: a sweep needs a folder of its own.
        let foreign = foreign_files(path)?;
        // Checked after the listing, since this file is always created before a task.
        let has_manifest = path.join(MANIFEST).exists();
        if !foreign.is_empty() {
            return Err(foreign_files_error(path, &foreign, has_manifest));
        }
        if has_manifest {
            let other = Manifest::read(&path.join(MANIFEST))?;
            if let Some(difference) = manifest.difference(&other) {
                let message = format!("{} holds another sweep: {difference}", path.display());
                return Err(Failure::new(message).with_help(
                    "name another folder by --out DIR, or repeat the command of that sweep to go on with it",
                ));
            }
        }
        let folder = Folder::prepare_beside_others(path, "sweep", &manifest.joint, &[RESULT, REPORT])?;
        if !has_manifest {
            write_text(&path.join(MANIFEST), &manifest.text()?)?;
        }
        Ok(Self { folder })
    }

    /// Path of the folder of the tasks.
    pub fn tasks(&self) -> PathBuf {
        self.folder.file(TASKS)
    }

    /// Writes all points in order, and returns a message with the paths.
    pub fn write_result(&self, manifest: &Manifest, grid: &Grid, points: &Points) -> Outcome<String> {
        self.folder.write_text(RESULT, &result(manifest, grid, points))?;
        self.folder.write_text(REPORT, &html(&page::document(manifest, grid, points)))?;
        let [result, report] = [RESULT, REPORT].map(|name| self.folder.file(name));
        Ok(format!("{} points: {}\nreport: {}\n", grid.points, result.display(), report.display()))
    }
}

/// Result as text: one row for each point.
fn result(manifest: &Manifest, grid: &Grid, points: &Points) -> String {
    let keys = grid.axes.iter().map(|axis| axis.key.clone());
    let metrics = manifest.metrics.iter().map(|metric| metric.name());
    let columns: Vec<String> = keys.chain(["status".to_owned()]).chain(metrics).collect();
    let mut text = columns.join(",") + "\n";
    for (point, result) in points {
        text += &grid.values(*point).join(",");
        text += ",";
        text += result;
        text += "\n";
    }
    text
}

/// Names in a folder, without hidden ones.
fn entries(path: &Path) -> Outcome<Vec<String>> {
    let failed = |error: std::io::Error| {
        Failure::new(format!("cannot read the folder {}: {error}", path.display()))
            .with_help("see that it is a folder and may be read")
    };
    let mut names = Vec::new();
    for entry in fs::read_dir(path).map_err(failed)? {
        let name = entry.map_err(failed)?.file_name().to_string_lossy().into_owned();
        if !name.starts_with('.') {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

/// Names of files that no sweep has written.
fn foreign_files(path: &Path) -> Outcome<Vec<String>> {
    let own = |name: &String| {
        let file = [MANIFEST, RESULT, REPORT].contains(&name.as_str()) && path.join(name).is_file();
        file || (name == TASKS && path.join(name).is_dir())
    };
    let mut names = entries(path)?;
    let swept = names.iter().any(|name| name == MANIFEST) || path.join(MANIFEST).exists();
    // Without the manifest, even a file with a known name may be the user's own.
    names.retain(|name| !(swept && own(name)));
    Ok(names)
}

fn foreign_files_error(path: &Path, foreign: &[String], swept: bool) -> Failure {
    let more = foreign.len().saturating_sub(MAX_LISTED_FILES);
    let mut named = foreign[..foreign.len().min(MAX_LISTED_FILES)].join(", ");
    if more > 0 {
        named += &format!(" and {more} more");
    }
    if swept && foreign.iter().all(|name| name.starts_with(JOURNAL)) {
        let message =
            format!("{} holds journals of an older version, which this one does not read: {named}", path.display());
        return Failure::new(message).with_help(
            "its points.csv stays valid; to sweep again, name another folder by --out DIR or remove the journals",
        );
    }
    let message = match swept {
        true => format!("{} holds files beside its sweep: {named}", path.display()),
        false => format!("{} holds files that are not a sweep's: {named}", path.display()),
    };
    Failure::new(message).with_help("move them elsewhere, or name another folder by --out DIR; nothing was written")
}
