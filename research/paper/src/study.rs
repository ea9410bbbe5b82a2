//! Computes everything that a plan asks for, in parallel over joints and half-backlashes; results do not depend on the
//! number of threads.

use model_core::gears::{Mechanics, Scales};
use parameters::DampingLaw;
use rayon::prelude::*;

use super::pictures::micrometres;
use super::plan::{StudyJoint, StudyPlan, SweepStart};
use super::record::{AttractorRecord, History, Reading, SpectrumRecord, Sweep, SweepPoint};
use super::{oracle, windows};
use crate::numerics::attractor::{self, Class, Effort};
use crate::numerics::integrator::EventIntegrator;
use crate::numerics::signal::{SAMPLES, Signal};
use report::failure::{Failure, Outcome};
use report::interruption;
use report::progress::Progress;
use report::spectrum::{Mean, Window, amplitudes};

/// Effort for attractors of the table: the standard deviation of Lyapunov exponents is about 0.0012.
const TABLE_EFFORT: Effort =
    Effort { transient: 300, longest_transient: 1000, alignment: 60, points: 1000, chaotic_periods: 12_000 };

/// Effort for points of a diagram.
const DIAGRAM_EFFORT: Effort =
    Effort { transient: 200, longest_transient: 600, alignment: 40, points: 200, chaotic_periods: 400 };

/// Number of Poincare points that are kept of an attractor without a period, and in which distinct points are counted.
const KEPT_POINTS: usize = 300;

/// Length of the signal of an attractor without a period [mesh periods].
const LONG_SIGNAL: u32 = 512;

/// Least length of the signal of a periodic attractor, extended to a whole number of its cycles [mesh periods].
const SHORT_SIGNAL: u32 = 48;

/// Length of the history that is kept [mesh periods].
const HISTORY_PERIODS: usize = 36;

/// Stride of the history: every HISTORY_STRIDE-th sample is kept.
const HISTORY_STRIDE: usize = 2;

/// Spectra are kept up to this multiple of the mesh frequency.
const HIGHEST_LINE: f64 = 6.0;

/// An attractor is so much more work than a point of a diagram, for the progress bar.
const ATTRACTOR_WORK: u64 = 20;

/// Everything, for every joint of the plan.
pub fn run(plan: &StudyPlan, progress: &Progress) -> Outcome<Vec<Reading>> {
    let points = plan.subjects.len() * plan.grid.len() * plan.starts.len();
    let attractors = (plan.subjects.len() * plan.values.len()) as u64;
    progress.run("computing", points as u64 + ATTRACTOR_WORK * attractors);
    plan.subjects.par_iter().with_max_len(1).map(|subject| reading(subject, plan, progress)).collect()
}

/// One joint: its diagrams beside its attractors.
fn reading(subject: &StudyJoint, plan: &StudyPlan, progress: &Progress) -> Outcome<Reading> {
    let parameters = &subject.parameters;
    let scales = Scales::new(parameters);
    let sweep = |start: &SweepStart| sweep(subject, *start, &plan.grid, progress);
    let attractor = |half_backlash: &f64| {
        stop_if_interrupted()?;
        let attractor = attractor_at(subject, *half_backlash)?;
        progress.advance(ATTRACTOR_WORK);
        Ok(attractor)
    };
    let (sweeps, attractors) = rayon::join(
        || plan.starts.par_iter().with_max_len(1).map(sweep).collect::<Outcome<Vec<_>>>(),
        || plan.values.par_iter().with_max_len(1).map(attractor).collect::<Outcome<Vec<_>>>(),
    );
    let (sweeps, attractors) = (sweeps?, attractors?);
    let omega = match parameters.excitation {
        parameters::Excitation::Time { mesh_frequency } => mesh_frequency / scales.frequency,
        parameters::Excitation::Angle => f64::NAN,
    };
    Ok(Reading {
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
    })
}

