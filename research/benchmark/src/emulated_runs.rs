//! Fixed-step methods on the emulated core: jobs as Rust source, built into one image, run, and compared with the digests computed by the
//! host.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use baselines::two_mass::{Contact, TwoMass};
use comparison::case::Case;
use comparison::method::Method;
use comparison::run;
use comparison::start::InitialState;
use comparison::trajectory::Restart;

use board::device::cross_build::cannot_write;
use board::device::toolchain::Toolchain;
use board::device::{Say, measuring};
use report::failure::{Failure, Outcome};

/// Computation of a case with a method at a step rate.
pub struct Job<'a> {
    /// The case.
    pub case: &'a Case,
    /// Restarts of the case.
    pub restarts: &'a [Restart],
    /// The method.
    pub method: Method,
    /// Step rate [Hz].
    pub rate: u32,
    /// Sub-steps of each step.
    pub substeps: u32,
    /// Digest reached by the host; `None` if the motion diverged, since NaNs differ.
    pub digest: Option<u64>,
}

/// Instructions of a job on the emulated core.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InstructionCount {
    /// Mean instructions a step.
    pub mean: f64,
    /// Largest number of instructions of a step.
    pub most: u32,
    /// Largest sum within a sample of 10, 20 and 40 kHz; 0 where steps do not fit.
    pub samples: [u32; 3],
}

/// Largest size of the numbers in one image [bytes], not counting the torques of a case, which its jobs share. The rest
/// of the flash holds code, most of it for five planets.
const IMAGE_DATA_MAX: usize = 250_000;

