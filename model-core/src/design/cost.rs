//! Instructions of a tick, predicted from what it does. Every constant was counted on an emulated Cortex-M4F (QEMU,
//! rustc 1.96, opt-level 3, fat LTO) over 72 sets of tables (3, 4 and 5 planets, both laws, with compliance and without, 1, 2 and 5
//! harmonics, 1, 2 and 4 sub-steps); caches and pipelines are the processor's
//! business.
//!
//! A tick by the exponential flow costs the same each time. One in sub-steps costs a fixed part (start, first look at
//! the accelerations, state taken over), each sub-step, each correction and each mesh that crosses; before it an
//! exponential tick may have been given up half-way. More than one harmonic of the stiffness wave makes every look at
//! a mesh dearer.

use crate::joint::{JointParameters, MIN_PLANETS};
use crate::mesh::{DampingLaw, MESH_KINDS};

/// Instructions with one number of planets, one harmonic, law `paper`, without compliance.
struct Counted {
    hold: f64,
    /// More with compliance.
    hold_compliant: f64,
    given_up: f64,
    fixed: f64,
    substep: f64,
    correction: f64,
}

/// 3, 4 and 5 planets. Counted to the instruction, but for `given_up`: what a tick that is forced open in its first
/// half takes beyond the rest (three planets), in proportion to `hold`.
const COUNTED: [Counted; 3] = [
    Counted { hold: 2391.0, hold_compliant: 140.0, given_up: 620.0, fixed: 1513.0, substep: 663.0, correction: 560.0 },
    Counted { hold: 2878.0, hold_compliant: 232.0, given_up: 740.0, fixed: 1795.0, substep: 837.0, correction: 614.0 },
    Counted { hold: 3423.0, hold_compliant: 145.0, given_up: 860.0, fixed: 2169.0, substep: 1000.0, correction: 753.0 },
];
/// One mesh of a correction that parts or meets.
const CROSSING: f64 = 259.0;
/// One that leaps from flank to flank, or whose numbers are none: more than that, found by the search for the worst tick.
const LEAP: f64 = 45.0;
/// More under the law `contact`: a mesh that crosses, a planet of an exponential tick, a tick in sub-steps.
const CONTACT: [f64; 3] = [7.0, 12.0, 10.0];
/// More with compliance: a sub-step.
const COMPLIANCE: f64 = 41.0;
/// More with overtones: a planet in each evaluation, and again for each harmonic after the first.
const OVERTONES: f64 = 126.0;
const OVERTONE: f64 = 48.0;
/// The same for a mesh that crosses.
const CROSSING_OVERTONES: f64 = 71.0;
const CROSSING_OVERTONE: f64 = 36.0;
/// Evaluations in an exponential tick (some with rates), in one given up half-way, in the fixed part, in a sub-step.
const EVALUATIONS: [f64; 4] = [3.5, 1.5, 2.0, 2.0];

/// Instructions of a joint's tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    hold: f64,
    given_up: f64,
    fixed: f64,
    substep: f64,
    correction: f64,
    crossing: f64,
    meshes: f64,
}

impl Cost {
    /// Of a joint.
    pub fn new(parameters: &JointParameters) -> Self {
        let planets = parameters.geometry.planets;
        let counted = &COUNTED[planets.saturating_sub(MIN_PLANETS).min(COUNTED.len() - 1)];
        let order = MESH_KINDS.map(|kind| parameters.mesh(kind).stiffness_wave.order());
        let planets = planets as f64;
        let beyond_first = (order[0].max(order[1]).max(1) - 1) as f64;
        let with = |yes: bool, more: f64| if yes { more } else { 0.0 };
        let contact = CONTACT.map(|more| with(parameters.damping_law == DampingLaw::Contact, more));
        let compliant = |more: f64| with(parameters.compliance.is_some(), more);
        let overtones = planets * with(beyond_first > 0.0, OVERTONES + OVERTONE * beyond_first);
        let evaluations = EVALUATIONS.map(|count| count * overtones);
        Self {
            hold: counted.hold + planets * contact[1] + compliant(counted.hold_compliant) + evaluations[0],
            given_up: counted.given_up + evaluations[1],
            fixed: counted.fixed + contact[2] + evaluations[2],
            substep: counted.substep + compliant(COMPLIANCE) + evaluations[3],
            correction: counted.correction,
            crossing: CROSSING
                + contact[0]
                + with(beyond_first > 0.0, CROSSING_OVERTONES + CROSSING_OVERTONE * beyond_first),
            meshes: 2.0 * planets,
        }
    }

    /// While contact holds.
    pub fn holding(&self) -> f64 {
        self.hold
    }

    /// In sub-steps, none of which sees a crossing.
    pub fn losing(&self, substeps: u32) -> f64 {
        self.fixed + f64::from(substeps) * self.substep
    }

    /// An exponential tick is given up, and every mesh crosses in one of the sub-steps; or late in an exponential tick.
    pub fn all_crossing(&self, substeps: u32) -> f64 {
        (self.given_up + self.losing(substeps) + self.all()).max(self.hold + 0.5 * self.substep + self.all())
    }

    /// Every mesh crosses in every sub-step, from flank to flank: more than any state of the search takes.
    pub fn bound(&self, substeps: u32) -> f64 {
        let leaps = f64::from(substeps.max(1)) * self.meshes * LEAP;
        self.all_crossing(substeps) + (f64::from(substeps.max(1)) - 1.0) * self.all() + leaps
    }

    /// The most sub-steps with which `all_crossing` stays within so many instructions; zero if not even one does.
    pub fn affordable(&self, instructions: f64) -> u32 {
        if self.all_crossing(1) > instructions {
            return 0;
        }
        let rest = instructions - self.given_up - self.fixed - self.all();
        libm::floor(rest / self.substep).max(1.0) as u32
    }

    fn all(&self) -> f64 {
        self.correction + self.meshes * self.crossing
    }
}
