//! Simulates every joint of a grid, in tasks that this process, Dask workers or a SLURM array run.
//!
//! `axis` and `grid` define the points, `manifest` identifies the sweep, `points` divides it into tasks and computes them
//! by `metrics`, `folder` holds tasks and result; `page` shows the result, with `pictures` of its `table`.

mod axis;
mod folder;
mod grid;
pub(crate) mod manifest;
mod metrics;
mod page;
mod pictures;
mod points;
mod table;

use std::path::{Path, PathBuf};

use folder::SweepFolder;
use grid::Grid;
use manifest::Manifest;
use metrics::Metric;
use points::Computation;
pub use points::{KIND, compute};

use crate::sim::arguments::MotionArguments;
use crate::sim::scheme::{SchemeChoice, SchemeName};
use board::profile::BUILTIN;
use joint_file::named::{self, Loaded};
use joint_file::warnings;
use report::command_line::{program, quoted};
use report::digest::sha256;
use report::failure::{Failure, Outcome};
use report::input;
use report::interruption::UninterruptedWork;
use report::output;
use report::progress::Progress;
use tasks::{EngineArguments, Execution, Progressed, TaskFolder};

/// Arguments of `joint sweep`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  joint sweep paper --vary mesh.half_backlash_um=0:150:0.5
  joint sweep q1 --vary half_backlash_um=10:80:5 --vary mesh.damping_ratio=0.03,0.05,0.1 --profile reversals
  joint sweep paper --vary half_backlash_um=0:150:0.1 --dask tcp://10.0.0.5:8786     on the workers of a Dask scheduler
  joint sweep paper --vary half_backlash_um=0:150:0.1 --slurm                        a job script for a SLURM array

Stopped or killed, the same command goes on from where it was, with any engine. The result is points.csv in the folder, and
report.html with its map: the same bytes whatever the engine, the number of threads, and the workers lost.

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
    /// Engine of the tasks.
    #[command(flatten)]
    pub engine: EngineArguments,
    /// Removed option of older versions.
    #[arg(long, value_name = "I/N", hide = true)]
    pub shard: Option<String>,
    /// Number of threads [default: number of processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

/// Runs or continues a sweep, and returns the message with the paths.
pub fn run(arguments: &Arguments, progress: &Progress) -> Outcome<String> {
    refuse_shard(arguments)?;
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
    let profile = profile_text(&motion)?;
    let manifest = manifest(&base, &grid, &metrics, scheme, &motion, profile.as_deref())?;
    let path = arguments.out.clone().unwrap_or_else(|| usual_folder(&manifest));
    let folder = SweepFolder::prepare(&path, &manifest)?;
    // Tasks in progress are still stored when the user stops the run.
    let _uninterrupted = UninterruptedWork::begin();
    let tasks = TaskFolder::prepare(&folder.tasks(), points::tasks(&manifest, &motion, profile)?)?;
    let computation = Computation { base: &base, grid: &grid, motion: &motion, scheme, metrics: &metrics };
    let execution = Execution {
        engine: &arguments.engine,
        threads: arguments.threads,
        repeat: repeat_command(arguments, &path),
        compute: &|_, task| computation.task(task),
    };
    if let Progressed::Scripted(message) = tasks.run(&execution, progress)? {
        return Ok(message);
    }
    let points = points::collect(&tasks)?;
    let refused = |result: &String| result.starts_with("refused");
    let count = points.values().filter(|result| refused(result)).count();
    if let Some((point, _)) = points.iter().find(|(_, result)| refused(result)) {
        let why = computation.refusal(*point).unwrap_or_default();
        output::remark(&format!("{count} points were refused; the first: {why}"));
    }
    folder.write_result(&manifest, &grid, &points)
}

/// Refuses the option of versions that divided a sweep into shards with a journal each.
fn refuse_shard(arguments: &Arguments) -> Outcome<()> {
    arguments.shard.as_ref().map_or(Ok(()), |shard| {
        Err(Failure::new(format!("--shard {shard} was removed: a sweep is divided into tasks with a result each"))
            .with_help(
                "give --slurm for a job array or --dask ADDRESS; then the same command without it collects the results",
            ))
    })
}

/// Text of a torque profile from a file.
fn profile_text(motion: &MotionArguments) -> Outcome<Option<String>> {
    let profile = motion.profile.as_ref().filter(|name| !BUILTIN.contains(&name.as_str()));
    let read = profile.map(|path| {
        input::text(Path::new(path), input::LARGEST_RECORDED).map_err(|why| {
            Failure::new(format!("cannot read the profile {path}: {why}"))
                .with_help(format!("built in: {}; or name a CSV file", BUILTIN.join(", ")))
        })
    });
    read.transpose()
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
    profile: Option<&str>,
) -> Outcome<Manifest> {
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
        profile_sha256: profile.map(|text| sha256(text.as_bytes())),
        joint_file: base.text.clone(),
    };
    Ok(manifest.sealed())
}

fn usual_folder(manifest: &Manifest) -> PathBuf {
    report::folder::default_folder("sweep", &format!("{}-{}", manifest.joint, &manifest.digest[..8]))
}

/// Command that continues this sweep in its own process.
fn repeat_command(arguments: &Arguments, path: &Path) -> String {
    let mut command = format!("{} sweep {}", program(), quoted(&arguments.file.display().to_string()));
    for vary in &arguments.vary {
        command += &format!(" --vary {}", quoted(vary));
    }
    if !arguments.metric.is_empty() {
        let names: Vec<String> = arguments.metric.iter().map(|metric| metric.name()).collect();
        command += &format!(" --metric {}", names.join(","));
    }
    command += &format!(" --scheme {}{}", arguments.scheme.shown().name(), arguments.motion.replay());
    format!("{command} --out {}", quoted(&path.display().to_string()))
}
