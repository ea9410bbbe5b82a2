//! The core against the reference outside the usual joint: four and five planets, unequal backlash, the rectangular stiffness wave, meshes
//! out of phase, a joint that turns backwards.

use host_tests::tolerance;
use model_core::gears::Kinematics;
use model_core::gears::design::Effort;
use parameters::{DampingLaw, JointParameters, MeshPhases, PerPlanet, StiffnessWave};
use reference::joint::RelativeState;
use reference::scenarios;
use reference::scenarios::{Scenario, TorqueSegment};

use super::comparison::check;

/// Joint L1 with other teeth, excited by its own angle with ripple and errors.
fn joint(planets: usize, teeth: [u32; 3]) -> JointParameters {
    let mut joint = scenarios::with_teeth(scenarios::l1(), planets, teeth);
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.damping_ratio = 0.15;
        mesh.stiffness_wave = StiffnessWave::Harmonic { stiffness_ratio: 0.12 };
        mesh.half_backlash = scenarios::same(planets, 50e-6);
        mesh.transmission_error = scenarios::same(planets, 4e-6);
        mesh.phases = MeshPhases::FromTeeth { stiffness: 0.3, error: 1.1 };
    }
    joint
}

/// Scenario whose torques change sign and back while the joint turns: across the gap to the back sides and again.
fn reversal(name: &str, joint: JointParameters, speed: f64) -> Scenario {
    let ratio = joint.geometry.ratio_by_radii();
    let segment =
        |from_tick, drive_torque| TorqueSegment { from_tick, drive_torque, load_torque: ratio * drive_torque };
    let start = RelativeState { rigid_speed: speed, ..RelativeState::centred(joint.geometry.planets) };
    let torques = vec![segment(0, 20.0), segment(800, -20.0), segment(1600, 30.0)];
    Scenario { torques, ticks: 2400, ..Scenario::new(name, joint, start) }
}

#[test]
fn four_planets_follow_reference() {
    check::<4>(&reversal("four planets", joint(4, [28, 36, 100]), 10.0), Effort::Accurate, &tolerance::core::RANGE);
}

#[test]
fn five_planets_follow_reference() {
    check::<5>(&reversal("five planets", joint(5, [25, 35, 95]), 10.0), Effort::Accurate, &tolerance::core::RANGE);
}

#[test]
fn planets_out_of_phase_follow_reference() {
    // 26 / 3 and 100 / 3 are not whole: the planets mesh a third of a period apart.
    check::<3>(&reversal("out of phase", joint(3, [26, 37, 100]), 10.0), Effort::Accurate, &tolerance::core::RANGE);
}

#[test]
fn backward_joint_follows_reference() {
    check::<3>(&reversal("backwards", joint(3, [27, 36, 99]), -15.0), Effort::Accurate, &tolerance::core::RANGE);
}

#[test]
fn unequal_backlash_follows_reference() {
    let mut joint = joint(3, [27, 36, 99]);
    joint.sun_planet.half_backlash = [30e-6, 50e-6, 80e-6].into_iter().collect::<PerPlanet>();
    joint.ring_planet.half_backlash = [60e-6, 20e-6, 45e-6].into_iter().collect::<PerPlanet>();
    joint.damping_law = DampingLaw::Paper;
    check::<3>(&reversal("unequal backlash", joint, 10.0), Effort::Accurate, &tolerance::core::RANGE);
}

#[test]
fn rectangular_wave_follows_reference() {
    let mut joint = joint(3, [27, 36, 99]);
    for mesh in [&mut joint.sun_planet, &mut joint.ring_planet] {
        mesh.stiffness_wave = StiffnessWave::Rectangular { stiffness_ratio: 0.2, contact_ratio: 1.6, order: 5 };
    }
    check::<3>(&reversal("rectangular wave", joint, 10.0), Effort::Accurate, &tolerance::core::RANGE);
}
