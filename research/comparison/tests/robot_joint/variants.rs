//! Case R's joint and variants of it. No bound is stated here.

use parameters::{JointParameters, Mesh};
use reference::scenarios::case_r;

/// Case R's own joint.
pub fn joint() -> JointParameters {
    case_r::case_r().joint
}

/// Joint with both kinds of mesh changed.
pub fn with_meshes(change: impl Fn(&mut Mesh)) -> JointParameters {
    let mut joint = joint();
    change(&mut joint.sun_planet);
    change(&mut joint.ring_planet);
    joint
}
