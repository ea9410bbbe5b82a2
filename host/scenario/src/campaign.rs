//! Runs one test: every seed and every controller, on all cores, and puts together what came of them. Order of
//! completion never shows in the results.

use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::controller::ControllerName;
use super::execution::{Order, execute};
use super::file::fault_word;
use super::log_file;
use super::on_board::Boards;
use super::plant::PlantName;
use super::record::{TestRecord, TestRun};
use super::rig::RunError;
use super::suite::Test;
use super::trace::Trace;
use super::values::Values;
use super::verdict::{Results, judge};
use report::failure::{Failure, Outcome};

/// How tests are run.
pub struct Conduct<'c> {
    /// What is controlled.
    pub plant: PlantName,
    /// One seed in place of the file's.
    pub seed: Option<u64>,
    /// The full lists of seeds.
    pub full: bool,
    /// The boards that the tested controller runs on, if it does not run here.
    pub boards: Option<&'c Boards<'c>>,
    /// Where logs go.
    pub logs: &'c Path,
    /// Told after every run how many are done.
    pub done: &'c (dyn Fn(u32) + Sync),
}

/// A test with what its pictures need.
pub struct Tested {
    /// Everything that is written.
    pub record: TestRecord,
    /// The shown seed's runs, in the order of the record's controllers.
    pub shown: Vec<(ControllerName, Trace)>,
    /// Faults by their words, with the times at which they begin and end [s].
    pub faults: Vec<(&'static str, [f64; 2])>,
}

struct Job {
    seed: u64,
    controller: ControllerName,
}

struct Done {
    values: Option<Values>,
    run: TestRun,
    trace: Trace,
}

impl Test {
    /// Seeds of a run.
    pub fn seeds(&self, seed: Option<u64>, full: bool) -> Vec<u64> {
        match (seed, full) {
            (Some(seed), _) => vec![seed],
            (None, true) => self.file.full_seeds.clone(),
            (None, false) => self.file.seeds.clone(),
        }
    }

