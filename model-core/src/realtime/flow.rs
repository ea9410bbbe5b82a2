//! Exponential flow of the closed joint. `hold` takes a whole tick while every mesh stays on its flank: linear motion
//! exactly, ripple and imposed error as a pseudo-force quadratic in time. `paper` is the paper's own scheme: the same
//! flow, with everything nonlinear as a pseudo-force held over the step.

#![allow(clippy::op_ref, reason = "a product by value would copy the table")]

use core::array;

use nalgebra::SVector;

use crate::mesh::DampingLaw;
use crate::real::Real;
use crate::realtime::excitation::Instants;
use crate::realtime::mesh_force::{
    Deflection, Drive, Law, PerMesh, deflections, kinematic_deflections, smoothed_force,
};
use crate::realtime::state::Relative;
use crate::realtime::substep::{Motion, Nodes, laws};
use crate::tables::{Inputs, Tables, Transition};

/// One tick with the contact set of its start; `None` if the set cannot be shown to hold.
#[inline]
pub fn hold<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    nodes: Nodes<'_, T, N>,
    motion: &Motion<T, N>,
) -> Option<Motion<T, N>> {
    if tables.sharpness > T::ZERO {
        return None;
    }
    let at_start = deflections(&motion.position, &motion.rate, nodes[0]);
    let laws = laws(tables, &at_start, nodes[0]);
    if !holds(tables, &laws, &at_start, nodes[0]) {
        return None;
    }
    let flow = &tables.flow;
    let modes = Modes::of(tables.planet_share, motion);
    let start = pseudo_force(tables, &laws, motion, nodes[0]);

    let middle = modes.free(&flow.half, drive).with([(&flow.half_constant, &start)]).motion();
    if !holds(tables, &laws, &deflections(&middle.position, &middle.rate, nodes[1]), nodes[1]) {
        return None;
    }
    let middle = pseudo_force(tables, &laws, &middle, nodes[1]);

    let free = modes.free(&flow.whole, drive);
    let [from_start, from_middle] = &flow.whole_linear;
    let end = free.with([(from_start, &start), (from_middle, &middle)]).motion();
    let end = pseudo_force(tables, &laws, &end, nodes[2]);

    let [from_start, from_middle, from_end] = &flow.whole_quadratic;
    let end = free.with([(from_start, &start), (from_middle, &middle), (from_end, &end)]).motion();
    holds(tables, &laws, &deflections(&end.position, &end.rate, nodes[2]), nodes[2]).then_some(end)
}

/// The paper's step: constant exponential, pseudo-force held (first-order exponential time differencing).
#[inline]
pub fn paper<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    instants: &Instants<T, N>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let actual = deflections(&motion.position, &motion.rate, instants);
    let linear = kinematic_deflections(&motion.position, &motion.rate);
    let force = array::from_fn(|kind| {
        let spring = &tables.springs[kind];
        array::from_fn(|i| {
            let instant = &instants[kind][i];
            let true_force = if tables.sharpness > T::ZERO {
                smoothed_force(tables, kind, i, actual[kind][i], instant)
            } else {
                Law::of(tables, kind, i, actual[kind][i], instant).force(actual[kind][i], instant)
            };
            spring.stiffness * linear[kind][i].value + spring.damping * linear[kind][i].rate - true_force
        })
    });
    let free = Modes::of(tables.planet_share, motion).free(&tables.flow.whole, drive);
    free.with([(&tables.flow.whole_constant, &force)]).motion()
}

/// Every mesh is closed, and too far from opening for its speed to open it between two nodes.
fn holds<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    laws: &PerMesh<Law<T>, N>,
    deflections: &PerMesh<Deflection<T>, N>,
    instants: &Instants<T, N>,
) -> bool {
    let reach = tables.flow.reach;
    (0..2).all(|kind| {
        (0..N).all(|i| {
            let law = &laws[kind][i];
            let Deflection { value, rate } = deflections[kind][i];
            let drive_side = value > T::ZERO;
            let overlap = if drive_side { value - law.offset } else { law.offset - value };
            let speed = if rate < T::ZERO { -rate } else { rate };
            let pushes = match tables.damping_law {
                DampingLaw::Paper => true,
                DampingLaw::Contact => (law.force(deflections[kind][i], &instants[kind][i]) > T::ZERO) == drive_side,
            };
            law.closed && overlap > reach * speed && pushes
        })
    })
}

/// What the linear flow does not know of closed meshes: offset, imposed error, ripple.
fn pseudo_force<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    laws: &PerMesh<Law<T>, N>,
    motion: &Motion<T, N>,
    instants: &Instants<T, N>,
) -> PerMesh<T, N> {
    let linear = kinematic_deflections(&motion.position, &motion.rate);
    array::from_fn(|kind| {
        let spring = &tables.springs[kind];
        array::from_fn(|i| {
            let instant = &instants[kind][i];
            let offset = laws[kind][i].offset + instant.error;
            (spring.stiffness - instant.stiffness) * linear[kind][i].value
                + instant.stiffness * offset
                + spring.damping * instant.error_rate
        })
    })
}

/// Motion split into what the planets do together and what each does apart, which the flow keeps apart.
#[derive(Clone, Copy)]
struct Modes<T: Real, const N: usize> {
    /// 1/N.
    share: T,
    in_phase: SVector<T, 6>,
    deviations: [SVector<T, 2>; N],
}

impl<T: Real, const N: usize> Modes<T, N> {
    fn of(share: T, motion: &Motion<T, N>) -> Self {
        let Motion { position, rate } = motion;
        let mean = share * total(&position.planets);
        let mean_rate = share * total(&rate.planets);
        Self {
            share,
            in_phase: SVector::from([mean, position.gap, position.wind_up, mean_rate, rate.gap, rate.wind_up]),
            deviations: array::from_fn(|i| SVector::from([position.planets[i] - mean, rate.planets[i] - mean_rate])),
        }
    }

    /// Linear flow under constant torques.
    fn free(&self, transition: &Transition<T>, drive: &Drive<T>) -> Self {
        let torques = SVector::from([drive.sun, drive.carrier, drive.link]);
        Self {
            share: self.share,
            in_phase: self.in_phase + (&transition.in_phase.0 * &self.in_phase + &transition.torques.0 * &torques),
            deviations: array::from_fn(|i| self.deviations[i] + &transition.deviation.0 * &self.deviations[i]),
        }
    }

    /// Plus the response to pseudo-forces, each under its time weight.
    fn with<const K: usize>(&self, terms: [(&Inputs<T>, &PerMesh<T, N>); K]) -> Self {
        let mut sum = *self;
        for (inputs, force) in terms {
            let sums = SVector::from([total(&force[0]), total(&force[1])]);
            sum.in_phase += &inputs.in_phase.0 * &sums;
            let middle = (sums[0] - sums[1]) * self.share;
            let [value, rate] = inputs.deviation;
            for (i, deviation) in sum.deviations.iter_mut().enumerate() {
                let apart = force[0][i] - force[1][i] - middle;
                *deviation += SVector::from([value * apart, rate * apart]);
            }
        }
        sum
    }

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
