//! A tick in sub-steps, the path that is taken when contacts may change. Each sub-step freezes the contact set, so that
//! its right-hand side is smooth, and is corrected for every crossing that its end reveals. The tanh dead zone has
//! nothing to freeze: see `unfrozen`.

use core::array;

use crate::real::Real;
use crate::realtime::contact::{Drive, Laws};
use crate::realtime::crossing::End;
use crate::realtime::excitation::{Beat, MeshPhase};
use crate::realtime::frozen::Frozen;
use crate::realtime::runge_kutta::Motion;
use crate::realtime::stages::{Coordinate, Weights};
use crate::realtime::state::Relative;
use crate::tables::Tables;

/// All coordinates.
pub struct Course<T, const N: usize> {
    /// u_s - u_pi - u_c of every planet, without imposed error.
    pub planets: [Coordinate<T>; N],
    /// u_s - 2 u_c.
    pub gap: Coordinate<T>,
    /// u_c - u_l.
    pub wind_up: Coordinate<T>,
}

/// One tick.
pub fn advance<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    phase: &MeshPhase<T>,
    laws: &Laws<T, N>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let frozen = Frozen { tables, drive };
    let half = phase.over(tables.half_part);
    let weights = Weights::new(tables.substep);
    let mut laws = *laws;
    let mut rotor = phase.start;
    let mut course = begin(&frozen, &laws, &weights, phase, &rotor.turned(&half), motion);
    for _ in 0..tables.substeps {
        rotor = rotor.turned(&half);
        let beat = Beat::new(rotor, phase.rate);
        let ends = (course.gap.middle(&weights), course.wind_up.middle(&weights));
        let middle = frozen.pull(&laws, &beat, ends, |i| course.planets[i].middle(&weights), |_, _| {});

        rotor = rotor.turned(&half);
        let beat = Beat::new(rotor, phase.rate);
        let ends = (course.gap.arrive(&weights, middle.gap), course.wind_up.arrive(&weights, middle.wind_up));
        let planets = &mut course.planets;
        let mut broken = [[false; N]; 2];
        let mut holds = true;
        let last = frozen.pull(
            &laws,
            &beat,
            ends,
            |i| planets[i].arrive(&weights, middle.planets[i]),
            |(kind, i), moment| {
                let held = frozen.holds(&laws[kind][i], (kind, i), moment);
                broken[kind][i] = !held;
                holds &= held;
            },
        );
        course.finish(&weights, &last);
        if !holds {
            let end = End { frozen: &frozen, step: tables.substep, phase_rate: phase.rate, beat: &beat, broken: &broken };
            end.correct(&mut laws, &mut course);
        }
    }
    course.motion()
}

/// The course at the start of a tick: accelerations from scratch, the one half a sub-step before from a first look at
/// the middle.
#[inline(never)]
fn begin<T: Real, const N: usize>(
    frozen: &Frozen<T, N>,
    laws: &Laws<T, N>,
    weights: &Weights<T>,
    phase: &MeshPhase<T>,
    middle: &crate::realtime::excitation::Rotor<T>,
    motion: &Motion<T, N>,
) -> Course<T, N> {
    let mut course = Course::of(motion);
    for (first, rotor) in [(true, &phase.start), (false, middle)] {
        let beat = Beat::new(*rotor, phase.rate);
        let point = |coordinate: &Coordinate<T>| {
            if first { coordinate.point() } else { coordinate.middle(weights) }
        };
        let ends = (point(&course.gap), point(&course.wind_up));
        let seen = frozen.pull(laws, &beat, ends, |i| point(&course.planets[i]), |_, _| {});
        course.each(&seen, |coordinate, seen| {
            if first {
                (coordinate.now, coordinate.before) = (seen, seen);
            } else {
                coordinate.before = coordinate.now + coordinate.now - seen;
            }
        });
    }
    course
}

impl<T: Real, const N: usize> Course<T, N> {
    /// A motion whose accelerations are not yet known.
    pub fn of(motion: &Motion<T, N>) -> Self {
        let Motion { position, rate } = motion;
        let still = |position: T, rate: T| Coordinate { position, rate, now: T::ZERO, before: T::ZERO };
        Self {
            planets: array::from_fn(|i| still(position.planets[i], rate.planets[i])),
            gap: still(position.gap, rate.gap),
            wind_up: still(position.wind_up, rate.wind_up),
        }
    }

    /// Does the same to every coordinate with a value that belongs to it.
    #[inline(always)]
    pub fn each(&mut self, values: &Relative<T, N>, mut act: impl FnMut(&mut Coordinate<T>, T)) {
        for i in 0..N {
            act(&mut self.planets[i], values.planets[i]);
        }
        act(&mut self.gap, values.gap);
        act(&mut self.wind_up, values.wind_up);
    }

    #[inline(always)]
    fn finish(&mut self, weights: &Weights<T>, last: &Relative<T, N>) {
        self.each(last, |coordinate, last| coordinate.finish(weights, last));
    }

    /// The motion without its accelerations.
    pub fn motion(&self) -> Motion<T, N> {
        let collect = |value: fn(&Coordinate<T>) -> T| Relative {
            planets: array::from_fn(|i| value(&self.planets[i])),
            gap: value(&self.gap),
            wind_up: value(&self.wind_up),
        };
        Motion { position: collect(|coordinate| coordinate.position), rate: collect(|coordinate| coordinate.rate) }
    }
}
