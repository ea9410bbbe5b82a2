//! Tables of the leapfrog sub-steps.
use crate::joint::JointParameters;
use crate::mesh::MESH_KINDS;
use crate::real::Real;
use crate::scales::Scales;
use crate::tables::{Light, Mobility};

/// Tables for so many sub-steps of a tick (dimensionless).
pub fn light<T: Real>(parameters: &JointParameters, scales: &Scales, unit: Mobility<T>, tick: f64, substeps: u32) -> Light<T> {
    let real = T::from_f64;
    let substep = tick / f64::from(substeps.max(1));
    let square = substep * substep;
    let scaled = |value: T| real(value.to_f64() * square);
    let damping = MESH_KINDS.map(|kind| scales.damping(parameters.damping_coefficient(kind)) / substep);
    let stiffness = MESH_KINDS.map(|kind| parameters.mesh(kind).mean_stiffness / scales.stiffness);
    Light {
        substeps,
        half_count: real(0.5 * f64::from(substeps)),
        substep: real(substep),
        square: real(square),
        per_substep: real(1.0 / substep),
        mobility: Mobility {
            sun: scaled(unit.sun), planet: scaled(unit.planet), carrier: scaled(unit.carrier), link: scaled(unit.link),
            wind_up: unit.wind_up, wind_up_stiffness: unit.wind_up_stiffness,
            wind_up_damping: real(unit.wind_up_damping.to_f64() / substep),
        },
        wind_up_yield: {
            let half = 0.5 * unit.wind_up_damping.to_f64() / substep;
            real(half / (1.0 + half * square * (unit.carrier.to_f64() + unit.link.to_f64())))
        },
        damping: damping.map(real),
        release: [0, 1].map(|kind| {
            let ratio = damping[kind] / stiffness[kind];
            [real(0.5 + 2.0 * ratio), real(ratio / stiffness[kind])]
        }),
        softness: [0, 1].map(|kind| {
            [real(1.0 / 12.0), real(0.5 * damping[kind])]
        }),
    }
}
