//! Motions through every state of backlash: free motion, load steps, reversals through the gap, all teeth separated,
//! back-side contact; on joints L1 and Q1, under both damping laws. All open loop on a 20 kHz tick grid.
//!
//! Under the law `contact` with a damping ratio of 0.05 the planets rattle between sun and ring for milliseconds after
//! every crossing, and each bounce amplifies earlier deviations: no two integrators agree on single meshes then. L1 is
//! therefore damped by 0.2 under this law, which ends the rattling; Q1 is unchanged and marked.

use parameters::{DampingLaw, JointParameters, MeshPhases, StiffnessWave};

use super::joints::{l1, q1, same};
use super::{Scenario, TorqueSegment};
use crate::joint::RelativeState;

/// Joint, unit of the drive torque of its motions, and predictability.
struct Subject {
    name: &'static str,
    joint: JointParameters,
    /// [N m].
    unit: f64,
    /// `true` if the planets rattle after a crossing.
    rattles: bool,
}

/// Returns all motions, joint by joint.
pub fn motions() -> Vec<Scenario> {
    let with_law = |mut joint: JointParameters, law| {
        joint.damping_law = law;
        with_ripple(joint)
    };
    let mut damped = l1();
    damped.sun_planet.damping_ratio = 0.2;
    damped.ring_planet.damping_ratio = 0.2;
    let subjects = [
        Subject { name: "L1 contact", joint: with_law(damped, DampingLaw::Contact), unit: 20.0, rattles: false },
        Subject { name: "L1 paper", joint: with_law(l1(), DampingLaw::Paper), unit: 20.0, rattles: false },
        Subject { name: "Q1 contact", joint: with_law(q1(), DampingLaw::Contact), unit: 1.0, rattles: true },
        Subject { name: "Q1 paper", joint: with_law(q1(), DampingLaw::Paper), unit: 1.0, rattles: false },
    ];
    let each = [free_motion, step_load, reversal, all_separated, back_side];
    subjects.iter().flat_map(|subject| each.map(|motion| motion(subject))).collect()
}

/// No torque; the joint turns at 20 rad/s while its teeth drift through the gap and bounce. Without errors: bouncing
/// between moving flanks is chaotic on every joint under the law `contact`.
fn free_motion(subject: &Subject) -> Scenario {
    let planets = subject.joint.geometry.planets;
    let start = RelativeState { gap_rate: 4e-3, rigid_speed: 20.0, ..RelativeState::centred(planets) };
    let mut scenario = subject.motion("free motion", start, 1000, &[], !subject.rattles);
    for mesh in [&mut scenario.joint.sun_planet, &mut scenario.joint.ring_planet] {
        mesh.transmission_error = same(planets, 0.0);
    }
    scenario
}

/// Turning under balanced torques, then the load rises by half and falls back.
fn step_load(subject: &Subject) -> Scenario {
    let start = RelativeState { rigid_speed: 5.0, ..subject.seated(1.0) };
    subject.motion("step load", start, 4000, &[(0, 1.0, 1.0), (1000, 1.0, 1.5), (2500, 1.0, 1.0)], true)
}

/// Drive and load change sign together: the teeth cross the gap and the joint hardly moves.
fn reversal(subject: &Subject) -> Scenario {
    let steps = [(0, 0.5, 0.5), (800, -0.5, -0.5), (2400, 0.5, 0.5)];
    subject.motion("reversal through the gap", subject.seated(0.5), 4000, &steps, !subject.rattles)
}

/// Every tooth in the middle of its gap; after 2 ms without torque the drive closes the gap.
fn all_separated(subject: &Subject) -> Scenario {
    let start = RelativeState::centred(subject.joint.geometry.planets);
    subject.motion("all teeth separated", start, 3000, &[(40, 0.2, 0.2)], !subject.rattles)
}

/// The load drives and the motor brakes: the back sides carry the torque, first steadily, then after a step.
fn back_side(subject: &Subject) -> Scenario {
    let start = RelativeState { rigid_speed: 5.0, ..subject.seated(-0.6) };
    subject.motion("back-side contact", start, 4000, &[(0, -0.6, -0.6), (1500, -1.2, -1.2)], true)
}

/// Stiffness ripple of 10 % and errors of 3 um, phases by tooth counts.
fn with_ripple(mut joint: JointParameters) -> JointParameters {
    let planets = joint.geometry.planets;
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.1 };
        mesh.transmission_error = same(planets, 3e-6);
        mesh.phases = MeshPhases::FromTeeth { stiffness: 0.0, error: 0.0 };
    }
    joint
}

impl Subject {
    /// r_c cos(alpha) [m].
    fn carrier_lever(&self) -> f64 {
        self.joint.geometry.carrier_radius * self.joint.geometry.working_pressure_angle.cos()
    }

    /// Load torque that balances a unit drive torque.
    fn ratio(&self) -> f64 {
        2.0 * self.carrier_lever() / self.joint.geometry.sun_base_radius
    }

    /// Static contact under a drive torque in units, all bodies at rest; negative for the back sides.
    fn seated(&self, drive: f64) -> RelativeState {
        let geometry = &self.joint.geometry;
        let drive_torque = drive * self.unit;
        let force = drive_torque / (geometry.planets as f64 * geometry.sun_base_radius);
        let mesh = &self.joint.sun_planet;
        let deflection = mesh.half_backlash[0] * force.signum() + force / mesh.mean_stiffness;
        let torsion =
            self.joint.compliance.map_or(0.0, |compliance| self.ratio() * drive_torque / compliance.stiffness);
        RelativeState {
            sun_planet: same(geometry.planets, deflection),
            gap: 2.0 * deflection,
            wind_up: torsion * self.carrier_lever(),
            ..RelativeState::centred(geometry.planets)
        }
    }

    /// Steps are (first tick, drive torque in units, load torque in units times the ratio).
    fn motion(
        &self,
        name: &str,
        start: RelativeState,
        ticks: u64,
        steps: &[(u64, f64, f64)],
        predictable: bool,
    ) -> Scenario {
        let segment = |&(from_tick, drive, load): &(u64, f64, f64)| TorqueSegment {
            from_tick,
            drive_torque: drive * self.unit,
            load_torque: load * self.unit * self.ratio(),
        };
        let name = format!("{}, {name}", self.name);
        let torques = steps.iter().map(segment).collect();
        Scenario { torques, ticks, predictable, ..Scenario::new(name, self.joint.clone(), start) }
    }
}
