//! Correction of a sub-step for meshes that parted or met inside it, from the end of the sub-step alone. Known from
//! real-time simulation as in-step correction of a switched right-hand side (R. M. Howe, Dynamics of Real-Time
//! Simulation, ch. 11); a mesh that leaves and returns within one sub-step is not seen.
//!
//! After the crossing, s before the end, the frozen law misses a force m. Near the end m(t) is known to second order,
//! so its first three integrals over [t - s, t] are closed forms; they correct rate, position and the integral of the
//! position. These corrections deform the other meshes too: one linear pass adds the forces that this causes.

use core::array;

use crate::real::Real;
use crate::realtime::excitation::Instants;
use crate::realtime::mesh_force::{
    Deflection, Drive, Law, PerMesh, acceleration, deflections, kinematic_deflections, wind_up_force,
};
use crate::realtime::substep::{Motion, laws};
use crate::tables::Tables;

/// Motion at the end of a sub-step, corrected for every mesh whose law there is not the frozen one.
#[inline]
pub fn correct<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    phase_rate: T,
    instants: &Instants<T, N>,
    frozen: &PerMesh<Law<T>, N>,
    end: Motion<T, N>,
) -> Motion<T, N> {
    let reached = deflections(&end.position, &end.rate, instants);
    let held = laws(tables, &reached, instants);
    if held == *frozen {
        return end;
    }
    let frozen_forces: PerMesh<T, N> =
        array::from_fn(|kind| array::from_fn(|i| frozen[kind][i].force(reached[kind][i], &instants[kind][i])));
    let wind_up = wind_up_force(tables, &end.position, &end.rate);
    let accelerations = acceleration(tables, drive, &frozen_forces, wind_up);
    let spread = kinematic_deflections(&end.rate, &accelerations);
    let force_rates = array::from_fn(|kind| {
        array::from_fn(|i| {
            let law = Law { offset: T::ZERO, ..frozen[kind][i] };
            law.force(spread[kind][i], &instants[kind][i])
        })
    });
    let jerks = acceleration(tables, &Drive::NONE, &force_rates, wind_up_force(tables, &end.rate, &accelerations));
    let spread = kinematic_deflections(&accelerations, &jerks);
    // e'' = -rate^2 e for the sine of eq. 11.
    let square = phase_rate * phase_rate;
    let mut missed: [PerMesh<T, N>; 3] = [[[T::ZERO; N]; 2]; 3];
    for kind in 0..2 {
        for i in 0..N {
            if held[kind][i] == frozen[kind][i] {
                continue;
            }
            let mesh = Crossing {
                deflection: reached[kind][i],
                acceleration: spread[kind][i].value + square * instants[kind][i].error,
                jerk: spread[kind][i].rate + square * instants[kind][i].error_rate,
                stiffness: instants[kind][i].stiffness,
                substep: tables.substep,
            };
            let integrals = mesh.missed(&frozen[kind][i], &held[kind][i]);
            for (integral, value) in missed.iter_mut().zip(integrals) {
                integral[kind][i] = value;
            }
        }
    }
    let [rate, position, integral] = missed.map(|force| acceleration(tables, &Drive::NONE, &force, T::ZERO));
    // Damping feels the rates first, so its share of the position comes before the sum of all.
    let bent = kinematic_deflections(&position, &integral);
    let damped = array::from_fn(|kind| array::from_fn(|i| held[kind][i].damping * bent[kind][i].rate));
    let wind_up_damped = tables.mobility.wind_up_damping * integral.wind_up;
    let position = position.plus(T::ONE, &acceleration(tables, &Drive::NONE, &damped, wind_up_damped));
    let bent = kinematic_deflections(&integral, &position);
    let bent_forces = array::from_fn(|kind| {
        array::from_fn(|i| {
            let law = Law { offset: T::ZERO, ..held[kind][i] };
            law.force(bent[kind][i], &instants[kind][i])
        })
    });
    let later = acceleration(tables, &Drive::NONE, &bent_forces, wind_up_force(tables, &integral, &position));
    Motion { position: end.position.plus(T::ONE, &position), rate: end.rate.plus(T::ONE, &rate).plus(T::ONE, &later) }
}

/// One mesh at the end of a sub-step, on the path that the frozen laws gave.
struct Crossing<T> {
    deflection: Deflection<T>,
    acceleration: T,
    jerk: T,
    stiffness: T,
    substep: T,
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
    fn missed(&self, frozen: &Law<T>, held: &Law<T>) -> [T; 3] {
        // Damping that acts whatever the contact cancels out; what is left acts in contact only.
        let base = if frozen.closed && held.closed { T::ZERO } else { smaller(frozen.damping, held.damping) };
        let mut total = [T::ZERO; 3];
        if frozen.closed {
            let force = self.force(frozen, base);
            let since = force.since_zero(self.substep);
            add(&mut total, Path { value: -force.value, rate: -force.rate, acceleration: -force.acceleration }, since);
        }
        if held.closed {
            let force = self.force(held, base);
            // Contact began when the surfaces met, or, between surfaces already overlapping, when the force turned.
            let met = self.overlap(held).since_zero(self.substep);
            let turned = force.since_zero(self.substep);
            add(&mut total, force, smaller(met, turned));
        }
        total
    }

    fn overlap(&self, law: &Law<T>) -> Path<T> {
        Path { value: self.deflection.value - law.offset, rate: self.deflection.rate, acceleration: self.acceleration }
    }

    /// Contact force under a law less the damping that acts anyway; its damping part is taken as linear in time.
    fn force(&self, law: &Law<T>, base: T) -> Path<T> {
        let damping = law.damping - base;
        let overlap = self.overlap(law);
        Path {
            value: self.stiffness * overlap.value + damping * overlap.rate,
            rate: self.stiffness * overlap.rate + damping * overlap.acceleration,
            acceleration: self.stiffness * overlap.acceleration + damping * self.jerk,
        }
    }
}

impl<T: Real> Path<T> {
    /// How long before the end the path was zero: a secant and one Newton step, within the sub-step. Paths that give
    /// no answer (they do not point away from zero) are given the whole sub-step, where they are small.
    fn since_zero(&self, substep: T) -> T {
        let sign = if self.value < T::ZERO { -T::ONE } else { T::ONE };
        let (value, rate, acceleration) = (sign * self.value, sign * self.rate, sign * self.acceleration);
        if value >= rate * substep {
            return if rate > T::ZERO { newton(value, rate, acceleration, substep, substep) } else { substep };
        }
        // Here rate * substep > value >= 0, so the quotient is within the sub-step.
        newton(value, rate, acceleration, value.over(rate), substep)
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
