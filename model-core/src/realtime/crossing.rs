//! Correction of a step for meshes that parted or met inside it, from its end alone. Known from
//! real-time simulation as in-step correction of a switched right-hand side (R. M. Howe, Dynamics of Real-Time
//! Simulation, ch. 11); a mesh that leaves and returns within the step is not seen.
//!
//! After the crossing, s before the end, the frozen law misses a force m. Near the end m(t) is known to second order,
//! so its first three integrals over [t - s, t] are closed forms; they correct rate, position and the integral of the
//! position. These corrections deform the other meshes too: one linear pass adds the forces that this causes.

use crate::real::Real;
use crate::realtime::contact::{Drive, Law, Laws, Net};
use crate::realtime::excitation::{Beat, PerMesh};
use crate::realtime::frozen::{Frozen, Moment};
use crate::realtime::stages::Point;
use crate::realtime::substep::Course;

/// The end of a step that was taken with one contact set throughout.
pub struct End<'a, T: Real, const N: usize> {
    /// The joint.
    pub frozen: &'a Frozen<'a, T, N>,
    /// How far back from its end a crossing may lie.
    pub step: T,
    /// d(phase)/d(tau) [rad].
    pub phase_rate: T,
    /// The excitation.
    pub beat: &'a Beat<T>,
    /// Meshes whose law does not hold.
    pub broken: &'a PerMesh<bool, N>,
}

impl<T: Real, const N: usize> End<'_, T, N> {
    /// Corrects the motion for every broken law, and the accelerations now and half a step before, which become those
    /// that the new laws would have caused on the same path.
    #[inline(never)]
    pub fn correct(&self, laws: &mut Laws<T, N>, course: &mut Course<T, N>) {
        let tables = self.frozen.tables;
        // e'' = -rate^2 e for the sine of eq. 11.
        let square = self.phase_rate * self.phase_rate;
        let (mut impulse, mut shift, mut jump, mut past) = (Net::NONE, Net::NONE, Net::NONE, Net::NONE);
        let mut longest = T::ZERO;
        let half = T::HALF * self.step;
        for i in 0..N {
            let planet = course.planets[i];
            for kind in 0..2 {
                if !self.broken[kind][i] {
                    continue;
                }
                let (mut at, mut acceleration) = (planet.point(), planet.now);
                if kind == 1 {
                    at = Point { position: course.gap.position - at.position, rate: course.gap.rate - at.rate };
                    acceleration = course.gap.now - acceleration;
                }
                let was = laws[kind][i];
                let Moment { overlap, speed, stiffness, error, .. } =
                    self.frozen.mesh(&Law::OPEN, (kind, i), self.beat, at);
                let is = Law::of(tables, (kind, i), overlap, speed, stiffness);
                if was.contact == is.contact {
                    continue;
                }
                laws[kind][i] = is;
                let stiffness_rate = tables.meshes[kind][i].stiffness_rate(self.beat, tables.excitation.harmonics);
                let mesh = Crossing {
                    deflection: overlap,
                    speed,
                    acceleration: acceleration + square * error,
                    stiffness,
                    stiffness_rate,
                    step: self.step,
                };
                let missed = mesh.missed(&was, &is);
                impulse.add_one((kind, i), missed.impulse);
                shift.add_one((kind, i), missed.shift);
                jump.add_one((kind, i), missed.path.value);
                past.add_one((kind, i), missed.path.before(half));
                if missed.since > longest {
                    longest = missed.since;
                }
            }
        }
        let respond = |net: &Net<T, N>, wind_up: T| net.accelerations(tables, &Drive::NONE, wind_up);
        let (rate, position) = (respond(&impulse, T::ZERO), respond(&shift, T::ZERO));
        let mut back = Net::NONE;
        for i in 0..N {
            let force = |kind: usize, position: T, rate: T| {
                let law = &laws[kind][i];
                law.closed * tables.springs[kind].stiffness * position + law.damping * rate
            };
            let (sun, sun_rate) = (position.planets[i], rate.planets[i]);
            back.add(i, force(0, sun, sun_rate), force(1, position.gap - sun, rate.gap - sun_rate));
        }
        let mobility = &tables.mobility;
        let wind_up = mobility.wind_up_stiffness * position.wind_up + mobility.wind_up_damping * rate.wind_up;
        let back = respond(&back, wind_up);
        // A force that grows from zero shifts by s/4 times what its double integral is.
        let quarter = T::HALF * T::HALF * longest;
        course.each(&position, |coordinate, position| coordinate.position += position);
        course.each(&rate, |coordinate, rate| coordinate.rate += rate);
        course.each(&back, |coordinate, back| {
            coordinate.rate += quarter * back;
            coordinate.now += back;
        });
        course.each(&respond(&jump, T::ZERO), |coordinate, jump| coordinate.now += jump);
        course.each(&respond(&past, T::ZERO), |coordinate, past| coordinate.before += past);
    }
}

