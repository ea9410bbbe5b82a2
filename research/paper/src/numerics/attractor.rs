//! Attractor of a motion: periodic with a period, or chaotic, by its Poincare points and its largest Lyapunov exponent.

use std::fmt;

use serde::Serialize;

use super::integrator::{EventIntegrator, State};
use super::lyapunov::{Growth, generic, measured_period, normalise, two_trajectories};
use super::shooting::periodic_state;
use super::system::{StudyError, System};

/// Longest period considered, in mesh periods.
pub const LONGEST_PERIOD: usize = 24;

/// Distance of Poincare points, over b_c, below which they are equal once the motion has settled.
const SAME_POINT: f64 = 1e-4;

/// Distance at which a repeating motion counts as settled, which ends the transient.
const SETTLED: f64 = 1e-7;

/// Exponent per unit of dimensionless time above which a motion is chaotic: periodic orbits stay below it in finite runs.
const CHAOTIC_EXPONENT: f64 = 0.004;

/// Distance of chaotic points, over b_c, above which they count as distinct.
const DISTINCT: f64 = 1e-2;

/// Class of the attractor of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "class", content = "period", rename_all = "snake_case")]
pub enum Class {
    /// Repeats after a number of mesh periods.
    Periodic(usize),
    /// Neighbouring trajectories diverge exponentially.
    Chaotic,
    /// Quasi-periodic, of a period longer than considered, or not settled.
    Unsettled,
}

impl fmt::Display for Class {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Periodic(period) => write!(formatter, "period {period}"),
            Self::Chaotic => write!(formatter, "chaos"),
            Self::Unsettled => write!(formatter, "no period found"),
        }
    }
}

/// Number of periods for each part of the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Periods before the motion is examined.
    pub transient: u32,
    /// Longest transient of a motion that does not become periodic.
    pub longest_transient: u32,
    /// Periods for a tangent vector to find its direction.
    pub alignment: u32,
    /// Measured periods, one Poincare point each.
    pub points: u32,
    /// Periods for the exponent of chaos, whose standard deviation is about 0.13 over the root of their number.
    pub chaotic_periods: u32,
}

/// An attractor.
#[derive(Debug, Clone, PartialEq)]
pub struct Attractor {
    /// Class of the attractor.
    pub class: Class,
    /// Largest Lyapunov exponent per unit of dimensionless time, by a tangent vector.
    pub exponent: f64,
    /// X_sp of planet 0, X_sc, X_sp', X_sc' at the beginning of each measured period.
    pub points: Vec<[f64; 4]>,
    /// Periods before the measurement.
    pub settled_after: u32,
    /// Start of the tangent vector.
    pub start: State,
}

impl Effort {
    /// Number of periods for the exponent of an attractor.
    pub fn periods(&self, class: Class) -> u32 {
        if class == Class::Chaotic { self.points.max(self.chaotic_periods) } else { self.points }
    }
}

impl Attractor {
    /// Points of the attractor: one cycle if it is periodic, else all.
    pub fn cycle(&self) -> &[[f64; 4]] {
        match self.class {
            Class::Periodic(period) => &self.points[..period.min(self.points.len())],
            _ => &self.points,
        }
    }

    /// Number of distinguishable points.
    pub fn distinct_points(&self) -> usize {
        let mut known: Vec<&[f64; 4]> = Vec::new();
        for point in &self.points {
            if known.iter().all(|other| distance(other, point) > DISTINCT) {
                known.push(point);
            }
        }
        known.len()
    }
}

/// Runs a motion until it has settled, and measures its attractor. The motion is left at the end of the measurement.
pub fn find(motion: &mut EventIntegrator<'_>, effort: &Effort) -> Result<Attractor, StudyError> {
    let mut recent: Vec<State> = Vec::new();
    let mut settled_after = 0;
    let settled = |recent: &[State]| period(recent, SETTLED).is_some();
    while settled_after < effort.transient || (settled_after < effort.longest_transient && !settled(&recent)) {
        motion.period()?;
        settled_after += 1;
        if recent.len() == 2 * LONGEST_PERIOD {
            recent.remove(0);
        }
        recent.push(motion.state());
    }
    let found = measure(motion, effort, settled_after)?;
    if found.class != Class::Unsettled || found.exponent >= 0.0 {
        return Ok(found);
    }
    // Neighbouring trajectories converge, but too slowly to wait.
    let Some(state) = periodic_state(motion)? else { return Ok(found) };
    let mut shorter = EventIntegrator::new(motion.system(), state);
    let polished = measure(&mut shorter, effort, settled_after + effort.alignment + effort.points)?;
    if matches!(polished.class, Class::Periodic(_)) {
        *motion = shorter;
        return Ok(polished);
    }
    Ok(found)
}

