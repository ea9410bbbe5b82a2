//! What a motion settles on: of which period, or chaotic, by its Poincare points and its largest Lyapunov exponent.
//! How points are drawn and what a change of class means is left to the commands.

use super::lyapunov::{Growth, by_two_trajectories, generic, measured_period, normalise};
use super::motion::{Motion, State, Stretch};
use super::system::StudyError;

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

/// Samples of one period for peak to peak and content at other frequencies.
const SAMPLES: usize = 256;

/// What a motion settles on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// It repeats after so many mesh periods.
    Periodic(usize),
    /// Neighbours part exponentially.
    Chaotic,
    /// Neither has shown itself: quasi-periodic, of a longer period than is looked for, or still settling.
    Unsettled,
}

/// How long to look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Periods before anything is looked at.
    pub transient: u32,
    /// Periods after which a motion that has not become periodic is taken as it is.
    pub patience: u32,
    /// Periods in which a tangent vector finds its direction.
    pub alignment: u32,
    /// Periods measured, one Poincare point each.
    pub points: u32,
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
pub fn find(motion: &mut Motion<'_>, effort: &Effort) -> Result<Attractor, StudyError> {
    let mut recent: Vec<State> = Vec::new();
    let mut settled_after = 0;
    let settled = |recent: &[State]| period(recent, SETTLED).is_some();
    while settled_after < effort.transient || (settled_after < effort.patience && !settled(&recent)) {
        motion.period()?;
        settled_after += 1;
        if recent.len() == 2 * LONGEST_PERIOD {
            recent.remove(0);
        }
        recent.push(motion.state());
    }
    let coordinates = motion.system().coordinates();
    *motion.tangents() = vec![generic(coordinates)];
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
    motion.tangents().clear();
    let exponent = growth.exponent(motion.system().period());
    let class = match period(&states, SAME_POINT) {
        Some(period) if exponent < CHAOTIC_EXPONENT => Class::Periodic(period),
        _ if exponent > CHAOTIC_EXPONENT => Class::Chaotic,
        _ => Class::Unsettled,
    };
    Ok(Attractor { class, exponent, points, settled_after: settled_after + effort.alignment })
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

/// X_sp of planet 0 over a whole number of periods, evenly sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Samples in one mesh period.
    pub per_period: usize,
    /// Time between two samples.
    pub interval: f64,
    /// X_sp.
    pub position: Vec<f64>,
    /// X_sp'.
    pub rate: Vec<f64>,
}

impl Signal {
    /// The next `periods` of a motion.
    pub fn record(motion: &mut Motion<'_>, periods: u32) -> Result<Self, StudyError> {
        let system = motion.system();
        let interval = system.period() / SAMPLES as f64;
        let mut signal = Self { per_period: SAMPLES, interval, position: Vec::new(), rate: Vec::new() };
        for _ in 0..periods {
            let mut next = 0;
            motion.period_with(|stretch: &Stretch<'_>| {
                while next < SAMPLES && next as f64 * interval < stretch.to {
                    let time = next as f64 * interval;
                    let state = stretch.at(time);
                    let (error, error_rate) = system.transmission_error(0, time);
                    signal.position.push(state.position[0] - error);
                    signal.rate.push(state.rate[0] - error_rate);
                    next += 1;
                }
            })?;
        }
        Ok(signal)
    }

    /// Greatest less least.
    pub fn peak_to_peak(&self) -> f64 {
        let (low, high) = self.position.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        high - low
    }

    /// Root mean square of all that is neither mean nor at the mesh frequency, over that of the mesh frequency. Over
    /// whole cycles it is exact, whatever the period.
    pub fn non_fundamental_ratio(&self) -> f64 {
        let count = self.position.len() as f64;
        let mean = self.position.iter().sum::<f64>() / count;
        let (mut sine, mut cosine, mut square) = (0.0, 0.0, 0.0);
        for (index, value) in self.position.iter().enumerate() {
            let phase = core::f64::consts::TAU * (index % self.per_period) as f64 / self.per_period as f64;
            sine += (value - mean) * phase.sin();
            cosine += (value - mean) * phase.cos();
            square += (value - mean) * (value - mean);
        }
        let fundamental = 2.0 * (sine * sine + cosine * cosine) / (count * count);
        ((square / count - fundamental).max(0.0) / fundamental).sqrt()
    }
}

/// The exponent by two trajectories, from where a motion is.
pub fn second_opinion(motion: &Motion<'_>, effort: &Effort) -> Result<f64, StudyError> {
    by_two_trajectories(motion, effort.alignment, effort.points)
}