/// One mesh at the end of a sub-step, on the path that the frozen laws gave.
struct Crossing<T> {
    deflection: T,
    speed: T,
    acceleration: T,
    stiffness: T,
    stiffness_rate: T,
    step: T,
}

/// What a frozen law missed.
struct Missed<T> {
    /// Integral of the force since the crossing.
    impulse: T,
    /// Integral of that.
    shift: T,
    /// The force itself along the path that was taken, as if it had always acted.
    path: Path<T>,
    /// How long ago the crossing was.
    since: T,
}

/// A quantity near the end of a sub-step: value, rate, acceleration there.
#[derive(Clone, Copy)]
struct Path<T> {
    value: T,
    rate: T,
    acceleration: T,
}

impl<T: Real> Crossing<T> {
    fn missed(&self, before: &Law<T>, after: &Law<T>) -> Missed<T> {
        let (was_closed, is_closed) = (before.closed > T::ZERO, after.closed > T::ZERO);
        // Damping that acts whatever the contact cancels out; what is left acts in contact only.
        let base = match (was_closed, is_closed) {
            (true, false) => after.damping,
            (false, true) => before.damping,
            _ => T::ZERO,
        };
        let mut missed =
            Missed { impulse: T::ZERO, shift: T::ZERO, path: Path { value: T::ZERO, rate: T::ZERO, acceleration: T::ZERO }, since: T::ZERO };
        if was_closed {
            let force = self.force(before, base);
            let gone = Path { value: -force.value, rate: -force.rate, acceleration: -force.acceleration };
            missed.add(gone, force.since_zero(self.step));
        }
        if is_closed {
            let force = self.force(after, base);
            // Contact began when the surfaces met, or, between surfaces already overlapping, when the force turned.
            let met = self.overlap(after).since_zero(self.step);
            missed.add(force, if met < self.step { met } else { force.since_zero(self.step) });
        }
        missed
    }

    fn overlap(&self, law: &Law<T>) -> Path<T> {
        Path { value: self.deflection - law.offset, rate: self.speed, acceleration: self.acceleration }
    }

    /// Contact force under a law less the damping that acts anyway; the jerk that damping would see is left out.
    fn force(&self, law: &Law<T>, base: T) -> Path<T> {
        let damping = law.damping - base;
        let overlap = self.overlap(law);
        Path {
            value: self.stiffness * overlap.value + damping * overlap.rate,
            rate: self.stiffness * overlap.rate
                + self.stiffness_rate * overlap.value
                + damping * overlap.acceleration,
            acceleration: self.stiffness * overlap.acceleration + T::TWO * self.stiffness_rate * overlap.rate,
        }
    }
}

impl<T: Real> Path<T> {
    /// Its value a while before the end.
    fn before(&self, while_: T) -> T {
        self.value - while_ * (self.rate - T::HALF * while_ * self.acceleration)
    }

    /// How long before the end the path was zero: a secant and one Newton step, within the sub-step. Paths that give
    /// no answer (they do not point away from zero) are given the whole sub-step, where they are small.
    fn since_zero(&self, step: T) -> T {
        let sign = if self.value < T::ZERO { -T::ONE } else { T::ONE };
        let (value, rate, acceleration) = (sign * self.value, sign * self.rate, sign * self.acceleration);
        if value >= rate * step {
            return if rate > T::ZERO { newton(value, rate, acceleration, step, step) } else { step };
        }
        // Here rate * step > value >= 0, so the quotient is within the sub-step.
        newton(value, rate, acceleration, value.over(rate), step)
    }
}

/// One Newton step for value - s rate + s^2/2 acceleration = 0 from a guess, kept within [0, limit].
fn newton<T: Real>(value: T, rate: T, acceleration: T, guess: T, limit: T) -> T {
    let slope = rate - guess * acceleration;
    // Half the secant's slope: below it the parabola turns inside the step and the guess is the better answer.
    if slope + slope < rate {
        return guess;
    }
    let rest = value - guess * (rate - T::HALF * guess * acceleration);
    let refined = guess + rest.over(slope);
    if refined < T::ZERO { T::ZERO } else { smaller(refined, limit) }
}

impl<T: Real> Missed<T> {
    /// Adds a force that has acted for the last `since`.
    fn add(&mut self, path: Path<T>, since: T) {
        let Path { value, rate, acceleration } = path;
        let s = since;
        self.impulse += s * (value - s * (rate * T::HALF - s * acceleration * T::SIXTH));
        self.shift += s * s * (value * T::HALF - s * (rate * T::THIRD - s * acceleration * T::EIGHTH));
        self.path.value += value;
        self.path.rate += rate;
        self.path.acceleration += acceleration;
        if since > self.since {
            self.since = since;
        }
    }
}

fn smaller<T: Real>(a: T, b: T) -> T {
    if b < a { b } else { a }
}
