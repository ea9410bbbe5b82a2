//! Instructions of a tick, predicted from what it does. Every constant was counted on an emulated Cortex-M4F (QEMU,
//! rustc 1.96, opt-level 3, fat LTO) over 108 sets of tables (3, 4 and 5 planets, both laws, with compliance and
//! without, 1, 2 and 5 harmonics, 1, 2 and 4 sub-steps; Verlet sub-steps apart).
//!
//! A tick by the exponential flow costs the same each time. One in sub-steps goes on from the one before at a fixed part, each
//! sub-step, each correction and each mesh that crosses. It costs more when it begins anew: after an exponential tick, which
//! may have been tried and given up, or when the motion was set from outside. More than one harmonic of the stiffness wave
//! makes every evaluation of a mesh dearer.

use crate::gears::certificate::Substeps;
use parameters::{DampingLaw, JointParameters, MESH_KINDS, MIN_PLANETS};

/// Instructions with one number of planets, one harmonic, law `paper`, without compliance.
struct Counted {
    hold: f64,
    /// More with compliance.
    hold_compliant: f64,
    given_up: f64,
    /// Where no tick is taken whole, and where some are.
    anew: [f64; 2],
    fixed: f64,
    substep: f64,
    correction: f64,
}

/// Verlet sub-steps of light planets with one number of planets; compliance and overtones change them less than counts differ.
#[derive(Debug, PartialEq)]
struct VerletCost {
    /// Every mesh is in contact.
    hold: f64,
    /// More if that is given up at the last planet and not at the first.
    given_up: f64,
    /// Law `paper`, `contact`.
    fixed: [f64; 2],
    /// All teeth apart, law `paper`, `contact`.
    substep: [f64; 2],
}

/// 3, 4 and 5 planets, each counted to the instruction at 3 and 9 Verlet sub-steps.
const VERLET: [VerletCost; 3] = [
    VerletCost { hold: 1182.0, given_up: 100.0, fixed: [564.0, 573.0], substep: [160.0, 151.0] },
    VerletCost { hold: 1441.0, given_up: 159.0, fixed: [653.0, 642.0], substep: [280.0, 196.0] },
    VerletCost { hold: 1686.0, given_up: 316.0, fixed: [824.0, 831.0], substep: [344.0, 333.0] },
];
/// More for a mesh that touches its flank in a Verlet sub-step, found by the search for the worst tick; and still more for one that
/// is not a number, so that no way through the machine code takes more.
const TOUCH: f64 = 50.0;
const NOT_A_NUMBER: f64 = 23.0;

/// 3, 4 and 5 planets. Counted to the instruction at 2 and 8 sub-steps, but for `given_up`: what is done of a whole tick up to
/// its second node, for three planets by function, in proportion to `hold` for others; `anew` at 2 sub-steps of four test joints, under
/// both laws. `fixed` is with torques that change; without
/// it is 34 to 42 less.
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
/// More in a tick whose state has numbers that are not canonical, by planet.
const CANONICAL: f64 = 42.0;
/// An equivalent gear: in contact, in free flight, and more for the changes of contact that a tick follows. Each counted to the
/// instruction, the last as the most that was found for states and torques of joints.
const EQUIVALENT: [f64; 3] = [151.0, 147.0, 96.0];
/// One mesh of a correction that parts or meets.
const CROSSING: f64 = 211.0;
/// One that crosses from flank to flank, or is not a number: more than that, found by the search for the worst tick.
const FLANK_TO_FLANK: f64 = 120.0;
/// More under the law `contact`: a mesh that crosses, a tick that begins anew.
const CONTACT: [f64; 2] = [10.0, 8.0];
/// More with compliance: a sub-step.
const COMPLIANCE: f64 = 44.0;
/// More with overtones: a planet in each evaluation, and again for each harmonic after the first.
const OVERTONES: f64 = 60.0;
const OVERTONE: f64 = 17.0;
/// The same for a mesh that crosses.
const CROSSING_OVERTONES: f64 = 36.0;
const CROSSING_OVERTONE: f64 = 19.0;
/// Evaluations in an exponential tick (some with rates), given up or not, in one that begins anew where some are taken whole, in a
/// sub-step.
const EVALUATIONS: [f64; 3] = [3.8, 3.0, 2.0];

