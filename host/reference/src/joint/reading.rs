//! Outputs of the reference: angles, forces and energies from the coordinates along the line of action.

use std::f64::consts::TAU;

use parameters::PerPlanet;

use super::equations::JointEquations;
use super::observation::{Observation, Work};
use super::reference::Reference;

impl Reference {
    /// Returns the present outputs.
    pub fn observe(&self) -> Observation {
        let equations = &self.equations;
        let time = self.integrator.time();
        let state = self.integrator.state();
        let bodies = equations.bodies();
        let (positions, speeds) = (&state[..bodies], &state[bodies..2 * bodies]);
        let (carrier, link) = (equations.carrier(), equations.link());
        let (rigid, rigid_speed) = (equations.rigid(positions), equations.rigid(speeds));
        let whole_turns = self.teeth_passed as f64 / equations.ring_teeth;
        let sun_lever = equations.sun_lever;
        let lever = equations.carrier_lever;
        // Carrier angle of the passed teeth, which were subtracted from the coordinates [rad].
        let counted = TAU * whole_turns;
        let internal = equations.internal_forces(time, state);

        let list = |kind: usize, value: &dyn Fn(usize) -> f64| -> PerPlanet {
            debug_assert!(kind < 2);
            (0..equations.planets).map(value).collect()
        };
        let both = |value: &dyn Fn(usize, usize) -> f64| [0, 1].map(|kind| list(kind, &|planet| value(kind, planet)));
        let kinetic = 0.5 * equations.masses.iter().zip(speeds).map(|(mass, speed)| mass * speed * speed).sum::<f64>();
        let in_meshes: f64 =
            internal.meshes.iter().flatten().map(|mesh| 0.5 * mesh.stiffness * mesh.overlap.powi(2)).sum();
        let wind_up = positions[carrier] - positions[link];
        let in_compliance = equations.compliance.map_or(0.0, |(stiffness, _)| 0.5 * stiffness * wind_up * wind_up);
        let in_slip =
            equations.hysteresis.map_or(0.0, |slip| 0.5 * slip.stiffness * state[equations.slip_entry()].powi(2));
        let work = &state[2 * bodies..];
        Observation {
            time,
            motor_angle: positions[0] / sun_lever + counted * JointEquations::rigid_share(0) * lever / sun_lever,
            motor_speed: speeds[0] / sun_lever,
            carrier_angle: positions[carrier] / lever + counted,
            carrier_speed: speeds[carrier] / lever,
            link_angle: positions[link] / lever + counted,
            link_speed: speeds[link] / lever,
            rigid_turns: whole_turns + rigid / (lever * TAU),
            rigid_speed: rigid_speed / lever,
            motor_offset: (positions[0] - JointEquations::rigid_share(0) * rigid) / sun_lever,
            link_offset: (positions[link] - rigid) / lever,
            gap: positions[0] - 2.0 * positions[carrier],
            gap_rate: speeds[0] - 2.0 * speeds[carrier],
            wind_up,
            wind_up_rate: speeds[carrier] - speeds[link],
            deflections: both(&|kind, planet| internal.meshes[kind][planet].deflection),
            deflection_rates: both(&|kind, planet| internal.meshes[kind][planet].deflection_rate),
            mesh_forces: both(&|kind, planet| internal.meshes[kind][planet].force),
            contacts: [0, 1].map(|kind| {
                (0..equations.planets)
                    .map(|planet| equations.meshes[kind][planet].contact(internal.meshes[kind][planet].deflection))
                    .collect()
            }),
            wind_up_torque: internal.wind_up_force * lever,
            kinetic_energy: kinetic,
            elastic_energy: in_meshes + in_compliance + in_slip,
            work: Work { supplied: work[0], dissipated: work[1], against_errors: work[2], by_stiffness: work[3] },
        }
    }
}
