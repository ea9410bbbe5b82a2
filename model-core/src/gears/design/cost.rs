//! Predicts the instructions of a tick from its operations. All constants were counted on an EMULATED Cortex-M4F (QEMU,
//! rustc 1.96, opt-level 3, fat LTO) over 108 sets of tables (3, 4 and 5 planets, both laws, with compliance and
//! without, 1, 2 and 5 harmonics, 1, 2 and 4 sub-steps), and separately for Verlet sub-steps.
//!
//! An exponential tick has a constant cost. A tick in sub-steps costs a fixed part, plus each sub-step, each correction and
//! each crossing mesh. A cold start adds cost: after an exponential tick, after an abandoned exponential tick, or after
//! the motion was set from outside. More than one harmonic of the stiffness wave adds cost to every evaluation of a mesh.

use crate::gears::certificate::Substeps;
use parameters::{DampingLaw, JointParameters, MESH_KINDS, MIN_PLANETS};

/// Instructions for one number of planets, with one harmonic, law `paper`, without compliance.
struct Counted {
    hold: f64,
    /// Additional instructions of `hold` with compliance.
    hold_compliant: f64,
    given_up: f64,
    /// Cold start of a joint without exponential ticks, and with exponential ticks.
    anew: [f64; 2],
    fixed: f64,
    substep: f64,
    correction: f64,
}

/// Instructions of a tick of light planets for one number of planets; compliance and overtones change the instructions less
/// than the counts scatter.
#[derive(Debug, PartialEq)]
struct VerletCost {
    /// Exponential tick, every mesh in contact.
    hold: f64,
    /// Additional instructions if the exponential tick is abandoned at the last planet instead of the first.
    given_up: f64,
    /// Fixed part of a tick in sub-steps under the laws `paper` and `contact`.
    fixed: [f64; 2],
    /// One sub-step with all meshes open, under the laws `paper` and `contact`.
    substep: [f64; 2],
}

/// Costs for 3, 4 and 5 planets, each counted to the instruction at 3 and 9 Verlet sub-steps.
const VERLET: [VerletCost; 3] = [
    VerletCost { hold: 1182.0, given_up: 100.0, fixed: [564.0, 573.0], substep: [160.0, 151.0] },
    VerletCost { hold: 1441.0, given_up: 159.0, fixed: [653.0, 642.0], substep: [280.0, 196.0] },
    VerletCost { hold: 1686.0, given_up: 316.0, fixed: [824.0, 831.0], substep: [344.0, 333.0] },
];
/// Additional instructions of a Verlet sub-step for a mesh that touches its flank (`TOUCH`, found by the search for the
/// worst tick), and further for a mesh that is NaN, so that no path through the machine code takes more.
const TOUCH: f64 = 50.0;
const NOT_A_NUMBER: f64 = 23.0;

