//! Correction of a step for meshes that parted or met inside it, from its end alone. Known from
//! real-time simulation as in-step correction of a switched right-hand side (R. M. Howe, Dynamics of Real-Time
//! Simulation, ch. 11); a mesh that leaves and returns within the step is not seen.
//!
//! After the crossing, s before the end, the frozen law misses a force m. Near the end m(t) is known to second order,
//! so its first three integrals over [t - s, t] are closed forms; they correct rate, position and the integral of the
//! position. These corrections deform the other meshes too: one linear pass adds the forces that this causes.

use crate::real::Real;
use crate::realtime::contact::{Drive, Law, Laws, Observed, acceleration, spread, wind_up_force};
use crate::realtime::excitation::Instant;
use crate::realtime::runge_kutta::Motion;
use crate::tables::Tables;

/// A step that was taken with one contact set throughout.
pub struct FrozenStep<'a, T, const N: usize> {
    /// How far back from its end a crossing may lie.
    pub step: T,
    /// d(phase)/d(tau) [rad].
    pub phase_rate: T,
    /// The meshes at its end.
    pub observed: &'a Observed<T, N>,
}

impl<T: Real, const N: usize> FrozenStep<'_, T, N> {
    /// The motion at the end, corrected for every mesh that is no longer under its law; `laws` are brought up to date.
    #[inline(never)]
    pub fn correct(
        &self,
        tables: &Tables<T, N>,
        drive: &Drive<T>,
        instant: &Instant<T, N>,
        laws: &mut Laws<T, N>,
        end: &Motion<T, N>,
    ) -> Motion<T, N> {
        let Observed { deflection, speed, force } = self.observed;
        let wind_up = wind_up_force(tables, &end.position, &end.rate);
        let accelerations = spread(&acceleration(tables, drive, force, wind_up));
        // e'' = -rate^2 e for the sine of eq. 11.
        let square = self.phase_rate * self.phase_rate;
        let mut missed = [[[T::ZERO; N]; 2]; 3];
        for kind in 0..2 {
            for i in 0..N {
                let (deflection, speed, stiffness) = (deflection[kind][i], speed[kind][i], instant.stiffness[kind][i]);
                let before = laws.get(kind, i);
                let after = Law::of(tables, (kind, i), deflection, speed, stiffness);
                if before == after {
                    continue;
                }
                laws.set(kind, i, after);
                let acceleration = accelerations[kind][i] + square * instant.error[kind][i];
                let mesh = Crossing { deflection, speed, acceleration, stiffness, step: self.step };
                let integrals = mesh.missed(&before, &after);
                for (integral, value) in missed.iter_mut().zip(integrals) {
                    integral[kind][i] = value;
                }
            }
        }
        let [rate, position, integral] = missed.map(|forces| acceleration(tables, &Drive::NONE, &forces, T::ZERO));
        let (bent, bending) = (spread(&integral), spread(&position));
        let mut forces = bent;
        for kind in 0..2 {
            for i in 0..N {
                forces[kind][i] = laws.closed[kind][i] * instant.stiffness[kind][i] * bent[kind][i]
                    + laws.damping[kind][i] * bending[kind][i];
            }
        }
        let wind_up = wind_up_force(tables, &integral, &position);
        let later = acceleration(tables, &Drive::NONE, &forces, wind_up);
        Motion {
            position: end.position.plus(T::ONE, &position),
            rate: end.rate.plus(T::ONE, &rate).plus(T::ONE, &later),
        }
    }
}

/// One mesh at the end of a sub-step, on the path that the frozen laws gave.
struct Crossing<T> {
    deflection: T,
    speed: T,
    acceleration: T,
    stiffness: T,
    step: T,
}

/// A quantity near the end of a sub-step: value, rate, acceleration there.
#[derive(Clone, Copy)]
struct Path<T> {
    value: T,
    rate: T,
    acceleration: T,
}

impl<T: Real> Crossing<T> {
    /// First three integrals of the force that the frozen law missed, from the crossing to the end.
    fn missed(&self, before: &Law<T>, after: &Law<T>) -> [T; 3] {
        let mut total = [T::ZERO; 3];
        let (was_closed, is_closed) = (before.closed > T::ZERO, after.closed > T::ZERO);
        // Damping that acts whatever the contact cancels out; what is left acts in contact only.
        let base = match (was_closed, is_closed) {
            (true, false) => after.damping,
            (false, true) => before.damping,
            _ => T::ZERO,
        };
        if was_closed {
            let force = self.force(before, base);
            let since = force.since_zero(self.step);
            add(&mut total, Path { value: -force.value, rate: -force.rate, acceleration: -force.acceleration }, since);
        }
        if is_closed {
            let force = self.force(after, base);
            // Contact began when the surfaces met, or, between surfaces already overlapping, when the force turned.
            let met = self.overlap(after).since_zero(self.step);
            let since = if met < self.step { met } else { force.since_zero(self.step) };
            add(&mut total, force, since);
        }
        total
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
            rate: self.stiffness * overlap.rate + damping * overlap.acceleration,
            acceleration: self.stiffness * overlap.acceleration,
        }
    }
}

impl<T: Real> Path<T> {
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

/// Adds the first three integrals over the last `since` of a path.
fn add<T: Real>(total: &mut [T; 3], path: Path<T>, since: T) {
    let Path { value, rate, acceleration } = path;
    let s = since;
    total[0] += s * (value - s * (rate * T::HALF - s * acceleration * T::SIXTH));
    total[1] += s * s * (value * T::HALF - s * (rate * T::THIRD - s * acceleration * T::EIGHTH));
    total[2] += s * s * s * (value * T::SIXTH - s * (rate * T::EIGHTH - s * acceleration * T::TWENTIETH));
}

fn smaller<T: Real>(a: T, b: T) -> T {
    if b < a { b } else { a }
}
