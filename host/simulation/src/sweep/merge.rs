//! Merges the shards of a sweep into one result, once all points are present.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::folder::SweepFolder;
use super::grid::{Grid, Shard};
use super::journal::{self, Points};
use super::manifest::Manifest;
use report::failure::{Failure, Outcome};

/// Largest number of missing points or shards in a message.
const MAX_LISTED: usize = 8;

/// Merges the shards in these folders into `out`, or into the first folder, and returns the message with the paths;
/// fails if a point is missing.
pub fn merge(folders: &[PathBuf], out: Option<&Path>) -> Outcome<String> {
    let mut points = Points::new();
    let mut shards = BTreeSet::new();
    let mut sweep: Option<(PathBuf, Manifest)> = None;
    for path in folders {
        let (folder, manifest) = SweepFolder::existing(path)?;
        if let Some((first, known)) = &sweep
            && let Some(difference) = known.difference(&manifest)
        {
            let (first, path) = (first.display(), path.display());
            return Err(Failure::new(format!("{path} holds another sweep than {first}: {difference}"))
                .with_help("merge only shards of the same joint file, grid, motion, metrics and version"));
        }
        folder.points(&manifest.digest, &mut points)?;
        let names = folder.journals()?;
        let names = names.iter().filter_map(|path| path.file_name()?.to_str().and_then(journal::shard_of));
        shards.extend(names.map(|shard| (shard.count, shard.index)));
        sweep.get_or_insert((path.clone(), manifest));
    }
    let Some((first, manifest)) = sweep else {
        return Err(Failure::new("nothing to merge").with_help("name the folders of a sweep"));
    };
    let grid = manifest.grid()?;
    complete(&grid, &points, &shards)?;
    SweepFolder::prepare(out.unwrap_or(&first), &manifest)?.write_result(&manifest, &grid, &points)
}

/// Checks that every point of the grid is present, and no other.
fn complete(grid: &Grid, points: &Points, shards: &BTreeSet<(u64, u64)>) -> Outcome<()> {
    if let Some(beyond) = points.keys().find(|point| **point >= grid.points) {
        return Err(Failure::new(format!("point {beyond} is beyond the {} points of the grid", grid.points))
            .with_help("a journal has been tampered with: sweep again into a new folder"));
    }
    let missing: Vec<u64> = (0..grid.points).filter(|point| !points.contains_key(point)).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let mut named: Vec<String> = missing.iter().take(MAX_LISTED).map(ToString::to_string).collect();
    if missing.len() > MAX_LISTED {
        named.push("...".into());
    }
    let message = format!("{} of {} points are missing: {}", missing.len(), grid.points, named.join(", "));
    // Missing shards are listed for the largest number of shards in use.
    let count = shards.iter().map(|(count, _)| *count).max().unwrap_or(1);
    let open = (1..=count).filter(|&index| missing.iter().any(|point| Shard { index, count }.contains(*point)));
    let open: Vec<String> = open.take(MAX_LISTED).map(|index| format!("--shard {index}/{count}")).collect();
    let help = format!("run the sweep's command again with {}, or name the folder that has them", open.join(", "));
    Err(Failure::new(message).with_help(help))
}