/// Costs for 3, 4 and 5 planets, counted to the instruction at 2 and 8 sub-steps. `given_up`: the part of an exponential
/// tick up to its second node, counted by function for three planets, in proportion to `hold` for others. `anew`: counted at
/// 2 sub-steps of four test joints under both laws. `fixed`: with changing torques; constant torques take 34 to 42 less.
const COUNTED: [Counted; 3] = [
    Counted {
        hold: 1799.0,
        hold_compliant: 16.0,
        given_up: 1160.0,
        anew: [484.0, 746.0],
        fixed: 445.0,
        substep: 539.0,
        correction: 359.0,
    },
    Counted {
        hold: 2006.0,
        hold_compliant: 133.0,
        given_up: 1320.0,
        anew: [652.0, 971.0],
        fixed: 468.0,
        substep: 685.0,
        correction: 455.0,
    },
    Counted {
        hold: 2384.0,
        hold_compliant: 386.0,
        given_up: 1620.0,
        anew: [785.0, 1168.0],
        fixed: 538.0,
        substep: 853.0,
        correction: 550.0,
    },
];
/// Additional instructions per planet in a tick whose state is not canonical.
const CANONICAL: f64 = 42.0;
/// Instructions of an equivalent gear: in contact, in free flight, and additional instructions for changes of contact within
/// a tick. Each counted to the instruction; the last is the largest count found over states and torques of joints.
const EQUIVALENT: [f64; 3] = [151.0, 147.0, 96.0];
/// Instructions of a correction per mesh that parts or meets.
const CROSSING: f64 = 211.0;
/// Additional instructions for a mesh that crosses from flank to flank or is NaN, found by the search for the worst tick.
const FLANK_TO_FLANK: f64 = 120.0;
/// Additional instructions under the law `contact`: per crossing mesh, per cold start.
const CONTACT: [f64; 2] = [10.0, 8.0];
/// Additional instructions of a sub-step with compliance.
const COMPLIANCE: f64 = 44.0;
/// Additional instructions with overtones, per planet and evaluation, and per harmonic after the first.
const OVERTONES: f64 = 60.0;
const OVERTONE: f64 = 17.0;
/// Additional instructions with overtones per crossing mesh, and per harmonic after the first.
const CROSSING_OVERTONES: f64 = 36.0;
const CROSSING_OVERTONE: f64 = 19.0;
/// Evaluations of the meshes in an exponential tick (some with rates), abandoned or not; in a cold start of a joint with
/// exponential ticks; in a sub-step.
const EVALUATIONS: [f64; 3] = [3.8, 3.0, 2.0];

/// Instructions of a tick of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    hold: f64,
    given_up: f64,
    /// Cold start of a joint without exponential ticks, and with exponential ticks.
    anew: [f64; 2],
    fixed: f64,
    substep: f64,
    correction: f64,
    crossing: f64,
    meshes: f64,
    verlet: &'static VerletCost,
    /// Index of the damping law: 0 for `paper`, 1 for `contact`.
    law: usize,
}

impl Cost {
    /// Predicts the instructions of a joint.
    pub fn new(parameters: &JointParameters) -> Self {
        if parameters.equivalent_gear().is_some() {
            return Self::of_equivalent_gear();
        }
        let planets = parameters.geometry.planets;
        let row = planets.saturating_sub(MIN_PLANETS).min(COUNTED.len() - 1);
        let counted = &COUNTED[row];
        let order = MESH_KINDS.map(|kind| parameters.mesh(kind).stiffness_wave.order());
        let planets = planets as f64;
        let beyond_first = (order[0].max(order[1]).max(1) - 1) as f64;
        let with = |yes: bool, more: f64| if yes { more } else { 0.0 };
        let contact = CONTACT.map(|more| with(parameters.damping_law == DampingLaw::Contact, more));
        let compliant = |more: f64| with(parameters.compliance.is_some(), more);
        let overtones = planets * with(beyond_first > 0.0, OVERTONES + OVERTONE * beyond_first);
        let evaluations = EVALUATIONS.map(|count| count * overtones);
        Self {
            hold: counted.hold + compliant(counted.hold_compliant) + evaluations[0],
            given_up: counted.given_up + evaluations[0],
            // Without exponential ticks a cold start has one evaluation less.
            anew: [
                counted.anew[0] + contact[1] + evaluations[1] - overtones,
                counted.anew[1] + contact[1] + evaluations[1],
            ],
            fixed: counted.fixed,
            substep: counted.substep + compliant(COMPLIANCE) + evaluations[2],
            correction: counted.correction,
            crossing: CROSSING
                + contact[0]
                + with(beyond_first > 0.0, CROSSING_OVERTONES + CROSSING_OVERTONE * beyond_first),
            meshes: 2.0 * planets,
            verlet: &VERLET[row],
            law: usize::from(parameters.damping_law == DampingLaw::Contact),
        }
    }

    /// Predicts the instructions of an equivalent gear; a tick has no sub-steps and at most two changes of contact.
    fn of_equivalent_gear() -> Self {
        let [hold, fixed, correction] = EQUIVALENT;
        Self {
            hold,
            given_up: 0.0,
            anew: [0.0; 2],
            fixed,
            substep: 0.0,
            correction,
            crossing: 0.0,
            // One contact; covers the cost of numbers at the ends of their range.
            meshes: 1.0,
            verlet: &VERLET[0],
            law: 1,
        }
    }