/// Runs all jobs; results in their order.
pub fn run(jobs: &[Job<'_>], toolchain: &Toolchain, say: Say<'_>) -> Outcome<Vec<InstructionCount>> {
    let mut counts = Vec::with_capacity(jobs.len());
    let mut rest = jobs;
    while !rest.is_empty() {
        // Each image holds as many jobs as fit into the flash.
        let mut size = 0;
        let fitting = rest.iter().take_while(|job| {
            size += bytes(job);
            size <= IMAGE_DATA_MAX
        });
        let (now, later) = rest.split_at(fitting.count().max(1));
        counts.extend(run_image(now, toolchain, say)?);
        rest = later;
    }
    Ok(counts)
}

/// Estimated flash of a job's numbers [bytes].
fn bytes(job: &Job<'_>) -> usize {
    let planets = job.case.joint.geometry.planets;
    let starts = 1 + job.restarts.len();
    match job.method {
        Method::Realtime => 3_000 + 300 * planets + starts * (44 + 8 * planets),
        Method::TwoMassSpring | Method::TwoMassRestitution => 200 + 8 * starts,
        _ => 900 + 200 * planets + starts * (32 + 8 * planets),
    }
}

fn run_image(jobs: &[Job<'_>], toolchain: &Toolchain, say: Say<'_>) -> Outcome<Vec<InstructionCount>> {
    let source = source(jobs)?;
    let file = write(toolchain.target_directory(), &source)?;
    let elf = measuring::build_other(toolchain, "board-comparison", &[("COMPARISON_JOBS", file.as_os_str())], say)?;
    say(&format!("running {} jobs on the emulated core", jobs.len()));
    let lines = measuring::run(&elf)?;
    let mut found: BTreeMap<usize, (InstructionCount, u64)> = lines.iter().filter_map(|line| parse(line)).collect();
    let one = |(index, job): (usize, &Job<'_>)| {
        let what = || format!("case {}, {}, {} Hz x {}", job.case.key, job.method.name(), job.rate, job.substeps);
        let (count, digest) = found
            .remove(&index)
            .ok_or_else(|| Failure::new(format!("{}: no result from the emulated core", what())))?;
        let Some(right) = job.digest.filter(|right| digest != *right) else { return Ok(count) };
        let message = format!("{}: the emulated core came to {digest:016x}, the host to {right:016x}", what());
        Err(Failure::check_failed(message)
            .with_help("host and core must agree bit for bit: the figures would not belong together"))
    };
    jobs.iter().enumerate().map(one).collect()
}

/// Index, count and digest of a line.
fn parse(line: &str) -> Option<(usize, (InstructionCount, u64))> {
    let fields: Vec<&str> = line.split(',').collect();
    let [job, steps, sum, most, slow, middle, fast, digest] = fields[..] else { return None };
    let whole = |field: &str| field.parse::<u32>().ok();
    let count = InstructionCount {
        mean: sum.parse::<f64>().ok()? / f64::from(whole(steps)?).max(1.0),
        most: whole(most)?,
        samples: [whole(slow)?, whole(middle)?, whole(fast)?],
    };
    Some((whole(job)? as usize, (count, u64::from_str_radix(digest, 16).ok()?)))
}

fn write(folder: &Path, source: &str) -> Outcome<PathBuf> {
    let place = folder.join("comparison-jobs.rs");
    let written = fs::create_dir_all(folder).and_then(|()| fs::write(&place, source));
    written.map_err(|error| cannot_write(&place, &error))?;
    place.canonicalize().map_err(|error| Failure::new(format!("{}: {error}", place.display())))
}

/// Source of the jobs for the firmware's `comparison`.
fn source(jobs: &[Job<'_>]) -> Outcome<String> {
    let mut text = String::from(
        "use core::option::Option::*;\n\
         use parameters::DampingLaw::*;\n\
         use model_core::gears::{Relative, RigidBody, State};\n\
         use model_core::gears::tables::{Scheme::*, *};\n\
         use baselines::etd1::Etd1;\nuse baselines::euler::SemiImplicitEuler;\nuse baselines::motion::Coordinates;\nuse baselines::peer::Start;\n\
         use baselines::plant::{Flow as PlantFlow, Gains, Law::*, Mesh, Phase, Plant};\nuse baselines::trapezoid::Trapezoid;\n\
         use baselines::two_mass::{Contact::*, TwoMass};\nuse super::{Change, JobRunner, StepSchedule};\n\n\
         type RungeKutta<const N: usize> = baselines::runge_kutta::RungeKutta4<f32, N>;\n\n",
    );
    let mut calls = String::new();
    let mut torques: Vec<&str> = Vec::new();
    for (index, job) in jobs.iter().enumerate() {
        if !torques.contains(&job.case.key.as_str()) {
            torques.push(&job.case.key);
            text += &lists(torques.len() - 1, job.case);
        }
        let list = torques.iter().position(|key| *key == job.case.key).unwrap_or_default();
        let (steps, rate, tick_rate) = (run::steps(job.case, job.rate), job.rate, job.case.tick_rate);
        let schedule = format!(
            "&StepSchedule {{ steps: {steps}, rate: {rate}, tick_rate: {tick_rate}, torques: &TORQUES_{list}, \
             restarts: &RESTARTS_{list} }}"
        );
        let (statics, call) = match job.case.joint.geometry.planets {
            3 => numbers::<3>(index, job)?,
            4 => numbers::<4>(index, job)?,
            _ => numbers::<5>(index, job)?,
        };
        text += &statics;
        // Writing to a string cannot fail.
        let _ = writeln!(calls, "    {}, {schedule});", call);
    }
    let _ = write!(text, "\npub fn run(runner: &JobRunner) {{\n{calls}}}\n");
    Ok(text)
}

/// Torques and restarts of a case.
fn lists(index: usize, case: &Case) -> String {
    let mut text = format!("static TORQUES_{index}: [Change; {}] = [\n", case.torques.len());
    for segment in &case.torques {
        let (tick, drive, load) = (segment.from_tick, segment.drive_torque as f32, segment.load_torque as f32);
        let _ = writeln!(text, "    Change {{ tick: {tick}, drive: {drive:?}, load: {load:?} }},");
    }
    let (count, ticks) = (case.restarts.len(), &case.restarts);
    text + &format!("];\nstatic RESTARTS_{index}: [u32; {count}] = {ticks:?};\n")
}

/// Statics of a job, and its call without the schedule.
fn numbers<const N: usize>(index: usize, job: &Job<'_>) -> Outcome<(String, String)> {
    let joint = &job.case.joint;
    let starts = InitialState::<N>::all(joint, &job.case.start, job.restarts);
    let count = starts.len();
    let peer = |scheme: &str| {
        let plant = run::plant::<f32, N>(joint, job.method, job.rate);
        let starts: Vec<_> = starts.iter().map(|start| start.peer::<f32>(joint, f64::from(job.rate))).collect();
        // The core's tables have a type `Flow` too.
        let plant = format!("{plant:?}").replace("Flow {", "PlantFlow {");
        (
            format!(
                "static PLANT_{index}: Plant<f32, {N}> = {plant};\n\
                 static STARTS_{index}: [Start<f32, {N}>; {count}] = {starts:?};\n"
            ),
            format!("runner.peer::<{N}, {scheme}>({index}, &PLANT_{index}, &STARTS_{index}"),
        )
    };
    let two_mass = |contact: Contact| {
        let model = TwoMass::<f32>::new(joint, f64::from(job.rate), contact);
        let start = |start: &InitialState<N>| {
            let (place, speed) = start.two_mass(joint);
            [place as f32, speed as f32]
        };
        let starts: Vec<[f32; 2]> = starts.iter().map(start).collect();
        (
            format!(
                "static MODEL_{index}: TwoMass<f32> = {model:?};\n\
                 static STARTS_{index}: [[f32; 2]; {count}] = {starts:?};\n"
            ),
            format!("runner.two_mass({index}, &MODEL_{index}, &STARTS_{index}"),
        )
    };
    Ok(match job.method {
        Method::Realtime => {
            let tables = run::tables::<f32, N>(joint, job.rate, job.substeps)
                .map_err(|error| Failure::new(format!("case {}: {error}", job.case.key)))?;
            let states: Vec<_> = starts.iter().map(|start| start.state(joint, &tables)).collect();
            (
                format!(
                    "static TABLES_{index}: Tables<f32, {N}> = {tables:?};\n\
                     static STATES_{index}: [State<f32, {N}>; {count}] = {states:?};\n"
                ),
                format!("runner.core::<{N}>({index}, &TABLES_{index}, &STATES_{index}"),
            )
        }
        Method::RungeKutta4 | Method::RungeKutta4Tanh => peer(&format!("RungeKutta<{N}>")),
        Method::PaperEtd1 => peer("Etd1<f32>"),
        Method::Euler => peer("SemiImplicitEuler"),
        Method::Trapezoid => peer(&format!("Trapezoid<f32, {N}>")),
        Method::TwoMassSpring => two_mass(Contact::SpringDamper),
        Method::TwoMassRestitution => two_mass(Contact::Restitution),
    })
}
