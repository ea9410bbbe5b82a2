//! Simulates every joint of a grid, in parallel, resumable and in shards.
//!
//! `axis` and `grid` define the points, `manifest` identifies the sweep, `folder` and `journal` store finished points,
//! `metrics` computes a point, `work` distributes the points, `merge` combines shards; `page` shows the result, with
//! `pictures` of its `table`.

mod axis;
mod folder;
mod grid;
mod journal;
pub(crate) mod manifest;
mod merge;
mod metrics;
mod page;
mod pictures;
mod table;
mod work;

use std::path::{Path, PathBuf};

use folder::SweepFolder;
use grid::{Grid, Shard};
use journal::{Journal, Points};
use manifest::{Manifest, sha256};
pub use merge::merge;
use metrics::Metric;
use work::Work;

use crate::sim::arguments::MotionArguments;
use crate::sim::scheme::{SchemeChoice, SchemeName};
use board::profile::BUILTIN;
use joint_file::named::{self, Loaded};
use joint_file::warnings;
use report::command_line::quoted;
use report::failure::{Failure, Outcome};
use report::input;
use report::interruption::UninterruptedWork;
use report::output;
use report::progress::Progress;

/// Arguments of `joint sweep`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  joint sweep paper --vary mesh.half_backlash_um=0:150:0.5
  joint sweep q1 --vary half_backlash_um=10:80:5 --vary mesh.damping_ratio=0.03,0.05,0.1 --profile reversals
  joint sweep paper --vary half_backlash_um=0:150:0.1 --shard 3/16 --out bifurcation     one job of sixteen
  joint merge bifurcation                                                                 when all are done

Stopped or killed, the same command goes on from where it was. The result is points.csv in the folder, and report.html with its
map: the same bytes whatever the number of threads and shards.