/// Poincare points and exponent from the present state of a motion.
fn measure(motion: &mut EventIntegrator<'_>, effort: &Effort, settled_after: u32) -> Result<Attractor, StudyError> {
    let start = motion.state();
    *motion.tangents() = vec![generic(motion.system().coordinates())];
    let mut growth = Growth::default();
    for _ in 0..effort.alignment {
        motion.period()?;
        motion.tangents().iter_mut().for_each(|tangent| {
            normalise(tangent);
        });
    }
    let (mut points, mut states) = (Vec::new(), Vec::new());
    for _ in 0..effort.points {
        points.push(motion.poincare_point());
        states.push(motion.state());
        measured_period(motion, &mut growth)?;
    }
    let mesh_period = motion.system().period();
    let mut exponent = growth.exponent(mesh_period);
    let class = match period(&states, SAME_POINT) {
        Some(period) if exponent < CHAOTIC_EXPONENT => Class::Periodic(period),
        _ if exponent > CHAOTIC_EXPONENT => Class::Chaotic,
        _ => Class::Unsettled,
    };
    if class == Class::Chaotic {
        for _ in effort.points..effort.chaotic_periods {
            measured_period(motion, &mut growth)?;
        }
        exponent = growth.mean(mesh_period);
    }
    motion.tangents().clear();
    Ok(Attractor { class, exponent, points, settled_after: settled_after + effort.alignment, start })
}

/// Shortest period after which the last states repeat to `tolerance`, if any.
fn period(states: &[State], tolerance: f64) -> Option<usize> {
    let repeats = |period: usize| {
        let last = &states[states.len() - 2 * period.max(LONGEST_PERIOD / 2)..];
        last.iter().zip(&last[period..]).all(|(early, late)| apart(early, late) < tolerance)
    };
    (1..=LONGEST_PERIOD).filter(|period| states.len() >= 2 * period.max(&(LONGEST_PERIOD / 2))).find(|p| repeats(*p))
}

fn apart(one: &State, other: &State) -> f64 {
    let pairs = one.position.iter().zip(&other.position).chain(one.rate.iter().zip(&other.rate));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn distance(one: &[f64; 4], other: &[f64; 4]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Exponent of an attractor by two trajectories. The first trajectory is the motion that carried the tangent vector, so that the methods
/// differ and not the stretch of chaos.
pub fn by_two_trajectories(system: &System, found: &Attractor, effort: &Effort) -> Result<f64, StudyError> {
    let motion = EventIntegrator::new(system, found.start);
    let growth = two_trajectories(&motion, effort.alignment, effort.periods(found.class))?;
    Ok(match found.class {
        Class::Chaotic => growth.mean(system.period()),
        _ => growth.exponent(system.period()),
    })
}

/// Largest exponent of disturbances that drive planets apart, for planets that all mesh in phase; `None` for other joints. Below zero,
/// planets in phase stay in phase.
pub fn between_planets(motion: &EventIntegrator<'_>, effort: &Effort) -> Result<Option<f64>, StudyError> {
    let system = motion.system();
    if !system.in_phase() {
        return Ok(None);
    }
    let mut apart = State::default();
    // One planet gains as much as the next loses: sun and carrier are not affected, so the vector stays of this kind.
    [apart.position[0], apart.position[1]] = [1.0, -1.0];
    let mut motion = EventIntegrator::new(system, motion.state());
    *motion.tangents() = vec![apart];
    let mut growth = Growth::default();
    for _ in 0..effort.alignment {
        measured_period(&mut motion, &mut Growth::default())?;
    }
    for _ in 0..effort.points {
        measured_period(&mut motion, &mut growth)?;
    }
    Ok(Some(growth.exponent(system.period())))
}
