//! Computes everything that a plan asks for, in parallel over joints and half-backlashes; results do not depend on the
//! number of threads. Judging and drawing are left to others.

use model_core::gears::{Mechanics, Scales};
use parameters::DampingLaw;
use rayon::prelude::*;

use super::pictures::micrometres;
use super::plan::{Plan, Subject, SweepStart};
use super::record::{AttractorRecord, ClassRecord, History, Reading, SpectrumRecord, Sweep, SweepPoint};
use super::{windows, witness};
use crate::numerics::attractor::{self, Class, Effort};
use crate::numerics::motion::Motion;
use crate::numerics::signal::{SAMPLES, Signal};
use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;
use report::spectrum::{Mean, Window, amplitudes};

/// For attractors of the table: exponents of chaos come to about 0.0012 (one standard deviation).
const TABLE: Effort = Effort { transient: 300, patience: 1000, alignment: 60, points: 1000, chaotic_periods: 12_000 };

/// For points of a diagram.
const DIAGRAM: Effort = Effort { transient: 200, patience: 600, alignment: 40, points: 200, chaotic_periods: 400 };

/// Poincare points of an attractor without a period that are kept, and among which distinct ones are counted.
const KEPT_POINTS: usize = 300;

/// Periods of the signal of an attractor without a period.
const LONG_SIGNAL: u32 = 512;

/// Periods of the signal of a periodic one, at least, and a whole number of its cycles.
const SHORT_SIGNAL: u32 = 48;

/// Periods of history that are kept.
const HISTORY: usize = 36;

/// Of the samples of the history one in so many is kept.
const THINNED: usize = 2;

/// Spectra are kept up to this multiple of the mesh frequency.
const HIGHEST_LINE: f64 = 6.0;

/// An attractor is so much more work than a point of a diagram, for the progress bar.
const ATTRACTOR_WORK: u64 = 20;

