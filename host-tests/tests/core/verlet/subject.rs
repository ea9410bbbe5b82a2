//! Joint Q1 with light planets, ripple and errors, its tables with a given number of Verlet sub-steps, and runs of core and reference. No
//! bound is stated here.

use model_core::gears::design::{Effort, design_scheme};
use model_core::gears::{Kinematics, Scheme, State, Tables};
use parameters::{DampingLaw, JointParameters, Mesh};
use reference::joint::{Observation, Reference, RelativeState, Start};
use reference::scenarios::{case_r, same, with_teeth};
use simulation::sim::start::core_state;

/// Case R's joint with a number of planets and a damping law.
pub fn joint(planets: usize, law: DampingLaw) -> JointParameters {
    let teeth = match planets {
        3 => [15, 30, 75],
        4 => [16, 28, 72],
        _ => [20, 30, 80],
    };
    JointParameters { damping_law: law, ..with_teeth(case_r::case_r().joint, planets, teeth) }
}

/// Tables with a given number of Verlet sub-steps a tick.
pub fn tables<const N: usize>(joint: &JointParameters, rate: u32, substeps: u32) -> Tables<f64, N> {
    design_scheme(joint, rate, Scheme::Realtime, Effort::Verlet(substeps)).expect("a sound joint")
}

/// Tables with Verlet sub-steps and no exponential ticks.
pub fn verlet_only<const N: usize>(joint: &JointParameters, rate: u32, substeps: u32) -> Tables<f64, N> {
    let mut tables = tables(joint, rate, substeps);
    tables.flow.longest_advance = -1.0;
    tables
}

/// Start of the reference as a state of the core.
pub fn state<const N: usize>(joint: &JointParameters, tables: &Tables<f64, N>, start: &RelativeState) -> State<f64, N> {
    core_state(joint, tables, &Start::Relative(start.clone()))
}

/// State at rest with all meshes pressed by `overlap` on the drive side [m].
pub fn in_contact(joint: &JointParameters, overlap: f64) -> RelativeState {
    let planets = joint.geometry.planets;
    let deflection = joint.sun_planet.half_backlash[0] + overlap;
    RelativeState { sun_planet: same(planets, deflection), gap: 2.0 * deflection, ..RelativeState::centred(planets) }
}

/// State at rest under a drive torque, and the load torque that balances it.
pub fn at_rest_under(joint: &JointParameters, drive: f64) -> (RelativeState, f64) {
    let geometry = &joint.geometry;
    let force = drive / (geometry.planets as f64 * geometry.sun_base_radius);
    let load = drive * geometry.ratio_by_radii();
    let at_rest = |mesh: &Mesh| mesh.half_backlash[0] * force.signum() + force / mesh.mean_stiffness;
    let deflection = at_rest(&joint.sun_planet);
    let torsion = joint.compliance.map_or(0.0, |compliance| load / compliance.stiffness);
    let start = RelativeState {
        sun_planet: same(geometry.planets, deflection),
        gap: deflection + at_rest(&joint.ring_planet),
        wind_up: torsion * geometry.carrier_base_radius(),
        ..RelativeState::centred(geometry.planets)
    };
    (start, load)
}

/// Observations of the reference at the start and at the end of each tick.
pub fn reference(
    joint: &JointParameters,
    start: &RelativeState,
    torques: (f64, f64),
    rate: u32,
    ticks: u32,
) -> Vec<Observation> {
    let mut reference = Reference::start(joint, &Start::Relative(start.clone())).expect("a sound joint");
    let mut seen = vec![reference.observe()];
    for tick in 1..=ticks {
        reference.advance(f64::from(tick) / f64::from(rate), torques.0, torques.1).expect("the reference follows");
        seen.push(reference.observe());
    }
    seen
}
