//! A tick in sub-steps, the path that is taken when contacts may change: each sub-step freezes the contact set, so
//! that its right-hand side is smooth, takes a Runge-Kutta step, and is corrected for every crossing that its end
//! reveals. With the tanh dead zone there is nothing to freeze and nothing to correct.

use crate::dead_zone;
use crate::real::Real;
use crate::realtime::contact::{Drive, Laws, acceleration, frozen_acceleration, spread, wind_up_force};
use crate::realtime::crossing::FrozenStep;
use crate::realtime::excitation::{Instant, MeshPhase, PerMesh, instant};
use crate::realtime::runge_kutta::{self, Motion};
use crate::tables::Tables;

/// One tick with a sharp dead zone.
pub fn sharp<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    phase: &MeshPhase<T>,
    start: &Instant<T, N>,
    laws: &Laws<T, N>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let half = phase.over(tables.half_part);
    let (mut motion, mut rotor, mut laws) = (*motion, phase.start, *laws);
    let mut at_start = laws.at(start);
    for _ in 0..tables.substeps {
        rotor = rotor.turned(&half);
        let at_middle = laws.at(&instant(tables, &rotor, phase.rate));
        rotor = rotor.turned(&half);
        let end = instant(tables, &rotor, phase.rate);
        let at_end = laws.at(&end);
        let nodes = [&at_start, &at_middle, &at_end];
        motion = runge_kutta::step(tables.substep, &motion, |node, position, rate| {
            frozen_acceleration(tables, drive, &laws.damping, nodes[node], position, rate)
        });
        let observed = laws.observe(&at_end, &motion, &end);
        if laws.hold(tables, &observed) {
            at_start = at_end;
        } else {
            let step = FrozenStep { step: tables.substep, phase_rate: phase.rate, observed: &observed };
            motion = step.correct(tables, drive, &end, &mut laws, &motion);
            at_start = laws.at(&end);
        }
    }
    motion
}

/// One tick with the tanh dead zone (eq. 13).
pub fn smoothed<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    drive: &Drive<T>,
    phase: &MeshPhase<T>,
    start: &Instant<T, N>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let half = phase.over(tables.half_part);
    let (mut motion, mut rotor, mut start) = (*motion, phase.start, *start);
    for _ in 0..tables.substeps {
        rotor = rotor.turned(&half);
        let middle = instant(tables, &rotor, phase.rate);
        rotor = rotor.turned(&half);
        let end = instant(tables, &rotor, phase.rate);
        let nodes = [&start, &middle, &end];
        motion = runge_kutta::step(tables.substep, &motion, |node, position, rate| {
            let forces = smoothed_forces(tables, &spread(position), &spread(rate), nodes[node]);
            acceleration(tables, drive, &forces, wind_up_force(tables, position, rate))
        });
        start = end;
    }
    motion
}

/// Mesh forces with the tanh dead zone, damping always acting; from mesh coordinates without imposed errors.
pub fn smoothed_forces<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    positions: &PerMesh<T, N>,
    rates: &PerMesh<T, N>,
    instant: &Instant<T, N>,
) -> PerMesh<T, N> {
    let mut forces = [[T::ZERO; N]; 2];
    for kind in 0..2 {
        for i in 0..N {
            let deflection = positions[kind][i] - instant.error[kind][i];
            let rate = rates[kind][i] - instant.error_rate[kind][i];
            let half_backlash = tables.meshes[kind][i].half_backlash;
            let elastic = dead_zone::smoothed(deflection, half_backlash, tables.sharpness);
            forces[kind][i] = instant.stiffness[kind][i] * elastic + tables.springs[kind].damping * rate;
        }
    }
    forces
}
