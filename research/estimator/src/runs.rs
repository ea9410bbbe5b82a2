//! Recorded runs: the present observer drives the loop, in this process, and what it was shown and said is kept beside the
//! truth, so that a candidate is fed the very same samples.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use model_core::gears::{Flank, sign};
use model_core::observer::design::{design_observer, observer_settings};
use model_core::observer::{Estimates, MotorFault, ObserverTables, OutputFault, Reading, Samples, Source};
use model_core::virtual_joint::fault::{FaultKind, Shaft};
use report::failure::{Failure, Outcome};
use scenario::case::Case;
use scenario::execution::{RunSpec, execute};
use scenario::file::{HostOnlyFault, TestFile};
use scenario::plant::PlantName;
use scenario::suite::{self, Choice, Test};

/// Which encoders an estimator stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stands {
    /// On both.
    Both,
    /// The output encoder is given up.
    MotorOnly,
    /// The motor encoder is given up.
    Nothing,
}

/// What an estimator says in a control period, present or candidate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Said {
    /// Gap coordinate [m].
    pub gap: f64,
    /// Its variance [m^2].
    pub gap_variance: f64,
    /// Whether it may be used.
    pub gap_valid: bool,
    /// -1, 0, 1: the flank that touches.
    pub side: i8,
    /// Half-backlash [m].
    pub width: f64,
    /// Its variance [m^2].
    pub width_variance: f64,
    /// Whether it may be used.
    pub width_valid: bool,
    /// Which encoders it stands on.
    pub stands: Stands,
}

impl Said {
    /// What the present observer said.
    pub fn of(estimates: &Estimates<f32>) -> Self {
        Self {
            gap: estimates.gap.value.into(),
            gap_variance: estimates.gap.variance.into(),
            gap_valid: estimates.gap.valid,
            side: sign::<f32>(Flank::touched(estimates.reported_contact)) as i8,
            width: estimates.half_backlash.value.into(),
            width_variance: estimates.half_backlash.variance.into(),
            width_valid: estimates.half_backlash.valid,
            stands: match estimates.source {
                Source::Both | Source::Nothing(MotorFault::Late) => Stands::Both,
                Source::MotorOnly(OutputFault::Absent) => Stands::Both,
                Source::MotorOnly(_) => Stands::MotorOnly,
                Source::Nothing(_) => Stands::Nothing,
            },
        }
    }
}

/// The truth when a period's samples are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// [s].
    pub time: f64,
    /// Gap coordinate [m].
    pub gap: f64,
    /// Half-backlash [m].
    pub half_backlash: f64,
    /// Force of all sun-planet meshes [N].
    pub force: f64,
    /// [rad/s].
    pub link_speed: f64,
}

/// One control period: what was shown, what was true, what the present observer said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// What both were shown.
    pub samples: Samples<f32>,
    /// What was true then.
    pub truth: Truth,
    /// What the present observer said then.
    pub present: Said,
}

/// When which shaft's encoder, or the torque, is faulty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrong {
    /// What.
    pub what: What,
    /// From when [s].
    pub start: f64,
    /// Until when [s].
    pub end: f64,
    /// Whether an estimator has to give the encoder up for it: noise and small errors it may live with.
    pub must: bool,
}

/// What is faulty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum What {
    /// The motor's encoder.
    Motor,
    /// The output's encoder.
    Output,
    /// Torque, teeth, set-points.
    Other,
}

/// A recorded run.
#[derive(Debug, Clone)]
pub struct Recording {
    /// Stem of the test file.
    pub file: String,
    /// Which seed.
    pub seed: u64,
    /// Tables of the observer that the candidate is designed from, in f64: those of the present one.
    pub tables: ObserverTables<f64>,
    /// Force over rated force is this times the force [1/N].
    pub per_rated: f64,
    /// Figures are taken from here on [s].
    pub settle: f64,
    /// What goes wrong.
    pub wrongs: Vec<Wrong>,
    /// All periods.
    pub steps: Vec<Step>,
}

/// Words of a step in a file.
const WORDS: usize = 18;

/// Reads a test file.
pub fn test(path: &Path) -> Outcome<Test> {
    let suite = suite::load(path, Choice::Full, PlantName::Reference)?;
    suite.tests.into_iter().next().ok_or_else(|| Failure::new(format!("{} holds no test", path.display())))
}

/// The tables of the present observer of a seed.
pub fn present_tables(test: &Test, seed: u64) -> Outcome<ObserverTables<f32>> {
    let case = Case::new(&test.file, &test.joint.text, seed, test.motion.as_ref())?;
    Ok(case.design(&test.file)?.observer)
}

