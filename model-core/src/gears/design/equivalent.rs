//! Tables of an equivalent gear: a joint with one massless planet, reduced to the gap and one contact. Entries of planets
//! and sub-steps are zero.

use core::array;

use nalgebra::{DMatrix, SMatrix};

use crate::gears::design::dynamics::MovingMasses;
use crate::gears::design::exponential;
use crate::gears::mechanics::Mechanics;
use crate::gears::scales::Scales;
use crate::gears::tables::{
    Block, Excitation, FlowTable, Inputs, MeshTable, Mobility, Rigid, Scheme, Spring, StageTable, Tables,
    TransitionTable, UnitTable, VerletTable,
};
use crate::numbers::Real;
use parameters::{JointParameters, MAX_HARMONICS, MESH_KINDS, MeshKind};

/// Largest phase of the contact's oscillation per tick [rad]. Up to this phase a contact lasts at least four ticks, and the
/// error of a part of a tick in contact, t^5 / 720, is below 3e-4 of the motion.
pub const LARGEST_PHASE: f64 = 0.7;

/// Computes the tables at a tick rate; `units` and `rigid` are those of every gear.
pub fn tables<T: Real, const N: usize>(
    parameters: &JointParameters,
    tick_rate: u32,
    units: UnitTable<T>,
    rigid: Rigid<T>,
) -> Tables<T, N> {
    let real = T::from_f64;
    let (scales, masses) = (Scales::new(parameters), MovingMasses::new(parameters));
    let step = scales.frequency / f64::from(tick_rate);
    let spring = |kind: MeshKind| Spring {
        stiffness: real(parameters.mesh(kind).mean_stiffness / scales.stiffness),
        damping: real(scales.damping(parameters.damping_coefficient(kind))),
    };
    let mesh = |kind: MeshKind, planet: usize| MeshTable {
        half_backlash: real(parameters.mesh(kind).half_backlash[planet] / scales.length),
        error: [T::ZERO; 2],
        ripple: [[T::ZERO; 2]; MAX_HARMONICS],
    };
    Tables {
        digest: 0,
        tick_rate,
        scheme: Scheme::Realtime,
        substeps: 1,
        half_substep_share: T::HALF,
        substep: real(step),
        planet_share: T::ONE,
        damping_law: parameters.damping_law,
        sharpness: T::ZERO,
        units,
        rigid,
        mobility: Mobility {
            sun: real(scales.mobility(masses.sun)),
            carrier: real(scales.mobility(masses.carrier)),
            ..no_mobility()
        },
        excitation: Excitation {
            phase_step: 0,
            phase_advance: T::ZERO,
            periods_per_turn: 0,
            rate: T::ZERO,
            harmonics: 1,
        },
        springs: MESH_KINDS.map(spring),
        meshes: MESH_KINDS.map(|kind| array::from_fn(|planet| mesh(kind, planet))),
        stage: StageTable { rate: T::ZERO, square_sixth: T::ZERO, mobility: no_mobility(), damping: [T::ZERO; 2] },
        flow: flow(step, scales.damping(parameters.damping_coefficient(MeshKind::SunPlanet))),
        verlet: VerletTable {
            substeps: 0,
            half_count: T::ZERO,
            substep: T::ZERO,
            square: T::ZERO,
            per_substep: T::ZERO,
            mobility: no_mobility(),
            wind_up_mobility: T::ZERO,
            wind_up_yield: T::ZERO,
            damping: [T::ZERO; 2],
            half_damped: [T::ZERO; 2],
            curvature: T::ZERO,
            release: [[T::ZERO; 2]; 2],
        },
    }
}

/// Computes the flow of the gap in contact, y'' = -y - c y', over a step.
fn flow<T: Real>(step: f64, damping: f64) -> FlowTable<T> {
    let motion = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, -damping]);
    let exact = exponential::exponential_minus_identity(&motion, step);
    // Mean planet, gap and wind-up, then their rates: the planet has half the gap.
    let mut in_phase = SMatrix::<T, 6, 6>::zeros();
    for (row, to) in [1, 4].into_iter().enumerate() {
        for (column, from) in [1, 4].into_iter().enumerate() {
            in_phase[(to, from)] = T::from_f64(exact[(row, column)]);
        }
    }
    let mut whole = no_transition();
    whole.in_phase = Block(in_phase);
    FlowTable {
        whole,
        early: no_transition(),
        late: no_transition(),
        early_inputs: array::from_fn(|_| no_inputs()),
        late_inputs: array::from_fn(|_| no_inputs()),
        whole_inputs: array::from_fn(|_| no_inputs()),
        nodes: [T::ZERO; 2],
        half: no_transition(),
        half_constant: no_inputs(),
        whole_linear: array::from_fn(|_| no_inputs()),
        whole_constant: no_inputs(),
        step: T::from_f64(step),
        reach: T::ZERO,
        longest_advance: T::ZERO,
    }
}

fn no_transition<T: Real>() -> TransitionTable<T> {
    TransitionTable {
        in_phase: Block(SMatrix::zeros()),
        deviation: Block(SMatrix::zeros()),
        torques: Block(SMatrix::zeros()),
    }
}

fn no_inputs<T: Real>() -> Inputs<T> {
    Inputs { in_phase: Block(SMatrix::zeros()), deviation: [T::ZERO; 2] }
}

fn no_mobility<T: Real>() -> Mobility<T> {
    Mobility {
        sun: T::ZERO,
        planet: T::ZERO,
        carrier: T::ZERO,
        link: T::ZERO,
        wind_up: T::ZERO,
        wind_up_stiffness: T::ZERO,
        wind_up_damping: T::ZERO,
    }
}
