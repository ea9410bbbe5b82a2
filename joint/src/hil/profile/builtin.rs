//! The built-in profile: torque steps of both signs through the gap on a joint that turns. It is made from the joint's
//! own rated torque, ratio and inertia, so that any joint may run it.

use std::f64::consts::TAU;

use model_core::joint::JointParameters;

use super::Torques;

/// Names of the built-in profiles.
pub const BUILTIN: [&str; 1] = ["reversals"];
/// Length of the built-in profile; longer runs repeat it [s].
pub const DURATION: f64 = 5.0;

/// Load steps: start [s], and level over the rated torque. Each is a balanced pair of drive and load torque.
const STEPS: [(f64, f64); 16] = [
    (0.0, 0.0),
    (0.2, 1.0),
    (0.8, -1.0),
    (1.1, 1.0),
    (1.4, 0.2),
    (1.7, -0.2),
    (2.0, 0.2),
    (2.3, 0.05),
    (2.5, -0.05),
    (2.7, 0.05),
    (2.9, 0.0),
    (3.1, -0.5),
    (3.5, 0.5),
    (3.9, 0.0),
    (4.2, 1.0),
    (4.8, 0.0),
];
/// A step rises in this time, as a drive's current loop lets it [s].
const RISE: f64 = 0.004;
/// Speed of the link between run-up and run-down: 1/4 turn a second [rad/s].
const SPEED: f64 = TAU / 4.0;
/// Run-up ends, run-down starts: the drive torque bears what accelerates the joint beside the steps [s].
const RUN_UP: f64 = 0.2;
const RUN_DOWN: f64 = 4.6;

/// Torques at a time.
pub fn reversals(joint: &JointParameters, time: f64) -> Torques {
    let time = time.rem_euclid(DURATION);
    let ratio = joint.geometry.ratio_by_radii();
    let load = joint.rated_output_torque * level(time);
    let inertial = if time < RUN_UP {
        SPEED / RUN_UP
    } else if time >= RUN_DOWN && time < RUN_DOWN + RUN_UP {
        -SPEED / RUN_UP
    } else {
        0.0
    } * inertia_at_link(joint)
        / ratio;
    Torques { drive: load / ratio + inertial, load }
}

/// Load over rated torque: steps with straight flanks.
fn level(time: f64) -> f64 {
    let step = STEPS.partition_point(|&(start, _)| start <= time).saturating_sub(1);
    let (start, to) = STEPS[step];
    let (_, from) = STEPS[(step + STEPS.len() - 1) % STEPS.len()];
    from + (to - from) * ((time - start) / RISE).min(1.0)
}

/// Inertia of the whole joint, felt at the link [kg m^2].
fn inertia_at_link(joint: &JointParameters) -> f64 {
    let geometry = &joint.geometry;
    let lever = geometry.carrier_base_radius();
    let ratio = geometry.ratio_by_radii();
    let sun = joint.bodies.sun_equivalent_mass * geometry.sun_base_radius.powi(2) + joint.rotor_inertia;
    // A rigid planet moves along the line of action as the carrier does: u_p = u_c.
    let planets = geometry.planets as f64 * joint.bodies.planet_equivalent_mass * lever.powi(2);
    let carrier = joint.carrier_equivalent_mass() * lever.powi(2) + joint.link_inertia;
    sun * ratio.powi(2) + planets + carrier
}
