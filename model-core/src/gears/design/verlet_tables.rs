//! Tables of the position-Verlet (leapfrog) sub-steps of light planets (S11), (S12); the unit of time is a sub-step.

use crate::gears::mechanics::Mechanics;
use crate::gears::scales::Scales;
use crate::gears::tables::{Mobility, VerletTable};
use crate::numbers::Real;
use parameters::{JointParameters, MESH_KINDS};

/// Computes the tables for a tick of dimensionless length `tick` in `substeps` sub-steps.
pub fn verlet<T: Real>(parameters: &JointParameters, unit: &Mobility<f64>, tick: f64, substeps: u32) -> VerletTable<T> {
    let scales = Scales::new(parameters);
    let real = T::from_f64;
    let count = f64::from(substeps.max(1));
    let substep = tick / count;
    let square = substep * substep;
    let damping = MESH_KINDS.map(|kind| scales.damping(parameters.damping_coefficient(kind)) / substep);
    let wind_up_damping = unit.wind_up_damping / substep;
    let wind_up_mobility = square * (unit.carrier + unit.link);
    VerletTable {
        substeps,
        half_count: real(0.5 * count),
        substep: real(substep),
        square: real(square),
        per_substep: real(1.0 / substep),
        mobility: Mobility {
            sun: real(square * unit.sun),
            planet: real(square * unit.planet),
            carrier: real(square * unit.carrier),
            link: real(square * unit.link),
            wind_up: real(unit.wind_up),
            wind_up_stiffness: real(unit.wind_up_stiffness),
            wind_up_damping: real(wind_up_damping),
        },
        wind_up_mobility: real(wind_up_mobility),
        wind_up_yield: real(0.5 * wind_up_damping / (1.0 + 0.5 * wind_up_damping * wind_up_mobility)),
        damping: damping.map(real),
        half_damped: damping.map(|value| real(0.5 * value)),
        // Makes the frequencies of the method exact to fourth order (modified potential of Takahashi and Imada).
        curvature: real(1.0 / 12.0),
        release: [0, 1].map(|kind| {
            let stiffness = parameters.mesh(MESH_KINDS[kind]).mean_stiffness / scales.stiffness;
            // c / k = c / k_mean (2 - k / k_mean) to first order in the ripple.
            let early = damping[kind] / stiffness;
            [real(0.5 + 2.0 * early), real(early / stiffness)]
        }),
    }
}