/// Records one seed, or takes what an earlier call has left in `folder`.
pub fn record(test: &Test, stem: &str, seed: u64, folder: &Path) -> Outcome<Recording> {
    let case = Case::new(&test.file, &test.joint.text, seed, test.motion.as_ref())?;
    let mut settings = observer_settings(&case.nominal_surroundings);
    if !test.file.output_encoder {
        settings.output_encoder = None;
    }
    let tables =
        design_observer::<f64>(&case.nominal, &settings).map_err(|error| Failure::new(format!("{stem}: {error}")))?;
    let joint = &case.truth.parameters;
    let lever = model_core::gears::Kinematics::carrier_base_radius(&joint.geometry);
    let kept = folder.join(format!("{stem}-{seed}.run"));
    let steps = match fs::read(&kept) {
        Ok(bytes) => steps_of(&bytes),
        Err(_) => {
            let steps = run(&test.file, &case, seed)?;
            fs::write(&kept, bytes_of(&steps)).map_err(|why| Failure::new(format!("{}: {why}", kept.display())))?;
            steps
        }
    };
    Ok(Recording {
        file: stem.to_owned(),
        seed,
        tables,
        per_rated: 2.0 * lever / joint.rated_output_torque,
        settle: test.file.settle,
        wrongs: wrongs(&test.file),
        steps,
    })
}

fn run(file: &TestFile, case: &Case, seed: u64) -> Outcome<Vec<Step>> {
    let spec = RunSpec { controller: file.controller, plant: PlantName::Reference, without_gap: false };
    let deadline = Instant::now() + Duration::from_secs(3600);
    let history =
        execute(file, case, seed, spec, deadline).map_err(|error| Failure::new(format!("seed {seed}: {error}")))?;
    let truths = history.run.samples.iter().zip(&history.truths).map(|(sample, truth)| Truth {
        time: sample.time,
        gap: truth.gap,
        half_backlash: truth.half_backlash,
        force: sample.mesh_force,
        link_speed: sample.link_speed,
    });
    let start = Truth {
        time: 0.0,
        gap: 0.0,
        half_backlash: case.half_backlash(),
        force: 0.0,
        link_speed: 0.0,
    };
    // A sample is taken at its period's end, which is where the next period's estimates are made.
    let periods = history.controller.iter().zip(std::iter::once(start).chain(truths));
    Ok(periods
        .filter_map(|(period, truth)| {
            let present = Said::of(period.estimates.as_ref()?);
            Some(Step { samples: period.samples, truth, present })
        })
        .collect())
}

/// What a file's faults are for an estimator.
fn wrongs(file: &TestFile) -> Vec<Wrong> {
    let faults = file.faults.iter().map(|fault| {
        let of = |shaft: Shaft| if matches!(shaft, Shaft::Motor) { What::Motor } else { What::Output };
        let (what, must) = match fault.kind {
            FaultKind::Frozen(shaft) | FaultKind::LostReadings(shaft, _) => (of(shaft), true),
            FaultKind::Offset(shaft, _) => (of(shaft), fault.start > 0.0),
            FaultKind::MissingCounts(shaft, _) => (of(shaft), true),
            FaultKind::Noise(shaft, _) | FaultKind::Eccentric(shaft, _) => (of(shaft), false),
            FaultKind::Other(HostOnlyFault::LateReadings(shaft, _)) => (of(shaft), false),
            _ => (What::Other, false),
        };
        Wrong { what, start: fault.start, end: fault.end, must }
    });
    faults.collect()
}

fn bytes_of(steps: &[Step]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(steps.len() * WORDS * 8);
    for Step { samples, truth, present } in steps {
        let output = samples.output.unwrap_or_default();
        let stands = match present.stands {
            Stands::Both => 0.0,
            Stands::MotorOnly => 1.0,
            Stands::Nothing => 2.0,
        };
        let flags = u32::from(present.gap_valid) + 2 * u32::from(present.width_valid);
        let words: [f64; WORDS] = [
            samples.time.into(),
            samples.motor.counts.into(),
            samples.motor.time.into(),
            f64::from(u8::from(samples.output.is_some())),
            output.counts.into(),
            output.time.into(),
            samples.torque.into(),
            truth.time,
            truth.gap,
            truth.half_backlash,
            truth.force,
            truth.link_speed,
            present.gap,
            present.gap_variance,
            f64::from(present.side) + 4.0 * f64::from(flags) + 100.0,
            present.width,
            present.width_variance,
            stands,
        ];
        words.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
    }
    bytes
}

fn steps_of(bytes: &[u8]) -> Vec<Step> {
    let (words, _) = bytes.as_chunks::<8>();
    let numbers: Vec<f64> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
    let (steps, _) = numbers.as_chunks::<WORDS>();
    let step = |w: &[f64; WORDS]| {
        let [time, motor, motor_time, read, output, output_time, torque, rest @ ..] = *w;
        let [at, gap, half_backlash, force, link_speed, said, variance, packed, width, width_variance, stands] = rest;
        let packed = packed as i32 - 100 + 1;
        let (side, flags) = (packed.rem_euclid(4) - 1, packed.div_euclid(4));
        Step {
            samples: Samples {
                time: time as u32,
                motor: Reading { counts: motor as u32, time: motor_time as u32 },
                output: (read > 0.5).then_some(Reading { counts: output as u32, time: output_time as u32 }),
                torque: torque as f32,
            },
            truth: Truth { time: at, gap, half_backlash, force, link_speed },
            present: Said {
                gap: said,
                gap_variance: variance,
                gap_valid: flags & 1 == 1,
                side: side as i8,
                width,
                width_variance,
                width_valid: flags & 2 == 2,
                stands: match stands as u8 {
                    0 => Stands::Both,
                    1 => Stands::MotorOnly,
                    _ => Stands::Nothing,
                },
            },
        }
    };
    steps.iter().map(step).collect()
}
