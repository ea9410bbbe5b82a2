//! Joints, snapshots and plants for the live view.

use live::{Description, Sample};
use model_core::gears::Kinematics;
use parameters::JointParameters;
use reference::drive_train::TrueTorques;
use reference::joint::{Observation, mean_half_backlash};

use super::snapshot::Snapshot;

/// Description of a joint under an identifier.
pub fn description(id: u8, name: &str, joint: &JointParameters) -> Description {
    Description {
        id,
        name: name.to_owned(),
        planets: joint.geometry.planets,
        ratio: joint.geometry.ratio_by_teeth(),
        rated_torque: joint.rated_output_torque,
    }
}

/// Snapshot as a sample. The desired angle of the link is the motor's over the ratio, so that its error is the twist.
pub fn sample(joint: &JointParameters, snapshot: &Snapshot) -> Sample {
    let mut sample = Sample {
        wanted: snapshot.link_angle() + snapshot.twist(joint),
        link: snapshot.link_angle(),
        motor: snapshot.motor_angle(joint),
        gap: snapshot.gap,
        half_backlash: mean_half_backlash(joint),
        mesh_force: snapshot.teeth.iter().take(snapshot.teeth.len() / 2).map(|mesh| mesh.force).sum(),
        load_torque: snapshot.load,
        motor_torque: snapshot.drive,
        ..Sample::at(snapshot.time)
    };
    snapshot.teeth.iter().for_each(|mesh| sample.meshes.add(mesh.contact, mesh.force));
    sample
}

/// State of a plant in its drive train as a sample, with its half-backlash [m] and the desired angle of its link [rad].
pub fn true_sample(joint: &Observation, torques: &TrueTorques, half_backlash: f64, wanted: f64) -> Sample {
    let mut sample = Sample {
        wanted,
        link: joint.link_angle,
        link_speed: joint.link_speed,
        motor: joint.motor_angle,
        gap: joint.gap,
        half_backlash,
        mesh_force: joint.sun_force(),
        load_torque: torques.load(),
        motor_torque: torques.air_gap,
        ..Sample::at(joint.time)
    };
    for (contacts, forces) in joint.contacts.iter().zip(&joint.mesh_forces) {
        contacts.iter().zip(forces).for_each(|(contact, force)| sample.meshes.add(*contact, *force));
    }
    sample
}
