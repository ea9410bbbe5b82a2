//! Classical Runge-Kutta method and semi-implicit Euler on the full nonlinear forces, without crossing correction.
//! Runge-Kutta is the step of the tanh dead zone, which has no contact set; with the sharp dead zone both methods serve
//! for comparison.

use crate::gears::contact::{AppliedAcceleration, Law, acceleration, mesh_coordinates, wind_up_force};
use crate::gears::dead_zone;
use crate::gears::excitation::{MAX_OVERTONES, MeshExcitations, MeshPhase, PerMesh, Phasor, mesh_excitations};
use crate::gears::runge_kutta;
use crate::gears::state::{Motion, Relative};
use crate::gears::tables::Tables;
use crate::numbers::Real;

/// Returns the motion after one tick of the classical Runge-Kutta method.
#[inline(never)]
pub fn runge_kutta<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    applied: &AppliedAcceleration<T>,
    phase: &MeshPhase<T>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let half = phase.phasor_over(tables.half_substep_share);
    let (mut motion, mut phasor) = (*motion, Phasor::at(phase.start));
    let mut start = mesh_excitations::<T, N, MAX_OVERTONES>(tables, phasor, phase.rate);
    for _ in 0..tables.substeps {
        phasor = phasor.turned(&half);
        let middle = mesh_excitations::<T, N, MAX_OVERTONES>(tables, phasor, phase.rate);
        phasor = phasor.turned(&half);
        let end = mesh_excitations::<T, N, MAX_OVERTONES>(tables, phasor, phase.rate);
        let nodes = [&start, &middle, &end];
        motion = runge_kutta::step(tables.substep, &motion, |node, position, rate| {
            forced(tables, applied, position, rate, nodes[node])
        });
        start = end;
    }
    motion
}

/// Returns the motion after one tick of semi-implicit Euler: first the rate, then the position with the new rate.
#[cfg(feature = "design")]
#[inline(never)]
pub fn semi_implicit_euler<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    applied: &AppliedAcceleration<T>,
    phase: &MeshPhase<T>,
    motion: &Motion<T, N>,
) -> Motion<T, N> {
    let half = phase.phasor_over(tables.half_substep_share);
    let (mut motion, mut phasor) = (*motion, Phasor::at(phase.start));
    let mut now = mesh_excitations::<T, N, MAX_OVERTONES>(tables, phasor, phase.rate);
    for _ in 0..tables.substeps {
        let acceleration = forced(tables, applied, &motion.position, &motion.rate, &now);
        let rate = motion.rate.plus(tables.substep, &acceleration);
        motion = Motion { position: motion.position.plus(tables.substep, &rate), rate };
        phasor = phasor.turned(&half).turned(&half);
        now = mesh_excitations::<T, N, MAX_OVERTONES>(tables, phasor, phase.rate);
    }
    motion
}

/// Returns the relative accelerations at one instant.
fn forced<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    applied: &AppliedAcceleration<T>,
    position: &Relative<T, N>,
    rate: &Relative<T, N>,
    mesh_excitations: &MeshExcitations<T, N>,
) -> Relative<T, N> {
    let forces = forces(tables, &mesh_coordinates(position), &mesh_coordinates(rate), mesh_excitations);
    acceleration(tables, applied, &forces, wind_up_force(tables, position, rate))
}

/// Returns the mesh forces with the joint's dead zone, sharp or tanh, from mesh coordinates without imposed errors. With
/// the tanh dead zone, which has no contact states, damping always acts.
pub fn forces<T: Real, const N: usize>(
    tables: &Tables<T, N>,
    positions: &PerMesh<T, N>,
    rates: &PerMesh<T, N>,
    mesh_excitations: &MeshExcitations<T, N>,
) -> PerMesh<T, N> {
    let mut forces = [[T::ZERO; N]; 2];
    for kind in 0..2 {
        for i in 0..N {
            let deflection = positions[kind][i] - mesh_excitations.error[kind][i];
            let speed = rates[kind][i] - mesh_excitations.error_rate[kind][i];
            let stiffness = mesh_excitations.stiffness[kind][i];
            forces[kind][i] = if tables.sharpness > T::ZERO {
                let half_backlash = tables.meshes[kind][i].half_backlash;
                let elastic = dead_zone::smoothed(deflection, half_backlash, tables.sharpness);
                stiffness * elastic + tables.springs[kind].damping * speed
            } else {
                // The unit of time of a law is a sub-step.
                let speed = tables.substep * speed;
                let law = Law::at_deflection(tables, (kind, i), deflection, speed, stiffness);
                law.closed * stiffness * (deflection - law.offset) + law.damping * speed
            };
        }
    }
    forces
}