/// One diagram. Points from rest are shared out; a chain of points cannot be split.
fn sweep(subject: &StudyJoint, start: SweepStart, grid: &[f64], progress: &Progress) -> Outcome<Sweep> {
    let from_rest = |half_backlash: &f64| {
        stop_if_interrupted()?;
        let system = subject.system(*half_backlash)?;
        let point = point(subject, *half_backlash, &mut EventIntegrator::from_rest(&system))?;
        progress.advance(1);
        Ok(point)
    };
    let points: Vec<SweepPoint> = match start {
        SweepStart::Rest => grid.par_iter().with_max_len(1).map(from_rest).collect::<Outcome<_>>()?,
        SweepStart::Up | SweepStart::Down => carried(subject, start, grid, progress)?,
    };
    Ok(Sweep { start: start.word().to_owned(), windows: windows::windows(&points), points })
}

fn stop_if_interrupted() -> Outcome<()> {
    if interruption::requested() {
        Err(Failure::interrupted("stopped by the user; nothing was written"))
    } else {
        Ok(())
    }
}

/// One point of a diagram.
fn point(subject: &StudyJoint, half_backlash: f64, motion: &mut EventIntegrator<'_>) -> Outcome<SweepPoint> {
    let found = attractor::find(motion, &DIAGRAM_EFFORT).map_err(|error| at(subject, half_backlash, error))?;
    let x_sp = found.cycle().iter().map(|point| rounded(point[0])).collect();
    Ok(SweepPoint { half_backlash_m: half_backlash, class: found.class, exponent: found.exponent, x_sp })
}

/// Points one after another, each from where the one before ended.
fn carried(subject: &StudyJoint, start: SweepStart, grid: &[f64], progress: &Progress) -> Outcome<Vec<SweepPoint>> {
    let mut order: Vec<f64> = grid.to_vec();
    if start == SweepStart::Down {
        order.reverse();
    }
    let mut state = None;
    let mut points = Vec::with_capacity(order.len());
    for half_backlash in order {
        stop_if_interrupted()?;
        let system = subject.system(half_backlash)?;
        let mut motion = match state {
            None => EventIntegrator::from_rest(&system),
            Some(state) => EventIntegrator::new(&system, state),
        };
        points.push(point(subject, half_backlash, &mut motion)?);
        state = Some(motion.state());
        progress.advance(1);
    }
    if start == SweepStart::Down {
        points.reverse();
    }
    Ok(points)
}

/// One row of the table, with what Figs 5-8 show of it.
fn attractor_at(subject: &StudyJoint, half_backlash: f64) -> Outcome<AttractorRecord> {
    let failed = |error| at(subject, half_backlash, error);
    let system = subject.system(half_backlash)?;
    let mut motion = EventIntegrator::from_rest(&system);
    let mut found = attractor::find(&mut motion, &TABLE_EFFORT).map_err(failed)?;
    let two = attractor::by_two_trajectories(&system, &found, &TABLE_EFFORT).map_err(failed)?;
    let between = attractor::between_planets(&motion, &TABLE_EFFORT).map_err(failed)?;
    found.points.truncate(KEPT_POINTS);
    let reference_distance = oracle::distance(subject, half_backlash, &motion, found.class);
    let (periods, window) = match found.class {
        Class::Periodic(period) => (period as u32 * SHORT_SIGNAL.div_ceil(period as u32), Window::Rectangular),
        _ => (LONG_SIGNAL, Window::Hann),
    };
    let signal = Signal::record(&mut motion, periods).map_err(failed)?;
    let shares = signal.contact;
    Ok(AttractorRecord {
        half_backlash_m: half_backlash,
        class: found.class,
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

fn at(subject: &StudyJoint, half_backlash: f64, error: crate::numerics::system::StudyError) -> Failure {
    subject.failure(error).while_doing(format!("at b = {} um", micrometres(half_backlash)))
}

fn history(signal: &Signal) -> History {
    let kept = (HISTORY_PERIODS * SAMPLES).min(signal.position.len());
    let thinned = |values: &[f64]| values[..kept].iter().step_by(HISTORY_STRIDE).map(|value| rounded(*value)).collect();
    History {
        periods: (0..kept).step_by(HISTORY_STRIDE).map(|index| rounded(index as f64 / SAMPLES as f64)).collect(),
        x_sp: thinned(&signal.position),
        x_sp_rate: thinned(&signal.rate),
    }
}

fn spectrum(signal: &Signal, window: Window) -> SpectrumRecord {
    // The index of a line is its number of cycles in the whole signal; `periods` is the length of the signal in mesh
    // periods.
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