    /// Controllers, the tested one first.
    pub fn controllers(&self) -> Vec<ControllerName> {
        std::iter::once(self.file.controller).chain(self.file.rivals.iter().copied()).collect()
    }
}

/// Runs a test.
pub fn run(test: &Test, conduct: &Conduct<'_>, before: &AtomicU32) -> Outcome<Tested> {
    let start = Instant::now();
    let deadline = start + Duration::from_secs_f64(test.file.timeout);
    let seeds = test.seeds(conduct.seed, conduct.full);
    let controllers = test.controllers();
    let jobs: Vec<Job> = seeds
        .iter()
        .flat_map(|seed| controllers.iter().map(|controller| Job { seed: *seed, controller: *controller }))
        .collect();
    let done: Vec<Outcome<Done>> = jobs
        .par_iter()
        .map(|job| {
            let done = one(test, conduct, job, deadline);
            (conduct.done)(before.fetch_add(1, Ordering::Relaxed) + 1);
            done
        })
        .collect();
    let done: Vec<Done> = done.into_iter().collect::<Outcome<_>>()?;
    let of = |seed: u64, controller: ControllerName| {
        let place = jobs.iter().position(|job| job.seed == seed && job.controller == controller)?;
        done[place].values.clone()
    };
    let assertions = judge(&test.file, &Results { seeds: &seeds, of: &of });
    // What the tested controller broke off for is the test's own failure; a rival that breaks only costs its figures.
    let own = |(job, done): (&Job, &Done)| {
        let why = done.run.broken.as_ref().filter(|_| job.controller == test.file.controller)?;
        Some(format!("seed {}: {why}", job.seed))
    };
    let broken = jobs.iter().zip(&done).find_map(own);
    let failed = assertions.iter().find(|assertion| assertion.verdict == report::checks::Verdict::Failed);
    let shown_seed = failed.and_then(|failed| failed.seed).or(seeds.first().copied()).unwrap_or_default();
    let passed = failed.is_none() && broken.is_none();
    let mut runs = Vec::new();
    let mut shown = Vec::new();
    for (job, done) in jobs.iter().zip(done) {
        if job.seed == shown_seed {
            shown.push((job.controller, done.trace));
        }
        runs.push(done.run);
    }
    let record = TestRecord {
        file: test.name.clone(),
        file_sha256: test.sha256.clone(),
        title: test.file.title.clone(),
        joint: test.joint.file.parameters.name.to_string(),
        joint_sha256: test.joint_sha256(),
        on: conduct.boards.map_or("host".to_owned(), Boards::label),
        plant: conduct.plant.word().to_owned(),
        profile: test.file.profile.kind.to_owned(),
        controller: test.file.controller.word().to_owned(),
        duration_s: test.file.duration,
        settle_s: test.file.settle,
        faults: test.file.faults.iter().map(|fault| fault_word(fault).to_owned()).collect(),
        seeds,
        passed,
        broken,
        assertions,
        runs,
        shown_seed,
        replay: format!(
            "cargo joint hil {} {} --plant {} --seed {shown_seed}",
            test.name,
            conduct.boards.map_or("--host".to_owned(), Boards::arguments),
            conduct.plant.word()
        ),
        seconds: start.elapsed().as_secs_f64(),
    };
    let faults = test.file.faults.iter().map(|fault| (fault_word(fault), [fault.start, fault.end])).collect();
    Ok(Tested { record, shown, faults })
}

fn one(test: &Test, conduct: &Conduct<'_>, job: &Job, deadline: Instant) -> Outcome<Done> {
    let mut case = test.case(job.seed)?;
    if let Some(boards) = conduct.boards {
        boards.tell(&mut case)?;
    }
    let order = Order { controller: job.controller, plant: conduct.plant, without_gap: false };
    let mut run = TestRun { seed: job.seed, controller: job.controller.word().to_owned(), ..TestRun::default() };
    let ran = match conduct.boards.filter(|_| job.controller == test.file.controller) {
        None => execute(&test.file, &case, job.seed, order, deadline),
        Some(boards) => boards.run(test, &case, job.seed, order).map(|(ran, board)| {
            run.board = Some(board);
            ran
        }),
    };
    let both = ran.and_then(|ran| {
        let wanted = test.file.gains.is_some() && job.controller.wants_gains();
        let other = Order { controller: job.controller.without_gap(), without_gap: true, ..order };
        let without_gap = wanted.then(|| execute(&test.file, &case, job.seed, other, deadline)).transpose()?;
        Ok((ran, without_gap))
    });
    match both {
        Ok((ran, without_gap)) => {
            let values = Values::of(&test.file, &case, &ran, without_gap.as_ref());
            run.refusal = ran.refusal().map(|refusal| refusal.to_string());
            run.digest = format!("{:016x}", ran.digest);
            run.figures = values.named().map(|(figure, value)| (figure.name(), value)).collect();
            let name = format!("{}-seed{}-{}.mcap", test.stem(), job.seed, run.controller);
            let remarks = [
                ("test", test.name.clone()),
                ("joint", case.told.name.to_string()),
                ("seed", job.seed.to_string()),
                ("controller", run.controller.clone()),
                ("plant", conduct.plant.word().to_owned()),
                ("digest", run.digest.clone()),
            ];
            let remarks = remarks.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
            log_file::write(&conduct.logs.join(&name), &ran, remarks)?;
            run.log = Some(format!("runs/{name}"));
            Ok(Done { values: Some(values), run, trace: Trace::of(&ran) })
        }
        Err(RunError::Refused(failure)) => Err(failure.while_doing(&test.name)),
        Err(RunError::Interrupted) => Err(Failure::interrupted("stopped by the user")),
        Err(error) => {
            run.broken = Some(error.to_string());
            Ok(Done { values: None, run, trace: Trace::default() })
        }
    }
}
