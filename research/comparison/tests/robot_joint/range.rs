//! Windows of the motion on other joints than case R's: other mesh phases, teeth, planets, backlash, masses, springs, damping law.

use host_tests::tolerance::light_planets::{
    ROBOT_LINK_RMS, ROBOT_LINK_WORST, ROBOT_VARIANTS_PEAK_FORCE, UNUSUAL_ROBOTS_LINK_RMS, UNUSUAL_ROBOTS_LINK_WORST,
};
use parameters::{DampingLaw, JointParameters, PerPlanet};
use reference::scenarios::{case_r, same, with_teeth};

use crate::variants::{joint, with_meshes};
use crate::windows::errors;

fn check(joint: JointParameters, shift: f64) {
    let errors = errors(case_r::brief(joint), shift);
    ROBOT_LINK_RMS.check(errors.link_rms);
    ROBOT_LINK_WORST.check(errors.link_worst);
    ROBOT_VARIANTS_PEAK_FORCE.check(errors.peak_force);
}

fn check_far(joint: JointParameters) {
    let errors = errors(case_r::brief(joint), 0.0);
    UNUSUAL_ROBOTS_LINK_RMS.check(errors.link_rms);
    UNUSUAL_ROBOTS_LINK_WORST.check(errors.link_worst);
    ROBOT_VARIANTS_PEAK_FORCE.check(errors.peak_force);
}

/// Other mesh phases follow the reference.
#[test]
fn other_mesh_phases_follow_reference() {
    check(joint(), 0.3);
    check(joint(), 0.6);
}

/// Other teeth and backlash follow the reference.
#[test]
fn other_teeth_follow_reference() {
    check(with_teeth(joint(), 3, [27, 36, 99]), 0.0);
    check(with_meshes(|mesh| mesh.half_backlash = same(3, 20e-6)), 0.0);
    check(with_meshes(|mesh| mesh.half_backlash = same(3, 80e-6)), 0.0);
}

/// A softer spring follows the reference.
#[test]
fn softer_spring_follows_reference() {
    let mut soft = joint();
    if let Some(compliance) = &mut soft.compliance {
        compliance.stiffness /= 3.0;
    }
    check(soft, 0.0);
}

/// The damping law `paper` follows the reference.
#[test]
fn paper_damping_law_follows_reference() {
    let mut joint = joint();
    joint.damping_law = DampingLaw::Paper;
    check(joint, 0.0);
}

/// Planets out of phase or heavy beside the link stay near the reference.
#[test]
fn unusual_planets_stay_near_reference() {
    // 25 / 5 is whole, 16 / 3 is not.
    check_far(with_teeth(joint(), 5, [25, 25, 75]));
    check_far(with_teeth(joint(), 3, [16, 29, 74]));
    let mut unequal = joint();
    unequal.sun_planet.half_backlash = [35e-6, 40e-6, 46e-6].into_iter().collect::<PerPlanet>();
    check_far(unequal);
    let mut light_link = joint();
    light_link.link_inertia = 0.05;
    check_far(light_link.clone());
    let mut heavy = light_link;
    heavy.bodies.planet_equivalent_mass = 0.06;
    check_far(heavy);
}