/// Instructions of a joint's tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    hold: f64,
    given_up: f64,
    /// Where no tick is taken whole, and where some are.
    anew: [f64; 2],
    fixed: f64,
    substep: f64,
    correction: f64,
    crossing: f64,
    meshes: f64,
    verlet: &'static VerletCost,
    /// 0 for law `paper`, 1 for `contact`.
    law: usize,
}

impl Cost {
    /// Of a joint.
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
            // Where none is, it takes an evaluation less.
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

    /// Of an equivalent gear, whose tick has no sub-steps and at most two changes.
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
            // One contact, and what numbers at the ends of their range cost it.
            meshes: 1.0,
            verlet: &VERLET[0],
            law: 1,
        }
    }

    /// Whether a tick in which contact holds is taken as a whole, by the exponential flow: where that costs less than the
    /// sub-steps. Those that are corrected are as accurate and need no test of whether contact will hold.
    pub fn takes_whole_ticks(&self, substeps: Substeps) -> bool {
        match substeps {
            Substeps::Corrected(_) => self.substep == 0.0 || self.hold < self.contact_changes(substeps),
            Substeps::Verlet(count) => self.verlet.hold < self.pressing(count),
        }
    }

    /// While contact holds.
    pub fn contact_holds(&self, substeps: Substeps) -> f64 {
        match substeps {
            Substeps::Corrected(_) if self.takes_whole_ticks(substeps) => self.hold,
            Substeps::Verlet(_) if self.takes_whole_ticks(substeps) => self.verlet.hold,
            Substeps::Corrected(_) => self.contact_changes(substeps),
            Substeps::Verlet(count) => self.pressing(count),
        }
    }

    /// In sub-steps, none of which has a crossing.
    pub fn contact_changes(&self, substeps: Substeps) -> f64 {
        match substeps {
            Substeps::Corrected(count) => self.fixed + f64::from(count) * self.substep,
            Substeps::Verlet(count) => self.verlet.fixed[self.law] + f64::from(count) * self.verlet.substep[self.law],
        }
    }

    /// Every mesh crosses in two of the sub-steps (joints that rattle come to that by themselves), or in one of a tick that
    /// begins anew, after an exponential tick was given up where there are such; or touches its flank in every Verlet sub-step.
    pub fn all_crossing(&self, substeps: Substeps) -> f64 {
        match substeps {
            Substeps::Corrected(count) => {
                let twice = self.contact_changes(substeps) + f64::from(count.min(2)) * self.all();
                twice.max(self.contact_changes_anew(substeps) + self.all())
            }
            Substeps::Verlet(count) => self.given_up(substeps) + self.pressing(count),
        }
    }

    /// Every mesh crosses in every sub-step, from flank to flank, or is not a number in any Verlet sub-step: an
    /// upper bound on every state of the search.
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

    /// In sub-steps that begin anew.
    fn contact_changes_anew(&self, substeps: Substeps) -> f64 {
        let anew = self.anew[usize::from(self.takes_whole_ticks(substeps))];
        self.given_up(substeps) + anew + self.contact_changes(substeps)
    }

    /// An exponential tick that was tried in vain, where there are such.
    fn given_up(&self, substeps: Substeps) -> f64 {
        match substeps {
            _ if !self.takes_whole_ticks(substeps) => 0.0,
            Substeps::Corrected(_) => self.given_up,
            Substeps::Verlet(_) => self.verlet.given_up,
        }
    }

    /// The most sub-steps, of so many, with which `all_crossing` stays within so many instructions; zero if not even one
    /// does.
    pub fn affordable(&self, instructions: f64, most: u32) -> u32 {
        let fits = |substeps: &u32| self.all_crossing(Substeps::Corrected(*substeps)) <= instructions;
        (1..=most).take_while(fits).last().unwrap_or(0)
    }

    /// Every mesh touches its flank in every Verlet sub-step.
    fn pressing(&self, count: u32) -> f64 {
        self.contact_changes(Substeps::Verlet(count)) + f64::from(count) * self.meshes * TOUCH
    }

    fn all(&self) -> f64 {
        self.correction + self.meshes * self.crossing
    }
}
