//! One sub-step of the path that is taken when contacts may change: the classical fourth-order Runge-Kutta method
//! with every mesh's contact frozen, so that the right-hand side is smooth, then a correction for each crossing that
//! the end of the sub-step reveals. With the tanh dead zone there is nothing to freeze and nothing to correct.

use core::array;

use crate::real::Real;
use crate::realtime::crossing;
use crate::realtime::excitation::Instants;
use crate::realtime::mesh_force::{
    Deflection, Drive, Law, PerMesh, acceleration, deflections, smoothed_force, wind_up_force,
};
use crate::realtime::state::Relative;
use crate::tables::Tables;

/// Position and rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<T, const N: usize> {
    /// Relative coordinates.
    pub position: Relative<T, N>,
    /// Their rates.
    pub rate: Relative<T, N>,
}

/// Meshes at start, middle and end of a sub-step.
pub type Nodes<'a, T, const N: usize> = [&'a Instants<T, N>; 3];

/// Advances the motion by one sub-step.
#[inline]
pub fn advance<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    phase_rate: T,
    nodes: Nodes<'_, T, N>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let start = deflections(&motion.position, &motion.rate, nodes[0]);
    if tables.sharpness > T::ZERO {
        return runge_kutta(tables, drive, nodes, motion, &start, |kind, i, deflection, instants| {
            smoothed_force(tables, kind, i, deflection, &instants[kind][i])
        });
    }
    let laws = laws(tables, &start, nodes[0]);
    let end = runge_kutta(tables, drive, nodes, motion, &start, |kind, i, deflection, instants| {
        laws[kind][i].force(deflection, &instants[kind][i])
    });
    crossing::correct(tables, drive, phase_rate, nodes[2], &laws, end)
}

/// The law that each mesh is under.
#[inline]
pub fn laws<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    deflections: &PerMesh<Deflection<T>, N>,
    instants: &Instants<T, N>,
) -> PerMesh<Law<T>, N> {
    array::from_fn(|kind| array::from_fn(|i| Law::of(tables, kind, i, deflections[kind][i], &instants[kind][i])))
}

#[inline]
fn runge_kutta<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    nodes: Nodes<'_, T, N>,
    motion: &Motion<T, N>,
    start: &PerMesh<Deflection<T>, N>,
    force: impl Fn(usize, usize, Deflection<T>, &Instants<T, N>) -> T,
) -> Motion<T, N> {
    let evaluate = |at: &PerMesh<Deflection<T>, N>, motion: &Motion<T, N>, instants: &Instants<T, N>| {
        let forces = array::from_fn(|kind| array::from_fn(|i| force(kind, i, at[kind][i], instants)));
        acceleration(tables, drive, &forces, wind_up_force(tables, &motion.position, &motion.rate))
    };
    let Motion { position, rate } = motion;
    let step = tables.substep;
    let half = step * T::HALF;
    let quarter_square = half * half;
    let half_square = half * step;
    let [at_start, at_middle, at_end] = nodes;

    let first = evaluate(start, motion, at_start);
    let coasted = position.plus(half, rate);
    let second_at = Motion { position: coasted, rate: rate.plus(half, &first) };
    let second = evaluate(&deflections(&second_at.position, &second_at.rate, at_middle), &second_at, at_middle);
    let third_at = Motion { position: coasted.plus(quarter_square, &first), rate: rate.plus(half, &second) };
    let third = evaluate(&deflections(&third_at.position, &third_at.rate, at_middle), &third_at, at_middle);
    let fourth_at =
        Motion { position: position.plus(step, rate).plus(half_square, &second), rate: rate.plus(step, &third) };
    let fourth = evaluate(&deflections(&fourth_at.position, &fourth_at.rate, at_end), &fourth_at, at_end);

    let middle = second.plus(T::ONE, &third);
    let sixth = step * T::SIXTH;
    Motion {
        position: position.plus(step, rate).plus(step * sixth, &first.plus(T::ONE, &middle)),
        rate: rate.plus(sixth, &first.plus(T::TWO, &middle).plus(T::ONE, &fourth)),
    }
}
