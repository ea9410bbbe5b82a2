//! Plants and periods for the live view.

use live::Sample;
pub use simulation::sim::live_view::description;

use super::plant::Plant;
use super::rig::Period;

/// State of a plant with its half-backlash [m] and the desired angle of its link [rad].
pub fn live_sample(plant: &Plant, half_backlash: f64, wanted: f64) -> Sample {
    let (joint, torques) = (plant.joint(), plant.torques());
    let mut sample = Sample {
        wanted,
        link: joint.link_angle,
        link_speed: joint.link_speed,
        motor: joint.motor_angle,
        gap: joint.gap,
        half_backlash,
        mesh_force: joint.sun_force(),
        load_torque: torques.load_friction + torques.gravity + torques.disturbance,
        motor_torque: torques.air_gap,
        ..Sample::at(joint.time)
    };
    for (contacts, forces) in joint.contacts.iter().zip(&joint.mesh_forces) {
        contacts.iter().zip(forces).for_each(|(contact, force)| sample.meshes.add(*contact, *force));
    }
    sample
}

/// State of a rig at the end of a period, with the gap by the observer where it is valid.
pub fn period_sample(period: &Period<'_>) -> Sample {
    let gap = period.answer.map(|answer| answer.estimates.gap).filter(|gap| gap.valid);
    let estimated_gap = gap.map_or(f64::NAN, |gap| gap.value.into());
    Sample { estimated_gap, ..live_sample(period.plant, period.half_backlash, period.wanted) }
}
