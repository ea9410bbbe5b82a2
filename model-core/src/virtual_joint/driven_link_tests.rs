//! A joint whose link another simulator moves, against a joint that is designed for this link. Both have the core's laws:
//! `bindings/mujoco/tests/wheels.rs` compares it with the independent reference.

use crate::gears::Mechanics;
use crate::virtual_joint::{DrivenLink, VirtualJoint, VirtualJointDesign};
use joint_file::JointFile;
use parameters::JointParameters;
use std::println;

/// A joint without friction and weight at the link, with a link of some times the inertia.
fn joint_file(name: &str, inertia: f64) -> JointFile {
    let mut file = joint_file::read(joint_file::preset(name).unwrap()).unwrap();
    file.surroundings.load_friction.coulomb = 0.0;
    file.surroundings.load_friction.viscous = 0.0;
    file.surroundings.gravity_torque = 0.0;
    let before = file.parameters.clone();
    file.parameters.link_inertia *= inertia;
    // Damping in N m s/rad stays: the ratio of a file is one of the masses on both sides.
    let ratio = (reduced_mass(&before) / reduced_mass(&file.parameters)).sqrt();
    if let Some(compliance) = &mut file.parameters.compliance {
        compliance.damping_ratio *= ratio;
    }
    file
}

/// Reduced mass of the gears and the link on both sides of the compliance.
fn reduced_mass(joint: &JointParameters) -> f64 {
    let geared = 4.0 * (joint.bodies.sun_equivalent_mass + joint.rotor_equivalent_mass())
        + joint.geometry.planets as f64 * joint.bodies.planet_equivalent_mass
        + joint.carrier_equivalent_mass();
    geared * joint.link_equivalent_mass() / (geared + joint.link_equivalent_mass())
}

/// Angle of the link [rad].
fn link_angle<const N: usize>(joint: &VirtualJoint<'_, f32, N>) -> f64 {
    let outputs = joint.outputs();
    let carrier = f64::from(outputs.carrier_turns) + f64::from(outputs.carrier_fraction) * 2_f64.powi(-32);
    carrier * core::f64::consts::TAU + f64::from(outputs.link_offset)
}

/// Control periods of a run: 0.6 s.
const PERIODS: usize = 6_000;

/// Largest error of the link's angle and root mean square of the error of the gap, relative to their ranges, under a torque
/// that reverses. A rebound that comes a little later makes the largest error of the gap as large as its range.
fn errors<const N: usize>(name: &str, inertia: f64) -> [f64; 2] {
    let (plain, other) = (joint_file(name, 1.0), joint_file(name, inertia));
    let [tables, exact] = [&plain, &other].map(|file| VirtualJointDesign::<N>::new(file, 10_000).unwrap());
    let (mut joint, mut expected) = (tables.joint(), exact.joint());
    let inverse_inertia = 1.0 / other.parameters.link_inertia as f32;
    let (load, amplitude) = (0.4_f32, 0.3 * plain.surroundings.torque_limit as f32);
    let (mut angle_error, mut gap_square, mut ranges) = (0.0_f64, 0.0, [[f64::MAX, f64::MIN]; 2]);
    for period in 0..PERIODS {
        let torque = amplitude * (37.0 * 1e-4 * period as f32).sin();
        joint.advance_with_link(torque, DrivenLink { inverse_inertia, acceleration: -load * inverse_inertia });
        expected.advance(torque, load);
        let of = |joint: &VirtualJoint<'_, f32, N>| [link_angle(joint), f64::from(joint.outputs().gap)];
        let (found, right) = (of(&joint), of(&expected));
        angle_error = angle_error.max((found[0] - right[0]).abs());
        gap_square += (found[1] - right[1]).powi(2);
        ranges.iter_mut().zip(right).for_each(|(range, value)| *range = [range[0].min(value), range[1].max(value)]);
    }
    let [angle_range, gap_range] = ranges.map(|[low, high]| high - low);
    [angle_error / angle_range, (gap_square / PERIODS as f64).sqrt() / gap_range]
}

#[test]
fn link_of_other_inertia_moves_like_its_own_design() {
    // Limits: measured 2.8e-3 and 2.7e-2 with 0.3 times the inertia, at most 5.4e-4 and 4.3e-4 otherwise.
    for (inertia, angle_limit, gap_limit) in
        [(0.3, 5e-3, 4e-2), (1.0, 1e-3, 4e-3), (3.0, 1e-3, 4e-3), (20.0, 1e-3, 4e-3)]
    {
        let [angle, gap] = errors::<3>("q1", inertia);
        println!("q1, link of {inertia} times the inertia: angle {angle:.2e}, gap {gap:.2e} of the range");
        assert!(angle < angle_limit && gap < gap_limit, "{inertia}: {angle} {gap}");
    }
}

#[test]
fn shifted_joint_has_the_angle_and_speed() {
    let design = VirtualJointDesign::<3>::new(&joint_file("q1", 1.0), 10_000).unwrap();
    let mut joint = design.joint();
    joint.shift(-3, 0.25, 1.5);
    assert!((link_angle(&joint) / core::f64::consts::TAU + 2.75).abs() < 1e-7);
    assert!((joint.link_speed() - 1.5).abs() < 1e-4);
    assert!((joint.motor_speed() / joint.link_speed() / design.surroundings.gear - 1.0).abs() < 1e-6);
    assert_eq!(joint.outputs().gap, 0.0);
}