    /// Returns true if exponential ticks cost less than sub-steps. Corrected sub-steps are as accurate and need no check in
    /// advance that contacts hold.
    pub fn takes_whole_ticks(&self, substeps: Substeps) -> bool {
        match substeps {
            Substeps::Corrected(_) => self.substep == 0.0 || self.hold < self.contact_changes(substeps),
            Substeps::Verlet(count) => self.verlet.hold < self.pressing(count),
        }
    }

    /// Returns the instructions of a tick in which contacts hold.
    pub fn contact_holds(&self, substeps: Substeps) -> f64 {
        match substeps {
            Substeps::Corrected(_) if self.takes_whole_ticks(substeps) => self.hold,
            Substeps::Verlet(_) if self.takes_whole_ticks(substeps) => self.verlet.hold,
            Substeps::Corrected(_) => self.contact_changes(substeps),
            Substeps::Verlet(count) => self.pressing(count),
        }
    }

    /// Returns the instructions of a tick in sub-steps without a crossing.
    pub fn contact_changes(&self, substeps: Substeps) -> f64 {
        match substeps {
            Substeps::Corrected(count) => self.fixed + f64::from(count) * self.substep,
            Substeps::Verlet(count) => self.verlet.fixed[self.law] + f64::from(count) * self.verlet.substep[self.law],
        }
    }

    /// Returns the instructions if every mesh crosses in two sub-steps (rattling joints reach this), or in one sub-step after a
    /// cold start and an abandoned exponential tick; or touches its flank in every Verlet sub-step.
    pub fn all_crossing(&self, substeps: Substeps) -> f64 {
        match substeps {
            Substeps::Corrected(count) => {
                let twice = self.contact_changes(substeps) + f64::from(count.min(2)) * self.all();
                twice.max(self.contact_changes_anew(substeps) + self.all())
            }
            Substeps::Verlet(count) => self.given_up(substeps) + self.pressing(count),
        }
    }

    /// Returns the instructions if every mesh crosses from flank to flank in every sub-step, or is NaN in every Verlet
    /// sub-step: an upper bound on all states of the search.
    pub fn bound(&self, substeps: Substeps) -> f64 {
        let count = f64::from(substeps.count().max(1));
        let most = match substeps {
            Substeps::Corrected(_) => {
                self.contact_changes_anew(substeps) + count * (self.all() + self.meshes * FLANK_TO_FLANK)
            }
            Substeps::Verlet(_) => self.all_crossing(substeps) + count * self.meshes * NOT_A_NUMBER,
        };
        most + 0.5 * self.meshes * CANONICAL
    }

    /// Returns the instructions of a tick in sub-steps with a cold start.
    fn contact_changes_anew(&self, substeps: Substeps) -> f64 {
        let anew = self.anew[usize::from(self.takes_whole_ticks(substeps))];
        self.given_up(substeps) + anew + self.contact_changes(substeps)
    }

    /// Returns the instructions of an abandoned exponential tick; zero without exponential ticks.
    fn given_up(&self, substeps: Substeps) -> f64 {
        match substeps {
            _ if !self.takes_whole_ticks(substeps) => 0.0,
            Substeps::Corrected(_) => self.given_up,
            Substeps::Verlet(_) => self.verlet.given_up,
        }
    }

    /// Returns the largest number of sub-steps, at most `most`, with which `all_crossing` stays within `instructions`; zero if
    /// one sub-step exceeds `instructions`.
    pub fn affordable(&self, instructions: f64, most: u32) -> u32 {
        let fits = |substeps: &u32| self.all_crossing(Substeps::Corrected(*substeps)) <= instructions;
        (1..=most).take_while(fits).last().unwrap_or(0)
    }

    /// Returns the instructions if every mesh touches its flank in every Verlet sub-step.
    fn pressing(&self, count: u32) -> f64 {
        self.contact_changes(Substeps::Verlet(count)) + f64::from(count) * self.meshes * TOUCH
    }

    fn all(&self) -> f64 {
        self.correction + self.meshes * self.crossing
    }
}
