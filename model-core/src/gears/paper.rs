//! Method of the paper, for comparison: first-order exponential time differencing. One constant exponential advances each
//! sub-step; dead zone, ripple and imposed error act as a pseudo-force held at its value at the start of the sub-step.

#![allow(clippy::op_ref, reason = "a product by value would copy the table")]

use core::array;

use nalgebra::SVector;

use crate::gears::contact::{AppliedAcceleration, mesh_coordinates};
use crate::gears::excitation::{MAX_OVERTONES, MeshPhase, PerMesh, Phasor, mesh_excitations};
use crate::gears::full_forces::forces;
use crate::gears::state::{Motion, Relative};
use crate::gears::tables::{Inputs, Tables, TransitionTable};
use crate::numbers::Real;

/// Returns the motion after one tick.
#[inline(never)]
pub fn step<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    applied: &AppliedAcceleration<T>,
    phase: &MeshPhase<T>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let half = phase.phasor_over(tables.half_substep_share);
    let (mut motion, mut phasor) = (*motion, Phasor::at(phase.start));
    let mut now = mesh_excitations::<T, N, MAX_OVERTONES>(tables, phasor, phase.rate);
    for _ in 0..tables.substeps {
        let (positions, rates) = (mesh_coordinates(&motion.position), mesh_coordinates(&motion.rate));
        let mut force = forces(tables, &positions, &rates, &now);
        for kind in 0..2 {
            let spring = &tables.springs[kind];
            for i in 0..N {
                let linear = spring.stiffness * positions[kind][i] + spring.damping * rates[kind][i];
                force[kind][i] = linear - force[kind][i];
            }
        }
        let force = PseudoForce::new(tables.planet_share, &force);
        let free = Modes::from_motion(tables.planet_share, &motion).free(&tables.flow.whole, applied);
        motion = free.with([(&tables.flow.whole_constant, &force)]).motion();
        phasor = phasor.turned(&half).turned(&half);
        now = mesh_excitations::<T, N, MAX_OVERTONES>(tables, phasor, phase.rate);
    }
    motion
}

/// Pseudo-force as input of the flow.
struct PseudoForce<T, const N: usize> {
    /// Sums over planets: sun-planet, ring-planet.
    sums: [T; 2],
    /// Sun-planet minus ring-planet force of every planet, minus the mean over planets.
    apart: [T; N],
}

impl<T: Real, const N: usize> PseudoForce<T, N> {
    #[inline]
    fn new(share: T, force: &PerMesh<T, N>) -> Self {
        let sums = [total(&force[0]), total(&force[1])];
        let mean = share * (sums[0] - sums[1]);
        let mut apart = force[0];
        for (value, ring) in apart.iter_mut().zip(&force[1]) {
            *value = *value - *ring - mean;
        }
        Self { sums, apart }
    }
}

/// Motion split into in-phase motion and the planets' deviations from the mean, which the flow decouples.
#[derive(Clone, Copy)]
struct Modes<T: Real, const N: usize> {
    in_phase: SVector<T, 6>,
    deviations: [SVector<T, 2>; N],
}

impl<T: Real, const N: usize> Modes<T, N> {
    #[inline]
    fn from_motion(share: T, motion: &Motion<T, N>) -> Self {
        let Motion { position, rate } = motion;
        let mean = share * total(&position.planets);
        let mean_rate = share * total(&rate.planets);
        Self {
            in_phase: SVector::from([mean, position.gap, position.wind_up, mean_rate, rate.gap, rate.wind_up]),
            deviations: array::from_fn(|i| SVector::from([position.planets[i] - mean, rate.planets[i] - mean_rate])),
        }
    }

    /// Returns the motion after the linear flow under constant torques.
    #[inline]
    fn free(&self, transition: &TransitionTable<T>, applied: &AppliedAcceleration<T>) -> Self {
        let torques = SVector::from([applied.sun, applied.carrier, applied.link]);
        Self {
            in_phase: self.in_phase + (&transition.in_phase.0 * &self.in_phase + &transition.torques.0 * &torques),
            deviations: array::from_fn(|i| self.deviations[i] + &transition.deviation.0 * &self.deviations[i]),
        }
    }

    /// Adds the response to pseudo-forces, each with its weight function of time.
    #[inline]
    fn with<const K: usize>(&self, terms: [(&Inputs<T>, &PseudoForce<T, N>); K]) -> Self {
        let mut sum = *self;
        for (inputs, force) in terms {
            sum.in_phase += &inputs.in_phase.0 * SVector::from(force.sums);
            let [value, rate] = inputs.deviation;
            for (deviation, apart) in sum.deviations.iter_mut().zip(&force.apart) {
                deviation[0] += value * *apart;
                deviation[1] += rate * *apart;
            }
        }
        sum
    }

    #[inline]
    fn motion(&self) -> Motion<T, N> {
        let [mean, gap, wind_up, mean_rate, gap_rate, wind_up_rate] = self.in_phase.data.0[0];
        Motion {
            position: Relative { planets: array::from_fn(|i| mean + self.deviations[i][0]), gap, wind_up },
            rate: Relative {
                planets: array::from_fn(|i| mean_rate + self.deviations[i][1]),
                gap: gap_rate,
                wind_up: wind_up_rate,
            },
        }
    }
}

fn total<T: Real, const N: usize>(values: &[T; N]) -> T {
    values.iter().fold(T::ZERO, |sum, value| sum + *value)
}
