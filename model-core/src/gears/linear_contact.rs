//! Exponential tick of light planets (S8), for ticks in which every mesh is in contact on one flank: the joint is linear.
//! Ripple and imposed error act as a pseudo-force, linear in time through its values at the start and in the middle.
//!
//! Condition (S13), checked at the start alone: a light planet oscillates about its balance between sun and ring. If it
//! presses more on the sun than on the ring now, it presses more on the ring half a period later. Both meshes therefore
//! stay closed if the smaller overlap exceeds the distance that the larger speed can open.

#![allow(clippy::op_ref, reason = "a product by value would copy the table")]

use nalgebra::SVector;

use crate::gears::contact::AppliedAcceleration;
use crate::gears::excitation::{MeshPhase, PerMesh, Phasor};
use crate::gears::state::MotionInPlace;
use crate::gears::tables::Tables;
use crate::numbers::Real;

/// Advances the motion in place by one tick. Returns false and leaves the motion unchanged if the phase advances too far
/// or a planet violates (S13).
#[inline(never)]
pub fn tick<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    applied: &AppliedAcceleration<T>,
    phase: &MeshPhase<T>,
    middle: &Phasor<T>,
    stiffness: &PerMesh<T, N>,
    motion: &mut MotionInPlace<T, N>,
) -> bool {
    let flow = &tables.flow;
    let (position, rate) = (&*motion.position, &*motion.rate);
    if phase.advance.abs() >= flow.longest_advance {
        return false;
    }
    let half_step = T::HALF * flow.step;
    let rates = middle.rates(phase.rate);
    let first = middle.moved(-half_step, &rates);
    let side = if position.gap < T::ZERO { -T::ONE } else { T::ONE };
    // Pseudo-force of each mesh: its factor on the coordinate [0], its value at the start [1], and its part in the middle
    // that does not depend on the coordinate [2].
    let mut from = [[[T::ZERO; N]; 2]; 3];
    for i in 0..N {
        let (x, u) = (position.planets[i], rate.planets[i]);
        let meshes = [&tables.meshes[0][i], &tables.meshes[1][i]];
        let (at, speed) = ([x, position.gap - x], [u, rate.gap - u]);
        let error_rate = meshes.map(|mesh| mesh.error_at(&rates));
        let offset = meshes.map(|mesh| side * mesh.half_backlash);
        // Coordinate at which each mesh touches its flank at the start.
        let flank = [0, 1].map(|kind| offset[kind] + meshes[kind].error_at(&first));
        let [sun, ring] = [0, 1].map(|kind| side * (at[kind] - flank[kind]));
        let twice_lesser = sun + ring - (sun - ring).abs();
        let [sun, ring] = [0, 1].map(|kind| speed[kind] - error_rate[kind]);
        let twice_greater = (sun + ring).abs() + (sun - ring).abs();
        if twice_lesser <= flow.reach * twice_greater {
            return false;
        }
        for kind in 0..2 {
            let stiffness = stiffness[kind][i];
            let spring = &tables.springs[kind];
            let viscous = spring.damping * error_rate[kind];
            from[0][kind][i] = spring.stiffness - stiffness;
            from[1][kind][i] = from[0][kind][i] * at[kind] + stiffness * flank[kind] + viscous;
            from[2][kind][i] = stiffness * (offset[kind] + meshes[kind].error_at(middle)) + viscous;
        }
    }
    let share = tables.planet_share;
    let start = PseudoForce::new(share, &from[1]);
    // Imposed errors change over the first half of the tick; their value in the middle of this half is the mean.
    let mut forces = from[1];
    for kind in 0..2 {
        for i in 0..N {
            forces[kind][i] += T::HALF * half_step * stiffness[kind][i] * tables.meshes[kind][i].error_at(&rates);
        }
    }
    let early = PseudoForce::new(share, &forces);

    let torques = SVector::from([applied.sun, applied.carrier, applied.link]);
    let (mean, mean_rate) = (share * total(&position.planets), share * total(&rate.planets));
    let in_phase = SVector::from([mean, position.gap, position.wind_up, mean_rate, rate.gap, rate.wind_up]);

    // Planets and gap in the middle of the tick.
    let half = &flow.half;
    let sums = SVector::from(start.sums);
    let early_sums = SVector::from(early.sums);
    let row = |row: usize| {
        in_phase[row]
            + (half.in_phase.0.row(row) * &in_phase)[0]
            + (half.torques.0.row(row) * &torques)[0]
            + (flow.half_constant.in_phase.0.row(row) * &early_sums)[0]
    };
    let (middle_mean, middle_gap) = (row(0), row(1));
    let [[own, _], [by_rate, _]] = half.deviation.0.data.0;
    let by_force = flow.half_constant.deviation[0];
    let mut forces = from[2];
    for i in 0..N {
        let (deviation, speed) = (position.planets[i] - mean, rate.planets[i] - mean_rate);
        let x = middle_mean + deviation + own * deviation + by_rate * speed + by_force * early.apart[i];
        let y = middle_gap - x;
        forces[0][i] += from[0][0][i] * x;
        forces[1][i] += from[0][1][i] * y;
    }
    let middle = PseudoForce::new(share, &forces);

    let whole = &flow.whole;
    let [first, second] = &flow.whole_linear;
    // Summing the changes before adding them to the state rounds the state only once.
    let change = &whole.in_phase.0 * &in_phase
        + &whole.torques.0 * &torques
        + &first.in_phase.0 * &sums
        + &second.in_phase.0 * SVector::from(middle.sums);
    let [mean_change, gap, wind_up, mean_rate_change, gap_rate, wind_up_rate] = change.data.0[0];
    let [[a, b], [c, d]] = whole.deviation.0.data.0;
    for i in 0..N {
        let (deviation, speed) = (motion.position.planets[i] - mean, motion.rate.planets[i] - mean_rate);
        let (from_start, from_middle) = (start.apart[i], middle.apart[i]);
        motion.position.planets[i] += mean_change
            + (a * deviation + c * speed)
            + (first.deviation[0] * from_start + second.deviation[0] * from_middle);
        motion.rate.planets[i] += mean_rate_change
            + (b * deviation + d * speed)
            + (first.deviation[1] * from_start + second.deviation[1] * from_middle);
    }
    motion.position.gap += gap;
    motion.position.wind_up += wind_up;
    motion.rate.gap += gap_rate;
    motion.rate.wind_up += wind_up_rate;
    true
}

/// Pseudo-force as input of the flow.
struct PseudoForce<T, const N: usize> {
    /// Sums over planets: sun-planet, ring-planet.
    sums: [T; 2],
    /// Sun-planet minus ring-planet force of every planet, minus the mean over planets.
    apart: [T; N],
}

impl<T: Real, const N: usize> PseudoForce<T, N> {
    #[inline(always)]
    fn new(share: T, force: &[[T; N]; 2]) -> Self {
        let sums = [total(&force[0]), total(&force[1])];
        let mean = share * (sums[0] - sums[1]);
        let mut apart = force[0];
        for (value, ring) in apart.iter_mut().zip(&force[1]) {
            *value = *value - *ring - mean;
        }
        Self { sums, apart }
    }
}

#[inline(always)]
fn total<T: Real, const N: usize>(values: &[T; N]) -> T {
    values.iter().fold(T::ZERO, |sum, value| sum + *value)
}
