//! The attractor of a motion: periodic with which period, or chaotic, by its Poincare points and its largest Lyapunov
//! exponent.

use std::fmt;

use serde::Serialize;

use super::integrator::{EventIntegrator, State};
use super::lyapunov::{Growth, generic, measured_period, normalise, two_trajectories};
use super::shooting::periodic_state;
use super::system::{StudyError, System};

/// Longest period looked for, in mesh periods.
pub const LONGEST_PERIOD: usize = 24;

/// Poincare points nearer than this, over b_c, are the same point once the motion has settled.
const SAME_POINT: f64 = 1e-4;

/// A motion that repeats this well has settled, and need not be waited for any longer.
const SETTLED: f64 = 1e-7;

/// Exponents above this, per unit of dimensionless time, are chaos: finite runs leave less to orbits without any.
const CHAOTIC_EXPONENT: f64 = 0.004;

/// Points farther apart than this, over b_c, count as distinct where points of chaos are counted.
const DISTINCT: f64 = 1e-2;

/// What a motion settles on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(tag = "class", content = "period", rename_all = "snake_case")]
pub enum Class {
    /// It repeats after so many mesh periods.
    Periodic(usize),
    /// Neighbours part exponentially.
    Chaotic,
    /// Quasi-periodic, of a longer period than is looked for, or not settled.
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

/// How many periods are spent on each part of the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Periods before anything is looked at.
    pub transient: u32,
    /// Periods after which a motion that has not become periodic is taken as it is.
    pub longest_transient: u32,
    /// Periods in which a tangent vector finds its direction.
    pub alignment: u32,
    /// Periods measured, one Poincare point each.
    pub points: u32,
    /// Periods over which the exponent of chaos is measured: it wanders by about 0.13 over the root of their number.
    pub chaotic_periods: u32,
}

/// An attractor.
#[derive(Debug, Clone, PartialEq)]
pub struct Attractor {
    /// What it is.
    pub class: Class,
    /// Largest Lyapunov exponent per unit of dimensionless time, by a tangent vector.
    pub exponent: f64,
    /// X_sp of planet 0, X_sc, X_sp', X_sc' at the beginning of each period measured.
    pub points: Vec<[f64; 4]>,
    /// Periods before measuring began.
    pub settled_after: u32,
    /// Where the tangent vector started.
    pub start: State,
}

impl Effort {
    /// Periods over which the exponent of an attractor is measured.
    pub fn periods(&self, class: Class) -> u32 {
        if class == Class::Chaotic { self.points.max(self.chaotic_periods) } else { self.points }
    }
}

impl Attractor {
    /// The points that tell it: one cycle if it is periodic, else all.
    pub fn cycle(&self) -> &[[f64; 4]] {
        match self.class {
            Class::Periodic(period) => &self.points[..period.min(self.points.len())],
            _ => &self.points,
        }
    }

    /// How many points can be told apart.
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

/// Follows a motion until it has settled, and measures it. The motion is left at the end of that.
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
    // Neighbours come together, but too slowly to wait for.
    let Some(state) = periodic_state(motion)? else { return Ok(found) };
    let mut shorter = EventIntegrator::new(motion.system(), state);
    let polished = measure(&mut shorter, effort, settled_after + effort.alignment + effort.points)?;
    if matches!(polished.class, Class::Periodic(_)) {
        *motion = shorter;
        return Ok(polished);
    }
    Ok(found)
}

/// Poincare points and exponent from where a motion is.
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

/// The shortest period after which the last states repeat to `tolerance`, if any.
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

/// The exponent of an attractor once more, by two trajectories. The first of them is the very motion along which the
/// tangent vector was carried, so that what differs is the method and not the stretch of chaos.
pub fn by_two_trajectories(system: &System, found: &Attractor, effort: &Effort) -> Result<f64, StudyError> {
    let motion = EventIntegrator::new(system, found.start);
    let growth = two_trajectories(&motion, effort.alignment, effort.periods(found.class))?;
    Ok(match found.class {
        Class::Chaotic => growth.mean(system.period()),
        _ => growth.exponent(system.period()),
    })
}

/// The largest exponent of disturbances that drive planets apart, for planets that all mesh in phase; otherwise there is
/// no such motion to begin with. Below zero, planets in phase stay in phase.
pub fn between_planets(motion: &EventIntegrator<'_>, effort: &Effort) -> Result<Option<f64>, StudyError> {
    let system = motion.system();
    if !system.in_phase() {
        return Ok(None);
    }
    let mut apart = State::default();
    // What one planet gains the next loses: sun and carrier do not notice, so the vector stays of this kind for good.
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