Exit code: 0 if all points are there, 2 for bad input or a bad environment, 130 after Ctrl-C.")]
pub struct Arguments {
    /// Joint file (TOML), or the name of a preset: q1, s1, d2, l1, c1, paper, paper_printed
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Key of the joint file with its values, as from:to:step or as a list with commas; repeated for more axes
    #[arg(long, value_name = "KEY=FROM:TO:STEP", required = true)]
    pub vary: Vec<String>,
    /// Metric to compute at every point; repeated, or a list with commas [default: all]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAME")]
    pub metric: Vec<Metric>,
    /// Integration scheme
    #[arg(long, value_enum, default_value = "realtime")]
    pub scheme: SchemeChoice,
    /// Motion of every point
    #[command(flatten)]
    pub motion: MotionArguments,
    /// Folder of the sweep [default: joint-out/sweep/<joint>-<digest>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Computes only the i-th of n parts of the grid, for job arrays
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    pub shard: Shard,
    /// Number of threads [default: number of processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

/// Runs or continues a sweep, and returns the message with the paths.
pub fn run(arguments: &Arguments, progress: &Progress) -> Outcome<String> {
    let scheme = scheme(arguments.scheme)?;
    arguments.motion.check_for(scheme)?;
    let base = named::load_with(&arguments.file, &arguments.motion.set)?;
    scheme.check_joint(&base.file.parameters)?;
    let grid = Grid::parse(&arguments.vary, Some(&base.text))?;
    warnings::print(&base);
    grid.check_axes(&base)?;
    let metrics = if arguments.metric.is_empty() { all_metrics() } else { arguments.metric.clone() };
    // The joint file already contains the changes of the command line.
    let motion = MotionArguments { set: Vec::new(), ..arguments.motion.clone() };
    let manifest = manifest(&base, &grid, &metrics, scheme, &motion)?;
    let path = arguments.out.clone().unwrap_or_else(|| usual_folder(&manifest));
    let folder = SweepFolder::prepare(&path, &manifest)?;
    // Points in progress are still stored when the user stops the run.
    let _uninterrupted = UninterruptedWork::begin();
    let mut journal = Journal::open(folder.path(), arguments.shard, &manifest.digest)?;
    let mut done = Points::new();
    folder.points(&manifest.digest, &mut done)?;
    let todo: Vec<u64> =
        (0..grid.points).filter(|point| arguments.shard.contains(*point) && !done.contains_key(point)).collect();
    if !done.is_empty() {
        output::remark(&format!("continuing: {} of {} points are in {}", done.len(), grid.points, path.display()));
    }
    progress.run("sweeping", todo.len() as u32);
    let work =
        Work { base: &base, grid: &grid, motion: &motion, scheme, metrics: &metrics, threads: arguments.threads };
    let outcome = work.run(&todo, &mut journal, progress);
    progress.clear();
    let result = outcome?;
    if let Some(remark) = &result.remark {
        output::remark(&format!("{} points were refused; the first: {remark}", result.refused));
    }
    if result.finished < todo.len() {
        let left = todo.len() - result.finished;
        return Err(Failure::interrupted(format!("stopped by the user: {left} of {} points are left", grid.points))
            .with_help(format!(
                "all others are kept in {}; run this command to continue:\n{}",
                path.display(),
                replay_command(arguments, &path)
            )));
    }
    conclude(arguments, &folder, &manifest, &grid)
}

/// Writes the result if all shards are complete; otherwise returns the number of points that are left.
fn conclude(arguments: &Arguments, folder: &SweepFolder, manifest: &Manifest, grid: &Grid) -> Outcome<String> {
    let mut points = Points::new();
    folder.points(&manifest.digest, &mut points)?;
    if points.len() as u64 == grid.points {
        return folder.write_result(manifest, grid, &points);
    }
    Ok(format!(
        "shard {} is done: {} of {} points are in {}\nwhen all shards are: cargo joint merge {}\n",
        arguments.shard,
        points.len(),
        grid.points,
        folder.path().display(),
        quoted(&folder.path().display().to_string())
    ))
}

fn scheme(choice: SchemeChoice) -> Outcome<SchemeName> {
    match choice {
        SchemeChoice::All => Err(Failure::new("a sweep has one scheme")
            .with_help("name one of realtime, paper, reference, rk4, euler; `joint sim --scheme all` compares them")),
        one => Ok(one.shown()),
    }
}

fn all_metrics() -> Vec<Metric> {
    use clap::ValueEnum as _;
    Metric::value_variants().to_vec()
}

fn manifest(
    base: &Loaded,
    grid: &Grid,
    metrics: &[Metric],
    scheme: SchemeName,
    motion: &MotionArguments,
) -> Outcome<Manifest> {
    let profile = motion.profile.as_ref().filter(|name| !BUILTIN.contains(&name.as_str()));
    let profile_sha256 = profile.map(|path| {
        let read = input::bytes(Path::new(path), input::LARGEST_RECORDED).map_err(|why| {
            Failure::new(format!("cannot read the profile {path}: {why}"))
                .with_help(format!("built in: {}; or name a CSV file", BUILTIN.join(", ")))
        });
        read.map(|bytes| sha256(&bytes))
    });
    // The contents of a profile matter, not its path.
    let motion = match profile {
        Some(_) => MotionArguments { profile: Some("file".into()), ..motion.clone() },
        None => motion.clone(),
    };
    let manifest = Manifest {
        schema: String::new(),
        digest: String::new(),
        version: String::new(),
        joint: base.file.parameters.name.to_string(),
        vary: grid.axes.iter().map(axis::Axis::text).collect(),
        points: grid.points,
        metrics: metrics.to_vec(),
        scheme: scheme.name().to_owned(),
        motion: motion.replay(),
        profile_sha256: profile_sha256.transpose()?,
        joint_file: base.text.clone(),
    };
    Ok(manifest.sealed())
}

fn usual_folder(manifest: &Manifest) -> PathBuf {
    report::folder::default_folder("sweep", &format!("{}-{}", manifest.joint, &manifest.digest[..8]))
}

/// Command that continues this sweep.
fn replay_command(arguments: &Arguments, path: &Path) -> String {
    let mut command = format!("cargo joint sweep {}", quoted(&arguments.file.display().to_string()));
    for vary in &arguments.vary {
        command += &format!(" --vary {}", quoted(vary));
    }
    if !arguments.metric.is_empty() {
        let names: Vec<String> = arguments.metric.iter().map(|metric| metric.name()).collect();
        command += &format!(" --metric {}", names.join(","));
    }
    command += &format!(" --scheme {}{}", arguments.scheme.shown().name(), arguments.motion.replay());
    if arguments.shard != Shard::WHOLE {
        command += &format!(" --shard {}", arguments.shard);
    }
    format!("{command} --out {}", quoted(&path.display().to_string()))
}