/// One piece of work.
enum Job<'a> {
    Attractor(&'a Subject, f64),
    FromRest(&'a Subject, f64),
    Carried(&'a Subject, SweepStart),
}

/// What came of it.
enum Done {
    Attractor(Box<AttractorRecord>),
    Points(Vec<SweepPoint>),
}

/// Everything, for every joint of the plan.
pub fn run(plan: &Plan, progress: &Progress) -> Outcome<Vec<Reading>> {
    let mut jobs = Vec::new();
    for subject in &plan.subjects {
        jobs.extend(plan.values.iter().map(|b| Job::Attractor(subject, *b)));
        for start in &plan.starts {
            match start {
                SweepStart::Rest => jobs.extend(plan.grid.iter().map(|b| Job::FromRest(subject, *b))),
                carried => jobs.push(Job::Carried(subject, *carried)),
            }
        }
    }
    let points = plan.subjects.len() * plan.grid.len() * plan.starts.len();
    let attractors = (plan.subjects.len() * plan.values.len()) as u64;
    progress.run("computing", points as u64 + ATTRACTOR_WORK * attractors);
    // Chains of points cannot be split: whoever is free takes them first.
    let order = |job: &Job<'_>| if matches!(job, Job::Carried(..)) { 0 } else { 1 };
    let mut ordered: Vec<usize> = (0..jobs.len()).collect();
    ordered.sort_by_key(|index| order(&jobs[*index]));
    let mut done: Vec<(usize, Done)> = ordered
        .into_par_iter()
        .with_max_len(1)
        .map(|index| Ok((index, perform(&jobs[index], plan, progress)?)))
        .collect::<Outcome<_>>()?;
    done.sort_by_key(|(index, _)| *index);
    let mut results = done.into_iter().map(|(_, result)| result);
    Ok(plan.subjects.iter().map(|subject| reading(subject, plan, &mut results)).collect())
}

/// Collects the results of one joint, which come in the order of its jobs.
fn reading(subject: &Subject, plan: &Plan, results: &mut impl Iterator<Item = Done>) -> Reading {
    let parameters = &subject.parameters;
    let scales = Scales::new(parameters);
    let (mut attractors, mut sweeps) = (Vec::new(), Vec::new());
    for result in results.by_ref().take(plan.values.len()) {
        if let Done::Attractor(attractor) = result {
            attractors.push(*attractor);
        }
    }
    for start in &plan.starts {
        let jobs = if *start == SweepStart::Rest { plan.grid.len() } else { 1 };
        let points: Vec<SweepPoint> = results
            .by_ref()
            .take(jobs)
            .flat_map(|result| match result {
                Done::Points(points) => points,
                Done::Attractor(_) => Vec::new(),
            })
            .collect();
        sweeps.push(Sweep { start: start.word().to_owned(), windows: windows::windows(&points), points });
    }
    let omega = match parameters.excitation {
        parameters::Excitation::Time { mesh_frequency } => mesh_frequency / scales.frequency,
        parameters::Excitation::Angle => f64::NAN,
    };
    Reading {
        joint: parameters.name.to_string(),
        joint_file: subject.loaded.name.clone(),
        description: subject.loaded.file.description.clone(),
        damping_law: match parameters.damping_law {
            DampingLaw::Paper => "paper",
            DampingLaw::Contact => "contact",
        }
        .to_owned(),
        omega,
        omega_n_rad_per_s: scales.frequency,
        characteristic_length_m: scales.length,
        drive_torque_nm: subject.drive_torque,
        load_torque_nm: subject.load_torque,
        carrier_equivalent_mass_kg: parameters.carrier_equivalent_mass(),
        attractors,
        sweeps,
    }
}

fn perform(job: &Job<'_>, plan: &Plan, progress: &Progress) -> Outcome<Done> {
    stop_if_asked()?;
    let done = match job {
        Job::Attractor(subject, b) => {
            let attractor = attractor_at(subject, *b)?;
            progress.done(ATTRACTOR_WORK);
            Done::Attractor(Box::new(attractor))
        }
        Job::FromRest(subject, b) => {
            let system = subject.system(*b)?;
            let point = point(subject, *b, &mut Motion::from_rest(&system))?;
            progress.done(1);
            Done::Points(vec![point])
        }
        Job::Carried(subject, start) => Done::Points(carried(subject, *start, &plan.grid, progress)?),
    };
    Ok(done)
}

fn stop_if_asked() -> Outcome<()> {
    if interruption::requested() {
        Err(Failure::interrupted("stopped by the user; nothing was written"))
    } else {
        Ok(())
    }
}

/// One point of a diagram.
fn point(subject: &Subject, half_backlash: f64, motion: &mut Motion<'_>) -> Outcome<SweepPoint> {
    let found = attractor::find(motion, &DIAGRAM).map_err(|error| at(subject, half_backlash, error))?;
    let x_sp = found.cycle().iter().map(|point| rounded(point[0])).collect();
    Ok(SweepPoint { half_backlash_m: half_backlash, class: found.class.into(), exponent: found.exponent, x_sp })
}

/// Points one after another, each from where the one before ended.
fn carried(subject: &Subject, start: SweepStart, grid: &[f64], progress: &Progress) -> Outcome<Vec<SweepPoint>> {
    let mut order: Vec<f64> = grid.to_vec();
    if start == SweepStart::Down {
        order.reverse();
    }
    let mut state = None;
    let mut points = Vec::with_capacity(order.len());
    for half_backlash in order {
        stop_if_asked()?;
        let system = subject.system(half_backlash)?;
        let mut motion = match state {
            None => Motion::from_rest(&system),
            Some(state) => Motion::new(&system, state),
        };
        points.push(point(subject, half_backlash, &mut motion)?);
        state = Some(motion.state());
        progress.done(1);
    }
    if start == SweepStart::Down {
        points.reverse();
    }
    Ok(points)
}

/// One row of the table, with what Figs 5-8 show of it.
pub fn attractor_at(subject: &Subject, half_backlash: f64) -> Outcome<AttractorRecord> {
    attractor_with(subject, half_backlash, &TABLE)
}

/// The same with another effort.
pub fn attractor_with(subject: &Subject, half_backlash: f64, effort: &Effort) -> Outcome<AttractorRecord> {
    let failed = |error| at(subject, half_backlash, error);
    let system = subject.system(half_backlash)?;
    let mut motion = Motion::from_rest(&system);
    let mut found = attractor::find(&mut motion, effort).map_err(failed)?;
    let two = attractor::by_two_trajectories(&system, &found, effort).map_err(failed)?;
    let between = attractor::between_planets(&motion, effort).map_err(failed)?;
    found.points.truncate(KEPT_POINTS);
    let reference_distance = witness::distance(subject, half_backlash, &motion, found.class);
    let (periods, window) = match found.class {
        Class::Periodic(period) => (period as u32 * SHORT_SIGNAL.div_ceil(period as u32), Window::Rectangular),
        _ => (LONG_SIGNAL, Window::Hann),
    };
    let signal = Signal::record(&mut motion, periods).map_err(failed)?;
    let shares = signal.contact;
    Ok(AttractorRecord {
        half_backlash_m: half_backlash,
        class: ClassRecord::from(found.class),
        poincare_points: found.cycle().to_vec(),
        points_looked_at: found.points.len(),
        distinct_points: found.distinct_points(),
        exponent_by_tangent_vector: found.exponent,
        exponent_by_two_trajectories: two,
        exponent_between_planets: between,
        non_fundamental_ratio: signal.non_fundamental_ratio(),
        peak_to_peak: signal.peak_to_peak(),
        contact_percent: [shares.drive_side, shares.separated, shares.back_side].map(|share| 100.0 * share),
        settled_after_periods: found.settled_after,
        reference_distance,
        history: history(&signal),
        spectrum: spectrum(&signal, window),
    })
}

fn at(subject: &Subject, half_backlash: f64, error: crate::numerics::system::StudyError) -> Failure {
    subject.failure(error).while_doing(format!("at b = {} um", micrometres(half_backlash)))
}

fn history(signal: &Signal) -> History {
    let kept = (HISTORY * SAMPLES).min(signal.position.len());
    let thinned = |values: &[f64]| values[..kept].iter().step_by(THINNED).map(|value| rounded(*value)).collect();
    History {
        periods: (0..kept).step_by(THINNED).map(|index| rounded(index as f64 / SAMPLES as f64)).collect(),
        x_sp: thinned(&signal.position),
        x_sp_rate: thinned(&signal.rate),
    }
}

fn spectrum(signal: &Signal, window: Window) -> SpectrumRecord {
    // A line lies at so many cycles in the whole stretch, which is so many mesh periods long.
    let periods = signal.position.len() as f64 / SAMPLES as f64;
    let mut amplitude = amplitudes(&signal.position, window, Mean::Plain);
    let frequencies = (0..amplitude.len()).map(|line| line as f64 / periods);
    let kept: Vec<f64> = frequencies.take_while(|frequency| *frequency <= HIGHEST_LINE).map(rounded).collect();
    amplitude.truncate(kept.len());
    SpectrumRecord { over_mesh_frequency: kept, amplitude }
}

/// Six decimals of something of order one: what a curve can show, and a file need not hold more.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
